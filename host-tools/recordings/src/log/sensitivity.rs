//! A displacement sensor's scale: how far a volt is.

use std::fmt;
use std::str::FromStr;

use measurement_files::{Quantity, Unit};

/// What a sensor's output in volts means, as in `2.5um/V` or `0.4V/um`; negative where more volts
/// mean less displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// µm a volt.
    pub um_per_v: f64,
}

/// The text is no sensor's scale.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SensitivityError {
    /// A placeholder was not replaced.
    #[error(
        "{0:?}: replace the part in angle brackets by the sensor's own number, from its data sheet or its calibration"
    )]
    Placeholder(String),
    /// It is not NUMBER UNIT/UNIT with a length and a voltage.
    #[error(
        "{0:?} is no sensor's scale: write how far a volt is, as NUMBERum/V (also nm/mV, or V/um), with a decimal point"
    )]
    Form(String),
}

impl FromStr for Sensitivity {
    type Err = SensitivityError;

    fn from_str(text: &str) -> Result<Self, SensitivityError> {
        if text.contains(['<', '>']) {
            return Err(SensitivityError::Placeholder(text.to_owned()));
        }
        let form = || SensitivityError::Form(text.to_owned());
        let (left, right) = text.split_once('/').ok_or_else(form)?;
        let left = left.trim();
        let unit_at = |at: &usize| left.is_char_boundary(*at) && left[*at..].trim().parse::<Unit>().is_ok();
        let at = (0..left.len()).find(unit_at).ok_or_else(form)?;
        let number: f64 = left[..at].trim().parse().map_err(|_| form())?;
        let units = (left[at..].parse::<Unit>(), right.parse::<Unit>());
        let (Ok(above), Ok(below)) = units else { return Err(form()) };
        let um_per_v = match (above.quantity(), below.quantity()) {
            (Quantity::Displacement, Quantity::Voltage) => above.to_base(number) / below.to_base(1.0),
            (Quantity::Voltage, Quantity::Displacement) => below.to_base(1.0) / above.to_base(number),
            _ => return Err(form()),
        };
        if um_per_v.is_finite() && um_per_v != 0.0 { Ok(Self { um_per_v }) } else { Err(form()) }
    }
}

impl fmt::Display for Sensitivity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}um/V", self.um_per_v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_and_any_units() {
        for (text, um_per_v) in [
            ("2.5um/V", 2.5),
            ("2.5 \u{b5}m / V", 2.5),
            ("80nm/mV", 80.0),
            ("-10um/V", -10.0),
            ("1e1um/V", 10.0),
            ("0.4V/um", 2.5),
            ("0.02mm/V", 20.0),
        ] {
            let found: Sensitivity = text.parse().unwrap();
            assert!((found.um_per_v / um_per_v - 1.0).abs() < 1e-12, "{text}: {}", found.um_per_v);
            assert_eq!(found.to_string().parse(), Ok(found));
        }
    }

    #[test]
    fn nonsense_and_placeholders_are_named() {
        for text in ["", "10", "um/V", "10um", "10um/s", "10V/V", "0um/V", "nanum/V", "x10um/V", "10um/V/V"] {
            assert!(matches!(text.parse::<Sensitivity>(), Err(SensitivityError::Form(_))), "{text}");
        }
        let placeholder = "<N>um/V".parse::<Sensitivity>().unwrap_err();
        assert!(placeholder.to_string().contains("angle brackets"));
    }
}
