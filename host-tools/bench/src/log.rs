//! A log that is written as it comes, and is there up to a second ago when something ends it.

use crate::error::BenchError;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Rows after which what has come is handed to the operating system.
const ROWS: u64 = 2_000;

/// A log under way: `time_s,voltage_V,displacement_um` and what else the heading says, a row a sample.
pub struct LogFile {
    path: PathBuf,
    file: File,
    /// Whole rows, so that none is cut where the program is killed.
    waiting: String,
    tick_s: f64,
    rows: u64,
}

impl LogFile {
    /// Begins one, never over another.
    ///
    /// # Errors
    /// It is there already; or it cannot be written, here and below.
    pub fn create(path: &Path, heading: &str, tick_s: f64) -> Result<Self, BenchError> {
        let file = File::create_new(path).map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => BenchError::Occupied { path: path.to_owned() },
            _ => BenchError::Log { path: path.to_owned(), source },
        })?;
        let mut log = Self { path: path.to_owned(), file, waiting: format!("{heading}\n"), tick_s, rows: 0 };
        log.hand_over()?;
        Ok(log)
    }

    /// Adds the row of a tick: the columns behind the time.
    pub fn row(&mut self, tick: usize, columns: &[f64]) -> Result<(), BenchError> {
        let Self { waiting, tick_s, .. } = self;
        // A String takes whatever is written. Whole ticks of some µs: six places hold them.
        let _ = write!(waiting, "{:.6}", tick as f64 * *tick_s);
        columns.iter().for_each(|number| {
            let _ = write!(waiting, ",{number:.5}");
        });
        waiting.push('\n');
        self.rows += 1;
        if self.rows.is_multiple_of(ROWS) { self.hand_over() } else { Ok(()) }
    }

    /// Ends it; its path and how many rows it has.
    pub fn end(mut self) -> Result<(PathBuf, u64), BenchError> {
        self.hand_over()?;
        Ok((self.path, self.rows))
    }

    fn hand_over(&mut self) -> Result<(), BenchError> {
        let written = self.file.write_all(self.waiting.as_bytes());
        self.waiting.clear();
        written.map_err(|source| BenchError::Log { path: self.path.clone(), source })
    }
}
