//! What in a log is no measurement of a displacement, found before anything is learnt from it: one such stretch can be the
//! largest error of a whole log, and the search would follow it.

use crate::signal::range;
use recordings::log::Log;
use recordings::session::Session;
use serde::Serialize;
use std::mem::discriminant;

/// A stretch of a log that does not show what the actuator did.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Flaw {
    /// The displacement leaps away and back within three rows, or in the first or last three, by this many µm.
    Spike {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far, µm.
        leap_um: f64,
        /// It leaps back; else it is where the log begins or ends.
        back: bool,
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
pub(crate) const SPIKE_ROWS: usize = 3;
/// A spike leaps by this many times the steps that all but one in 20 are within,
const STEPS: f64 = 6.0;
/// and by this part of the stroke,
const LEAP: f64 = 0.05;
/// and comes back to where it left by this part of its leap.
const BACK: f64 = 0.3;
/// A leap at an end of up to this many times (stroke/voltage range) × (the largest step of the voltage near that end) is the voltage's.
const EXPLAINED: f64 = 2.0;
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
    log.displacement.as_deref().map_or(Vec::new(), |of| in_rows(&log.voltage, of, log.start_s, log.sample_period))
}

/// The flaws of rows that begin at `start_s`, one a `period`, s.
pub(crate) fn in_rows(voltage: &[f64], displacement: &[f64], start_s: f64, period: f64) -> Vec<Flaw> {
    if displacement.len() <= 2 * ROWS {
        return Vec::new();
    }
    let (stroke, volts) = (range(displacement), range(voltage));
    let at = |first: usize, last: usize| Stretch {
        from_s: start_s + first as f64 * period,
        to_s: start_s + last as f64 * period,
    };
    let least = least_leap(displacement, stroke);
    let mut inside = spikes(displacement, least);
    let [start, end] = at_ends(displacement, voltage, stroke / volts, least);
    // A leap at an end holds what is inside it; beside a spike inside it is nothing but that one's way back.
    inside.retain(|of| ![start, end].iter().flatten().any(|end| end.0 <= of.0 && of.1 <= end.1));
    let clear = |first: usize, last: usize| inside.iter().all(|of| of.1 + 1 < first || last + 1 < of.0);
    let end_spike = |of: Option<(usize, usize, f64)>| {
        let (first, last, leap_um) = of.filter(|of| clear(of.0, of.1))?;
        Some(Flaw::Spike { at: at(first, last), leap_um, back: false })
    };
    let spike = |&(first, last, leap_um): &_| Flaw::Spike { at: at(first, last), leap_um, back: true };
    let mut found: Vec<Flaw> =
        end_spike(start).into_iter().chain(inside.iter().map(spike)).chain(end_spike(end)).collect();
    found.extend(
        frozen(voltage, displacement)
            .map(|(first, last)| Flaw::Frozen { at: at(first, last), voltage_v: extent(&voltage[first..=last]) }),
    );
    let (low, high) = ends(voltage);
    found.extend(runs(voltage).filter_map(|(first, last)| {
        let voltage_v = voltage[first];
        let cut = voltage_v == low || voltage_v == high;
        (cut && goes_and_comes_back(&displacement[first..=last], MOVES * stroke))
            .then(|| Flaw::Clipped { at: at(first, last), voltage_v })
    }));
    found
}

/// First and last row of each stretch in which the displacement is one number and the voltage moves.
pub(crate) fn frozen(voltage: &[f64], displacement: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    let least_v = MOVES * range(voltage);
    let fine = resolution(displacement) < COARSE * range(displacement);
    runs(displacement).filter(move |&(first, last)| fine && extent(&voltage[first..=last]) > least_v)
}

/// The gravest of each kind, and how many there are of it.
pub fn gravest(flaws: &[Flaw]) -> Vec<(Flaw, usize)> {
    let graver = |a: &&Flaw, b: &&Flaw| a.size().total_cmp(&b.size());
    let kinds = flaws.chunk_by(|a, b| discriminant(a) == discriminant(b));
    kinds.filter_map(|kind| Some((*kind.iter().max_by(graver)?, kind.len()))).collect()
}

/// Leaves what was measured in the flaws of its log out of a session whose sensor is late by `delay_s`; the voltage stays.
/// Returns how many instants it were, the first among them where it has another's value: none where it would be most of them.
pub fn leave_out(session: &mut Session, flaws: &[Flaw], delay_s: f64) -> usize {
    let (start_s, tick_s) = (session.start_s, session.tick_s);
    let flawed = |instant: u32| {
        // A session has what was seen at the tick at which it happened.
        let time = start_s + f64::from(instant) * tick_s + delay_s;
        // What was resampled between a good row and a flawed one is neither.
        let near = |at: Stretch| time > at.from_s - tick_s && time < at.to_s + tick_s;
        flaws.iter().any(|flaw| near(flaw.at()))
    };
    let kept: Vec<bool> = session.instants.iter().map(|&instant| !flawed(instant)).collect();
    let left_out = kept.iter().filter(|kept| !**kept).count();
    if left_out as f64 > MOST * kept.len() as f64 {
        return 0;
    }
    // A session begins at its first instant: that stays, and has what was soundly measured next.
    let next = kept.iter().position(|kept| *kept).unwrap_or(0);
    if next > 0 {
        session.displacement[0] = session.displacement[next];
    }
    let kept: Vec<bool> = kept.iter().enumerate().map(|(at, kept)| at == 0 || *kept).collect();
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

/// The least leap of a spike.
fn least_leap(values: &[f64], stroke: f64) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let usual = steps.len() - 1 - steps.len() / 20;
    let usual = *steps.select_nth_unstable_by(usual, f64::total_cmp).1;
    (STEPS * usual).max(LEAP * stroke)
}

/// First and last row of a leap within the first rows, and of one within the last, and how far it is: further than the voltage's
/// steps there explain, at so many µm/V. Before the log the voltage may have been 0 V.
fn at_ends(values: &[f64], voltage: &[f64], um_per_v: f64, least: f64) -> [Option<(usize, usize, f64)>; 2] {
    let count = values.len();
    let step = |of: &[f64]| of.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let leaps = |from_end: &dyn Fn(usize) -> f64, step_v: f64| {
        let explained = if step_v > 0.0 { EXPLAINED * um_per_v * step_v } else { 0.0 };
        // The longest first: rows that are broken differently leap among themselves, too.
        (1..=SPIKE_ROWS).rev().find_map(|rows| {
            let leap = (0..rows).map(|row| (from_end(row) - from_end(rows)).abs()).fold(f64::INFINITY, f64::min);
            (leap > least + explained).then_some((rows, leap))
        })
    };
    let start = leaps(&|row| values[row], step(&voltage[..2 * ROWS]).max(voltage[0].abs()));
    let end = leaps(&|row| values[count - 1 - row], step(&voltage[count - 2 * ROWS..]));
    [start.map(|(rows, leap)| (0, rows - 1, leap)), end.map(|(rows, leap)| (count - rows, count - 1, leap))]
}

/// First and last row of each spike that leaps by more than so much and back, and its leap.
fn spikes(values: &[f64], least: f64) -> Vec<(usize, usize, f64)> {
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
mod tests;
