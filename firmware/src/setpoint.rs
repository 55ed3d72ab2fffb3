//! The set-point: the displacement that a controller wants by a voltage of its own, at a third channel of the ADC.
//!
//! A controller that is switched on after the board, or a wire that is plugged in later, must not move the amplifier on
//! its way there. So nothing is wanted until the voltage has been at rest and everything sound for [`CALM_TICKS`]
//! without a break. From then on every code is followed, except one near an end of the ADC's range: then the last
//! displacement is held, until the watch ([`crate::watch`]) calls it a fault.

use crate::ends::Ends;
use crate::rate::TICK_HZ;
use crate::watch::SATURATED;
use estimator_core::{AdcCode, Admitted, SetpointCalibration};

/// How long everything must have been sound, and the voltage at rest, before a set-point is followed: 1 s.
pub const CALM_TICKS: u32 = TICK_HZ;
/// A set-point at an end of its range is a fault within this time, so that it comes before the set-point is followed.
/// One that does not change shows later.
const _: () = assert!(SATURATED < CALM_TICKS);

/// A set-point's code.
#[derive(Clone, Copy, Debug)]
pub struct SetpointCode {
    /// As it was read, which shows whether it is one.
    pub read: AdcCode,
    /// As it would be were the supply not off.
    pub corrected: AdcCode,
}

/// The displacement that a set-point's codes ask for.
#[derive(Clone, Debug)]
pub struct Setpoint {
    calibration: SetpointCalibration,
    ends: Ends,
    /// Ticks at rest that everything has been sound for, at most [`CALM_TICKS`].
    calm: u32,
}

impl Setpoint {
    /// The set-point of a table that says which displacements its codes stand for.
    pub fn new(table: &Admitted) -> Option<Self> {
        let calibration = table.drive?.setpoint?;
        Some(Self { calibration, ends: Ends::new(table.adc.full_scale), calm: 0 })
    }

    /// Whether it is to be followed after a start without having been asked to.
    pub fn at_start(&self) -> bool {
        self.calibration.at_start
    }

    /// Waits for another [`CALM_TICKS`] before the set-point is followed.
    pub fn restart(&mut self) {
        self.calm = 0;
    }

    /// What is wanted at a tick, µm relative to the model's zero, where that can be said; `sound` says that nothing
    /// else is wrong, `rests` that the voltage is at rest, which matters before the set-point is followed only.
    pub fn wanted(&mut self, SetpointCode { read, corrected }: SetpointCode, sound: bool, rests: bool) -> Option<f32> {
        let plausible = !self.ends.near(read);
        if !sound {
            self.calm = 0;
            return None;
        }
        if self.calm < CALM_TICKS {
            self.calm = if plausible && rests { self.calm + 1 } else { 0 };
            return None;
        }
        plausible.then(|| self.calibration.displacement(corrected))
    }
}
