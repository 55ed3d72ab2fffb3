//! A proof: a random drive that no training has seen, and the board's own estimate beside the sensor.
//!
//! ```text
//! rest, a swing over the whole range, rest      what was before is wiped out, as the table's settling asks
//! zero                                          the board calls its displacement 0, the sensor's mean there is taken off
//! random                                        e = estimate − (sensor − zero), at every tick
//! ```

use crate::error::BenchError;
use crate::loan;
use crate::log::LogFile;
use crate::watch::{Complaint, Watch};
use crate::wiring::Wiring;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::play::{Play, Played, play};
use device_link::table;
use estimator_core::{AdcCode, Admitted};
use excitation::{Drive, Request};
use protocol::{Mode, Sample};
use std::path::{Path, PathBuf};
use validation::{Coverage, Figures};

/// Columns of the log: the estimate as the board gives it, told at the zero; and its ±, where it has one.
const HEADING: &str = "time_s,voltage_V,displacement_um,estimate_um";
const HALF_WIDTH: &str = ",half_width_um";
/// Ticks whose mean is the sensor's zero: 50 ms.
const ZERO_TICKS: usize = 100;
/// Fewest ticks that prove something.
const FEWEST: usize = 1_000;
/// How long it rests beyond what the table asks before it is zeroed, s.
const REST_S: f64 = 0.5;

/// What is to be proven, and with what.
pub struct Proof<'a> {
    /// The board.
    pub wiring: &'a Wiring,
    /// Highest frequency, Hz.
    pub up_to_hz: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Draws the voltage.
    pub seed: u64,
    /// Where the log goes.
    pub log: &'a Path,
    /// The wish to end.
    pub interrupt: &'a Interrupt,
}

/// What came of it.
#[derive(Debug)]
pub struct Proven {
    /// Errors of the estimate since the zero.
    pub figures: Figures,
    /// How the table's interval did; `None` where the table has none.
    pub coverage: Option<Coverage>,
    /// The log.
    pub log: PathBuf,
    /// What was complained of, and ended it before its time.
    pub complaint: Option<Complaint>,
}

/// Drives the device by the table in use and compares. However it ends, the voltage goes to rest.
///
/// # Errors
/// The table in use does not drive, or by other converters; there is no such drive; the device is stopped or lost.
pub fn prove(client: &mut Client, proof: &Proof<'_>, progress: &mut dyn FnMut(usize)) -> Result<Proven, BenchError> {
    let table = table::running(client)?;
    let request = request(&table, proof)?;
    let segment = Drive::random(&request)?;
    let earliest_s = table.interval.map_or(0.0, |interval| f64::from(interval.earliest_s));
    let (lead_in, rest) = segment.volts.split_at(segment.lead_in);
    let mut lead_in = lead_in.to_vec();
    let waits = ((earliest_s + REST_S) / request.tick_s) as usize;
    lead_in.extend(std::iter::repeat_n(request.rest_v as f32, waits));
    let measured = drive(client, proof, &table, &lead_in, rest, progress);
    let home = loan::rest(client, proof.wiring);
    let measured = measured?;
    home?;
    let Measured { estimates, sensor, half_widths, complaint, log } = measured;
    if estimates.len() < FEWEST {
        return Err(BenchError::Nothing(estimates.len()));
    }
    let figures = Figures::of(&estimates, &sensor);
    let errors = estimates.iter().zip(&sensor).map(|(estimate, sensor)| estimate - sensor);
    let beside: Vec<(f64, f64)> = errors.zip(&half_widths).filter_map(|(e, half)| Some((e, (*half)?))).collect();
    Ok(Proven { figures, coverage: Coverage::of(&beside), log, complaint })
}

