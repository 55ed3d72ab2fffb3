//! Preisach model, Eq. (3.1)–(3.5) (thesis 3.1.1): relays that switch up at α and down at β ≤ α, weighed by a density
//! that is constant in each cell of a triangular grid of n × n cells, n ≤ 10, over the voltages from `lower_v` to
//! `upper_v`.
//!
//! ```text
//! y = offset + Σ m_ij·(part of cell ij that is switched up)     µm
//! ascending:   y = y_min + E(V, V_min)                          Eq. (3.4)
//! descending:  y = y_max − E(V_max, V)                          Eq. (3.5)
//! ```
//!
//! Cell ij is `α` in the i-th and `β ≤ α` in the j-th interval of the grid; the list has them row by row: 00, 10, 11,
//! 20, …. `m_ij` is the mass of a whole cell; of the half cells at the diagonal (i = j) only half of it is there.
//! Relays give 0 or their mass, so that the offset is the displacement of negative saturation; the thesis's ±1 relays
//! have twice the jump, hence its ½ in Eq. (3.17).
//!
//! Rate-independent; V is the voltage behind a lag (`lagged.rs`). Beyond the grid's voltages every relay is switched.
//! See `everett.rs` for `E` (3.18), `memory.rs` for the reversals, `reversal_curves.rs` for densities from first-order
//! reversal curves (3.17)–(3.19).

mod everett;
mod memory;
mod reversal_curves;

pub use everett::{CELLS, SIDE};
pub use memory::{PreisachState, REVERSALS};
pub use reversal_curves::densities_from_reversal_curves;

use super::lagged::{self, Lagged};
use super::{Discretisation, Linear, Published, Recursion, solve};
use crate::admissible::{Inadmissible, within};
use crate::list::List;
use crate::math::Real;
use crate::range::Range;
use crate::rule::{self, Rule};
use everett::{Everett, side};
use serde::{Deserialize, Serialize};

/// Masses of the cells of Eq. (3.1) and the square of voltages that they divide.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreisachParameters {
    /// Time constant of the input lag, s; 0 is none. Below 0 the time by which the displacement is ahead of a tick
    /// after its voltage: at most a tick of it counts.
    pub lag_s: f32,
    /// Voltage at which every relay is down, V.
    pub lower_v: f32,
    /// Voltage at which every relay is up, V.
    pub upper_v: f32,
    /// Displacement (µm) that a whole cell makes, row by row: 1, 3, 6, … or 55 numbers, at least 0.
    pub densities_um: List<CELLS>,
    /// Displacement of negative saturation, every relay down, µm.
    pub offset_um: f32,
}

/// The largest quotient that `build` makes with the span of the voltages.
const SIDE_LIMIT: f32 = SIDE as f32;

impl Published for PreisachParameters {
    type Coefficients<T: Real> = Lagged<T, Preisach<T>, f32>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Self::Coefficients<T> {
        Lagged::build(self.lag_s, discretisation.sample_period, Preisach::build(self))
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        lagged::check(self.lag_s)?;
        if ![self.lower_v, self.upper_v, self.offset_um].iter().all(|number| number.is_finite()) {
            return Err("lower_v, upper_v and offset_um must be finite");
        }
        let span = self.upper_v - self.lower_v;
        if span <= 0.0 || !span.is_finite() || !(SIDE_LIMIT / span).is_finite() {
            return Err("upper_v must lie above lower_v");
        }
        if side(self.densities_um.len()).is_none() {
            return Err("densities_um must be n(n+1)/2 numbers with n of 1 to 10");
        }
        if !self.densities_um.iter().all(|density| density.is_finite() && *density >= 0.0) {
            return Err("densities_um must be finite and at least 0");
        }
        let sum = self.densities_um.iter().sum::<f32>();
        rule::check([("densities_um must not all be 0, and have a finite sum", sum > 0.0 && sum.is_finite())])
    }
}

