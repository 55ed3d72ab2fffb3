//! The tabulated form: the affine map of a tick, linearly interpolated between knots over the voltage.
//!
//! The knots are spaced evenly over the voltage range, shifted by less than one interval so that one of them stands at
//! 0 V, where the drive has its cusp. Terms between knots are weighted means of the knots' terms, so a table whose knots
//! are admissible is admissible; [`covered`] says which voltages that concerns.

use crate::math::Real;
use crate::model::{Terms, Voigt};
use crate::range::Range;
use crate::table::Table;

/// Number of knots.
pub const KNOTS: usize = 257;
/// Number of intervals between them.
const INTERVALS: u16 = KNOTS as u16 - 1;

/// The per-tick functions at [`KNOTS`] voltages.
#[derive(Clone, PartialEq, Debug)]
pub struct Lookup<T> {
    /// Voltage of the first knot, V.
    pub first: T,
    /// Knots per V.
    pub per_volt: T,
    /// The terms at the knots.
    pub knots: [Terms<T>; KNOTS],
}

/// From the first knot to the last, V: the voltage range and less than one interval more on either side.
pub fn covered<T: Real>(voltage: Range<T>) -> Range<T> {
    // One interval is spare, for the shift that puts a knot at 0 V.
    let step = interval(voltage);
    let crosses_zero = voltage.min < T::zero() && T::zero() < voltage.max;
    let first = if crosses_zero { (voltage.min / step).floor() * step } else { voltage.min };
    Range { min: first, max: first + T::of(f32::from(INTERVALS)) * step }
}

fn interval<T: Real>(voltage: Range<T>) -> T {
    voltage.span() / T::of(f32::from(INTERVALS - 1))
}

impl<T: Real> Lookup<T> {
    /// Tabulates a table's model over its voltage range.
    pub fn build(table: &Table) -> Self {
        Self::tabulate(&table.coefficients(), table.voltage_range_v.of())
    }

    fn tabulate(model: &Voigt<T>, voltage: Range<T>) -> Self {
        let step = interval(voltage);
        let first = covered(voltage).min;
        let mut knots = [Terms { a: T::zero(), c: T::zero(), m: T::zero() }; KNOTS];
        for (knot, index) in knots.iter_mut().zip(0..) {
            *knot = model.terms(first + T::of(f32::from(index as u16)) * step);
        }
        Self { first, per_volt: T::one() / step, knots }
    }

    /// The affine map at a voltage (V); at the nearest end beyond the knots.
    #[inline]
    pub fn terms(&self, voltage: T) -> Terms<T> {
        let position = (voltage - self.first) * self.per_volt;
        let index = position.to_u16_saturating().min(INTERVALS - 1);
        let weight = position - T::of(f32::from(index));
        let weight = weight.max(T::zero()).min(T::one());
        let (left, right) = (&self.knots[usize::from(index)], &self.knots[usize::from(index) + 1]);
        let mean = |l: T, r: T| l + weight * (r - l);
        Terms { a: mean(left.a, right.a), c: mean(left.c, right.c), m: mean(left.m, right.m) }
    }
}