fn request(table: &Admitted, proof: &Proof<'_>) -> Result<Request, BenchError> {
    let drive = table.drive.ok_or(BenchError::NotDriving)?;
    if table.adc != proof.wiring.adc() {
        return Err(BenchError::OtherConverters { what: "calibration of the ADC" });
    }
    let of_board = proof.wiring.drive();
    if (drive.gain_codes_per_v, drive.offset_code) != (of_board.gain_codes_per_v, of_board.offset_code) {
        return Err(BenchError::OtherConverters { what: "calibration of the DAC" });
    }
    let range = drive.limits.range_v;
    let range = (f64::from(range.min), f64::from(range.max));
    let request = proof.wiring.request(Some(range), proof.up_to_hz, proof.duration_s, proof.seed)?;
    Ok(Request { rest_v: drive.limits.rest_v.into(), slew_v_per_s: drive.limits.slew_v_per_s.into(), ..request })
}

/// What was measured since the zero, µm, at each tick.
struct Measured {
    estimates: Vec<f64>,
    sensor: Vec<f64>,
    half_widths: Vec<Option<f64>>,
    complaint: Option<Complaint>,
    log: PathBuf,
}

fn drive(
    client: &mut Client,
    proof: &Proof<'_>,
    table: &Admitted,
    lead_in: &[f32],
    random: &[f32],
    progress: &mut dyn FnMut(usize),
) -> Result<Measured, BenchError> {
    let (wiring, interrupt) = (proof.wiring, proof.interrupt);
    let mut watch = Watch::new(wiring, table.drive.map_or(0.0, |drive| drive.limits.range_v.span().into()));
    let mut complaint = None;
    let volts = |sample: &Sample| wiring.adc().voltage::<f64>(AdcCode(sample.code));
    let mut before: Vec<f64> = Vec::with_capacity(lead_in.len());
    let of = |references, goes_on, ticks| Play { mode: Mode::Excite, goes_on, references, hold: true, ticks };
    let led_in = play(client, &of(lead_in, false, lead_in.len()), interrupt, &mut |sample| {
        progress(before.len());
        before.push(wiring.sensor.um(sample).unwrap_or(f64::NAN));
        complaint = watch.complaint(sample, volts(sample));
        complaint.is_none()
    })?;
    stopped(&led_in)?;
    let heading = HEADING.to_owned() + table.interval.map_or("", |_| HALF_WIDTH);
    let mut log = LogFile::create(proof.log, &heading, table.sample_period())?;
    let (mut estimates, mut sensor, mut half_widths) = (Vec::new(), Vec::new(), Vec::new());
    if complaint.is_none() {
        client.set_zero(0.0)?;
        let last = &before[before.len().saturating_sub(ZERO_TICKS)..];
        let zero = last.iter().sum::<f64>() / last.len().max(1) as f64;
        let (mut next, mut failed): (Option<(f64, Option<f64>)>, _) = (None, None);
        let played = play(client, &of(random, true, random.len()), interrupt, &mut |sample| {
            complaint = watch.complaint(sample, volts(sample));
            let um = wiring.sensor.um(sample).unwrap_or(f64::NAN) - zero;
            // A sample's estimate is of the next tick.
            let of_next = (f64::from(sample.displacement), sample.half_width.map(f64::from));
            if let Some((estimate, half)) = next.replace(of_next) {
                estimates.push(estimate);
                sensor.push(um);
                half_widths.push(half);
                let mut row = vec![volts(sample), um, estimate];
                // A table that has an interval has it from the zero on.
                row.extend(table.interval.map(|_| half.unwrap_or(f64::NAN)));
                failed = log.row(&row).err();
            }
            progress(lead_in.len() + estimates.len());
            complaint.is_none() && failed.is_none()
        })?;
        stopped(&played)?;
        if let Some(error) = failed {
            return Err(error);
        }
    }
    Ok(Measured { estimates, sensor, half_widths, complaint, log: log.end()?.0 })
}

fn stopped(played: &Played) -> Result<(), BenchError> {
    match played.stopped {
        faults if faults.is_empty() => Ok(()),
        faults => Err(BenchError::Stopped { ticks: played.ticks, faults }),
    }
}
