//! A trajectory that a device has followed: what was wanted beside what it estimated at the same instant.
//!
//! The reference of tick k moves the DAC at tick k + 1 and the displacement a tick after that, later by
//! the model's delay.

use crate::waveform::{WaveformError, begins_in_reach};
use device_link::streamed::{Streamed, of_tick_before};
use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Estimator, Range, Status};
use feedforward::{Plan, Trajectory, approach, near, plan, reach};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};

/// An estimate this near to what was wanted has met it, as a fraction of the table's span of displacements.
const MET: f64 = 1e-2;

/// Ticks in which the way over the drive's range is looked at, at most.
const LONGEST_RANGE: f64 = 1e6;

/// An instant at which something was wanted, and what was estimated then.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Row {
    /// Since the first reference, s.
    pub seconds: f64,
    /// Read by the ADC, V.
    pub voltage: f64,
    /// The board's estimate, µm.
    pub estimated: f64,
    /// What was asked for, µm.
    pub wanted: f64,
    /// What the DAC stood for, V at the amplifier.
    pub driven: f64,
}

/// A trajectory that no limit is in the way of, and the way there from rest.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Foreseen {
    /// Both, by the device's own model.
    #[serde(skip)]
    pub plan: Plan,
    /// Ticks of the way there.
    #[serde(rename = "approach_ticks")]
    pub begins: usize,
    /// From which tick on errors count: a trajectory may begin at a speed that the displacement has only
    /// a moment later.
    #[serde(skip)]
    counts: usize,
    /// Ticks of that moment, at the trajectory's beginning.
    #[serde(rename = "uncounted_ticks")]
    pub uncounted: usize,
    /// How far the model is off the trajectory there, µm.
    pub uncounted_off_um: f64,
    /// How far the model is off the trajectory, µm.
    pub off_um: f64,
    /// On how many ticks of the trajectory a limit is in the way; none where that leads nowhere off.
    #[serde(rename = "limited_ticks")]
    pub limited: usize,
}

impl Foreseen {
    /// What comes of a trajectory on the device that has this table.
    ///
    /// # Errors
    /// The table does not drive; or a limit keeps the model off by `allowed_um`, without it by what counts as off.
    pub fn of(table: &Admitted, trajectory: &Trajectory, allowed_um: Option<f64>) -> Result<Self, WaveformError> {
        let DriveCalibration { limits, .. } = table.drive.ok_or(WaveformError::NoDrive)?;
        if allowed_um.is_none() {
            begins_in_reach(table, &limits, trajectory.at(0.0) as f32)?;
        }
        let mut whole = approach(table, &limits, trajectory)?;
        let begins = whole.len();
        whole.extend(&trajectory.0);
        let plan = plan(table, &limits, &Trajectory(whole))?;
        // A tick's voltage is for what is wanted so many ticks later.
        let ahead = (1.0 + table.parameters.delay_ticks()).ceil() as usize;
        let (near, before) = (near(table), begins.saturating_sub(ahead));
        let of_it = &plan.limited[before..];
        let limited = of_it.iter().filter(|&&limited| limited).count();
        // A moment is no longer than the voltage takes for its range, and no speed is come to that it cannot have.
        let (ticks_of_range, fastest) = fastest(table, &limits);
        let too_fast = trajectory.0.windows(2).position(|pair| (pair[1] - pair[0]).abs() > fastest);
        let moment = trajectory.0.len().min(ticks_of_range).min(too_fast.unwrap_or(usize::MAX));
        let uncounted = of_it[..moment].iter().rposition(|&limited| limited).map_or(0, |last| last + 1);
        let (counts, end) = (begins + uncounted, plan.wanted.len());
        let uncounted_off_um = plan.off(begins..counts);
        let off_um = plan.round_trip(counts).map_or(0.0, |errors| errors.max_um);
        let in_the_way = of_it[uncounted.min(of_it.len())..].iter().position(|&limited| limited);
        let short_um = in_the_way.map(|at| plan.off((before + uncounted + at).max(counts)..end));
        if let Some(off_um) = short_um.filter(|short_um| *short_um >= allowed_um.unwrap_or(near)) {
            let (ticks, reach_um) = (trajectory.0.len(), reach(table, &limits));
            return Err(WaveformError::OutOfReach { limited, ticks, off_um, reach_um });
        }
        let limited = if off_um < near { 0 } else { limited };
        Ok(Self { plan, begins, counts, uncounted, uncounted_off_um, off_um, limited })
    }

