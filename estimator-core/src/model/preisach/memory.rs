//! The memory of the Preisach model: the reversals of the voltage that nothing has wiped out, Eq. (3.4) and (3.5).
//!
//! Reversals alternate: a maximum, a minimum, …; each maximum is below the last, each minimum above. Beneath the first
//! lies the negative saturation, a minimum. A voltage that passes an older extreme wipes out the loop that began there.
//! The displacement is that of the last reversal plus or minus the Everett function from there: one interpolation a
//! tick.
//!
//! Memory is fixed: 24 reversals. At the end of the tick that brings the 25th, two successive maxima (or minima) with
//! what lies between them are merged into one, at the voltage between them at which as much area of the Preisach plane
//! is switched up as down; of all such places, the one where that area is smallest. With q and p the distances of the
//! extreme between them from those before and behind it, and A that of the two, either area is `A·p·q/(p + q)`. A
//! uniform density notices nothing of it. The rectangles A·(p + q) of the 22 places cover the plane's n²/2 cells at
//! most twice, so the smallest area is at most n²/88 cells, and the displacement changes by at most that many times the
//! largest density. What remains is again the memory of some history. Areas, not masses, decide, so that the memory
//! (and with it the columns of the identification) does not depend on the densities. Which pair is merged hangs on the
//! last bit of a voltage, and so places are `f32` in every number type: reference and target remember and forget the
//! same. Such a tick costs up to 25 interpolations and 22 divisions.

use super::everett::Everett;
use crate::math::Real;
use heapless::Vec;

/// Most reversals that are remembered.
pub const REVERSALS: usize = 24;

/// A voltage, in units of the grid, and the displacement there, µm above negative saturation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Reversal<T> {
    pub at: f32,
    pub displacement: T,
}

/// The reversals, and the voltage and displacement now.
#[derive(Clone, PartialEq, Debug)]
pub struct PreisachState<T> {
    /// One place more than are remembered from tick to tick: the 25th is there within a tick only.
    reversals: Vec<Reversal<T>, { REVERSALS + 1 }>,
    now: Reversal<T>,
}

impl<T: Real> PreisachState<T> {
    /// The memory after a swing to negative saturation.
    pub(super) fn saturated() -> Self {
        Self { reversals: Vec::new(), now: Self::floor() }
    }

    fn floor() -> Reversal<T> {
        Reversal { at: 0.0, displacement: T::zero() }
    }

    /// Reversals that are remembered now.
    pub fn reversals(&self) -> usize {
        self.reversals.len()
    }

    /// Negative saturation and every reversal in turn; every second one is a minimum.
    fn extremes(&self) -> impl Iterator<Item = Reversal<T>> + Clone + '_ {
        core::iter::once(Self::floor()).chain(self.reversals.iter().copied())
    }

    /// The extremes, and now.
    pub(super) fn points(&self) -> impl Iterator<Item = Reversal<T>> + Clone + '_ {
        self.extremes().chain([self.now])
    }

    /// What [`go`](Self::go) would return.
    #[inline]
    pub(super) fn peek(&self, everett: &Everett<T>, at: f32) -> T {
        if at == self.now.at { self.now.displacement } else { self.branch(everett, self.left(at), at).displacement }
    }

    /// Takes a voltage (units of the grid, 0…n); returns the displacement (µm) above negative saturation. In a tick
    /// that forgets it is that of the whole memory; the next tick and [`points`](Self::points) go by what is left.
    #[inline]
    pub(super) fn go(&mut self, everett: &Everett<T>, at: f32) -> T {
        if at == self.now.at {
            return self.now.displacement;
        }
        let left = self.left(at);
        let there = self.branch(everett, left, at);
        if left > self.reversals.len() {
            // There is a place: a full memory has forgotten two in the tick that filled it.
            let _ = self.reversals.push(self.now);
        } else {
            self.reversals.truncate(left);
        }
        self.now = there;
        if self.reversals.is_full() {
            self.forget(everett);
        }
        there.displacement
    }

    /// How many reversals nothing has wiped out once the voltage has come to another one than now's; where it turns,
    /// now is counted as the last of them.
    #[inline]
    fn left(&self, at: f32) -> usize {
        let count = self.reversals.len();
        let turns = (at < self.now.at) == count.is_multiple_of(2);
        let mut left = count + usize::from(turns);
        while let Some(last) = left.checked_sub(1) {
            let older = last.checked_sub(1).and_then(|index| self.reversals.get(index)).map_or(0.0, |r| r.at);
            let passed = if left.is_multiple_of(2) { at >= older } else { at <= older };
            if !passed {
                break;
            }
            // The first fall ends at the negative saturation, which is no entry.
            left = last.saturating_sub(1);
        }
        left
    }

    /// Where the branch from the last of the first `count` reversals is at this voltage. One more than there are is
    /// the branch that turns at the voltage of now.
    #[inline]
    fn branch(&self, everett: &Everett<T>, count: usize, at: f32) -> Reversal<T> {
        let from = match count.checked_sub(1) {
            Some(last) => self.reversals.get(last).copied().unwrap_or(self.now),
            None => Self::floor(),
        };
        let displacement = if count.is_multiple_of(2) {
            from.displacement + everett.between(T::of(at), T::of(from.at))
        } else {
            from.displacement - everett.between(T::of(from.at), T::of(at))
        };
        Reversal { at, displacement }
    }

    #[cold]
    fn forget(&mut self, everett: &Everett<T>) {
        let mut smallest: Option<(usize, f32, f32)> = None;
        let points = || self.extremes().map(|point| point.at);
        let between = points().zip(points().skip(2)).zip(points().skip(4));
        for (index, (((before, middle), after), (first, second))) in
            between.zip(points().skip(1).zip(points().skip(3))).enumerate()
        {
            let (to_middle, to_after) = ((middle - before).abs(), (after - middle).abs());
            // Extremes of one kind differ: equal ones have wiped each other out.
            let merged = first + (second - first) * (to_after / (to_middle + to_after));
            let area = (first - merged).abs() * to_middle;
            if smallest.is_none_or(|(_, least, _)| area <= least) {
                smallest = Some((index, area, merged));
            }
        }
        let Some((index, _, merged)) = smallest else { return };
        if let Some(first) = self.reversals.get_mut(index) {
            first.at = merged;
        }
        // `index` counts quintuples of extremes, whose middle three are reversals: these two exist.
        self.reversals.remove(index + 1);
        self.reversals.remove(index + 1);
        for place in index..self.reversals.len() {
            let Some(at) = self.reversals.get(place).map(|reversal| reversal.at) else { return };
            let reversal = self.branch(everett, place, at);
            if let Some(to) = self.reversals.get_mut(place) {
                *to = reversal;
            }
        }
        self.now = self.branch(everett, self.reversals.len(), self.now.at);
    }
}
