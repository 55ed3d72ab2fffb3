//! The proof that a parameter set of the Voigt family is stable at every voltage and bounded on its own extrema.
//!
//! 1. **Stable.** `0 < a(V) < 1` over the whole voltage range, so that the recursion neither oscillates nor diverges.
//!    `rate(V)` is convex with its minimum at β, so three voltages decide. What a tick takes away, `1 − a`, must be at
//!    least [`LEAST_DECAY`]: it is rounded to the 2⁻²⁴ of an f32 near 1, and the static displacement with it. The
//!    zero-order hold may keep nothing (a = 0), since it cannot overshoot.
//! 2. **Bounded.** With 1, a tick moves the displacement to a weighted mean of itself and of the static displacement
//!    `(drive(V) + ext)/rate(V)`. If that static displacement lies within the limits for *every* voltage of the range
//!    and *every* pair of extrema (voltage within the range, displacement within the limits), then the limits are
//!    invariant: no sequence of voltages, reversals and glitches can carry the displacement out of them. This is checked
//!    with interval arithmetic on [`CELLS`] cells of the voltage range (drive is monotone, rate convex), so it is a
//!    proof, not a trial, up to rounding: less than 2⁻²⁴/[`LEAST_DECAY`], 0.03 % of the displacement, and that the clamp of
//!    the running estimator takes.
//!
//! The second condition is what a parameter set with positive feedback through `y_ext` fails, however well it predicts
//! one step ahead.

use super::coefficients::Voigt;
use crate::admissible::{Inadmissible, within};
use crate::math::Real;
use crate::model::published::Scheme;
use crate::range::Range;

/// Smallest part of the displacement that a tick may take away.
pub const LEAST_DECAY: f32 = 1.0 / 4096.0;
/// Cells into which the voltage range is cut for the interval proof.
const CELLS: u16 = 256;

/// Checks both conditions. Returns the limits (µm), which are then invariant.
///
/// `voltage` in V (relative to the model's zero). All of the model's parameters are finite, P, h and f at least 0.
pub fn check<T: Real>(model: &Voigt<T>, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
    let overflows =
        [voltage.min, voltage.max].iter().any(|&v| !model.drive(v).is_finite() || !model.voltage_term(v).is_finite())
            || [limits.min, limits.max].iter().any(|&y| !model.displacement_term(y).is_finite());
    if overflows {
        return Err(Inadmissible::Overflow);
    }
    let slowest = voltage.clamp(model.slowest_voltage());
    for v in [voltage.min, voltage.max, slowest] {
        let a = model.terms(v).a;
        let kept = a > T::zero() || (a == T::zero() && model.scheme == Scheme::ZeroOrderHold);
        // Not the opposite comparisons: a NaN must fail.
        if !(kept && T::one() - a >= T::of(LEAST_DECAY)) {
            return Err(Inadmissible::Unstable { voltage: v, a });
        }
    }
    within(static_reach(model, voltage, extremum_range(model, voltage, limits)), limits)?;
    Ok(limits)
}

/// The values that the extremum terms can have (µm/s); 0 is one of them.
fn extremum_range<T: Real>(model: &Voigt<T>, voltage: Range<T>, limits: Range<T>) -> Range<T> {
    let span = |p: T, q: T| Range::point(T::zero()).include(p).include(q);
    let of_voltage = span(model.voltage_term(voltage.min), model.voltage_term(voltage.max));
    let of_displacement = span(model.displacement_term(limits.min), model.displacement_term(limits.max));
    Range { min: of_voltage.min + of_displacement.min, max: of_voltage.max + of_displacement.max }
}

/// Bounds of `(drive(V) + ext)/rate(V)` over the voltage range.
fn static_reach<T: Real>(model: &Voigt<T>, voltage: Range<T>, ext: Range<T>) -> Range<T> {
    let step = (voltage.max - voltage.min) / T::of(f32::from(CELLS));
    let slowest = model.slowest_voltage();
    let mut reach = Range::empty();
    let mut left = voltage.min;
    let (mut left_rate, mut left_drive) = (model.rate(left), model.drive(left));
    for cell in 1..=CELLS {
        let right = if cell == CELLS { voltage.max } else { voltage.min + step * T::of(f32::from(cell)) };
        let (right_rate, right_drive) = (model.rate(right), model.drive(right));
        let least = if left < slowest && slowest < right { model.rate(slowest) } else { left_rate.min(right_rate) };
        let most = left_rate.max(right_rate);
        let quotient =
            |numerator: T, away: T, towards: T| numerator / if numerator > T::zero() { away } else { towards };
        let highest = quotient(right_drive + ext.max, least, most);
        let lowest = quotient(left_drive + ext.min, most, least);
        if lowest.is_nan() || highest.is_nan() {
            // `include` would pass over it.
            return Range::point(T::nan());
        }
        reach = reach.include(lowest).include(highest);
        (left, left_rate, left_drive) = (right, right_rate, right_drive);
    }
    reach
}
