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
    let turns = reversals(voltage, LARGE * span(voltage).max(least));
    turns.windows(3).map(|turns| turns[0]..turns[2]).find(|cycle| span(&voltage[cycle.clone()]) >= least)
}

/// The samples of a log's first two full cycles, as of [`first_cycle`], the second one first: it begins after a swing
/// from one reversal to the next, which wipes out what the log began with.
pub fn early_cycles(voltage: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let turns = reversals(voltage, LARGE * span(voltage));
    let cycles: Vec<Range<usize>> = turns.windows(3).take(2).map(|turns| turns[0]..turns[2]).collect();
    cycles.into_iter().rev()
}

fn span(voltage: &[f64]) -> f64 {
    Span::of_values(voltage.iter().copied()).span()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_cycles_the_one_that_begins_after_a_swing_comes_first() {
        let voltage: Vec<f64> = (0..=600).map(|k| (f64::from(k) * std::f64::consts::TAU / 200.0).sin()).collect();
        assert!(early_cycles(&voltage).eq([150..350, 50..250]));
        let few = |samples: usize| early_cycles(&voltage[..samples]).collect::<Vec<_>>();
        assert_eq!((few(300).first(), few(300).len(), few(200).len()), (Some(&(50..250)), 1, 0), "three reversals");
    }

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
