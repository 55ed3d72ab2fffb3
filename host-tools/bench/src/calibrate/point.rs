//! A reading beside the codes of the board's converters, and the line through two.

use super::channel::Averaged;
use crate::calibration_error::CalibrationError;

/// How far the two points must be apart, of full scale: the error of a reading is an error of the gain,
/// and grows outside.
const APART: f64 = 0.1;

/// An instrument's reading and the codes that belong to it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Point {
    /// What the instrument shows: V of a voltage, µm of a sensor.
    pub reading: f64,
    /// The mean code of the channel while the instrument showed that.
    pub channel: Averaged,
    /// The DAC's code meanwhile, where the board drove the amplifier there.
    pub dac: Option<f64>,
}

/// What codes 0 and full scale stand for, by the line through two points (code, reading).
///
/// # Errors
/// The points are too near each other, or their readings do not differ.
pub fn line(points: [(f64, f64); 2], full_scale: u16) -> Result<(f64, f64), CalibrationError> {
    let [(c1, r1), (c2, r2)] = points;
    let (codes, scale) = ((c2 - c1).abs(), f64::from(full_scale));
    if codes < APART * scale {
        return Err(CalibrationError::TooNear { codes, full_scale });
    }
    let gain = (r2 - r1) / (c2 - c1);
    if !(gain.is_finite() && gain != 0.0) {
        return Err(CalibrationError::SameReading(r1, r2));
    }
    let zero = r1 - gain * c1;
    Ok((zero, zero + gain * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_goes_through_both_points_and_to_the_ends() {
        let (zero, full) = line([(10_000.0, -20.0), (50_000.0, 70.0)], 65_520).unwrap();
        let at = |code: f64| zero + (full - zero) * code / 65_520.0;
        assert!((at(10_000.0) + 20.0).abs() < 1e-9 && (at(50_000.0) - 70.0).abs() < 1e-9);
        let inverted = line([(10_000.0, 70.0), (50_000.0, -20.0)], 65_520).unwrap();
        assert!(inverted.0 > inverted.1);
    }

    #[test]
    fn points_that_say_nothing_are_refused() {
        let near = line([(10_000.0, 1.0), (16_000.0, 9.0)], 65_520);
        assert_eq!(near, Err(CalibrationError::TooNear { codes: 6_000.0, full_scale: 65_520 }));
        let same = line([(10_000.0, 5.0), (50_000.0, 5.0)], 65_520);
        assert_eq!(same, Err(CalibrationError::SameReading(5.0, 5.0)));
        assert!(line([(10_000.0, f64::NAN), (50_000.0, 5.0)], 65_520).is_err());
    }
}
