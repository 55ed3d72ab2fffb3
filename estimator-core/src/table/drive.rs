//! Whether a table may drive the amplifier: its model has an inverse within the limits, and the converters and an `f32`
//! resolve what it puts out.

use super::{Admitted, LARGEST_OFFSET_CODE, OFFSET_RULE, TableError};
use crate::calibration::{DriveCalibration, DriveLimits};
use crate::inverse::{Inverse, InverseContext, NoInverse};
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;

/// What a drive changes its voltage by in a tick is so many machine epsilons of its largest voltage at least. Each
/// change is then rounded by less than a thirtieth; by one of half an epsilon the voltage would stand still.
const LEAST_STRIDE_EPSILONS: f32 = 16.0;
const STRIDE_RULE: Rule =
    "the drive's slew_v_per_s must be larger: a tick's change of the voltage would be lost in rounding";
/// A drive goes through its range in this time at most, s. A device that fails goes to rest before it starts anew, and
/// answers nobody meanwhile; an actuator creeps as much in ten minutes as a slower ramp is there to avoid.
const LONGEST_SWEEP_S: f32 = 600.0;

impl Admitted {
    /// The inverse of the model, at rest, within limits that may be other than the table's own.
    ///
    /// # Errors
    /// The limits break a rule, or the model has no inverse.
    pub fn inverse<T: Real>(&self, limits: &DriveLimits) -> Result<Inverse<T>, NoInverse> {
        let zero = self.voltage_zero_v;
        let Range { min, max } = self.voltage_range_v;
        limits.check(Range { min: min + zero, max: max + zero }).map_err(NoInverse::Limits)?;
        if !self.resolves_stride::<T>(limits) {
            return Err(NoInverse::Limits(STRIDE_RULE));
        }
        let context = InverseContext {
            voltage_zero: T::of(zero),
            sample_period: self.sample_period(),
            displacement_span: T::of(self.displacement_limits_um.span()),
        };
        Inverse::build(&self.engine(), &context, limits)
    }

    /// Whether an inverse that computes in `T` tells its voltages of two ticks apart, at its slowest and wherever
    /// in its range.
    fn resolves_stride<T: Real>(&self, limits: &DriveLimits) -> bool {
        let Range { min, max } = limits.range_v;
        let zero = self.voltage_zero_v;
        let largest = T::of((min - zero).abs().max((max - zero).abs()));
        let stride = T::of(limits.slew_v_per_s) * self.sample_period();
        stride >= T::of(LEAST_STRIDE_EPSILONS) * T::epsilon() * largest
    }

    pub(super) fn check_drive(&self, drive: &DriveCalibration) -> Result<(), TableError> {
        let DriveCalibration { gain_codes_per_v, offset_code, limits, setpoint } = *drive;
        if !gain_codes_per_v.is_finite() || !offset_code.is_finite() || gain_codes_per_v == 0.0 {
            return Err(TableError::OutOfRange { rule: "the drive's gain and offset must be finite, the gain not 0" });
        }
        if offset_code.abs() > LARGEST_OFFSET_CODE {
            return Err(TableError::OutOfRange { rule: OFFSET_RULE });
        }
        if gain_codes_per_v.abs() * limits.range_v.span() < 1.0 {
            return Err(TableError::OutOfRange { rule: "the drive's gain must make its range_v a code wide at least" });
        }
        if self.amplifier_slew_v_per_s.is_some_and(|slew| limits.slew_v_per_s > slew) {
            return Err(TableError::OutOfRange {
                rule: "the drive's slew_v_per_s must be no more than amplifier_slew_v_per_s, the fastest that the amplifier can",
            });
        }
        self.inverse::<f32>(&limits).map_err(TableError::Drive)?;
        if limits.range_v.span() > LONGEST_SWEEP_S * limits.slew_v_per_s {
            return Err(TableError::OutOfRange {
                rule: "the drive's slew_v_per_s must be so large that its range_v is gone through in 10 minutes",
            });
        }
        if let Some(setpoint) = setpoint {
            let checked = setpoint.check(self.displacement_limits_um, self.adc.full_scale);
            checked.map_err(|rule| TableError::OutOfRange { rule })?;
        }
        let codes = [limits.range_v.min, limits.range_v.max].map(|volts| offset_code + gain_codes_per_v * volts);
        let scale = Range { min: -0.5, max: f32::from(self.dac.full_scale) + 0.5 };
        if codes.iter().all(|&code| scale.contains(code)) {
            Ok(())
        } else {
            Err(TableError::OutOfRange { rule: "the drive's range_v must lie within what the DAC can put out" })
        }
    }
}
