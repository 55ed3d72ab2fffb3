//! Whether the estimate still depends on where it was assumed to start, or on voltages that the model was not fed.
//!
//! Hysteresis forgets what lies within a swing of the voltage, and so does the estimate: it counts as settled once the
//! voltage has turned at either end of a swing of half of the table's voltage range ([`SETTLED_SWING`]).

use crate::extremum::Tracker;
use crate::math::Real;
use crate::range::Range;

/// Part of the table's voltage range that must lie between reversals for the estimate to count as settled.
pub const SETTLED_SWING: f32 = 0.5;

/// The reversals since the start, or since the last voltage that was not the model's.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settling<T> {
    tracker: Tracker<T>,
    /// Voltages of the reversals so far.
    turned: Range<T>,
    /// What must lie between them, V.
    swing: T,
}

impl<T: Real> Settling<T> {
    /// Nothing seen yet. `voltage_range` is the table's, `deadband` the retreat that counts as a reversal, both in V.
    pub fn new(voltage_range: Range<T>, deadband: T) -> Self {
        Self {
            tracker: Tracker::new(deadband),
            turned: Range::empty(),
            swing: T::of(SETTLED_SWING) * voltage_range.span(),
        }
    }

    /// Takes this tick's voltage (V); `true` from the tick on that reveals the second end of a swing of half the range.
    pub fn settles(&mut self, voltage: T) -> bool {
        // Only the voltages of the reversals are asked for.
        if !self.tracker.update(voltage, T::zero()) {
            return false;
        }
        self.turned = self.turned.include(self.tracker.last().voltage);
        self.turned.span() >= self.swing
    }
}
