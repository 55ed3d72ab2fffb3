//! A table into a device, and the proof that the device runs it as the host does.

use crate::board_file::BoardFacts;
use crate::error::BenchError;
use crate::wiring::WiringError;
use ::calibration::CalibrationOptions;
use ::calibration::drive::identified_on;
use device_link::Client;
use device_link::board;
use device_link::interrupt::Interrupt;
use device_link::pil::{Comparison, compare, feed};
use device_link::table::{in_use, to_record};
use device_link::write::Writing;
use estimator_core::{AdcCode, Admitted};
use excitation::{Drive, ExcitationError, Request};
use identification::table_file::{TableFile, TableFileError};
use protocol::Mode;
use std::path::{Path, PathBuf};

/// Length of a rehearsal, s, its highest frequency, Hz, and how often its voltage may go over the whole range in a second.
const REHEARSAL_S: f64 = 5.0;
const REHEARSAL_HZ: f64 = 20.0;
const REHEARSAL_WAYS: f64 = 20.0;

/// What came of it.
#[derive(Clone, PartialEq, Debug)]
pub struct Installed {
    /// Ticks compared, and how many of them are the host's to the last bit.
    pub comparison: Comparison,
}

impl Installed {
    /// Every bit is the host's.
    pub fn bit_exact(&self) -> bool {
        self.comparison.identical == self.comparison.ticks
    }
}

/// A table file's table with a board's calibration: the file, which may be named by its folder, the table, and why not to trust it.
///
/// # Errors
/// A file cannot be read, the board's does not say what the ADC's codes are, or the table is refused with its calibration.
pub fn for_board(table: &Path, board: &Path) -> Result<(PathBuf, Admitted, Vec<String>), BenchError> {
    let path = if table.is_dir() { table.join("table.toml") } else { table.to_owned() };
    let (mut file, _) = TableFile::load(&path)?;
    let facts = BoardFacts::read(board)?;
    if facts.adc_span.is_none() {
        return Err(
            WiringError::Missing { field: "adc_span", what: "the volts at ADC code 0 and at full scale" }.into()
        );
    }
    facts.calibration(&CalibrationOptions::default()).apply(&mut file.table);
    let admitted = file.admit().map_err(|source| TableFileError::Refused { path: path.clone(), source })?;
    Ok((path, admitted, file.doubts))
}

/// Codes of a random voltage over all that a table was identified on.
///
/// # Errors
/// The table's range is none that can be gone over.
pub fn rehearsal(table: &Admitted) -> Result<Vec<AdcCode>, ExcitationError> {
    let range = identified_on(table);
    let (min_v, max_v) = (f64::from(range.min), f64::from(range.max));
    let request = Request {
        min_v,
        max_v,
        rest_v: 0f64.clamp(min_v, max_v),
        slew_v_per_s: REHEARSAL_WAYS * (max_v - min_v),
        up_to_hz: REHEARSAL_HZ.min(0.1 / table.sample_period::<f64>()),
        duration_s: REHEARSAL_S,
        tick_s: table.sample_period(),
        seed: 1,
    };
    Ok(Drive::random(&request)?.volts.iter().map(|&volts| table.adc.code(volts)).collect())
}

/// Stores a table, restarts the device, and feeds codes through its tick. The device then estimates by this table.
///
/// # Errors
/// The table is not for this device, its flash cannot be written, or the codes cannot be fed.
pub fn install(
    client: &mut Client,
    table: &Admitted,
    rewired: bool,
    codes: &[AdcCode],
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Installed, BenchError> {
    table.fits(&board::of(&client.identify()?)?)?;
    let record = to_record(table);
    let writing = Writing { reset: true, rewired, ..Writing::default() };
    writing.write(client, |client, consent| client.push(record.clone(), consent))?;
    if in_use(client)?.as_ref() != Some(&record) {
        return Err(BenchError::NotTaken);
    }
    let fed = feed(client, table, codes, interrupt, progress);
    // Whatever happened, the device estimates again.
    let restored = client.set_mode(Mode::Estimate);
    let comparison = compare(table, codes, &fed?);
    restored?;
    Ok(Installed { comparison })
}