    /// What the device said of it in these samples.
    pub fn reached(&self, samples: &[Streamed]) -> Reached {
        let mut status = samples.iter().fold(Status::empty(), |all, of| all | of.sample.status);
        let own = || samples.iter().filter(|of| of.tick >= self.begins);
        let limited = own().filter(|of| of.sample.status.contains(Status::OUT_OF_REACH)).count();
        status.set(Status::OUT_OF_REACH, limited > 0 && self.limited > 0);
        Reached { status, limited, ticks: own().count() }
    }

    /// What of it does not count, in words.
    fn aside(&self) -> String {
        match self.uncounted {
            0 => String::new(),
            ticks => format!(
                " without its first {ticks} ticks (it begins at a speed, and there the model is up to {:.4} µm off),",
                self.uncounted_off_um
            ),
        }
    }

    /// How it was met by as many ticks, in words.
    pub fn told(&self, ticks: usize, met: Option<Met>) -> String {
        let aside = self.aside();
        match met {
            Some(Met { after_s, mae_um, max_um }) => format!(
                "{ticks} ticks, the first {} of them from rest to where the trajectory begins; the estimate was {mae_um:.4} µm off the trajectory \
                 on average,{aside} {max_um:.4} µm at most, and first met it after {after_s:.3} s",
                self.begins
            ),
            None => format!(
                "FAILED: {ticks} ticks, and the estimate never came near what was wanted: does the DAC drive this amplifier, and the ADC read it?"
            ),
        }
    }
}

/// Ticks that the voltage takes for the drive's range at its slew rate, and the fastest that the displacement goes on
/// the way up and back, µm a tick.
fn fastest(table: &Admitted, limits: &DriveLimits) -> (usize, f64) {
    let Range { min, max } = limits.range_v;
    let ticks = (f64::from(max - min) / (f64::from(limits.slew_v_per_s) * table.sample_period::<f64>())).ceil();
    let ticks = ticks.clamp(1.0, LONGEST_RANGE) as usize;
    let mut model = Estimator::<f64>::new(table).of_held_voltage();
    let mut at = |volts: f64| model.tick_volts(volts).displacement;
    let mut last = at(min.into());
    let up = (0..=ticks).map(|k| f64::from(min) + f64::from(max - min) * k as f64 / ticks as f64);
    let fastest = up.clone().chain(up.rev()).fold(0.0, |most: f64, volts| {
        let before = std::mem::replace(&mut last, at(volts));
        most.max((last - before).abs())
    });
    (ticks, fastest)
}

/// What the device said of a trajectory.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reached {
    /// Of all that it did, but for limits that lead nowhere off or were in the way there.
    pub status: Status,
    /// On how many ticks of the trajectory it was at a limit.
    pub limited: usize,
    /// Ticks of the trajectory, all of them.
    pub ticks: usize,
}

impl Display for Foreseen {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { plan, begins, off_um, limited, .. } = self;
        write!(
            f,
            "{} ticks, the first {begins} of them from rest to where the trajectory begins; the device's model is {off_um:.4} µm off it at \
             most,{} with a limit in the way on {limited} of its ticks; nothing was driven",
            plan.voltage.len(),
            self.aside()
        )
    }
}

/// How well a trajectory was met, the way there left aside.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Met {
    /// When it first was, s since the first reference.
    pub after_s: f64,
    /// Mean of |estimate − wanted| over all of it that counts, µm.
    pub mae_um: f64,
    /// The largest |estimate − wanted| of what counts, µm.
    pub max_um: f64,
}

/// Ticks from a reference to the displacement that it moves.
pub fn late(table: &Admitted) -> f64 {
    2.0 + f64::from(table.parameters.delay_ticks())
}

/// Names of a log's columns.
const HEADING: &str = "time_s,voltage_V,estimated_displacement_um,wanted_um,driven_V";

/// What a device has done of a trajectory so far, of which a log can be written as it comes.
#[derive(Debug)]
pub struct Following<'t> {
    table: &'t Admitted,
    trajectory: &'t Trajectory,
    /// The device's: what is wanted is relative to the model's zero, and so are the estimates of the log.
    bias_um: f64,
    /// What it has sent.
    pub samples: Vec<Streamed>,
    /// The instants of those that have one before them.
    pub rows: Vec<Row>,
}

impl<'t> Following<'t> {
    /// Nothing yet, of a device whose estimate has this bias, µm.
    pub fn new(table: &'t Admitted, trajectory: &'t Trajectory, bias_um: f32) -> Self {
        Self { table, trajectory, bias_um: bias_um.into(), samples: Vec::new(), rows: Vec::new() }
    }

