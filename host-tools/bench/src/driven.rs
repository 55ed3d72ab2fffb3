//! A board that drives the amplifier to a voltage and stays there for as long as the host says so: a host that dies, or is killed, is
//! waited for for a second, and then the voltage goes to rest.

use crate::error::BenchError;
use crate::loan;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::play::{Held, Play, PlayError, play};
use device_link::table;
use estimator_core::{Admitted, DriveCalibration};
use protocol::{Mode, Sample};

/// How fast it goes, of the fastest that the drive allows.
const OF_SLEW: f64 = 0.5;
/// How long the amplifier gets to come to the voltage after the last step, s, and how long it is held at a time.
const SETTLES_S: f64 = 0.5;
const STAYS_S: f64 = 0.25;

/// The board, and where it drives to.
pub struct Driven {
    table: Admitted,
    drive: DriveCalibration,
    volts: f32,
    held: Option<Held>,
}

impl Driven {
    /// By the table in use; nothing moves yet.
    ///
    /// # Errors
    /// It does not drive, the voltages are beyond its range, or the link fails.
    pub fn new(client: &mut Client, volts: [f32; 2]) -> Result<Self, BenchError> {
        let table = table::running(client)?;
        let drive = table.drive.ok_or(BenchError::NotDriving)?;
        let range_v = drive.limits.range_v;
        match volts.into_iter().find(|volts| !range_v.contains(*volts)) {
            Some(volts) => Err(BenchError::BeyondDrive { volts, range_v }),
            None => Ok(Self { table, drive, volts: drive.limits.rest_v, held: None }),
        }
    }

    /// Goes to a voltage, V, and waits until the amplifier has come there.
    ///
    /// # Errors
    /// A fault stops it, the link fails, or the user has had enough; here and below.
    pub fn go(&mut self, client: &mut Client, volts: f32, interrupt: &Interrupt) -> Result<(), BenchError> {
        let tick_s: f64 = self.table.sample_period();
        let (from, way) = (f64::from(self.volts), f64::from(volts - self.volts));
        let steps =
            (way.abs() / (OF_SLEW * f64::from(self.drive.limits.slew_v_per_s) * tick_s)).ceil().max(1.0) as usize;
        let mut references: Vec<f32> =
            (1..=steps).map(|step| (from + way * step as f64 / steps as f64) as f32).collect();
        references.extend(std::iter::repeat_n(volts, (SETTLES_S / tick_s) as usize));
        self.volts = volts;
        self.play(client, &references, interrupt).map(drop)
    }

    /// Stays for a quarter of a second; the samples meanwhile.
    pub fn stay(&mut self, client: &mut Client, interrupt: &Interrupt) -> Result<Vec<Sample>, BenchError> {
        let references = vec![self.volts; (STAYS_S / self.table.sample_period::<f64>()) as usize];
        self.play(client, &references, interrupt)
    }

    /// Lets go, and waits until the voltage is at rest.
    pub fn rest(&self, client: &mut Client) -> Result<(), BenchError> {
        loan::rest(client, self.table.adc, self.drive.limits)
    }

    fn play(
        &mut self,
        client: &mut Client,
        references: &[f32],
        interrupt: &Interrupt,
    ) -> Result<Vec<Sample>, BenchError> {
        let mut samples = Vec::with_capacity(references.len());
        let of = Play { mode: Mode::Excite, goes_on: self.held, references, hold: false, ticks: references.len() };
        let played = play(client, &of, interrupt, &mut |sample| {
            samples.push(*sample);
            true
        });
        let played = match played {
            Err(PlayError::Interrupted { .. }) => return Err(crate::calibrate::CalibrationError::Interrupted.into()),
            played => played?,
        };
        self.held = Some(played.held);
        match played.stopped.is_empty() {
            true => Ok(samples),
            false => Err(BenchError::Stopped { ticks: played.ticks, faults: played.stopped }),
        }
    }
}
