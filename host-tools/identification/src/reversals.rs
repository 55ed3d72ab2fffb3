//! Where a voltage reverses its direction.

use estimator_core::Tracker;

/// The samples at which the voltage (V) stands at a reversal, as the model's own tracker finds them: a retreat of more than
/// `deadband` (V) from the running extreme counts, the first movement does not.
pub fn reversals(voltage: &[f64], deadband: f64) -> Vec<usize> {
    // The tracker records the displacement at the extreme; here that is the sample's number.
    let mut tracker = Tracker::new(deadband);
    let mut found = Vec::new();
    for (sample, &volts) in voltage.iter().enumerate() {
        if tracker.update(volts, sample as f64) {
            found.push(tracker.last().displacement as usize);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremes_are_found_and_a_ripple_is_none() {
        let voltage = [0.0, 1.0, 3.0, 2.9, 3.1, 1.0, 0.0, 0.05, 0.0, 2.0];
        assert_eq!(reversals(&voltage, 0.5), [4, 8]);
        assert_eq!(reversals(&voltage, 0.0), [2, 3, 4, 6, 7, 8]);
        assert!(reversals(&[], 0.5).is_empty() && reversals(&[1.0; 9], 0.0).is_empty());
    }
}
