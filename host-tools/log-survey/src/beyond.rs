//! Whether logs go on as they began: an amplitude or a frequency that comes late in each of them is in none of their
//! first parts.

use crate::half_cycle::{HalfCycle, half_cycles, large_reversals};
use estimator_core::Range;
use recordings::log::Log;
use std::collections::BTreeSet;

/// Classes of swings and of their durations: each this many times the one before. Half cycles in neighbouring classes
/// of both are alike.
const CLASS: f64 = 1.4;
/// More than this part of the half cycles, or of their time, is something of its own, where it is more than the half
/// cycles that one misread voltage makes.
const RARE: f64 = 0.05;
const OF_A_GLITCH: usize = 3;
/// A model knows nothing of voltages farther than this part of the whole span from all that it was learnt from. Less
/// than this part of the readings there are misread.
const FARTHER: f64 = 0.02;
const MISREAD: f64 = 2e-3;

/// The classes of its swing and of its duration.
fn class(of: &HalfCycle) -> [i32; 2] {
    [of.volts, of.seconds].map(|of| (of.ln() / CLASS.ln()).floor() as i32)
}

/// Whether the second parts of logs go to voltages that no first part goes to, or through half cycles like none of
/// those in the first parts.
pub fn ends_go_beyond<'l>(parts: impl Iterator<Item = (&'l Log, &'l Log)>) -> bool {
    let volts = |logs: &[&'l Log]| Range::of_values(logs.iter().flat_map(|log| log.voltage.iter().copied()));
    let (firsts, rests): (Vec<&Log>, Vec<&Log>) = parts.unzip();
    let (before, all) = (volts(&firsts), volts(&[&firsts[..], &rests].concat()));
    let known = Range { min: before.min - FARTHER * all.span(), max: before.max + FARTHER * all.span() };
    let late = || rests.iter().flat_map(|log| &log.voltage);
    if late().filter(|volts| !known.contains(**volts)).count() as f64 > MISREAD * late().count() as f64 {
        return true;
    }
    let of = |log: &Log| half_cycles(&log.voltage, &large_reversals(&log.voltage, all.span()), log.sample_period);
    let known: BTreeSet<_> = firsts.into_iter().flat_map(of).map(|half_cycle| class(&half_cycle)).collect();
    let like = |class: [i32; 2]| {
        let near = |of: i32| of - 1..=of + 1;
        near(class[0]).any(|volts| near(class[1]).any(|seconds| known.contains(&[volts, seconds])))
    };
    let late: Vec<HalfCycle> = rests.into_iter().flat_map(of).collect();
    let unlike: Vec<HalfCycle> = late.iter().copied().filter(|half_cycle| !like(class(half_cycle))).collect();
    let seconds = |of: &[HalfCycle]| of.iter().map(|of| of.seconds).sum::<f64>();
    let rare = unlike.len() as f64 <= RARE * late.len() as f64 && seconds(&unlike) <= RARE * seconds(&late);
    unlike.len() > OF_A_GLITCH && !rare
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::rig::{EXCITATIONS, Rig};

    /// Whether a log of these sines, of an amplitude (V), Hz and s each, goes beyond its first half in the second.
    fn ends_go(sines: &[(f64, f64, f64)]) -> bool {
        let log = Rig { duration: 0.01, ..Rig::default() }.log(EXCITATIONS[1]);
        let of = |&(amplitude, hertz, seconds): &(f64, f64, f64)| {
            let rows = (seconds / log.sample_period) as u32;
            (0..rows)
                .map(move |row| amplitude * (std::f64::consts::TAU * hertz * f64::from(row) * log.sample_period).sin())
        };
        let voltage: Vec<f64> = sines.iter().flat_map(of).collect();
        let halves = Log { displacement: Some(voltage.clone()), voltage, ..log }.split(0.5);
        ends_go_beyond([(&halves.0, &halves.1)].into_iter())
    }

    #[test]
    fn amplitudes_and_frequencies_that_come_late_are_beyond_what_was_before() {
        let ladder = [20.0, 40.0, 60.0, 80.0, 100.0].map(|volts| (volts, 1.0, 4.0));
        let falling: Vec<_> = ladder.into_iter().rev().collect();
        let sweep = [0.5, 1.0, 2.0, 5.0, 20.0].map(|hertz| (100.0, hertz, 4.0));
        assert!(ends_go(&ladder) && ends_go(&falling) && ends_go(&sweep), "ladders and a sweep");
        assert!(ends_go(&[(100.0, 0.5, 20.0), (100.0, 20.0, 1.0)]), "short, and most of the half cycles");
        assert!(ends_go(&[(60.0, 1.0, 10.0), (70.0, 1.0, 10.0)]), "no model knows what is farther");
        for alike in
            [&[(100.0, 1.0, 20.0)][..], &[(100.0, 1.0, 10.0), (80.0, 1.1, 10.0)], &[falling.clone(), falling].concat()]
        {
            assert!(!ends_go(alike), "{alike:?}");
        }
    }

    #[test]
    fn a_misread_voltage_is_no_amplitude() {
        let log = |glitch: f64| {
            let of = Rig { duration: 2.0, ..Rig::default() }.log(EXCITATIONS[1]);
            let mut voltage = of.voltage.clone();
            let at = voltage.len() - 500;
            voltage[at] = glitch;
            Log { voltage, ..of }.split(0.5)
        };
        for glitch in [0.0, 80.0, -300.0] {
            let (first, rest) = log(glitch);
            assert!(!ends_go_beyond([(&first, &rest)].into_iter()), "{glitch} V");
        }
    }

    #[test]
    fn what_one_log_ends_with_another_may_begin_with() {
        let log = |volts: f64| {
            let of = Rig { duration: 0.5, ..Rig::default() }.log(EXCITATIONS[1]);
            Log { voltage: of.voltage.iter().map(|of| volts * of).collect(), ..of }
        };
        let (small, large) = (log(0.3), log(1.0));
        assert!(ends_go_beyond([(&small, &large)].into_iter()));
        assert!(!ends_go_beyond([(&small, &large), (&large, &small)].into_iter()));
    }
}
