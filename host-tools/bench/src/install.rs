//! A table into a device, and the proof that the device runs it as the host does.

use crate::board_file::BoardFacts;
use crate::error::BenchError;
use crate::loan::bring;
use crate::output::Output;
use crate::wiring::WiringError;
use ::calibration::CalibrationOptions;
use ::calibration::drive::identified_on;
use device_link::Client;
use device_link::board;
use device_link::interrupt::Interrupt;
use device_link::pil::{Comparison, compare, feed};
use device_link::table::{in_use, to_record};
use device_link::write::Writing;
use estimator_core::table::Misfit;
use estimator_core::{AdcCode, Admitted, DriveLimits, Range, Table};
use excitation::{Drive, ExcitationError, Request};
use protocol::{Identity, Mode};
use std::path::{Path, PathBuf};
use table_files::{TableFile, TableFileError, agree, in_folder};

/// Length of a rehearsal, s, its highest frequency, Hz, and how often its voltage may go over the whole range
/// in a second.
const REHEARSAL_S: f64 = 5.0;
const REHEARSAL_HZ: f64 = 20.0;
const REHEARSAL_WAYS: f64 = 20.0;

/// A table file's table with a board's calibration: the file, which may be named by its folder, the table, and what to
/// be careful about. Limits of its own that the table's drive has are kept where they are narrower than the board's,
/// and its rest in any case.
///
/// # Errors
/// A file cannot be read, a face of another table lies beside it, the board's does not say what the ADC's codes are, or
/// the table is refused with its calibration.
pub fn for_board(table: &Path, board: &Path) -> Result<(PathBuf, Admitted, Vec<String>), BenchError> {
    let path = in_folder(table);
    let (mut file, stated) = TableFile::load(&path)?;
    agree(&path, &stated).map_err(TableFileError::from)?;
    let facts = BoardFacts::read(board)?;
    if facts.adc_span.is_none() {
        return Err(
            WiringError::Missing { field: "adc_span", what: "the volts at ADC code 0 and at full scale" }.into()
        );
    }
    let own = file.table.drive.map(|drive| drive.limits);
    facts.calibration(&CalibrationOptions::default()).apply(&mut file.table);
    file.doubts.extend(facts.adc_span.filter(|(zero, full)| zero > full).map(|(zero, full)| {
        format!(
            "adc_span falls from {zero} V at code 0 to {full} V at full scale: right where the divider inverts, else its ends are swapped"
        )
    }));
    let kept = file.table.drive.as_mut().zip(own).and_then(|(drive, own)| keep(own, &mut drive.limits));
    file.doubts.extend(kept);
    let admitted = file.admit().map_err(|source| TableFileError::Refused { path: path.clone(), line: None, source })?;
    Ok((path, admitted, file.doubts))
}

/// Narrows a board's limits to a table's own; says so where that changes them.
fn keep(own: DriveLimits, limits: &mut DriveLimits) -> Option<String> {
    let of_board = *limits;
    *limits = DriveLimits {
        range_v: own.range_v.intersection(of_board.range_v),
        rest_v: own.rest_v,
        slew_v_per_s: own.slew_v_per_s.min(of_board.slew_v_per_s),
    };
    let said = |limits: &DriveLimits| {
        let DriveLimits { range_v: Range { min, max }, rest_v, slew_v_per_s } = limits;
        format!("{min} … {max} V at {slew_v_per_s} V/s, at rest {rest_v} V")
    };
    (*limits != of_board).then(|| {
        format!(
            "the table drives within limits of its own, {}; with those of the board, {}, it is installed with {}",
            said(&own),
            said(&of_board),
            said(limits)
        )
    })
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

/// Refuses a table whose converters, which the board's file has stated, are not the device's.
///
/// # Errors
/// They are not, or the device says what no board has.
pub fn converters_fit(table: &Table, identity: &Identity) -> Result<(), BenchError> {
    match table.fits(&board::of(identity)?) {
        Err(misfit @ Misfit::Converters { .. }) => Err(misfit.into()),
        _ => Ok(()),
    }
}

/// Refuses a table that a device could not take as its wires are, or of which nobody says that they were changed.
///
/// # Errors
/// The table is not for this device, the voltage would jump and the board is not `rewired`, or the link fails.
fn may_take(client: &mut Client, table: &Admitted, rewired: bool) -> Result<(), BenchError> {
    table.fits(&board::of(&client.identify()?)?)?;
    if let (false, Some(former)) = (rewired, in_use(client)?) {
        // One that cannot be read here is of another format, which the line above has refused, or damaged.
        if let Ok(former) = Table::parse(&former) {
            Output::same(&former, table)?;
        }
    }
    Ok(())
}

/// Why a device would not take a table that fits it, or only with a jump of its voltage; empty where it would.
///
/// # Errors
/// The table is not for this device, or the link fails.
pub fn refusals(client: &mut Client, table: &Admitted, rewired: bool) -> Result<Vec<BenchError>, BenchError> {
    let writing = Writing { reset: true, rewired, ..Writing::default() };
    let mut refusals: Vec<BenchError> = writing.refusals(client, Some(table))?.into_iter().map(Into::into).collect();
    match may_take(client, table, rewired) {
        Err(jump @ BenchError::WouldJump { .. }) => refusals.push(jump),
        may => may?,
    }
    Ok(refusals)
}

/// Stores a table, restarts the device, and feeds codes through its tick: how many of the ticks are the host's to the
/// last bit. The device then estimates by this table.
///
/// # Errors
/// The table is not for this device, the voltage would jump and the board is not `rewired`, its flash cannot be
/// written, or the codes cannot be fed.
pub fn install(
    client: &mut Client,
    table: &Admitted,
    rewired: bool,
    codes: &[AdcCode],
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Comparison, BenchError> {
    may_take(client, table, rewired)?;
    bring(client, &to_record(table), rewired)?;
    let fed = feed(client, table, codes, interrupt, progress);
    // Whatever happened, the device estimates again.
    let restored = client.set_mode(Mode::Estimate);
    let comparison = compare(table, codes, &fed?);
    restored?;
    Ok(comparison)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_keeps_limits_of_its_own_that_are_narrower_than_the_board_s_and_its_rest() {
        let limits = |min, max, rest_v, slew_v_per_s| DriveLimits { range_v: Range { min, max }, rest_v, slew_v_per_s };
        let kept = |own, mut board: DriveLimits| {
            let said = keep(own, &mut board);
            (board, said)
        };
        let board = limits(0.0, 100.0, 0.0, 500.0);
        let (narrow, said) = kept(limits(-5.0, 40.0, 10.0, 50.0), board);
        assert_eq!(narrow, limits(0.0, 40.0, 10.0, 50.0));
        assert!(said.unwrap().contains("installed with 0 … 40 V at 50 V/s, at rest 10 V"));
        assert_eq!(kept(limits(-5.0, 140.0, 0.0, 900.0), board), (board, None));
    }
}
