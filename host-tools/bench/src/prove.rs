//! A proof: a random drive that no training has seen, and the board's own estimate beside the sensor.
//!
//! ```text
//! rest, a swing over the whole range, rest      what was before is wiped out, as the table's settling asks
//! zero                                          the board calls its displacement 0, the sensor's mean there is taken off
//! random                                        e = estimate − (sensor − zero), at every tick
//! ```

use crate::error::BenchError;
use crate::loan::{self, beside};
use crate::log::LogFile;
use crate::verdict::{ENOUGH_PERCENT, Instant, MOST_PERCENT, Shares, Verdict};
use crate::watch::{Complaint, Watch};
use crate::wiring::{Wiring, WiringError, require_model};
use ::calibration::drive::trained_on;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::play::{Play, Played, play};
use device_link::{table, told};
use estimator_core::{AdcCode, Admitted, DriveLimits, Range, record};
use excitation::{Drive, Request};
use log_survey::stroke;
use protocol::{Mode, Sample};
use std::path::{Path, PathBuf};
use validation::Figures;

/// Columns of the log: the estimate as the board gives it, told at the zero; and its ±, where it has one.
const HEADING: &str = "time_s,voltage_V,displacement_um,estimate_um";
const HALF_WIDTH: &str = ",half_width_um";
/// Time over which the sensor's mean is its zero, s.
const ZERO_S: f64 = 0.05;
/// Fewest samples that prove something.
const FEWEST: usize = 1_000;
/// How long it rests beyond what the table asks before it is zeroed, s.
const REST_S: f64 = 0.5;

/// What is to be proven, and with what.
pub struct Proof<'a> {
    /// What the board's converters and wires stand for.
    pub wiring: &'a Wiring,
    /// Lowest and highest voltage, V; without it all that both the table's drive and the board allow.
    pub range: Option<(f64, f64)>,
    /// Highest frequency, Hz.
    pub up_to_hz: f64,
    /// Length of the random voltage with its way there and back, s.
    pub duration_s: f64,
    /// Seed of the random voltage.
    pub seed: u64,
    /// The mean absolute error that passes, % of the stroke, where another than
    /// [`MOST_PERCENT`](crate::verdict::MOST_PERCENT) does; it must be said where the table has no interval.
    pub max_percent: Option<f64>,
    /// Where the log goes; there is none yet.
    pub log: &'a Path,
    /// The wish to end.
    pub interrupt: &'a Interrupt,
}

/// What came of it.
#[derive(Debug)]
pub struct Proven {
    /// Errors of the estimate since the zero.
    pub figures: Figures,
    /// On how many of the ticks the estimate was what it says it is.
    pub shares: Shares,
    /// Whether that is good enough.
    pub verdict: Verdict,
    /// The voltages that the table was learnt on, V.
    pub learnt: Range,
    /// The table's own mean absolute error on what was held out, µm, where anything was.
    pub held_out_um: Option<f64>,
    /// The checksum of the table, which the device goes on with.
    pub table: u32,
    /// Where voltage, sensor and estimate since the zero are written.
    pub log: PathBuf,
    /// Whether the voltage is at rest; else what hinders.
    pub home: Result<(), BenchError>,
}

/// Drives the device by the table in use and compares. However it ends, the voltage goes to rest.
///
/// # Errors
/// The table in use is no model, does not drive, drives by other converters, or states nothing to judge by; there is no
/// such drive; there is a log already; the sensor is not there or saturated; the device is stopped or lost.
pub fn prove(client: &mut Client, proof: &Proof<'_>, progress: &mut dyn FnMut(usize)) -> Result<Proven, BenchError> {
    let Plan { table, request, limits, lead_in, random } = plan(client, proof)?;
    let measured =
        drive(client, proof, (&table, request.span_v()), &lead_in, &random, progress).and_then(Measured::sound);
    let home = loan::rest(client, table.adc, limits);
    let Measured { instants, .. } = match measured {
        Ok(measured) => measured,
        Err(error) => return Err(beside(error, home)),
    };
    let figures = figures(&instants);
    let shares = Shares::of(&instants, table.interval.is_some());
    let verdict = Verdict::of(&figures, &shares, proof.max_percent);
    let held_out_um = table.provenance.validation_mae_um.map(f64::from);
    let checksum = record::checksum(&table::to_record(&table)).unwrap_or(0);
    Ok(Proven {
        figures,
        shares,
        verdict,
        learnt: trained_on(&table),
        held_out_um,
        table: checksum,
        log: proof.log.to_owned(),
        home,
    })
}

