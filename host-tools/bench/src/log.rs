//! A log that is written as it comes, a line at a time, and is there up to its last row when something ends it.

use crate::error::BenchError;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A log under way: `time_s,voltage_V,displacement_um` and what else the heading says, a row a sample. It is of whole
/// lines whenever something ends it.
pub struct LogFile {
    path: PathBuf,
    file: File,
    /// Bytes of the lines that are written.
    length: u64,
    tick_s: f64,
    rows: u64,
    /// It is left without a row, too.
    left_empty: bool,
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
        let mut log = Self { path: path.to_owned(), file, length: 0, tick_s, rows: 0, left_empty: true };
        log.line(heading).inspect_err(|_| {
            // It holds nothing, and would be in the way of the next session; the error that is said comes first.
            let _ = std::fs::remove_file(path);
        })?;
        Ok(log)
    }

    /// Takes it away, however it ends, where it has no row then: it would be in the way of the next one.
    pub fn with_rows_alone(mut self) -> Self {
        self.left_empty = false;
        self
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
        (self.path.clone(), self.rows)
    }
}

impl Drop for LogFile {
    fn drop(&mut self) {
        if self.rows == 0 && !self.left_empty {
            // What has ended it is said; that an empty file is left, the next one says.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_that_must_have_rows_is_left_only_with_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("proven.csv");
        let begun = || LogFile::create(&path, "time_s", 5e-4).unwrap();
        drop(begun().with_rows_alone());
        assert!(!path.exists());
        let mut log = begun().with_rows_alone();
        log.row(0, &[]).unwrap();
        drop(log);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time_s\n0.000000\n");
        std::fs::remove_file(&path).unwrap();
        drop(begun());
        assert!(path.exists());
    }
}
