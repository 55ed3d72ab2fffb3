//! What must hold before a parameter set may run: a recursion that is stable, and bounded by the displacement limits.
//!
//! How that is shown is each model's own ([`Recursion::bound`](crate::Recursion::bound)): the Voigt family by interval
//! arithmetic over its voltages and extrema, the others by their structure, a resonance by the
//! sum of its answers (`resonance.rs`), NARX by its clamp and a contraction.

use crate::math::Real;
use crate::range::Range;

/// Why a parameter set may not run.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum Inadmissible<T: Real = f32> {
    /// What a tick keeps of the displacement, `a(V)`, is not between 0 and 1: `t_s·rate(V)` is too large (or too small
    /// to be told from 0).
    #[error(
        "unstable: at {voltage} V the recursion keeps {a} of the displacement a tick, which must lie between 0 and 1, \
         and below 1 by at least 1/4096"
    )]
    Unstable {
        /// Voltage of the table's range at which `a(V)` is out of bounds, V relative to the model's zero.
        voltage: T,
        /// `a(V) = 1 − t_s·rate(V)` there, no unit: the part of the displacement that a tick keeps (Eq. 4.8).
        a: T,
    },
    /// Some voltage and some memory draw the displacement out of its limits.
    #[error(
        "some sequence of reversals draws the displacement to {} … {} µm, beyond the limits, {} … {} µm: correct the \
         parameters, or widen these",
        reach.min,
        reach.max,
        limits.min,
        limits.max
    )]
    Unbounded {
        /// The displacement that can be reached, µm.
        reach: Range<T>,
        /// What it is to lie within, µm.
        limits: Range<T>,
    },
    /// The model's resonance is not damped as far as the number type can tell.
    #[error(
        "unstable: the resonance must lie below half the tick rate and lose 1/4096 a tick: raise damping, or set both to 0"
    )]
    Undamped,
    /// The model's resonance is so slow that what an `f32` rounds in a tick would add up to a displacement.
    #[error(
        "the resonance lies below a 400th of the tick rate, where rounding outweighs it; what moves that slowly is creep: set resonance_hz \
         and damping to 0 and describe it by creep_times_s and creep_gains, or take a longer tick"
    )]
    Slow,
    /// Two runs of the same voltages need not come together, and then the rounding decides where they are.
    #[error(
        "unstable: a tick may make a difference {by} times as large, not 4095/4096 at most: a lower degree, or narrower limits_um"
    )]
    Spreads {
        /// What a tick may make of a difference at most.
        by: T,
    },
    /// The recursion has no bound at all.
    #[error("unstable: the recursion has no bound")]
    NoBound,
    /// The parameters overflow the number type.
    #[error("the parameters overflow within the voltage range or the displacement limits")]
    Overflow,
}

/// Checks that what can be reached lies within `limits`, both in µm. Returns what can be reached.
///
/// # Errors
/// It does not, or an end of it is no number.
pub fn within<T: Real>(reach: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
    // False for a NaN.
    let inside = limits.min <= reach.min && reach.min <= reach.max && reach.max <= limits.max;
    if inside { Ok(reach) } else { Err(Inadmissible::Unbounded { reach, limits }) }
}
