//! The rows of a log as long as it is none of the longest, to look for its flaws, and for exchanged columns, as
//! an identification does.

use crate::ahead::{self, Ahead};
use crate::clock::{Clock, Tally};
use crate::flaw::{Flaw, gravest, holes, in_rows, level, sound_rows};
use crate::hum::{HumRead, hum_read};
use crate::implausible::Implausible;
use recordings::log::bridge;
use serde::Serialize;
use std::ops::Range;

/// Most rows that are kept, 64 MB.
const MOST: usize = 1 << 22;

/// The gravest of a log's flaws of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Found {
    /// The one of its kind that costs most.
    pub worst: Flaw,
    /// Its first row, counted from 0; where rows are missing, the one behind them.
    pub first_row: u64,
    /// How many there are of its kind.
    pub count: usize,
}

/// Voltage and displacement of the rows so far.
pub(crate) struct Rows {
    /// None where there are too many.
    series: Option<(Vec<f64>, Vec<f64>)>,
    /// The rows in which either was none.
    holes: Vec<Range<usize>>,
}

impl Default for Rows {
    fn default() -> Self {
        Self { series: Some(Default::default()), holes: Vec::new() }
    }
}

impl Found {
    /// The gravest of each kind, of flaws dated by their rows and of samples that are missing by the time stamps.
    pub(crate) fn of(flaws: &[Flaw], clock: &Clock, stamps: &Tally) -> Vec<Self> {
        let dated = |flaw: &Flaw| {
            let first_row = (flaw.at().from_s * clock.hz).round() as u64;
            (flaw.later(stamps.late_by(first_row, clock.hz)), first_row)
        };
        let missing = stamps.missing(clock.hz).map(|(row, at)| (Flaw::Hole { at }, row));
        // Holes come first among the flaws, and kinds stand together.
        let all: Vec<(Flaw, u64)> = missing.chain(flaws.iter().map(dated)).collect();
        let flaws: Vec<Flaw> = all.iter().map(|(flaw, _)| *flaw).collect();
        let first_row = |worst: &Flaw| all.iter().find(|(flaw, _)| flaw == worst).map_or(0, |(_, row)| *row);
        gravest(&flaws).into_iter().map(|(worst, count)| Self { worst, first_row: first_row(&worst), count }).collect()
    }
}

impl Rows {
    pub fn add(&mut self, volts: f64, micrometres: f64) {
        self.series = self.series.take().filter(|(voltage, _)| voltage.len() < MOST);
        if let Some((voltage, displacement)) = &mut self.series {
            voltage.push(volts);
            displacement.push(micrometres);
        }
    }

    /// Puts what is none on straight lines, once all rows are known.
    pub fn bridge(&mut self) {
        let series = self.series.iter_mut().flat_map(|(voltage, displacement)| [voltage, displacement]);
        self.holes = bridge(series.map(Vec::as_mut_slice));
    }

    /// What of them runs the wrong way round.
    pub fn ahead(&self, clock: &Clock) -> Option<Ahead> {
        let (voltage, displacement) = self.series.as_ref().filter(|_| clock.hz.is_finite())?;
        ahead::in_rows(voltage, displacement, 1.0 / clock.hz)
    }

    /// What the sensor picks up of the mains, as if no row were missing: a gap shifts what is periodic.
    pub fn hum(&self, clock: &Clock) -> Option<HumRead> {
        let (voltage, displacement) = self.series.as_ref().filter(|_| clock.hz.is_finite())?;
        let times: Vec<f64> = (0..voltage.len()).map(|row| row as f64 / clock.hz).collect();
        hum_read(&times, voltage, displacement)
    }

    /// Every flaw; `None` where there are too many rows to look for them.
    pub fn flaws(&self, clock: &Clock) -> Option<Vec<Flaw>> {
        let (voltage, displacement) = self.series.as_ref()?;
        Some(match clock.hz.is_finite() {
            true => holes(&self.holes, 0.0, 1.0 / clock.hz)
                .chain(in_rows(voltage, displacement, 0.0, 1.0 / clock.hz))
                .collect(),
            false => Vec::new(),
        })
    }

    /// The stroke without these flaws, where it is none of a piezo actuator's.
    pub fn implausible(&self, flaws: &[Flaw], clock: &Clock) -> Option<Implausible> {
        let (voltage, displacement) = self.series.as_ref()?;
        let (mut displacement, period) = (displacement.clone(), 1.0 / clock.hz);
        level(&mut displacement, 0.0, period, flaws);
        let sound = sound_rows(voltage.len(), 0.0, period, flaws);
        let span = |values: &[f64]| {
            let (low, high) = sound.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &row| {
                (low.min(values[row]), high.max(values[row]))
            });
            high - low
        };
        Implausible::of(span(&displacement), span(voltage))
    }
}
