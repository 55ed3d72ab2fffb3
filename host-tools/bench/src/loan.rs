//! The device's table while a session needs another: a straight line's, by which the board can be driven over all that
//! its wiring allows. The table of before is kept in a file until it is in use again.

use crate::error::BenchError;
use crate::output::Output;
use crate::session::unoccupied;
use crate::wiring::Wiring;
use device_link::busy::idle;
use device_link::table::{in_use, to_record};
use device_link::write::Writing;
use device_link::{Client, board};
use estimator_core::{AdcCalibration, AdcCode, Admitted, DriveLimits, Table};
use protocol::{Mode, Record, TableSource};
use std::path::Path;
use std::time::{Duration, Instant};

/// Name of the file that keeps the table of before.
pub const FORMER: &str = "former-table.bin";

/// How near to its rest the voltage must come, of the drive's range: as near as the firmware asks it to be where it was
/// commanded.
const NEAR: f32 = 0.05;
/// How much longer than by the slew limit it may take to get there: an emulated board may be slower than its host.
const PATIENCE: f32 = 5.0;
const AT_LEAST: Duration = Duration::from_secs(3);
/// How long it is waited for what is left of the way from near, at most, s.
const MOST_LEFT_S: f32 = 60.0;

/// What must be undone.
#[derive(Debug)]
pub enum Loan {
    /// Nothing: the straight line's table was in use before.
    Nothing,
    /// This table was stored.
    Stored(Box<Record>),
    /// The one of the firmware image was in use.
    Compiled,
}

impl Loan {
    /// Brings the straight line's table into use, and makes the folder once nothing is in the way of that.
    ///
    /// # Errors
    /// Something depends on what the device drives, the board is another one, its DAC is not known to be plugged into
    /// the amplifier, the voltage would jump, the folder keeps the only copy of a table that is not in use again or
    /// another session's logs, or it or the flash cannot be written.
    pub fn take(client: &mut Client, wiring: &Wiring, folder: &Path) -> Result<Self, BenchError> {
        idle(client)?;
        let identity = client.identify()?;
        wiring.line().fits(&board::of(&identity)?)?;
        let former = in_use(client)?.ok_or(BenchError::NotDriving)?;
        let kept = folder.join(FORMER);
        // Where it is in use again, as it stands there, somebody has brought it back by hand.
        if kept.exists() && std::fs::read(&kept).ok().as_deref() != Some(&former[..]) {
            return Err(BenchError::FormerKept { path: kept });
        }
        unoccupied(folder)?;
        let line = to_record(wiring.line());
        if former == line {
            result_files::folder(folder)?;
            return Ok(Self::Nothing);
        }
        let table: Admitted = Table::parse(&former).map_err(|_| BenchError::NotDriving)?;
        if table.drive.is_none() {
            return Err(BenchError::NotDriving);
        }
        Output::same(&table, wiring.line())?;
        result_files::folder(folder)?;
        result_files::write(&kept, &former)?;
        let loan = if identity.source == TableSource::Stored { Self::Stored(Box::new(former)) } else { Self::Compiled };
        match bring(client, &line, false) {
            Ok(()) => Ok(loan),
            // Both are said: where the second fails, too, the file holds the only copy.
            Err(error) => Err(beside(error, loan.give_back(client, folder))),
        }
    }

    /// Brings the table of before into use again; the folder then keeps it no longer.
    ///
    /// # Errors
    /// The flash cannot be written.
    pub fn give_back(&self, client: &mut Client, folder: &Path) -> Result<(), BenchError> {
        match self {
            Self::Nothing => return Ok(()),
            Self::Stored(former) => bring(client, former, false)?,
            Self::Compiled => {
                let writing = Writing { reset: true, ..Writing::default() };
                writing.write(client, |client, consent| client.erase(consent))?;
            }
        }
        // What is in use again needs no copy; one that cannot be removed does no harm.
        let _ = std::fs::remove_file(folder.join(FORMER));
        Ok(())
    }
}

/// An error, and what went wrong after it where that is something else.
pub fn beside(error: BenchError, after: Result<(), BenchError>) -> BenchError {
    match after {
        Err(other) if other.to_string() != error.to_string() => BenchError::Both(Box::new(error), Box::new(other)),
        _ => error,
    }
}

/// Stores a table, restarts the device, and sees that it runs it. The device lets its voltage go to rest before it
/// restarts; by a table of another rest it would jump there, which [`Output::same`] refuses; `rewired` says that the
/// DAC is unplugged, or plugged where it belongs by this table.
///
/// # Errors
/// The flash cannot be written, or the device does not take it.
pub fn bring(client: &mut Client, record: &Record, rewired: bool) -> Result<(), BenchError> {
    let writing = Writing { reset: true, rewired, ..Writing::default() };
    writing.write(client, |client, consent| client.push(record.clone(), consent))?;
    if in_use(client)?.as_ref() == Some(record) { Ok(()) } else { Err(BenchError::NotTaken) }
}

/// Lets go of the drive, and waits until the voltage has come to the rest of the table in use.
///
/// # Errors
/// The link fails, or it does not come to rest.
pub fn rest(client: &mut Client, adc: AdcCalibration, limits: DriveLimits) -> Result<(), BenchError> {
    client.set_mode(Mode::Estimate)?;
    client.stream(true)?;
    let (rest_v, near) = (limits.rest_v, NEAR * limits.range_v.span());
    let patience = Duration::from_secs_f32((PATIENCE * limits.range_v.span() / limits.slew_v_per_s).min(3600.0));
    let (begun, mut volts) = (Instant::now(), f32::NAN);
    while begun.elapsed() < patience.max(AT_LEAST) {
        if let Some(batch) = client.samples(Duration::from_millis(100))? {
            volts = batch.samples.last().map_or(volts, |sample| adc.voltage(AdcCode(sample.code)));
        }
        if (volts - rest_v).abs() <= near {
            client.stream(false)?;
            // What is left of the way.
            std::thread::sleep(Duration::from_secs_f32((near / limits.slew_v_per_s).min(MOST_LEFT_S)));
            return Ok(());
        }
    }
    client.stream(false)?;
    Err(BenchError::NotAtRest { volts, rest_v })
}
