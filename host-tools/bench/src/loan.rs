//! The device's table while a session needs another: a straight line's, by which the board can be driven over all that its
//! wiring allows. The table of before is kept in a file, and in use again afterwards.

use crate::error::BenchError;
use crate::wiring::Wiring;
use device_link::table::{in_use, to_record};
use device_link::write::Writing;
use device_link::{Client, board};
use estimator_core::{AdcCode, Admitted, Table};
use protocol::{Mode, Record, TableSource};
use recordings::file;
use std::path::Path;
use std::time::{Duration, Instant};

/// Name of the file that keeps the table of before.
pub const FORMER: &str = "former-table.bin";

/// How near to its rest the voltage must come, of the drive's range.
const NEAR: f32 = 0.02;
/// How much longer than by the slew limit it may take to get there: an emulated board may be slower than its host.
const PATIENCE: f32 = 5.0;
const AT_LEAST: Duration = Duration::from_secs(3);

/// What must be undone.
pub enum Loan {
    /// Nothing: the straight line's table was in use before.
    Nothing,
    /// This table was stored.
    Stored(Box<Record>),
    /// The one of the firmware image was in use.
    Compiled,
}

impl Loan {
    /// Brings the straight line's table into use.
    ///
    /// # Errors
    /// The board is another one, its DAC is not known to be plugged into the amplifier, or its flash cannot be written.
    pub fn take(client: &mut Client, wiring: &Wiring, folder: &Path) -> Result<Self, BenchError> {
        let identity = client.identify()?;
        wiring.line().fits(&board::of(&identity)?)?;
        let former = in_use(client)?.ok_or(BenchError::NotDriving)?;
        let line = to_record(wiring.line());
        if former == line {
            return Ok(Self::Nothing);
        }
        let drives = Table::parse(&former).is_ok_and(|table: Admitted| table.drive.is_some());
        if !drives {
            return Err(BenchError::NotDriving);
        }
        file::write(&folder.join(FORMER), &former)?;
        let loan = if identity.source == TableSource::Stored { Self::Stored(Box::new(former)) } else { Self::Compiled };
        if let Err(error) = bring(client, &line) {
            // What went wrong first is what is said; the file is there in any case.
            let _ = loan.give_back(client);
            return Err(error);
        }
        Ok(loan)
    }

    /// Brings the table of before into use again.
    ///
    /// # Errors
    /// The flash cannot be written.
    pub fn give_back(&self, client: &mut Client) -> Result<(), BenchError> {
        match self {
            Self::Nothing => Ok(()),
            Self::Stored(former) => bring(client, former),
            Self::Compiled => {
                let writing = Writing { reset: true, ..Writing::default() };
                writing.write(client, |client, consent| client.erase(consent))?;
                Ok(())
            }
        }
    }
}

/// Stores a table, restarts the device, and sees that it runs it. The voltage goes to rest before.
///
/// # Errors
/// The flash cannot be written, or the device does not take it.
pub fn bring(client: &mut Client, record: &Record) -> Result<(), BenchError> {
    let writing = Writing { reset: true, ..Writing::default() };
    writing.write(client, |client, consent| client.push(record.clone(), consent))?;
    if in_use(client)?.as_ref() == Some(record) { Ok(()) } else { Err(BenchError::NotTaken) }
}

/// Lets go of the drive, and waits until the voltage has come to its rest.
///
/// # Errors
/// The link fails, or it does not come to rest.
pub fn rest(client: &mut Client, wiring: &Wiring) -> Result<(), BenchError> {
    client.set_mode(Mode::Estimate)?;
    client.stream(true)?;
    let limits = wiring.drive().limits;
    let (rest_v, near) = (limits.rest_v, NEAR * limits.range_v.span());
    let way = Duration::from_secs_f32((PATIENCE * limits.range_v.span() / limits.slew_v_per_s).min(3600.0));
    let (begun, mut volts) = (Instant::now(), f32::NAN);
    while begun.elapsed() < way.max(AT_LEAST) {
        if let Some(batch) = client.samples(Duration::from_millis(100))? {
            volts = batch.samples.last().map_or(volts, |sample| wiring.adc().voltage(AdcCode(sample.code)));
        }
        if (volts - rest_v).abs() <= near {
            return Ok(client.stream(false)?);
        }
    }
    client.stream(false)?;
    Err(BenchError::NotAtRest { volts, rest_v })
}
