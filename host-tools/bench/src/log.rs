//! A log that is written as it comes, and is there up to a second ago when something ends it.

use crate::error::BenchError;
use serde::Deserialize;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// What was done, beside the logs.
pub const SESSION: &str = "session.toml";
/// Rows after which what has come is handed to the operating system.
const ROWS: u64 = 2_000;

/// Refuses a folder in which another session's logs would be mixed with those of this one.
///
/// # Errors
/// It holds a session's description or numbered logs; or it cannot be read.
pub fn unoccupied(folder: &Path) -> Result<(), BenchError> {
    let failed = |source| BenchError::Log { path: folder.to_owned(), source };
    if !folder.exists() {
        return Ok(());
    }
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name();
        let numbered = matches!(name.as_encoded_bytes(), [b'0'..=b'9', b'0'..=b'9', b'-', .., b'.', b'c', b's', b'v']);
        if name == SESSION || numbered {
            return Err(BenchError::Occupied { path: entry.path() });
        }
    }
    Ok(())
}

/// Logs that a session wrote, as its description names them.
#[derive(Debug)]
pub struct Session {
    /// It did not end before its time.
    pub complete: bool,
    /// What its voltages were drawn with.
    pub seed: u64,
    /// The board's tick, µs.
    pub tick_us: u32,
    /// To be learnt from.
    pub logs: Vec<PathBuf>,
    /// To prove with.
    pub held_out: Vec<PathBuf>,
}

/// The tick of a board at 2 kHz, µs.
fn of_2_khz() -> u32 {
    500
}

/// Reads a session's description.
///
/// # Errors
/// There is none, or it is none.
pub fn session(folder: &Path) -> Result<Session, BenchError> {
    #[derive(Deserialize)]
    struct Log {
        log: PathBuf,
        held_out: bool,
    }
    #[derive(Deserialize)]
    struct Described {
        complete: bool,
        seed: u64,
        /// Sessions of before had but one.
        #[serde(default = "of_2_khz")]
        tick_us: u32,
        logs: Vec<Log>,
    }
    let path = folder.join(SESSION);
    let failed = |source| BenchError::Log { path: path.clone(), source };
    let text = std::fs::read_to_string(&path).map_err(failed)?;
    let Described { complete, seed, tick_us, logs } =
        toml::from_str(&text).map_err(|error| failed(std::io::Error::new(ErrorKind::InvalidData, error)))?;
    let (held_out, learnt): (Vec<Log>, Vec<Log>) = logs.into_iter().partition(|log| log.held_out);
    // They lie beside it, wherever it was moved to.
    let paths = |logs: Vec<Log>| logs.iter().filter_map(|of| Some(folder.join(of.log.file_name()?))).collect();
    Ok(Session { complete, seed, tick_us, logs: paths(learnt), held_out: paths(held_out) })
}

/// A log under way: `time_s,voltage_V,displacement_um` and what else the heading says, a row a sample.
pub struct LogFile {
    path: PathBuf,
    file: BufWriter<File>,
    tick_s: f64,
    rows: u64,
}

impl LogFile {
    /// Begins one, never over another.
    ///
    /// # Errors
    /// It is there already; or it cannot be written, here and below.
    pub fn create(path: &Path, heading: &str, tick_s: f64) -> Result<Self, BenchError> {
        let failed = |source: std::io::Error| match source.kind() {
            ErrorKind::AlreadyExists => BenchError::Occupied { path: path.to_owned() },
            _ => BenchError::Log { path: path.to_owned(), source },
        };
        let mut file = BufWriter::new(File::create_new(path).map_err(failed)?);
        writeln!(file, "{heading}").map_err(failed)?;
        Ok(Self { path: path.to_owned(), file, tick_s, rows: 0 })
    }

    /// Adds the row of a tick: the columns behind the time.
    pub fn row(&mut self, tick: usize, columns: &[f64]) -> Result<(), BenchError> {
        let mut row = || -> std::io::Result<()> {
            // Whole ticks of some µs: six places hold them.
            write!(self.file, "{:.6}", tick as f64 * self.tick_s)?;
            columns.iter().try_for_each(|number| write!(self.file, ",{number:.5}"))?;
            writeln!(self.file)?;
            if self.rows.is_multiple_of(ROWS) { self.file.flush() } else { Ok(()) }
        };
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
