//! The tabulated form: the affine map of a tick, linearly interpolated between knots over the voltage.
//!
//! The knots are spaced evenly over the voltage range, shifted by less than one interval so that one of them stands at
//! 0 V, where the drive has its cusp. Terms between knots are weighted means of the knots' terms, so a table whose knots
//! are admissible is admissible; [`covered`] says which voltages that concerns.

use crate::math::Real;
use crate::model::{Terms, Voigt};
use crate::range::Range;

/// Number of knots.
pub const KNOTS: usize = 257;
/// Number of intervals between them.
const INTERVALS: u32 = KNOTS as u32 - 1;

/// Where the knots stand.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Grid<T> {
    /// Voltage of the first knot, V.
    pub first: T,
    /// Knots per V.
    pub per_volt: T,
}

/// Where a voltage lies between the knots.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Position<T> {
    /// The knot on the left; below [`KNOTS`] − 1.
    index: u32,
    /// Weight of the knot on its right, 0 … 1.
    weight: T,
}

impl<T: Real> Grid<T> {
    /// The knots for a voltage range (V).
    pub fn of(voltage: Range<T>) -> Self {
        Self { first: covered(voltage).min, per_volt: T::one() / interval(voltage) }
    }

    /// The position of a voltage (V); at the nearest end beyond the knots.
    #[inline]
    pub fn locate(&self, voltage: T) -> Position<T> {
        let knots = (voltage - self.first) * self.per_volt;
        let index = knots.to_u32_saturating();
        if knots >= T::zero() && index < INTERVALS {
            Position { index, weight: knots - T::of(index as f32) }
        } else if knots > T::zero() {
            Position { index: INTERVALS - 1, weight: T::one() }
        } else {
            Position { index: 0, weight: T::zero() }
        }
    }
}

/// The per-tick functions at [`KNOTS`] voltages.
#[derive(Clone, PartialEq, Debug)]
pub struct Lookup<T> {
    /// Where the knots stand.
    pub grid: Grid<T>,
    /// The terms at the knots.
    pub knots: [Terms<T>; KNOTS],
}

/// From the first knot to the last, V: the voltage range and less than one interval more on either side.
pub fn covered<T: Real>(voltage: Range<T>) -> Range<T> {
    // One interval is spare, for the shift that puts a knot at 0 V.
    let step = interval(voltage);
    let crosses_zero = voltage.min < T::zero() && T::zero() < voltage.max;
    let first = if crosses_zero { (voltage.min / step).floor() * step } else { voltage.min };
    Range { min: first, max: first + T::of(INTERVALS as f32) * step }
}

fn interval<T: Real>(voltage: Range<T>) -> T {
    voltage.span() / T::of((INTERVALS - 1) as f32)
}

impl<T: Real> Lookup<T> {
    /// Tabulates a model over a voltage range (V).
    pub fn tabulate(model: &Voigt<T>, voltage: Range<T>) -> Self {
        let grid = Grid::of(voltage);
        let step = interval(voltage);
        let mut knots = [Terms { a: T::zero(), c: T::zero(), m: T::zero() }; KNOTS];
        for (knot, index) in knots.iter_mut().zip(0u16..) {
            *knot = model.terms(grid.first + T::of(f32::from(index)) * step);
        }
        Self { grid, knots }
    }

    /// The affine map at a voltage (V); at the nearest end beyond the knots.
    #[inline]
    pub fn terms(&self, voltage: T) -> Terms<T> {
        self.at(self.grid.locate(voltage))
    }

    /// The affine map at a position that this lookup's grid, or an equal one, has located.
    #[inline]
    pub fn at(&self, position: Position<T>) -> Terms<T> {
        let left = position.index as usize;
        let (left, right) = (&self.knots[left], &self.knots[left + 1]);
        let mean = |l: T, r: T| l + position.weight * (r - l);
        Terms { a: mean(left.a, right.a), c: mean(left.c, right.c), m: mean(left.m, right.m) }
    }
}
