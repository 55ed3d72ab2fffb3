//! What in a log is no measurement of a displacement, found before anything is learnt from it: one such stretch can be
//! the largest error of a whole log, and the search would follow it.

mod commanded;
mod lasting;
mod leaps;
mod missing;
mod railed;
mod repair;
mod steps;
mod voltage;

use crate::signal::{ends, range, resolution};
use recordings::log::Log;
use serde::Serialize;
use std::mem::discriminant;
use std::ops::Range;

pub(crate) use commanded::Commanded;
pub(crate) use leaps::{Explained, SPIKE_ROWS};
pub(crate) use repair::{level, sound_rows};
pub use repair::{measured, sound};

#[cfg(test)]
use repair::{leave_out, mended};

use lasting::{brief, lasting};
use leaps::{ROWS, at_ends, glitches, least_leap, spikes};
use missing::missing;
use railed::{merge, railed};
use steps::steps;
use voltage::{voltage_spikes, without};

/// A stretch of a log that does not show what the actuator did.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Flaw {
    /// The displacement leaps away and back within some rows, or in the first or last three, by this many µm, and no
    /// pulse of the voltage commands it.
    Spike {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far the displacement leaps, µm.
        leap_um: f64,
        /// It leaps back; else it is where the log begins or ends.
        back: bool,
    },
    /// The displacement is one number while the voltage moves, or within a narrow band at its highest or lowest: a
    /// sensor that was off, beyond its range, or read too slowly.
    Frozen {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far the voltage moves, V.
        voltage_v: f64,
    },
    /// The voltage is one number, its largest or smallest, while the displacement goes and comes back: what was
    /// recorded of it is cut off.
    Clipped {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// The voltage there, V.
        voltage_v: f64,
    },
    /// The voltage leaps away and back within three rows, or in the last but for one to rest, and the displacement does
    /// not go along.
    VoltageSpike {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
        /// How far the voltage leaps, V.
        leap_v: f64,
    },
    /// The file has no number there for the voltage or the displacement, or no row ([`Log::holes`]).
    Hole {
        /// The rows that it takes.
        #[serde(flatten)]
        at: Stretch,
    },
    /// The displacement goes on at another level from the middle of some rows on, and the voltage does not step there.
    Step {
        /// The rows within which it changes.
        #[serde(flatten)]
        at: Stretch,
        /// How far the level is above the one before, µm.
        leap_um: f64,
    },
    /// Both leap together from one row to the next as nowhere near, and go on as before: samples may
    /// be missing between.
    Missing {
        /// The two rows between which they leap.
        #[serde(flatten)]
        at: Stretch,
        /// How far the voltage leaps, V.
        leap_v: f64,
        /// How far the displacement does, µm.
        leap_um: f64,
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

/// Smallest part of the voltage's or the displacement's range that is a movement.
const MOVES: f64 = 0.05;
/// A sensor whose steps are this part of the stroke stands still between them.
const COARSE: f64 = 0.02;

impl Flaw {
    /// The rows that the flaw takes.
    pub fn at(&self) -> Stretch {
        let (Self::Spike { at, .. }
        | Self::Frozen { at, .. }
        | Self::Clipped { at, .. }
        | Self::VoltageSpike { at, .. }
        | Self::Hole { at }
        | Self::Step { at, .. }
        | Self::Missing { at, .. }) = *self;
        at
    }

    /// The same so many s later.
    #[must_use]
    pub(crate) fn later(mut self, by_s: f64) -> Self {
        let (Self::Spike { at, .. }
        | Self::Frozen { at, .. }
        | Self::Clipped { at, .. }
        | Self::VoltageSpike { at, .. }
        | Self::Hole { at }
        | Self::Step { at, .. }
        | Self::Missing { at, .. }) = &mut self;
        (at.from_s, at.to_s) = (at.from_s + by_s, at.to_s + by_s);
        self
    }

    /// Whether it can be mended: what is missing without a trace in the time stamps cannot.
    pub fn repairable(&self) -> bool {
        !matches!(self, Self::Missing { .. })
    }

    /// How grave it is beside others of its kind: how far it leaps, µm or V; how long it lasts, s, where it does not.
    pub fn size(&self) -> f64 {
        match *self {
            Self::Spike { leap_um, .. } | Self::Missing { leap_um, .. } => leap_um,
            Self::Step { leap_um, .. } => leap_um.abs(),
            Self::VoltageSpike { leap_v, .. } => leap_v,
            Self::Frozen { at, .. } | Self::Clipped { at, .. } | Self::Hole { at } => at.to_s - at.from_s,
        }
    }
}

/// The flaws of a log, by kind, each in the order of time.
pub fn flaws(log: &Log) -> Vec<Flaw> {
    let within = |of: &Vec<f64>| in_rows(&log.voltage, of, log.start_s, log.sample_period);
    holes(&log.holes, log.start_s, log.sample_period).chain(log.displacement.iter().flat_map(within)).collect()
}

/// The holes among rows that begin at `start_s`, one a `period`, s.
pub(crate) fn holes(of: &[Range<usize>], start_s: f64, period: f64) -> impl Iterator<Item = Flaw> {
    let time = move |row: usize| start_s + row as f64 * period;
    of.iter().map(move |rows| Flaw::Hole { at: Stretch { from_s: time(rows.start), to_s: time(rows.end - 1) } })
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
    let commanded = Commanded::of(voltage, displacement, stroke);
    let uncommanded = |of: &(usize, usize, f64)| !commanded.explains(of.0, of.1, of.2);
    let misread = voltage_spikes(voltage, displacement, volts, stroke / volts, &uncommanded);
    let voltage = &without(voltage, misread.iter().map(|&(first, last, _)| (first, last)));
    let least = least_leap(displacement, stroke);
    let mut inside = spikes(displacement, least);
    inside.retain(uncommanded);
    let late = (steps::LATE_S / period) as usize;
    // The way away to one spike and that back from another are no glitch between them.
    let between = without(displacement, inside.iter().map(|&(first, last, _)| (first, last)));
    let fine = least.max(steps::RESOLUTIONS * resolution(displacement));
    let longer = glitches(&between, fine, voltage, stroke / volts, late);
    inside.extend(longer);
    inside.sort_by_key(|&(first, ..)| first);
    let [start, end] = at_ends(displacement, Explained::of(voltage, 0.0, stroke / volts), least);
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
    let mut still = railed(voltage, &between, MOVES * volts, stroke);
    still.extend(frozen(voltage, displacement));
    merge(&mut still);
    found.extend(
        still
            .into_iter()
            .map(|(first, last)| Flaw::Frozen { at: at(first, last), voltage_v: extent(&voltage[first..=last]) }),
    );
    let (low, high) = ends(voltage);
    found.extend(runs(voltage).filter_map(|(first, last)| {
        let voltage_v = voltage[first];
        let cut = voltage_v == low || voltage_v == high;
        (cut && goes_and_comes_back(&displacement[first..=last], MOVES * stroke))
            .then(|| Flaw::Clipped { at: at(first, last), voltage_v })
    }));
    found.extend(misread.iter().map(|&(first, last, leap_v)| Flaw::VoltageSpike { at: at(first, last), leap_v }));
    let lost = missing(voltage, displacement, volts, stroke);
    let near = |row: usize| {
        let Stretch { from_s, to_s } = at(row.saturating_sub(steps::ROWS), row + 1 + steps::ROWS);
        move |flaw: &Flaw| flaw.at().from_s <= to_s && from_s <= flaw.at().to_s
    };
    // What begins and ends another flaw is that one's.
    let leaps: Vec<(usize, f64)> = steps(voltage, displacement, volts, stroke, period)
        .into_iter()
        .filter(|&(row, _)| !found.iter().any(near(row)) && lost.iter().all(|of| of.0.abs_diff(row) > steps::ROWS))
        .collect();
    let (mut brief_spikes, mut stepped) = (Vec::new(), Vec::new());
    if !leaps.is_empty() {
        let row = |time: f64| ((time - start_s) / period).round() as usize;
        let flawed = found.iter().map(|flaw| row(flaw.at().from_s)..=row(flaw.at().to_s));
        for (&(row, leap_um), lasts) in leaps.iter().zip(lasting(voltage, displacement, flawed, &leaps)) {
            let stretch = at(row + 1 - steps::SPREAD, row + steps::SPREAD);
            match lasts {
                true => stepped.push(Flaw::Step { at: stretch, leap_um }),
                false => brief_spikes.extend(brief(displacement, (row, leap_um)).as_ref().map(spike)),
            }
        }
    }
    // Those of a kind stand together, in the order of time.
    let spikes = found.iter().take_while(|flaw| matches!(flaw, Flaw::Spike { .. })).count();
    let all = spikes + brief_spikes.len();
    found.splice(spikes..spikes, brief_spikes);
    found[..all].sort_by(|a, b| a.at().from_s.total_cmp(&b.at().from_s));
    found.extend(stepped);
    found.extend(lost.iter().map(|&(row, leap_v, leap_um)| Flaw::Missing { at: at(row, row + 1), leap_v, leap_um }));
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

/// First and last row of each long stretch of one number.
fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    let mut first = 0;
    values.chunk_by(|a, b| a == b).filter_map(move |run| {
        let from = first;
        first += run.len();
        (run.len() >= ROWS).then_some((from, first - 1))
    })
}

/// Whether the values leave their first and last by more than so much, to the same side, and are there halfway: what
/// rings after a step is not.
fn goes_and_comes_back(values: &[f64], by: f64) -> bool {
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return false };
    let mut middle = values[values.len() / 3..values.len() - values.len() / 3].to_vec();
    let half = middle.len() / 2;
    let middle = *middle.select_nth_unstable_by(half, f64::total_cmp).1;
    middle - first.max(last) > by || first.min(last) - middle > by
}

fn extent(values: &[f64]) -> f64 {
    let (low, high) = ends(values);
    high - low
}

#[cfg(test)]
mod tests;
