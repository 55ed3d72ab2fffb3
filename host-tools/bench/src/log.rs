//! A log that is written as it comes, a line at a time, and is there up to its last row when something ends it.

use crate::error::BenchError;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A log under way: `time_s,voltage_V,displacement_um` and what else the heading says, a row a sample. It is of whole lines
/// whenever something ends it.
pub struct LogFile {
    path: PathBuf,
    file: File,
    /// Bytes of the lines that are written.
    length: u64,
    tick_s: f64,
    rows: u64,
}

impl LogFile {
    /// Begins one, never over another.
    ///
    /// # Errors
    /// It is there already; or it cannot be written, here and below, and ends with the line before.
    pub fn create(path: &Path, heading: &str, tick_s: f64) -> Result<Self, BenchError> {
        let file = File::create_new(path).map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => BenchError::Occupied { path: path.to_owned() },
            _ => BenchError::Log { path: path.to_owned(), source },
        })?;
        let mut log = Self { path: path.to_owned(), file, length: 0, tick_s, rows: 0 };
        log.line(heading).inspect_err(|_| {
            // It holds nothing, and would be in the way of the next session; the error that is said comes first.
            let _ = std::fs::remove_file(path);
        })?;
        Ok(log)
    }

    /// Adds the row of a tick: the columns behind the time.
    pub fn row(&mut self, tick: usize, columns: &[f64]) -> Result<(), BenchError> {
        // Whole ticks of some µs: six places hold them.
        let mut row = format!("{:.6}", tick as f64 * self.tick_s);
        columns.iter().for_each(|number| row += &format!(",{number:.5}"));
        self.line(&row)?;
        self.rows += 1;
        Ok(())
    }

    fn line(&mut self, text: &str) -> Result<(), BenchError> {
        let line = format!("{text}\n");
        self.file.write_all(line.as_bytes()).map_err(|source| {
            // Half a line would be read as other numbers. Where this fails, too, the disk is what is said.
            let _ = self.file.set_len(self.length);
            BenchError::Log { path: self.path.clone(), source }
        })?;
        self.length += line.len() as u64;
        Ok(())
    }

    /// Ends it; its path and how many rows it has.
    pub fn end(self) -> (PathBuf, u64) {
        (self.path, self.rows)
    }
}
