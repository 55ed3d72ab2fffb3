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
