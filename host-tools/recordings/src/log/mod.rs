//! Recorded sessions: voltage and displacement over time, read from CSV, text tables and MATLAB files.
//!
//! A log that comes out of [`read`] is in V and µm at one sample period, finite, without gaps, and of plausible size;
//! everything else is refused with the file, the line, the value and the remedy ([`LogError`]).

mod channels;
mod clock;
mod columns;
mod delimiter;
mod error;
mod fault;
mod label;
mod mat;
mod mat_reader;
mod number;
mod plausible;
mod read_options;
mod recorded;
mod recording;
mod resolution;
mod steps;
mod text;
mod units;
mod write;

#[cfg(test)]
mod tests;

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use sha2::{Digest, Sha256};

pub use columns::{Column, Columns, ColumnsError, Position};
use error::PlacedFault;
pub use error::{LogError, Place};
pub use fault::Fault;
pub use number::Number;
pub use read_options::ReadOptions;
pub use recorded::Log;
use recording::Recording;
pub use units::{Quantity, Unit, UnknownUnit};
pub use write::{Displacement, write_csv};

/// Fewest rows that make a log.
pub const MINIMUM_ROWS: usize = 16;

/// Reads the log in the file at `path`.
///
/// # Errors
/// Whatever makes the file no usable log; see [`Fault`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
    let refuse = |fault: Fault| LogError { path: path.to_owned(), place: Place::File, fault };
    read_bytes(path, &load(path).map_err(refuse)?, options)
}

/// Reads the log in the bytes of a file, which come with a program or were read before.
///
/// # Errors
/// Whatever makes them no usable log.
pub fn read_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Log, LogError> {
    let refuse = |PlacedFault(place, fault)| LogError { path: path.to_owned(), place, fault };
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let (recording, sample_period) = parse(bytes, &file, options).map_err(refuse)?;
    Ok(Log {
        name: Path::new(&*file).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        path: path.to_owned(),
        sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
        start_s: 0.0,
        sample_period,
        voltage: recording.voltage,
        displacement: recording.displacement,
        displacement_estimated: recording.channels.displacement_estimated,
    })
}

fn load(path: &Path) -> Result<Vec<u8>, Fault> {
    let fault = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => Fault::NotFound,
        _ => Fault::Unreadable(error),
    };
    let kind = fs::metadata(path).map_err(fault)?;
    if kind.is_dir() {
        return Err(Fault::Directory);
    }
    if !kind.is_file() {
        return Err(Fault::NotRegular);
    }
    let bytes = fs::read(path).map_err(fault)?;
    if bytes.is_empty() {
        return Err(Fault::Empty);
    }
    Ok(bytes)
}

/// The recording in `bytes`, checked, and its sample period in s. `file` is the file's name.
fn parse(bytes: &[u8], file: &str, options: &ReadOptions) -> Result<(Recording, f64), PlacedFault> {
    if let Some(rate) = options.sample_rate {
        clock::check_rate(rate)?;
    }
    let named_mat = Path::new(file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mat"));
    let recording = if named_mat || mat::is_mat(bytes) {
        mat::read(bytes, file, options)?
    } else {
        text::read(bytes, file, options)?
    };
    let rows = recording.rows();
    // What is wanted may be said in a few corners.
    let minimum = if options.voltage_required { MINIMUM_ROWS } else { 2 };
    if rows < minimum {
        return Err(Fault::FewRows { rows, minimum }.into());
    }
    let sample_period = clock::sample_period(&recording, options.sample_rate)?;
    if options.voltage_required {
        plausible::check(&recording)?;
    }
    Ok((recording, sample_period))
}
