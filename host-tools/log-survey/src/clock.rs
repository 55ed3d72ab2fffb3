//! When the rows of a log were recorded: the period, and how evenly the time stamps keep it.

use crate::flaw::Stretch;
use serde::Serialize;

/// When the rows were recorded.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Clock {
    /// Rows a second, by the time stamps without their gaps, or as stated; NaN of a single row, and where the stamps
    /// do not advance.
    pub hz: f64,
    /// Whether time stamps, the file or the user say the rate.
    pub source: RateSource,
    /// Smallest and largest step from a time stamp to the next, s, where a column holds them.
    pub steps_s: Option<(f64, f64)>,
    /// Steps of more than one and a half periods.
    pub long_steps: u64,
    /// Time from the first row to the last, s.
    pub duration_s: f64,
}

/// Who says how fast the rows were recorded.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RateSource {
    /// A column of time stamps.
    Column,
    /// The file's header, under this name.
    File(String),
    /// Whoever reads the log.
    Stated,
}

/// So many long steps are known by their rows.
const KNOWN: usize = 1000;
/// A leap of both series is placed within so many rows.
const NEAR: u64 = 2;
/// Steps of more periods than this, back or forth, are no jitter of a clock.
const FAR: f64 = 10.0;
/// How near a gap is to whole periods, in periods.
const NEARLY: f64 = 0.1;
/// Largest part of the steps that are gaps.
const GAPS: f64 = 0.05;

/// The time stamps so far.
#[derive(Default)]
pub(crate) struct Tally {
    first: Option<f64>,
    last: f64,
    rows: u64,
    steps: Option<(f64, f64)>,
    long: u64,
    /// How many of them the next step made up for.
    made_up: u64,
    /// What the others last together, s.
    long_s: f64,
    /// The step before, s, where it is a long one.
    long_before: Option<f64>,
    /// Steps to a stamp before the last one.
    back: u64,
    /// Steps back or forth that are no jitter, and what they last together, s.
    far: u64,
    far_s: f64,
    /// The rows behind the first long steps, and how long these are, s.
    behind: Vec<(u64, f64)>,
}

impl Tally {
    pub fn add(&mut self, time: Option<f64>) {
        let Some(time) = time else { return };
        let Some(first) = self.first else {
            (self.first, self.last, self.rows) = (Some(time), time, 1);
            return;
        };
        let step = time - self.last;
        let mean = (self.last - first) / (self.rows.saturating_sub(1)).max(1) as f64;
        self.back += u64::from(step < 0.0);
        if self.rows > 2 && step.abs() > FAR * mean {
            (self.far, self.far_s) = (self.far + 1, self.far_s + step);
        }
        // A stamp that comes late alone leaves the next step as much shorter, and is no gap.
        if let Some(long) = self.long_before.take().filter(|long| step < 0.5 * mean && long + step < 2.5 * mean) {
            self.made_up += 1;
            self.long_s -= long;
            self.behind.pop_if(|(row, _)| *row + 1 == self.rows);
        }
        // The mean so far tells a gap from the second step on.
        if self.rows > 2 && step > 1.5 * mean {
            self.long += 1;
            self.long_s += step;
            self.long_before = Some(step);
            if self.behind.len() < KNOWN {
                self.behind.push((self.rows, step));
            }
        }
        let (low, high) = self.steps.unwrap_or((step, step));
        self.steps = Some((low.min(step), high.max(step)));
        (self.last, self.rows) = (time, self.rows + 1);
    }

    /// The long steps, where they are gaps: rounded stamps have them all the time, and those that go back make
    /// up for them.
    fn gaps(&self) -> u64 {
        let seldom = (self.long as f64) < GAPS * self.rows.saturating_sub(1) as f64;
        if seldom && self.back == 0 { self.long - self.made_up } else { 0 }
    }

    /// Whether a time stamp near this row, counted from 0, comes late: what is missing there is no secret.
    pub fn late_near(&self, row: u64) -> bool {
        self.gaps() > 0 && self.behind.iter().any(|(behind, _)| behind.abs_diff(row) <= NEAR)
    }

    /// What a row, counted from 0, comes later for the gaps before it than at this rate (Hz) without them, s.
    pub fn late_by(&self, row: u64, hz: f64) -> f64 {
        let before = self.behind.iter().filter(|(behind, _)| *behind <= row && self.gaps() > 0);
        before.map(|(_, step)| step - 1.0 / hz).sum()
    }

    /// The rows behind steps of several whole periods, and the time stamps, s since the log's start, of the first and
    /// the last sample that are missing there; none where the stamps go back, and so jitter.
    pub fn missing(&self, hz: f64) -> impl Iterator<Item = (u64, Stretch)> {
        let whole = move |step: f64| (step * hz).round() >= 2.0 && (step * hz - (step * hz).round()).abs() < NEARLY;
        let gaps = self.behind.iter().filter(move |(_, step)| self.gaps() > 0 && whole(*step));
        gaps.map(move |&(row, step)| {
            let to_s = self.late_by(row, hz) + (row as f64 - 1.0) / hz;
            (row, Stretch { from_s: to_s + 2.0 / hz - step, to_s })
        })
    }

    /// The rows behind steps of several periods; none where the stamps go back, and so jitter.
    pub fn behind_gaps(&self) -> Vec<u64> {
        self.behind.iter().filter(|_| self.gaps() > 0).map(|&(row, _)| row).collect()
    }

    /// `stated` is a period that no column states, s, and what the file calls it.
    pub fn result(&self, rows: u64, stated: Option<(f64, Option<String>)>) -> Clock {
        let intervals = rows.saturating_sub(1) as f64;
        let Some((period, name)) = stated else {
            let duration_s = self.first.map_or(0.0, |first| self.last - first);
            let gaps = self.gaps();
            // A stamp that goes back makes up for one that was late.
            let (left_out, left_out_s) = match self.back {
                0 if gaps > 0 => (gaps, self.long_s),
                0 => (0, 0.0),
                _ => (self.far, self.far_s),
            };
            let (steps, steps_s) = (intervals - left_out as f64, duration_s - left_out_s);
            return Clock {
                hz: if steps_s > 0.0 { whole(steps / steps_s) } else { f64::NAN },
                source: RateSource::Column,
                steps_s: self.steps,
                long_steps: self.long,
                duration_s,
            };
        };
        let source = name.map_or(RateSource::Stated, RateSource::File);
        Clock { hz: whole(1.0 / period), source, steps_s: None, long_steps: 0, duration_s: intervals * period }
    }
}

/// The nearest whole number of a rate that is one but for rounding.
fn whole(hz: f64) -> f64 {
    if (hz / hz.round() - 1.0).abs() < 1e-6 { hz.round() } else { hz }
}
