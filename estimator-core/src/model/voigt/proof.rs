//! The proof that a parameter set of the Voigt family is stable at every voltage and bounded on its own extrema.
//!
//! 1. **Stable.** `0 < a(V) < 1` over the whole voltage range, so that the recursion neither oscillates nor diverges.
//!    `rate(V)` is convex with its minimum at β, so three voltages decide. What a tick takes away, `1 − a`, must be at
//!    least [`LEAST_DECAY`]: it is rounded to the 2⁻²⁴ of an f32 near 1, and the static displacement with it. The
//!    zero-order hold may keep nothing (a = 0), since it cannot overshoot.
//! 2. **Bounded.** With 1, a tick moves the displacement to a weighted mean of itself and of the static displacement
//!    `(drive(V) + ext)/rate(V)`. If that static displacement lies within the limits for *every* voltage of the range
//!    and *every* pair of extrema (voltage within the range, displacement within the limits), then the limits are
//!    invariant: no sequence of voltages, reversals and glitches can carry the displacement out of them. This is
//!    checked with interval arithmetic on [`CELLS`] cells of the voltage range (drive is monotone, rate convex), so it
//!    is a proof, not a trial, up to rounding: less than 2⁻²⁴/[`LEAST_DECAY`], 0.03 % of the displacement, and that the
//!    clamp of the running estimator takes.
//!
//! The second condition is what a parameter set with positive feedback through `y_ext` fails, however well it predicts
//! one step ahead.

use super::coefficients::{Voigt, VoigtPoint};
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
    let step = (voltage.max - voltage.min) / T::of(f32::from(CELLS));
    let between = (1..CELLS).map(|cell| voltage.min + step * T::of(f32::from(cell)));
    let ends = core::iter::once(voltage.min).chain(between).chain(core::iter::once(voltage.max));
    check_between(model, ends.map(|voltage| model.point(voltage)), voltage, limits)
}

/// As [`check`], with the points between the cells of the voltage range given, from its lower end to its upper one.
pub fn check_between<T: Real>(
    model: &Voigt<T>,
    points: impl Iterator<Item = VoigtPoint<T>>,
    voltage: Range<T>,
    limits: Range<T>,
) -> Result<Range<T>, Inadmissible<T>> {
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
    within(static_reach(model, points, extremum_range(model, voltage, limits)), limits)?;
    Ok(limits)
}

/// The values that the extremum terms can have (µm/s); 0 is one of them.
fn extremum_range<T: Real>(model: &Voigt<T>, voltage: Range<T>, limits: Range<T>) -> Range<T> {
    let span = |p: T, q: T| Range::point(T::zero()).include(p).include(q);
    let of_voltage = span(model.voltage_term(voltage.min), model.voltage_term(voltage.max));
    let of_displacement = span(model.displacement_term(limits.min), model.displacement_term(limits.max));
    Range { min: of_voltage.min + of_displacement.min, max: of_voltage.max + of_displacement.max }
}

/// Bounds of `(drive(V) + ext)/rate(V)` over the voltages from the first point to the last.
fn static_reach<T: Real>(model: &Voigt<T>, mut points: impl Iterator<Item = VoigtPoint<T>>, ext: Range<T>) -> Range<T> {
    let slowest = model.slowest_voltage();
    let mut reach = Range::empty();
    let Some(mut left) = points.next() else { return reach };
    for right in points {
        let passes_slowest = left.voltage < slowest && slowest < right.voltage;
        let least = if passes_slowest { model.rate(slowest) } else { left.rate.min(right.rate) };
        let most = left.rate.max(right.rate);
        let quotient =
            |numerator: T, away: T, towards: T| numerator / if numerator > T::zero() { away } else { towards };
        let highest = quotient(right.drive + ext.max, least, most);
        let lowest = quotient(left.drive + ext.min, most, least);
        if lowest.is_nan() || highest.is_nan() {
            // `include` would pass over it.
            return Range::point(T::nan());
        }
        reach = reach.include(lowest).include(highest);
        left = right;
    }
    reach
}
