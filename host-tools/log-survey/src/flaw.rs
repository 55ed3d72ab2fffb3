//! What in a log is no measurement of a displacement, found before anything is learnt from it: one such stretch can be the
//! largest error of a whole log, and the search would follow it.

use crate::signal::range;
use recordings::log::Log;
use recordings::session::Session;
use serde::Serialize;

/// A stretch of a log that does not show what the actuator did.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Flaw {
    /// The displacement leaps away and back within three rows, by this many µm.
    Spike {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far, µm.
        leap_um: f64,
    },
    /// The displacement is one number while the voltage moves: a sensor that was off, beyond its range, or read too slowly.
    Frozen {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far the voltage moves, V.
        voltage_v: f64,
    },
    /// The voltage is one number, its largest or smallest, while the displacement goes and comes back: what was recorded of it
    /// is cut off.
    Clipped {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// The voltage there, V.
        voltage_v: f64,
    },
}

/// Some rows of a log.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Stretch {
    /// Time of the first since the log's start, s.
    pub from_s: f64,
    /// Time of the last, s.
    pub to_s: f64,
}

/// Most rows of a spike.
const SPIKE_ROWS: usize = 3;
/// A spike leaps by this many times the steps that all but one in 20 are within,
const STEPS: f64 = 6.0;
/// and by this part of the stroke,
const LEAP: f64 = 0.05;
/// and comes back to where it left by this part of its leap.
const BACK: f64 = 0.3;
/// Fewest rows of one number that are a stretch.
const ROWS: usize = 8;
/// Smallest part of the voltage's or the displacement's range that is a movement.
const MOVES: f64 = 0.05;
/// A sensor whose steps are this part of the stroke stands still between them.
const COARSE: f64 = 0.02;
/// More than this part of a log is no flaw of it: it is left as it is.
const MOST: f64 = 0.5;

impl Flaw {
    /// Where it is.
    pub fn at(&self) -> Stretch {
        match *self {
            Self::Spike { at, .. } | Self::Frozen { at, .. } | Self::Clipped { at, .. } => at,
        }
    }

    /// How grave it is beside others of its kind: a spike's leap, µm; how long it lasts, s, of the others.
    pub fn size(&self) -> f64 {
        match *self {
            Self::Spike { leap_um, .. } => leap_um,
            Self::Frozen { at, .. } | Self::Clipped { at, .. } => at.to_s - at.from_s,
        }
    }
}

/// The flaws of a log, by kind, each in the order of time.
pub fn flaws(log: &Log) -> Vec<Flaw> {
    let Some(displacement) = log.displacement.as_deref().filter(|of| of.len() > 2 * ROWS) else { return Vec::new() };
    let (stroke, volts) = (range(displacement), range(&log.voltage));
    let at = |first: usize, last: usize| Stretch {
        from_s: log.start_s + first as f64 * log.sample_period,
        to_s: log.start_s + last as f64 * log.sample_period,
    };
    let mut found: Vec<Flaw> = spikes(displacement, stroke)
        .into_iter()
        .map(|(first, last, leap_um)| Flaw::Spike { at: at(first, last), leap_um })
        .collect();
    if resolution(displacement) < COARSE * stroke {
        let frozen = runs(displacement).filter_map(|(first, last)| {
            let voltage_v = extent(&log.voltage[first..=last]);
            (voltage_v > MOVES * volts).then(|| Flaw::Frozen { at: at(first, last), voltage_v })
        });
        found.extend(frozen);
    }
    let (low, high) = ends(&log.voltage);
    found.extend(runs(&log.voltage).filter_map(|(first, last)| {
        let voltage_v = log.voltage[first];
        let cut = voltage_v == low || voltage_v == high;
        (cut && goes_and_comes_back(&displacement[first..=last], MOVES * stroke))
            .then(|| Flaw::Clipped { at: at(first, last), voltage_v })
    }));
    found
}

/// Leaves what was measured in the flaws of its log out of a session whose sensor is late by `delay_s`; the voltage stays.
/// Returns how many instants it were: none where it would be most of them.
pub fn leave_out(session: &mut Session, flaws: &[Flaw], delay_s: f64) -> usize {
    let flawed = |instant: u32| {
        // A session has what was seen at the tick at which it happened.
        let time = session.start_s + f64::from(instant) * session.tick_s + delay_s;
        // What was resampled between a good row and a flawed one is neither.
        let near = |at: Stretch| time > at.from_s - session.tick_s && time < at.to_s + session.tick_s;
        instant > 0 && flaws.iter().any(|flaw| near(flaw.at()))
    };
    let kept: Vec<bool> = session.instants.iter().map(|&instant| !flawed(instant)).collect();
    let left_out = kept.iter().filter(|kept| !**kept).count();
    if left_out as f64 > MOST * kept.len() as f64 {
        return 0;
    }
    let before = kept.iter().take(session.lead_in).filter(|kept| !**kept).count();
    session.lead_in -= before;
    let mut keep = kept.iter();
    session.instants.retain(|_| keep.next() == Some(&true));
    let mut keep = kept.iter();
    session.displacement.retain(|_| keep.next() == Some(&true));
    left_out
}