    /// Takes the next sample, and writes its row, where there is a log; the heading is above the first one.
    ///
    /// # Errors
    /// The log cannot be written.
    pub fn take(&mut self, now: &Streamed, log: Option<&mut impl Write>) -> io::Result<()> {
        let before = self.samples.last().copied();
        self.samples.push(*now);
        let Some(before) = before else { return Ok(()) };
        let row = self.row(&before, now);
        // A line is handed over at once: a program that is killed leaves whole ones.
        let line = if self.rows.is_empty() { format!("{HEADING}\n{row}\n") } else { format!("{row}\n") };
        self.rows.push(row);
        log.map_or(Ok(()), |log| log.write_all(line.as_bytes()))
    }

    fn row(&self, before: &Streamed, now: &Streamed) -> Row {
        let Self { table, trajectory, bias_um, .. } = self;
        // The code of a sample is put out a tick later.
        let driven =
            table.drive.map_or([0.0; 2], |drive| [before, now].map(|of| drive.voltage::<f64>(DacCode(of.sample.dac))));
        Row {
            seconds: now.tick as f64 * table.sample_period::<f64>(),
            voltage: table.adc.voltage(AdcCode(now.sample.code)),
            estimated: f64::from(now.estimate(&before.sample)) - bias_um,
            wanted: trajectory.at(now.tick as f64 - late(table)),
            driven: of_tick_before(driven[0], driven[1], now.every),
        }
    }
}

impl Display for Row {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { seconds, voltage, estimated, wanted, driven } = self;
        write!(f, "{seconds:.6},{voltage:.6},{estimated:.6},{wanted:.6},{driven:.6}")
    }
}

impl Met {
    /// How the estimate met what was foreseen; `None` where it never did.
    pub fn of(table: &Admitted, rows: &[Row], foreseen: &Foreseen) -> Option<Self> {
        let begin_s = (foreseen.counts as f64 + late(table) - 0.5) * table.sample_period::<f64>();
        let met = &rows[rows.partition_point(|row| row.seconds < begin_s)..];
        let near = MET * f64::from(table.displacement_limits_um.span());
        let error = |row: &Row| (row.estimated - row.wanted).abs();
        Some(Self {
            after_s: met.iter().find(|row| error(row) < near)?.seconds,
            mae_um: met.iter().map(error).sum::<f64>() / met.len() as f64,
            max_um: met.iter().map(error).fold(0.0, f64::max),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{GeneralisedPrandtlIshlinskiiParameters, Parameters, Table};
    use std::path::Path;
    use table_files::TableFile;

    /// A table that drives 3.6 V in 90 ms, with a delay in ticks.
    fn delayed(delay_ticks: f32) -> Admitted {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/table/models");
        let (_, table) = TableFile::load(&Path::new(models).join("generalised-prandtl-ishlinskii.toml")).unwrap();
        let Parameters::GeneralisedPrandtlIshlinskii(of) = table.parameters else { panic!("another model") };
        let of = GeneralisedPrandtlIshlinskiiParameters { delay_ticks, ..of };
        let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.0, slew_v_per_s: 40.0 };
        let drive = DriveCalibration { gain_codes_per_v: 1000.0, offset_code: 0.0, limits, setpoint: None };
        let parameters = Parameters::GeneralisedPrandtlIshlinskii(of);
        Table { parameters, drive: Some(drive), ..*table }.admit().unwrap()
    }

    /// Held at 15 µm, then from a tick on by so many µm a tick.
    fn trajectory(from: usize, per_tick: f64, most: f64) -> Trajectory {
        Trajectory((0..600).map(|tick: usize| 15.0 + most.min(per_tick * tick.saturating_sub(from) as f64)).collect())
    }

    #[test]
    fn a_step_is_refused_however_late_the_displacement_is_and_a_speed_is_come_to() {
        for delay_ticks in [0.0, 8.0] {
            let table = delayed(delay_ticks);
            let (_, fastest) = fastest(&table, &table.drive.unwrap().limits);
            for from in [0, 1, 5, 20, 100, 400] {
                // The voltage goes as far within the delay.
                let step =
                    Foreseen::of(&table, &trajectory(from, 5.0 * fastest, 5.0 * fastest), None).map(|of| of.uncounted);
                assert!(matches!(step, Err(WaveformError::OutOfReach { .. })), "{delay_ticks}, {from}: {step:?}");
            }
            let ramp = Foreseen::of(&table, &trajectory(0, 0.5 * fastest, 20.0), None).unwrap();
            let Foreseen { uncounted, uncounted_off_um, off_um, .. } = ramp;
            assert!(off_um < near(&table) && (1..=180).contains(&uncounted), "{uncounted} ticks, then {off_um} µm off");
            assert!(uncounted_off_um >= near(&table), "{uncounted_off_um} µm");
        }
    }
}