/// The Everett function of Eq. (3.18) by cells, and the way from V to cells.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Preisach<T> {
    lower: f32,
    /// Cells of the grid in a volt.
    scale: f32,
    offset: T,
    everett: Everett<T>,
}

impl<T: Real> Preisach<T> {
    /// Coefficients of a set without a [fault](PreisachParameters::check); the lag is not among them.
    pub fn build(parameters: &PreisachParameters) -> Self {
        let everett = Everett::<T>::build(&parameters.densities_um);
        let lower = parameters.lower_v;
        let scale = everett.end().single() / (parameters.upper_v - lower);
        Self { lower, scale, offset: T::of(parameters.offset_um), everett }
    }

    /// The Everett function (µm) from `low` to `high`, V: what a rise between them adds.
    pub fn everett(&self, high: T, low: T) -> T {
        let (high, low) = (self.place(high), self.place(low));
        if low < high { self.everett.between(T::of(high), T::of(low)) } else { T::zero() }
    }

    /// A voltage in units of the grid, 0…n; 0 for NaN. An `f32` in every number type, see `memory.rs`.
    #[inline]
    fn place(&self, voltage: T) -> f32 {
        Range { min: 0.0, max: self.everett.end().single() }.clamp((voltage.single() - self.lower) * self.scale)
    }

    /// What the displacement (µm) can be for voltages of this range (V).
    ///
    /// Relays with α below the range are up, relays with β above it are down; the others may be either. Both bounds are
    /// attained by [`begin`](Recursion::begin). Widened by the rounding of as many branches as the memory holds.
    pub fn reach(&self, voltage: Range<T>) -> Range<T> {
        let end = self.everett.end();
        let total = self.everett.between(end, T::zero());
        let rounding = T::of(256.0 * f32::EPSILON) * (self.offset.abs() + total);
        let always = self.everett.between(T::of(self.place(voltage.min)), T::zero());
        let never = self.everett.between(end, T::of(self.place(voltage.max)));
        Range { min: self.offset + always - rounding, max: self.offset + (total - never) + rounding }
    }
}

impl<T: Real> Recursion<T> for Preisach<T> {
    type State = PreisachState<T>;

    /// From negative saturation up to a peak and back to this voltage; the peak is the one that gives the displacement,
    /// or, where that is not known, the mean of what the lowest and the highest peak give.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let (place, end) = (self.place(voltage), self.everett.end());
        let at = T::of(place);
        let after = |peak: T| self.offset + (self.everett.between(peak, T::zero()) - self.everett.between(peak, at));
        let displacement = displacement.unwrap_or((after(at) + after(end)) * T::of(0.5));
        let mut state = PreisachState::saturated();
        state.go(&self.everett, solve(displacement, at, end, after).single());
        state.go(&self.everett, place);
        state
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        self.offset + state.go(&self.everett, self.place(voltage))
    }

    /// Of a memory that is left as it is: a copy of it would be most of what the search of an inverse takes.
    #[inline]
    fn peek(&self, state: &Self::State, voltage: T) -> T {
        self.offset + state.peek(&self.everett, self.place(voltage))
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage), limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

impl<T: Real> Linear<T> for Preisach<T> {
    fn advance(&self, state: &mut Self::State, voltage: T) {
        state.go(&self.everett, self.place(voltage));
    }

    /// The part of each cell that is switched up, 0…1 of a whole cell's area (0…½ at the diagonal), in the order of the
    /// densities, then 1. They do not depend on the densities. After a tick that forgets they are those of what is
    /// remembered from then on.
    fn columns(&self, state: &Self::State, mut each: impl FnMut(T)) {
        for row in 0..self.everett.side() {
            for column in 0..=row {
                let mut up = T::zero();
                for (index, (from, to)) in state.points().zip(state.points().skip(1)).enumerate() {
                    up = if index.is_multiple_of(2) {
                        up + Everett::part(row, column, T::of(to.at), T::of(from.at))
                    } else {
                        up - Everett::part(row, column, T::of(from.at), T::of(to.at))
                    };
                }
                each(up);
            }
        }
        each(T::one());
    }
}