/// What [`prove`] would do with a device, in sentences; nothing is driven, and the device is changed in nothing.
///
/// # Errors
/// What `prove` refuses before it drives.
pub fn foresee(client: &mut Client, proof: &Proof<'_>) -> Result<Vec<String>, BenchError> {
    let Plan { table, request, lead_in, random, .. } = plan(client, proof)?;
    let Request { min_v, max_v, rest_v, slew_v_per_s, tick_s, seed, up_to_hz, .. } = request;
    // As they were typed: a limit's other digits are those of an f32 in an f64.
    let [min_v, max_v, rest_v, slew_v_per_s] = [min_v, max_v, rest_v, slew_v_per_s].map(|number| number as f32);
    let [before_s, random_s] = [lead_in.len(), random.len()].map(|ticks| ticks as f64 * tick_s);
    let holds = match table.interval {
        Some(_) => format!(", and the table's ± holds the sensor for {ENOUGH_PERCENT} % of the time"),
        None => String::new(),
    };
    Ok(vec![
        format!(
            "for {before_s:.1} s a swing from rest at {rest_v} V over {min_v} … {max_v} V, at {} V/s at most, and a rest",
            slew_v_per_s
        ),
        "there a zero: the board forgets the one that it was told before".to_owned(),
        format!(
            "for {random_s:.1} s a random voltage within {min_v} … {max_v} V and up to {up_to_hz} Hz, by seed {seed}; then to rest"
        ),
        format!("{}: voltage, sensor and estimate since the zero", proof.log.display()),
        format!(
            "PASS where the mean absolute error is at most {} % of the stroke{holds}",
            proof.max_percent.unwrap_or(MOST_PERCENT)
        ),
    ])
}

/// A proof that can be.
struct Plan {
    table: Admitted,
    request: Request,
    limits: DriveLimits,
    /// The voltages before the zero, from rest to rest.
    lead_in: Vec<f32>,
    /// The random voltages after the zero, V.
    random: Vec<f32>,
}

/// Plans a proof by the table in use.
fn plan(client: &mut Client, proof: &Proof<'_>) -> Result<Plan, BenchError> {
    let table = table::running(client)?;
    require_model(&table)?;
    if table.interval.is_none() && proof.max_percent.is_none() {
        return Err(BenchError::NothingStated);
    }
    if proof.log.exists() {
        return Err(BenchError::Occupied { path: proof.log.to_owned() });
    }
    let (request, limits) = request(&table, proof)?;
    let segment = Drive::random(&request)?;
    let earliest_s = table.interval.map_or(0.0, |interval| f64::from(interval.earliest_s));
    let (lead_in, random) = segment.volts.split_at(segment.lead_in);
    let mut lead_in = lead_in.to_vec();
    let waits = ((earliest_s + REST_S) / request.tick_s) as usize;
    lead_in.extend(std::iter::repeat_n(request.rest_v as f32, waits));
    let random = random.to_vec();
    Ok(Plan { table, request, limits, lead_in, random })
}

/// The drive, and the limits of the table's own.
fn request(table: &Admitted, proof: &Proof<'_>) -> Result<(Request, DriveLimits), BenchError> {
    let drive = table.drive.ok_or(BenchError::NotDriving)?;
    if table.adc != proof.wiring.adc() {
        return Err(BenchError::OtherConverters { what: "calibration of the ADC" });
    }
    let of_board = proof.wiring.drive();
    if (drive.gain_codes_per_v, drive.offset_code) != (of_board.gain_codes_per_v, of_board.offset_code) {
        return Err(BenchError::OtherConverters { what: "calibration of the DAC" });
    }
    let (limits, board) = (drive.limits, of_board.limits);
    // What both allow: a proof asks no more of either.
    let allowed = limits.range_v.intersection(board.range_v);
    let (min_v, max_v) = proof.range.unwrap_or((allowed.min.into(), allowed.max.into()));
    if !(allowed.contains(min_v as f32) && allowed.contains(max_v as f32)) {
        return Err(WiringError::BeyondRange { min_v, max_v, allowed }.into());
    }
    let request = proof.wiring.request(Some((min_v, max_v)), proof.up_to_hz, proof.duration_s, proof.seed)?;
    let slew_v_per_s = limits.slew_v_per_s.min(board.slew_v_per_s).into();
    Ok((Request { rest_v: limits.rest_v.into(), slew_v_per_s, ..request }, limits))
}

/// What was measured since the zero, µm, at each sample's tick.
struct Measured {
    instants: Vec<Instant>,
    complaint: Option<Complaint>,
    /// Where it was written, where anything was.
    log: Option<PathBuf>,
}

impl Measured {
    /// What is wrong with the sensor says why there is next to nothing, too.
    fn sound(self) -> Result<Self, BenchError> {
        match self.complaint {
            Some(complaint) => Err(BenchError::Sensor { complaint, log: self.log }),
            None if self.instants.len() < FEWEST => Err(BenchError::Nothing(self.instants.len())),
            None => Ok(self),
        }
    }
}

