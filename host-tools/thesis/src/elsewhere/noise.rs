//! The sensor's noise floor in a recording, from what no actuator does between two samples.
//!
//! The fourth difference of white noise of deviation σ has the deviation √70·σ, that of a sine of ω the fraction
//! (ω·dt)⁴/√70 of its amplitude. The median of its size, for a normal number 0.6745 of the deviation, looks past
//! reversals and steps. Noise that is not white, and drift, are not in it.

/// Weights of the fourth difference.
const WEIGHTS: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];

/// The noise floor of a sensor's readings, µm rms; `None` of fewer than five.
pub fn floor_um(readings: &[f64]) -> Option<f64> {
    let difference = |five: &[f64]| five.iter().zip(WEIGHTS).map(|(y, weight)| weight * y).sum::<f64>().abs();
    let mut sizes: Vec<f64> = readings.windows(WEIGHTS.len()).map(difference).collect();
    sizes.sort_by(f64::total_cmp);
    let norm = WEIGHTS.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    sizes.get(sizes.len() / 2).map(|median| median / (0.6745 * norm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plants::{CATALOGUE, Plant, Waveform};

    #[test]
    fn the_floor_is_the_noise_that_was_added_under_a_full_stroke() {
        let plant = Plant::drawn(CATALOGUE[0], 1);
        let log = plant.log("sine", &Waveform::Sine { amplitude: 20.0, hertz: 10.0, offset: 0.0 }, 1.0, 1);
        let floor = floor_um(&log.displacement.unwrap()).unwrap();
        assert!((floor / 0.010 - 1.0).abs() < 0.1, "{floor}");
        assert_eq!(floor_um(&[1.0; 4]), None);
    }
}
