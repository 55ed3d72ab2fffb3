//! Between the converters' codes and the model's units. A raw code is a newtype and never a bare integer.

use crate::math::Real;
use crate::range::Range;
use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// A code as the analogue-to-digital converter (with its oversampling) delivers it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct AdcCode(pub u16);

/// A code as the digital-to-analogue converter takes it, right-aligned.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct DacCode(pub u16);

/// `voltage = offset ± gain·code`: the divider, its offset, and whether it inverts.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdcCalibration {
    /// V at the amplifier per code; greater than 0.
    pub gain_v_per_code: f32,
    /// V at the amplifier at code 0.
    pub offset_v: f32,
    /// The divider inverts: a larger code is a lower voltage.
    pub invert: bool,
    /// The largest code of the converter. This code and 0 mean that the input is beyond the converter's range.
    pub full_scale: u16,
}

impl AdcCalibration {
    /// `offset ± gain·code`: the voltage at the amplifier that a code stands for, V, not yet relative to the model's
    /// zero.
    pub fn voltage<T: Real>(&self, code: AdcCode) -> T {
        self.line(T::zero()).at(code)
    }

    /// The straight line from codes to the voltage relative to `zero`, V.
    pub fn line<T: Real>(&self, zero: T) -> Line<T> {
        Line { offset: T::of(self.offset_v) - zero, slope: self.signed_gain() }
    }

    /// The code that a voltage (V) gives, as the converter rounds and saturates.
    pub fn code<T: Real>(&self, voltage: T) -> AdcCode {
        let exact = (voltage - T::of(self.offset_v)) / self.signed_gain::<T>();
        AdcCode(nearest(exact, self.full_scale))
    }

    /// Whether the code says "beyond the range" rather than a voltage.
    #[inline]
    pub fn saturated(&self, code: AdcCode) -> bool {
        code.0 == 0 || code.0 >= self.full_scale
    }

    fn signed_gain<T: Real>(&self) -> T {
        T::of(if self.invert { -self.gain_v_per_code } else { self.gain_v_per_code })
    }
}

/// A straight line over codes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Line<T> {
    offset: T,
    slope: T,
}

impl<T: Real> Line<T> {
    /// Its value at a code.
    #[inline]
    pub fn at(&self, code: AdcCode) -> T {
        self.offset + self.slope * T::of(f32::from(code.0))
    }
}

/// `code = offset + gain·displacement`.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DacCalibration {
    /// Codes per µm; negative where the output inverts, never 0.
    pub gain_codes_per_um: f32,
    /// The code (with fraction) of displacement 0.
    pub offset_code: f32,
    /// The largest code of the converter.
    pub full_scale: u16,
}

impl DacCalibration {
    /// The code of a displacement (µm), rounded and limited to the converter's range.
    #[inline]
    pub fn code<T: Real>(&self, displacement: T) -> DacCode {
        let exact = T::of(self.offset_code) + T::of(self.gain_codes_per_um) * displacement;
        DacCode(nearest(exact, self.full_scale))
    }

    /// The same line in parts of codes, for a converter that is given so many of them to a code; their largest
    /// fits 16 bits.
    #[must_use]
    pub fn finer(self, parts: u16) -> Self {
        Self {
            gain_codes_per_um: self.gain_codes_per_um * f32::from(parts),
            offset_code: self.offset_code * f32::from(parts),
            full_scale: self.full_scale.saturating_mul(parts),
        }
    }

    /// Whether the code says "that far, or farther".
    #[inline]
    pub fn saturated(&self, code: DacCode) -> bool {
        code.0 == 0 || code.0 >= self.full_scale
    }

    /// The displacement (µm) that a code stands for.
    pub fn displacement<T: Real>(&self, code: DacCode) -> T {
        (T::of(f32::from(code.0)) - T::of(self.offset_code)) / T::of(self.gain_codes_per_um)
    }
}

/// Where the DAC drives the amplifier instead of showing the displacement: `code = offset + gain·voltage`, and what it
/// may be driven to.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveCalibration {
    /// Codes per V at the amplifier; negative where the output inverts, never 0.
    pub gain_codes_per_v: f32,
    /// The code (with fraction) of 0 V at the amplifier.
    pub offset_code: f32,
    /// What the amplifier may be driven to.
    pub limits: DriveLimits,
    /// Where a controller says by a voltage of its own which displacement it wants; `None` where none is connected.
    pub setpoint: Option<SetpointCalibration>,
}

impl DriveCalibration {
    /// The code of an amplifier voltage (V), rounded, but to no voltage beyond the limits, and limited to
    /// the converter's range.
    pub fn code<T: Real>(&self, voltage: T, full_scale: u16) -> DacCode {
        let exact = T::of(self.offset_code) + T::of(self.gain_codes_per_v) * voltage;
        let code = nearest(exact, full_scale);
        let Range { min, max } = self.limits.range_v;
        let stands_for: T = self.voltage(DacCode(code));
        let (beyond, below) = (stands_for > T::of(max), stands_for < T::of(min));
        let larger_is_higher = self.gain_codes_per_v > 0.0;
        DacCode(match (beyond, below) {
            (true, _) if larger_is_higher => code.saturating_sub(1),
            (_, true) if !larger_is_higher => code.saturating_sub(1),
            (true, _) | (_, true) => code.saturating_add(1).min(full_scale),
            _ => code,
        })
    }

