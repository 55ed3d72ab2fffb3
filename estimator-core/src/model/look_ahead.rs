//! A displacement seen up to a tick ahead of the one that a rate-independent model gives.
//!
//! ```text
//! y_a = y + a·(y − y'),   a = min(−lag/t_s, 1) for lag < 0     y' the displacement a tick ago
//! ```
//!
//! For tick k + 1 such a model gives what the voltage of tick k makes. A sensor that is read at the same instant as the
//! voltage is a whole tick ahead of that, and no lag can be short enough. The displacement is extrapolated and not the
//! input, since an input that may not come true must move no memory. What goes beyond the displacements that the model
//! can reach is left to the table's limits.

use crate::math::Real;

/// a of the equation above, 0 to 1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LookAhead<T>(T);

impl<T: Real> LookAhead<T> {
    /// What a lag (s) below 0 asks for, at ticks of `sample_period` seconds; none for any other.
    pub fn build(lag: T, sample_period: T) -> Self {
        let ticks = -lag / sample_period;
        Self(if ticks > T::zero() { ticks.min(T::one()) } else { T::zero() })
    }

    /// No look-ahead: what is seen is the equation's own.
    pub fn none() -> Self {
        Self(T::zero())
    }

    /// Whether what is seen hangs on a tick ago.
    pub fn is_some(&self) -> bool {
        self.0 > T::zero()
    }

    /// A quantity seen ahead, of now and a tick ago; without a look-ahead it is the one of now itself.
    #[inline]
    pub fn of(&self, now: T, before: T) -> T {
        if self.is_some() { now + self.0 * (now - before) } else { now }
    }
}
