//! A log, and parts of it.

use std::borrow::Cow;
use std::ops::Range;
use std::path::PathBuf;

/// One recorded session.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// File name without its extension.
    pub name: String,
    /// The file as the caller named it.
    pub path: PathBuf,
    /// SHA-256 of the file's bytes, in lower-case hexadecimal; of a simulated log, what it is a simulation of.
    pub sha256: String,
    /// Time of the first sample since the file's first, s: 0 unless the log was cut.
    pub start_s: f64,
    /// Sample period, s.
    pub sample_period: f64,
    /// Voltage of each sample, V; empty only where
    /// [`ReadOptions::voltage_required`](super::ReadOptions::voltage_required) is off.
    pub voltage: Vec<f64>,
    /// Displacement of each sample, µm; `None` only where
    /// [`ReadOptions::displacement`](super::ReadOptions::displacement) does not require it.
    pub displacement: Option<Vec<f64>>,
    /// The displacement is an estimate and no sensor's, by the name of its column.
    pub displacement_estimated: bool,
    /// Rows in which the file has no number for the voltage or the displacement, or that its time stamps leave out:
    /// these lie on the straight line between their neighbours ([`ReadOptions::holes`](super::ReadOptions::holes)).
    pub holes: Vec<Range<usize>>,
}

impl Log {
    /// Its rows, each as long as the sample period, s.
    pub fn duration(&self) -> f64 {
        self.voltage.len() as f64 * self.sample_period
    }

    /// The log without so many seconds at its start and end, itself without none; possibly nothing.
    #[must_use]
    pub fn trimmed(&self, start_s: f64, end_s: f64) -> Cow<'_, Self> {
        let rows = |seconds: f64| (seconds / self.sample_period).round() as usize;
        let start = rows(start_s).min(self.voltage.len());
        let end = self.voltage.len().saturating_sub(rows(end_s)).max(start);
        match (start, end) {
            (0, end) if end == self.voltage.len() => Cow::Borrowed(self),
            _ => Cow::Owned(self.rows(start..end)),
        }
    }

    /// The first part of the log and the rest; `fraction` (0 … 1) is the rest's.
    #[must_use]
    pub fn split(&self, fraction: f64) -> (Self, Self) {
        let count = self.voltage.len();
        let at = count - (fraction.clamp(0.0, 1.0) * count as f64).round() as usize;
        (self.rows(0..at), self.rows(at..count))
    }

    fn rows(&self, rows: Range<usize>) -> Self {
        Self {
            name: self.name.clone(),
            path: self.path.clone(),
            sha256: self.sha256.clone(),
            start_s: self.start_s + rows.start as f64 * self.sample_period,
            sample_period: self.sample_period,
            voltage: self.voltage[rows.clone()].to_vec(),
            displacement: self.displacement.as_ref().map(|displacement| displacement[rows.clone()].to_vec()),
            displacement_estimated: self.displacement_estimated,
            holes: self.holes.iter().filter_map(|hole| within(hole, &rows)).collect(),
        }
    }
}

/// What of some rows is within others, counted from the first of these.
fn within(hole: &Range<usize>, rows: &Range<usize>) -> Option<Range<usize>> {
    let (start, end) = (hole.start.max(rows.start), hole.end.min(rows.end));
    (start < end).then(|| start - rows.start..end - rows.start)
}

/// A log that holds the same bytes as one before it, and that one.
pub fn twins(logs: &[Log]) -> Option<[&Log; 2]> {
    logs.iter().enumerate().find_map(|(index, log)| {
        let before = logs[..index].iter().find(|before| before.sha256 == log.sha256)?;
        Some([log, before])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log() -> Log {
        let rows: Vec<f64> = (0..100).map(f64::from).collect();
        Log {
            name: "ramp".into(),
            path: "ramp.csv".into(),
            sha256: String::new(),
            start_s: 0.0,
            sample_period: 0.01,
            voltage: rows.clone(),
            displacement: Some(rows),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    #[test]
    fn parts_keep_their_time() {
        let log = log();
        let trimmed = log.trimmed(0.1, 0.2);
        assert_eq!((trimmed.voltage[0], trimmed.voltage.len()), (10.0, 70));
        let (first, rest) = trimmed.split(0.5);
        assert_eq!((first.voltage.len(), rest.voltage[0]), (35, 45.0));
        assert!((rest.start_s - 0.45).abs() < 1e-12);
        assert_eq!(rest.displacement.unwrap()[0], 45.0);
    }

    #[test]
    fn more_than_there_is_leaves_nothing() {
        assert!(log().trimmed(2.0, 0.0).voltage.is_empty());
        assert!(log().trimmed(0.6, 0.6).voltage.is_empty());
        assert!(log().split(1.0).0.voltage.is_empty());
    }
}