    /// The same line in parts of codes, for a converter that is given so many of them to a code.
    #[must_use]
    pub fn finer(self, parts: u16) -> Self {
        Self {
            gain_codes_per_v: self.gain_codes_per_v * f32::from(parts),
            offset_code: self.offset_code * f32::from(parts),
            ..self
        }
    }

    /// The amplifier voltage (V) that a code stands for.
    pub fn voltage<T: Real>(&self, code: DacCode) -> T {
        (T::of(f32::from(code.0)) - T::of(self.offset_code)) / T::of(self.gain_codes_per_v)
    }
}

/// The channel of the ADC at which a controller wants a displacement: `displacement = offset + gain·code`.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetpointCalibration {
    /// µm per code; negative where the input inverts, never 0.
    pub gain_um_per_code: f32,
    /// Displacement at code 0, µm relative to the model's zero.
    pub offset_um: f32,
    /// The device drives the amplifier by the set-point of itself after a start, without a host.
    pub at_start: bool,
}

impl SetpointCalibration {
    /// The displacement (µm relative to the model's zero) that a code wants.
    #[inline]
    pub fn displacement<T: Real>(&self, code: AdcCode) -> T {
        Line { offset: T::of(self.offset_um), slope: T::of(self.gain_um_per_code) }.at(code)
    }

    /// Displacements at code 0 and at an ADC's largest code, µm, the lower one first.
    pub fn span(&self, full_scale: u16) -> Range {
        let [zero, full]: [f32; 2] = [0, full_scale].map(|code| self.displacement(AdcCode(code)));
        Range { min: zero.min(full), max: zero.max(full) }
    }

    /// Checks it beside the table's displacement limits, µm, and the ADC's largest code.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn check(&self, displacements: Range, full_scale: u16) -> Result<(), Rule> {
        let span = self.span(full_scale);
        rule::check([
            ("the set-point's gain and offset must be finite, the gain not 0", {
                span.min.is_finite() && span.max.is_finite() && span.min < span.max
            }),
            ("the set-point's span must share displacements with displacement_limits_um", {
                span.min < displacements.max && span.max > displacements.min
            }),
        ])
    }
}

/// What the amplifier may be driven to.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveLimits {
    /// Amplifier voltages, V; within the table's voltage range.
    pub range_v: Range,
    /// Amplifier voltage when nothing is wanted, V; within `range_v`.
    pub rest_v: f32,
    /// Fastest change, V/s; greater than 0.
    pub slew_v_per_s: f32,
}

impl DriveLimits {
    /// Checks them beside `voltages`, those that the table's model was identified on, at the amplifier, V.
    ///
    /// # Errors
    /// The rule that they break.
    pub fn check(&self, voltages: Range) -> Result<(), Rule> {
        let Self { range_v, rest_v, slew_v_per_s } = *self;
        rule::check([
            ("the drive's range_v must be ordered", range_v.min < range_v.max),
            (
                "the drive's range_v must lie within the voltages that the model was identified on",
                voltages.contains(range_v.min) && voltages.contains(range_v.max),
            ),
            ("the drive's rest_v must lie within its range_v", range_v.contains(rest_v)),
            ("the drive's slew_v_per_s must be positive", slew_v_per_s > 0.0 && slew_v_per_s.is_finite()),
        ])
    }
}

/// The nearest code of a converter; 0 for NaN.
#[inline]
fn nearest<T: Real>(exact: T, full_scale: u16) -> u16 {
    // No more than the full scale, which fits.
    (exact + T::of(0.5)).to_u32_saturating().min(full_scale.into()) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn adc(invert: bool) -> AdcCalibration {
        AdcCalibration {
            gain_v_per_code: 44.0 / 4095.0,
            offset_v: if invert { 22.0 } else { -22.0 },
            invert,
            full_scale: 4095,
        }
    }

    #[test]
    fn ends_of_the_converter_are_saturation() {
        for invert in [false, true] {
            let adc = adc(invert);
            assert_eq!(adc.code(if invert { 1e9f32 } else { -1e9 }), AdcCode(0));
            assert_eq!(adc.code(if invert { -1e9f32 } else { 1e9 }), AdcCode(4095));
            assert!(adc.saturated(AdcCode(0)) && adc.saturated(AdcCode(4095)) && adc.saturated(AdcCode(u16::MAX)));
            assert!(!adc.saturated(AdcCode(1)) && !adc.saturated(AdcCode(4094)));
        }
    }

    proptest! {
        #[test]
        fn code_to_voltage_and_back(code in 0u16..=4095, invert: bool) {
            let adc = adc(invert);
            prop_assert_eq!(adc.code(adc.voltage::<f32>(AdcCode(code))), AdcCode(code));
            prop_assert_eq!(adc.code(adc.voltage::<f64>(AdcCode(code))), AdcCode(code));
        }

        #[test]
        fn code_to_displacement_and_back(code in 0u16..=4095, invert: bool) {
            let sign = if invert { -1.0 } else { 1.0 };
            let dac = DacCalibration { gain_codes_per_um: sign * 400.0, offset_code: 2047.5, full_scale: 4095 };
            prop_assert_eq!(dac.code(dac.displacement::<f32>(DacCode(code))), DacCode(code));
        }

        #[test]
        fn no_displacement_leaves_the_converter_s_range(displacement: f32) {
            let dac = DacCalibration { gain_codes_per_um: 400.0, offset_code: 2047.5, full_scale: 4095 };
            prop_assert!(dac.code(displacement).0 <= 4095);
        }
    }
}
