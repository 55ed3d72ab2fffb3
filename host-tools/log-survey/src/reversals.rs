//! Where a voltage reverses its direction, and its first full cycle: what lies between its first and
//! its third reversal.

use estimator_core::{Range as Span, Tracker};
use std::ops::Range;

/// A retreat of the voltage by so much of its span is a reversal of a cycle.
const LARGE: f64 = 0.25;

/// The samples at which the voltage (V) stands at a reversal, as the model's own tracker finds them: a retreat of more
/// than `deadband` (V) from the running extreme counts, the first movement does not.
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

/// The samples of the voltage's (V) first full cycle, from one reversal to the next but one, a retreat by a
/// quarter of the voltage's span; `None` where there is none. A cycle that spans less than `least` (V) is noise or
/// ripple, and none.
pub fn first_cycle(voltage: &[f64], least: f64) -> Option<Range<usize>> {
    let span = |part: &[f64]| Span::of_values(part.iter().copied()).span();
    let turns = reversals(voltage, LARGE * span(voltage).max(least));
    turns.windows(3).map(|turns| turns[0]..turns[2]).find(|cycle| span(&voltage[cycle.clone()]) >= least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_and_ripple_make_no_cycle() {
        let ripple = |k: u32| 0.3 * f64::from(k % 2);
        let rest: Vec<f64> = (0..100).map(ripple).collect();
        assert_eq!(first_cycle(&rest, 1.0), None);
        assert!(first_cycle(&rest, 0.0).is_some(), "it is one for who asks for no more");
        // Up to 10 V, down, and up again, with the same ripple.
        let swing = |k: u32| f64::from(if k <= 100 { k } else { k.abs_diff(200) }) / 10.0 + ripple(k);
        let voltage: Vec<f64> = (0..=300).chain((0..=250).rev()).map(swing).collect();
        let found = first_cycle(&voltage, 1.0).expect("three reversals");
        assert!(found.start.abs_diff(100) < 4 && found.end.abs_diff(300) < 4, "{found:?}");
        assert_eq!(first_cycle(&voltage, 20.0), None);
        assert_eq!(first_cycle(&[], 0.0), None);
    }
}
