//! Recorded sessions: voltage and displacement over time, read from what instruments and programs write.
//!
//! A log that comes out of [`read`] is in V and µm at one sample period, finite, without gaps or with them
//! bridged ([`Log::holes`]), and of plausible size; everything else is refused with the file, the line, the value
//! and the remedy ([`LogError`]).

mod channels;
mod choose;
mod clock;
mod columns;
mod complete;
mod error;
mod fault;
mod guess;
mod holes;
mod label;
mod number;
mod plausible;
mod read_options;
mod reading;
mod recorded;
mod recording;
mod resolution;
mod sensitivity;
mod steps;
mod vocabulary;
mod write;

#[cfg(test)]
mod tests;

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

pub use channels::Remark;
pub use columns::{Column, Columns, ColumnsError, Position};
pub use error::LogError;
use error::PlacedFault;
pub use fault::Fault;
pub use holes::{MOST_HOLES, bridge};
pub use measurement_files::{Place, Quantity, Unit, UnknownUnit};
pub use number::Number;
pub use read_options::{Need, ReadOptions};
pub use reading::{Chosen, Reading, Row};
pub use recorded::{Log, twins};
pub use recording::MINIMUM_ROWS;
use recording::Recording;
pub use sensitivity::{Sensitivity, SensitivityError};
pub use write::{Displacement, csv_beside};

/// Reads the log in the file at `path`.
///
/// # Errors
/// Whatever makes the file no usable log; see [`Fault`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Log, LogError> {
    read_remarked(path, options).map(|(log, _)| log)
}

/// Reads the log in the file at `path`, and what is to be said of how its columns were understood.
///
/// # Errors
/// Whatever makes the file no usable log.
pub fn read_remarked(path: &Path, options: &ReadOptions) -> Result<(Log, Vec<Remark>), LogError> {
    let bytes = load(path).map_err(|fault| PlacedFault::from(fault).in_file(path))?;
    of_bytes(path, &bytes, options)
}

/// Reads the log in the bytes of a file, which come with a program or were read before.
///
/// # Errors
/// Whatever makes them no usable log.
pub fn read_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Log, LogError> {
    of_bytes(path, bytes, options).map(|(log, _)| log)
}

fn of_bytes(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<(Log, Vec<Remark>), LogError> {
    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let (recording, sample_period) = parse(bytes, options).map_err(|fault| fault.in_file(path))?;
    let log = Log {
        name: Path::new(&*file).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        path: path.to_owned(),
        sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
        start_s: 0.0,
        sample_period,
        voltage: recording.voltage,
        displacement: recording.displacement,
        displacement_estimated: recording.channels.displacement_estimated,
        holes: recording.holes,
    };
    Ok((log, recording.channels.remarks()))
}

/// Opens the log in the file at `path` without reading it to its end: only what is needed to know its columns.
///
/// # Errors
/// Whatever keeps its columns from being known.
pub fn open(path: &Path, options: &ReadOptions) -> Result<Reading<'static>, LogError> {
    let opened = file(path).map_err(PlacedFault::from).and_then(|file| Reading::new(file, path, options));
    opened.map_err(|fault| fault.in_file(path))
}

/// The regular file at `path`.
fn file(path: &Path) -> Result<fs::File, Fault> {
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
    fs::File::open(path).map_err(fault)
}

fn load(path: &Path) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    file(path)?.read_to_end(&mut bytes).map_err(Fault::Unreadable)?;
    Ok(bytes)
}

/// The recording in `bytes`, checked, and its sample period in s.
fn parse(bytes: &[u8], options: &ReadOptions) -> Result<(Recording, f64), PlacedFault> {
    let mut recording = Reading::new(bytes, Path::new(""), options)?.recording()?;
    let rows = recording.rows();
    // What is wanted may be said in a few corners.
    let minimum = if options.voltage_required { MINIMUM_ROWS } else { 2 };
    if rows < minimum {
        return Err(Fault::FewRows { rows, minimum }.into());
    }
    if options.holes {
        recording.bridge(&clock::gaps(&recording))?;
    }
    let sample_period = clock::sample_period(&recording, options.sample_rate)?;
    if options.voltage_required {
        plausible::check(&recording)?;
    }
    Ok((recording, sample_period))
}
