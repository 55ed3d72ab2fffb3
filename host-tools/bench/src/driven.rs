//! A board that drives the amplifier to a voltage and stays there for as long as the host says so: a host that dies, or
//! is killed, is waited for for a second, and then the voltage goes to rest.

use crate::board_file::BoardFacts;
use crate::calibration_error::CalibrationError;
use crate::error::BenchError;
use crate::loan;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::play::{Held, Play, PlayError, play};
use device_link::table;
use estimator_core::{Admitted, DriveCalibration, DriveLimits, Range};
use protocol::{Mode, Sample};

/// How fast it goes, of the fastest that the drive allows.
const OF_SLEW: f64 = 0.5;
/// The longest ramp, s.
const LONGEST_S: f64 = 60.0;
/// How long the amplifier gets to come to the voltage after the last step, s, and how long it is held at a time.
const SETTLES_S: f64 = 0.5;
pub(crate) const STAYS_S: f64 = 0.25;
/// What the amplifier puts out may be so far from what it was driven to, of the drive's range, by a calibration to
/// begin with,
const FAR: f64 = 0.1;
/// and by the file of a board that was calibrated.
const FAR_CALIBRATED: f64 = 0.05;

/// The board, and where it drives to.
pub struct Driven {
    table: Admitted,
    drive: DriveCalibration,
    volts: f32,
    held: Option<Held>,
    /// The board's file was calibrated.
    calibrated: bool,
}

impl Driven {
    /// By the table in use, as far and as fast as both it and the board's file allow; nothing moves yet.
    ///
    /// # Errors
    /// It does not drive, the voltages are beyond a range, the way there takes too long, or the link fails.
    pub fn new(client: &mut Client, volts: [f32; 2], facts: &BoardFacts) -> Result<Self, BenchError> {
        let table = table::running(client)?;
        let mut drive = table.drive.ok_or(BenchError::NotDriving)?;
        drive.limits = allowed(volts, drive.limits, facts)?;
        let calibrated = facts.board_uid.is_some() && facts.drive_span.is_some();
        Ok(Self { table, drive, volts: drive.limits.rest_v, held: None, calibrated })
    }

    /// How far what the amplifier puts out may be from what it was driven to, V.
    pub(crate) fn far_v(&self) -> f64 {
        (if self.calibrated { FAR_CALIBRATED } else { FAR }) * f64::from(self.drive.limits.range_v.span())
    }

    /// Goes to a voltage, V, and waits until the amplifier has come there.
    ///
    /// # Errors
    /// A fault stops it, the link fails, or the user has had enough; here and below.
    pub fn go(&mut self, client: &mut Client, volts: f32, interrupt: &Interrupt) -> Result<(), BenchError> {
        let tick_s: f64 = self.table.sample_period();
        let (from, travel) = (f64::from(self.volts), f64::from(volts - self.volts));
        let steps = (ramp_s(travel, self.drive.limits.slew_v_per_s) / tick_s).ceil().max(1.0) as usize;
        let mut references: Vec<f32> =
            (1..=steps).map(|step| (from + travel * step as f64 / steps as f64) as f32).collect();
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
        let played = play(client, &of, interrupt, &mut |of| {
            samples.push(of.sample);
            true
        });
        let played = match played {
            Err(PlayError::Interrupted { .. }) => return Err(CalibrationError::Interrupted.into()),
            played => played?,
        };
        self.held = Some(played.held);
        match played.stopped.is_empty() {
            true => Ok(samples),
            false => Err(BenchError::Stopped { ticks: played.ticks, faults: played.stopped }),
        }
    }
}

/// How long a way of so many volts takes, s.
fn ramp_s(travel: f64, slew_v_per_s: f32) -> f64 {
    travel.abs() / (OF_SLEW * f64::from(slew_v_per_s))
}

/// The limits of a table's drive, with the smaller slew where the board's file has one, if they and the file
/// allow the voltages.
fn allowed(volts: [f32; 2], limits: DriveLimits, facts: &BoardFacts) -> Result<DriveLimits, BenchError> {
    let file = facts.drive_range.map(|(one, other)| Range { min: one.min(other) as f32, max: one.max(other) as f32 });
    let ranges = [
        Some((limits.range_v, "what the table in use drives to")),
        file.map(|range| (range, "drive_range of board.toml")),
    ];
    for (range_v, of) in ranges.into_iter().flatten() {
        if let Some(volts) = volts.into_iter().find(|volts| !range_v.contains(*volts)) {
            return Err(BenchError::BeyondDrive { volts, range_v, of });
        }
    }
    let slew_v_per_s = facts.drive_slew.map_or(limits.slew_v_per_s, |slew| limits.slew_v_per_s.min(slew as f32));
    let travels = [volts[0] - limits.rest_v, volts[1] - volts[0]];
    let seconds = travels.map(|travel| ramp_s(f64::from(travel), slew_v_per_s)).into_iter().fold(0.0, f64::max);
    match seconds <= LONGEST_S {
        true => Ok(DriveLimits { slew_v_per_s, ..limits }),
        false => Err(BenchError::SlowRamp { seconds, slew_v_per_s }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: DriveLimits =
        DriveLimits { range_v: Range { min: -10.0, max: 100.0 }, rest_v: 0.0, slew_v_per_s: 500.0 };

    #[test]
    fn the_board_file_limits_the_drive_as_the_table_does() {
        let facts = BoardFacts { drive_range: Some((0.0, 60.0)), drive_slew: Some(50.0), ..BoardFacts::default() };
        let slew = |volts, facts: &BoardFacts| allowed(volts, LIMITS, facts).map(|limits| limits.slew_v_per_s);
        assert_eq!(slew([5.0, 90.0], &BoardFacts::default()).unwrap(), 500.0);
        assert_eq!(slew([5.0, 55.0], &facts).unwrap(), 50.0);
        let said = slew([5.0, 90.0], &facts).unwrap_err().to_string();
        assert!(said.contains("90 V") && said.contains("drive_range of board.toml, 0 … 60 V"), "{said}");
        let said = slew([5.0, 101.0], &facts).unwrap_err().to_string();
        assert!(said.contains("101 V") && said.contains("the table in use"), "{said}");
    }

    #[test]
    fn a_ramp_of_more_than_a_minute_is_refused() {
        let facts = BoardFacts { drive_slew: Some(0.001), ..BoardFacts::default() };
        assert!(matches!(allowed([5.0, 55.0], LIMITS, &facts), Err(BenchError::SlowRamp { .. })));
        assert!(matches!(
            allowed([5.0, 55.0], DriveLimits { slew_v_per_s: 0.0, ..LIMITS }, &BoardFacts::default()),
            Err(BenchError::SlowRamp { .. })
        ));
    }
}
