//! What must hold before a parameter set may run: stable at every voltage, and bounded on its own extrema.
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
//! one step ahead. A linear interpolation between knots that pass keeps passing: its static displacement is a mediant of
//! theirs.

use crate::math::Real;
use crate::model::{Scheme, Voigt};
use crate::range::Range;

/// Smallest part of the displacement that a tick may take away.
pub const LEAST_DECAY: f32 = 1.0 / 4096.0;
/// Cells into which the voltage range is cut for the interval proof.
pub const CELLS: u16 = 256;

/// Why a parameter set may not run.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Inadmissible<T = f32> {
    /// `a(V)` is not between 0 and 1: `t_s·rate(V)` is too large (or too small to be told from 0).
    Unstable {
        /// Where, V.
        voltage: T,
        /// The offending `a`.
        a: T,
    },
    /// Some voltage and some pair of extrema draw the displacement out of its limits.
    Unbounded {
        /// The displacement that can be reached, µm.
        reach: Range<T>,
    },
    /// A model beyond the Voigt family whose recursion is unstable.
    NoBound,
}

impl<T: Real> core::fmt::Display for Inadmissible<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unstable { voltage, a } => write!(
                f,
                "unstable: at {voltage} V the recursion keeps {a} of the displacement a tick, which must lie between 0 and \
                 1, and below 1 by at least 1/4096"
            ),
            Self::Unbounded { reach } => write!(
                f,
                "unbounded: some sequence of reversals draws the displacement to {} … {} µm, beyond its limits",
                reach.min, reach.max
            ),
            Self::NoBound => write!(f, "unstable: the recursion has no bound"),
        }
    }
}

impl<T: Real> core::error::Error for Inadmissible<T> {}

/// Checks both conditions. Returns the static displacement that can be reached, which lies within `limits`.
///
/// `voltage` in V (relative to the model's zero), `limits` in µm. All of the model's parameters are finite, P, h and f
/// at least 0.
pub fn check<T: Real>(model: &Voigt<T>, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
    let slowest = voltage.clamp(model.slowest_voltage());
    for v in [voltage.min, voltage.max, slowest] {
        let a = model.terms(v).a;
        let kept = a > T::zero() || (a == T::zero() && model.scheme() == Scheme::ZeroOrderHold);
        // Not the opposite comparisons: a NaN must fail.
        if !(kept && T::one() - a >= T::of(LEAST_DECAY)) {
            return Err(Inadmissible::Unstable { voltage: v, a });
        }
    }
    check_reach(Some(static_reach(model, voltage, extremum_range(model, voltage, limits))), limits)
}

/// Checks the bound that a model beyond the Voigt family has by its structure: what it can reach lies within `limits` (µm).
pub fn check_reach<T: Real>(reach: Option<Range<T>>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
    let reach = reach.ok_or(Inadmissible::NoBound)?;
    // False for a NaN.
    let inside = limits.min <= reach.min && reach.min <= reach.max && reach.max <= limits.max;
    if inside { Ok(reach) } else { Err(Inadmissible::Unbounded { reach }) }
}

/// The values that the extremum terms can have (µm/s); 0 is one of them.
fn extremum_range<T: Real>(model: &Voigt<T>, voltage: Range<T>, limits: Range<T>) -> Range<T> {
    let span = |p: T, q: T| Range { min: p.min(q).min(T::zero()), max: p.max(q).max(T::zero()) };
    let of_voltage = span(model.voltage_term(voltage.min), model.voltage_term(voltage.max));
    let of_displacement = span(model.displacement_term(limits.min), model.displacement_term(limits.max));
    Range { min: of_voltage.min + of_displacement.min, max: of_voltage.max + of_displacement.max }
}

/// Bounds of `(drive(V) + ext)/rate(V)` over the voltage range.
fn static_reach<T: Real>(model: &Voigt<T>, voltage: Range<T>, ext: Range<T>) -> Range<T> {
    let step = (voltage.max - voltage.min) / T::of(f32::from(CELLS));
    let slowest = model.slowest_voltage();
    let mut reach = Range { min: T::infinity(), max: T::neg_infinity() };
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
            // `max` and `min` would pass over it.
            return Range { min: T::nan(), max: T::nan() };
        }
        reach = Range { min: reach.min.min(lowest), max: reach.max.max(highest) };
        (left, left_rate, left_drive) = (right, right_rate, right_drive);
    }
    reach
}