fn drive(
    client: &mut Client,
    proof: &Proof<'_>,
    (table, span_v): (&Admitted, f64),
    lead_in: &[f32],
    random: &[f32],
    progress: &mut dyn FnMut(usize),
) -> Result<Measured, BenchError> {
    let (wiring, interrupt) = (proof.wiring, proof.interrupt);
    let mut watch = Watch::new(wiring, span_v);
    let mut complaint = None;
    let volts = |sample: &Sample| wiring.adc().voltage::<f64>(AdcCode(sample.code));
    let mut before: Vec<(usize, f64)> = Vec::with_capacity(lead_in.len());
    let of = |references, goes_on, ticks| Play { mode: Mode::Excite, goes_on, references, hold: true, ticks };
    let led_in = play(client, &of(lead_in, None, lead_in.len()), interrupt, &mut |of| {
        progress(of.tick);
        before.push((of.tick, wiring.sensor.um(&of.sample).unwrap_or(f64::NAN)));
        complaint = watch.complaint(&of.sample, volts(&of.sample));
        complaint.is_none()
    })?;
    stopped(&led_in)?;
    let heading = HEADING.to_owned() + table.interval.map_or("", |_| HALF_WIDTH);
    let mut log = LogFile::create(proof.log, &heading, table.sample_period())?.with_rows_alone();
    let mut instants: Vec<Instant> = Vec::new();
    if complaint.is_none() {
        told::zero(client, 0.0)?;
        let zero_ticks = (ZERO_S / table.sample_period::<f64>()).round() as usize;
        let last: Vec<f64> =
            before.iter().filter(|(tick, _)| tick + zero_ticks >= led_in.ticks).map(|(_, um)| *um).collect();
        let zero = last.iter().sum::<f64>() / last.len().max(1) as f64;
        let (mut last, mut began, mut failed) = (None, None, None);
        let played = play(client, &of(random, Some(led_in.held), random.len()), interrupt, &mut |of| {
            let sample = &of.sample;
            complaint = watch.complaint(sample, volts(sample));
            let um = wiring.sensor.um(sample).unwrap_or(f64::NAN) - zero;
            if let Some(before) = last.replace(*sample) {
                let (estimate, half) = (f64::from(of.estimate(&before)), before.half_width.map(f64::from));
                let status = of.status(&before);
                let voltage_v = volts(sample);
                instants.push(Instant { estimate_um: estimate, sensor_um: um, voltage_v, half_width_um: half, status });
                let mut row = vec![voltage_v, um, estimate];
                // A table that has an interval has it from the zero on, but where the voltage is beyond its range.
                row.extend(table.interval.map(|_| half.unwrap_or(f64::NAN)));
                // The first row is at 0 s.
                let began = *began.get_or_insert(of.tick);
                failed = log.row(of.tick - began, &row).err();
            }
            progress(lead_in.len() + of.tick);
            complaint.is_none() && failed.is_none()
        })?;
        stopped(&played)?;
        if let Some(error) = failed {
            return Err(error);
        }
    }
    let (log, rows) = log.end();
    Ok(Measured { instants, complaint, log: (rows > 0).then_some(log) })
}

/// Errors since the zero.
fn figures(instants: &[Instant]) -> Figures {
    let all = |of: fn(&Instant) -> f64| instants.iter().map(of).collect::<Vec<_>>();
    let (sensor, voltage) = (all(|at| at.sensor_um), all(|at| at.voltage_v));
    // It begins at rest.
    let rest_v = voltage.first().copied().unwrap_or(0.0);
    Figures::of(&all(|at| at.estimate_um), &sensor, stroke(&voltage, &sensor, rest_v))
}

fn stopped(played: &Played) -> Result<(), BenchError> {
    match played.stopped {
        faults if faults.is_empty() => Ok(()),
        faults => Err(BenchError::Stopped { ticks: played.ticks, faults }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Status;

    #[test]
    fn one_spike_of_the_sensor_makes_no_proof_pass() {
        let instant = |row: usize, spike_um: f64| {
            let course = f64::sin(row as f64 * 0.01);
            Instant {
                estimate_um: 5.0 * course + 0.5,
                sensor_um: 5.0 * course + if row == 3_000 { spike_um } else { 0.0 },
                voltage_v: 50.0 * course,
                half_width_um: None,
                status: Status::empty(),
            }
        };
        let of = |spike_um: f64| {
            let instants: Vec<Instant> = (0..6_000).map(|row| instant(row, spike_um)).collect();
            let figures = figures(&instants);
            (figures.mae_percent, Verdict::of(&figures, &Shares::of(&instants, false), None).passed)
        };
        let ((sound, passes), (spiky, passes_too)) = (of(0.0), of(90.0));
        assert!((spiky / sound - 1.0).abs() < 0.05 && !passes && !passes_too, "{spiky} %, not {sound} %");
    }
}
