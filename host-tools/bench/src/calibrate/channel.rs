//! One of the board's inputs, and the codes that it has while it stands still.

use crate::calibration_error::CalibrationError;
use protocol::Sample;

/// How far the two halves of the average may be apart, of full scale: a thousandth of a volt in five.
const DRIFT: f64 = 2e-4;
/// This part of the channel at either end is saturated, as the firmware judges it.
const MARGIN: u16 = 128;

/// Which of the board's inputs is calibrated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Channel {
    /// The amplifier's monitor, V at its output.
    Monitor,
    /// The displacement sensor, µm.
    Sensor,
}

impl Channel {
    pub(super) fn code(self, sample: &Sample) -> Option<u16> {
        match self {
            Self::Monitor => Some(sample.code),
            Self::Sensor => sample.sensor,
        }
    }
}

/// Codes of a channel, averaged.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Averaged {
    /// Mean of the codes.
    pub code: f64,
    /// Standard deviation of a code.
    pub noise: f64,
    /// From the mean of the first half to that of the second.
    pub drift: f64,
}

impl Averaged {
    /// Of a channel's codes.
    ///
    /// # Errors
    /// There are none, or they stand at an end of the channel.
    pub fn of(codes: &[u16], full_scale: u16) -> Result<Self, CalibrationError> {
        if codes.len() < 2 {
            return Err(CalibrationError::Silent);
        }
        let mean = |codes: &[u16]| codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
        let code = mean(codes);
        let squares: f64 = codes.iter().map(|&of| (f64::from(of) - code).powi(2)).sum();
        let (before, after) = codes.split_at(codes.len() / 2);
        let margin = full_scale / MARGIN;
        // One that comes near the end with its noise alone is not there.
        if code <= f64::from(margin) || code >= f64::from(full_scale - margin) {
            return Err(CalibrationError::Saturated { code, full_scale });
        }
        Ok(Self { code, noise: (squares / codes.len() as f64).sqrt(), drift: mean(after) - mean(before) })
    }

    pub(super) fn stands_still(&self, full_scale: u16) -> bool {
        self.drift.abs() <= DRIFT * f64::from(full_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_average_has_its_noise_and_drift_and_is_refused_at_an_end() {
        let noisy: Vec<u16> = (0..2_000).map(|k| 30_000 + 3 * (k % 2)).collect();
        let of = Averaged::of(&noisy, 65_520).unwrap();
        assert_eq!((of.code, of.noise, of.drift), (30_001.5, 1.5, 0.0));
        assert!(of.stands_still(65_520));
        let creeping: Vec<u16> = (0..2_000).map(|k| 30_000 + k / 50).collect();
        assert!(!Averaged::of(&creeping, 65_520).unwrap().stands_still(65_520));
        for end in [0u16, 500, 65_100, 65_520] {
            assert!(matches!(Averaged::of(&[end; 10], 65_520), Err(CalibrationError::Saturated { .. })), "{end}");
        }
        assert_eq!(Averaged::of(&[], 65_520), Err(CalibrationError::Silent));
    }
}
