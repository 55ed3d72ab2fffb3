//! Whether the amplifier does what the drive commands: the voltage that the ADC reads beside those that were commanded.
//!
//! An amplifier lags, and the drive does not know by how much. So the voltage is held against all that was commanded in
//! the last [`REACH_TICKS`], and is astray where it lies beyond them by more than [`TOLERANCE`] of the drive's range.
//! An open wire, a tripped amplifier and a wrong span are found as soon as the command goes where the voltage does not;
//! but not where the voltage of the open wire lies amid a swing that is faster than the reach.

use crate::rate::ticks_in;
use estimator_core::{AdcCalibration, AdcCode, DriveLimits, Range};

/// How far the voltage may lie beyond what was commanded, as a part of the drive's range.
pub const TOLERANCE: f32 = 0.05;
/// How long what was commanded counts at most, ticks: 20 ms. At least it counts for half as long.
pub const REACH_TICKS: u32 = ticks_in(20);

/// What was commanded lately.
#[derive(Clone, Debug)]
pub struct AmplifierCheck {
    adc: AdcCalibration,
    tolerance_v: f32,
    /// Commanded since `ticks`, and in the half of the reach before that, V.
    now: Range,
    before: Range,
    ticks: u32,
}

impl AmplifierCheck {
    /// Of an amplifier at rest.
    pub fn new(adc: AdcCalibration, limits: &DriveLimits) -> Self {
        let rest = Range { min: limits.rest_v, max: limits.rest_v };
        Self { adc, tolerance_v: TOLERANCE * limits.range_v.span(), now: rest, before: rest, ticks: 0 }
    }

    /// Takes the voltage (V) that is commanded at this tick.
    #[inline]
    pub fn commanded(&mut self, voltage: f32) {
        if self.ticks == REACH_TICKS / 2 {
            self.before = self.now;
            self.now = Range { min: voltage, max: voltage };
            self.ticks = 0;
        }
        self.ticks += 1;
        self.now = Range { min: self.now.min.min(voltage), max: self.now.max.max(voltage) };
    }

    /// Whether the voltage that the ADC reads is none that was commanded lately.
    #[inline]
    pub fn astray(&self, code: AdcCode) -> bool {
        let voltage: f32 = self.adc.voltage(code);
        let (min, max) = (self.now.min.min(self.before.min), self.now.max.max(self.before.max));
        voltage < min - self.tolerance_v || voltage > max + self.tolerance_v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate::TICK_HZ;

    const ADC: AdcCalibration =
        AdcCalibration { gain_v_per_code: 0.002, offset_v: -10.0, invert: false, full_scale: 65_520 };
    const LIMITS: DriveLimits =
        DriveLimits { range_v: Range { min: 0.0, max: 100.0 }, rest_v: 20.0, slew_v_per_s: 2e3 };

    /// Of ten swings of 10 Hz over most of the range, the part of the ticks at which this amplifier is astray.
    fn astray(mut amplifier: impl FnMut(f32) -> f32) -> f32 {
        let mut check = AmplifierCheck::new(ADC, &LIMITS);
        let ticks = TICK_HZ;
        let mut count = 0;
        for k in 0..ticks {
            let commanded = 60.0 - 40.0 * (k as f32 / TICK_HZ as f32 * 10.0 * core::f32::consts::TAU).cos();
            count += u32::from(check.astray(ADC.code(amplifier(commanded))));
            check.commanded(commanded);
        }
        count as f32 / ticks as f32
    }

    #[test]
    fn an_amplifier_that_lags_or_is_a_little_off_is_none() {
        assert_eq!(astray(|volts| volts), 0.0);
        assert_eq!(astray(|volts| 1.03 * volts + 1.0), 0.0);
        for lag_ticks in [2.0, 10.0, 20.0] {
            let mut voltage = 20.0;
            let lagging = |volts: f32| {
                voltage += (volts - voltage) / lag_ticks;
                voltage
            };
            assert_eq!(astray(lagging), 0.0, "{lag_ticks}");
        }
    }

    #[test]
    fn what_does_not_go_along_is_found() {
        for (name, amplifier) in [
            ("a tripped amplifier", (|_| 0.0) as fn(f32) -> f32),
            ("an open wire", |_| 55.0),
            ("a wrong span", |volts| 1.2 * volts),
            ("an inverted monitor", |volts| 120.0 - volts),
        ] {
            // A fifth of the time is enough for a fault.
            assert!(astray(amplifier) > 0.2, "{name}: {}", astray(amplifier));
        }
    }
}