/// A log's sound rows, as if nothing had been between them: what zeros are decided from.
#[must_use]
pub fn sound(log: &Log, flaws: &[Flaw]) -> Log {
    let half = 0.5 * log.sample_period;
    let flawed = |row: usize| {
        let time = log.start_s + row as f64 * log.sample_period;
        flaws.iter().any(|flaw| time > flaw.at().from_s - half && time < flaw.at().to_s + half)
    };
    let rows = |values: &[f64]| -> Vec<f64> {
        values.iter().enumerate().filter(|(row, _)| !flawed(*row)).map(|(_, value)| *value).collect()
    };
    Log { voltage: rows(&log.voltage), displacement: log.displacement.as_deref().map(rows), ..log.clone() }
}

/// First and last row of each spike, and its leap.
fn spikes(values: &[f64], stroke: f64) -> Vec<(usize, usize, f64)> {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let usual = steps.len() - 1 - steps.len() / 20;
    let usual = *steps.select_nth_unstable_by(usual, f64::total_cmp).1;
    let least = (STEPS * usual).max(LEAP * stroke);
    let mut found = Vec::new();
    let mut row = 1;
    while row < values.len() {
        let before = values[row - 1];
        let spike = (1..=SPIKE_ROWS).find_map(|rows| {
            let after = *values.get(row + rows)?;
            let leap = values[row..row + rows].iter().map(|value| (value - before).abs()).fold(f64::INFINITY, f64::min);
            let back = (values[row + rows - 1] - after).abs();
            (leap > least && back > least && (after - before).abs() < BACK * leap).then_some((rows, leap))
        });
        match spike {
            Some((rows, leap)) => {
                found.push((row, row + rows - 1, leap));
                row += rows + 1;
            }
            None => row += 1,
        }
    }
    found
}

/// First and last row of each long stretch of one number.
fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    let mut first = 0;
    values.chunk_by(|a, b| a == b).filter_map(move |run| {
        let from = first;
        first += run.len();
        (run.len() >= ROWS).then_some((from, first - 1))
    })
}

/// Whether the values leave their first and last by more than so much, to the same side, and are there halfway: what rings
/// after a step is not.
fn goes_and_comes_back(values: &[f64], by: f64) -> bool {
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return false };
    let mut middle = values[values.len() / 3..values.len() - values.len() / 3].to_vec();
    let half = middle.len() / 2;
    let middle = *middle.select_nth_unstable_by(half, f64::total_cmp).1;
    middle - first.max(last) > by || first.min(last) - middle > by
}

/// Least step that is none.
fn resolution(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min)
}

fn extent(values: &[f64]) -> f64 {
    let (low, high) = ends(values);
    high - low
}

fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plants::{CATALOGUE, Plant, Waveform};
    use recordings::rig::{EXCITATIONS, Rig};

    fn log() -> Log {
        Rig { duration: 0.5, ..Rig::default() }.log(EXCITATIONS[1])
    }

    fn changed(change: impl Fn(usize, f64, f64) -> (f64, f64)) -> Log {
        let mut log = log();
        let displacement = log.displacement.take().unwrap();
        let changed = log.voltage.iter().zip(&displacement).enumerate().map(|(row, (&v, &y))| change(row, v, y));
        let (voltage, displacement): (Vec<f64>, Vec<f64>) = changed.unzip();
        Log { voltage, displacement: Some(displacement), ..log }
    }

    #[test]
    fn logs_as_they_should_be_have_none() {
        for seed in 1..=20 {
            for excitation in EXCITATIONS {
                let log = Rig { duration: 0.5, seed, ..Rig::default() }.log(excitation);
                assert_eq!(flaws(&log), [], "{} of seed {seed}", excitation.name);
            }
        }
    }

    /// Stairs, holds and noise among them.
    #[test]
    fn devices_of_other_classes_have_none_either() {
        for (seed, kind) in (1u32..).zip(CATALOGUE) {
            let plant = Plant::drawn(kind, seed.into());
            let amplitude = 0.8 * plant.full_v;
            for waveform in [
                Waveform::Sine { amplitude, hertz: 100.0, offset: 0.0 },
                Waveform::AmplitudeModulated { amplitude, hertz: 5.0, swell_hz: 0.5 },
                Waveform::Staircase { amplitude, steps: 6, hold_s: 0.1 },
                Waveform::Multisine { amplitude, from_hz: 1.0, to_hz: 40.0, tones: 12 },
            ] {
                let log = plant.log("log", &waveform, 2.0, seed.into());
                assert_eq!(flaws(&log), [], "{} on {waveform:?}", kind.name());
            }
        }
    }

    #[test]
    fn spikes_are_found_one_by_one() {
        let spiky = changed(|row, v, y| (v, if [300, 700, 701].contains(&row) { y + 20.0 } else { y }));
        let found = flaws(&spiky);
        let rows = |flaw: &Flaw| {
            let Stretch { from_s, to_s } = flaw.at();
            [from_s, to_s].map(|time| (time / spiky.sample_period).round() as usize)
        };
        assert_eq!(found.iter().map(rows).collect::<Vec<_>>(), [[300, 300], [700, 701]]);
        assert!(found.iter().all(|flaw| matches!(flaw, Flaw::Spike { leap_um, .. } if (leap_um - 20.0).abs() < 1.0)));
    }

    #[test]
    fn a_sensor_that_stands_still_or_is_cut_off_is_found_and_so_is_a_voltage() {
        let stopped = changed(|row, v, y| (v, if (200..500).contains(&row) { 1.25 } else { y }));
        assert!(matches!(flaws(&stopped)[..], [Flaw::Frozen { voltage_v, .. }] if voltage_v > 10.0));
        let top = ends(&log().displacement.unwrap()).1;
        let beyond = changed(|_, v, y| (v, y.min(0.6 * top)));
        assert!(flaws(&beyond).iter().all(|flaw| matches!(flaw, Flaw::Frozen { .. })) && !flaws(&beyond).is_empty());
        let cut = changed(|_, v, y| (v.min(12.0), y));
        let found = flaws(&cut);
        assert!(!found.is_empty() && found.iter().all(|flaw| matches!(flaw, Flaw::Clipped { voltage_v: 12.0, .. })));
    }

    #[test]
    fn a_hold_after_which_the_actuator_rings_is_none() {
        let rings = |row: usize| 40.0 - 40.0 * libm::exp(-(row as f64) / 60.0) * libm::cos(row as f64 * 0.3);
        let rows = 0..4000;
        let voltage = rows.clone().map(|row| if row % 1000 < 500 { 100.0 } else { 0.0 }).collect();
        let step = |row: usize| if row % 1000 < 500 { rings(row % 1000) } else { 40.0 - rings(row % 1000 - 500) };
        let ringing = Log { voltage, displacement: Some(rows.map(step).collect()), ..log() };
        assert_eq!(flaws(&ringing), []);
    }

    #[test]
    fn what_is_left_out_is_what_was_measured_there() {
        let spiky = changed(|row, v, y| (v, if row == 300 { y + 20.0 } else { y }));
        let flaws = flaws(&spiky);
        assert_eq!(sound(&spiky, &flaws).voltage.len(), spiky.voltage.len() - 1);
        let recipe = recordings::prepare::PrepareOptions::default().resolve(std::slice::from_ref(&spiky));
        let whole = recipe.session(&spiky).unwrap();
        let mut session = Session { lead_in: 100, ..whole.clone() };
        let left_out = leave_out(&mut session, &flaws, 0.0);
        assert!((1..=3).contains(&left_out), "{left_out}");
        assert_eq!(session.instants.len() + left_out, whole.instants.len());
        assert_eq!((session.instants.len(), &session.voltage), (session.displacement.len(), &whole.voltage));
        let largest = |session: &Session| ends(&session.displacement).1;
        assert!(largest(&whole) - largest(&session) > 10.0);
        // Of a log that is nothing but flaws nothing is left out.
        let all = [Flaw::Frozen { at: Stretch { from_s: 0.0, to_s: 1e3 }, voltage_v: 1.0 }];
        assert_eq!(leave_out(&mut session.clone(), &all, 0.0), 0);
        // A late sensor shows the spike later than the tick that it stands at.
        let late = recordings::prepare::Recipe { delay_ticks: 20, ..recipe };
        let mut session = late.session(&spiky).unwrap();
        assert!(leave_out(&mut session, &flaws, 20.0 * late.tick_s()) > 0);
        assert!(largest(&whole) - largest(&session) > 10.0);
    }
}
