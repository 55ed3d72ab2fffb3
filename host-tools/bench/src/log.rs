//! A log that is written as it comes, and is there up to a second ago when something ends it.

use crate::error::BenchError;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Rows after which what has come is handed to the operating system.
const ROWS: u64 = 2_000;

/// A log under way: `time_s,voltage_V,displacement_um` and what else the heading says, a row a tick.
pub struct LogFile {
    path: PathBuf,
    file: BufWriter<File>,
    tick_s: f64,
    rows: u64,
}

impl LogFile {
    /// Begins one.
    ///
    /// # Errors
    /// It cannot be written, here and below.
    pub fn create(path: &Path, heading: &str, tick_s: f64) -> Result<Self, BenchError> {
        let failed = |source| BenchError::Log { path: path.to_owned(), source };
        let mut file = BufWriter::new(File::create(path).map_err(failed)?);
        writeln!(file, "{heading}").map_err(failed)?;
        Ok(Self { path: path.to_owned(), file, tick_s, rows: 0 })
    }

    /// Adds a row: the columns behind the time.
    pub fn row(&mut self, columns: &[f64]) -> Result<(), BenchError> {
        let row = || -> std::io::Result<()> {
            // Whole ticks of some µs: six places hold them.
            write!(self.file, "{:.6}", self.rows as f64 * self.tick_s)?;
            columns.iter().try_for_each(|number| write!(self.file, ",{number:.5}"))?;
            writeln!(self.file)?;
            if self.rows.is_multiple_of(ROWS) { self.file.flush() } else { Ok(()) }
        };
        let mut row = row;
        row().map_err(|source| BenchError::Log { path: self.path.clone(), source })?;
        self.rows += 1;
        Ok(())
    }

    /// Ends it; its path and how many rows it has.
    pub fn end(mut self) -> Result<(PathBuf, u64), BenchError> {
        self.file.flush().map_err(|source| BenchError::Log { path: self.path.clone(), source })?;
        Ok((self.path, self.rows))
    }
}
