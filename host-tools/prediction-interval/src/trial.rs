//! What a device's table is off on recordings that it was not learnt on, beside what the interval is made of there.

use crate::device::Device;
use crate::lead_in::lead_in;
use crate::told::{Recording, judged};
use estimator_core::{Admitted, IntervalParameters, Range};
use identification::Problem;
use log_survey::reversals::reversals;
use plants::{STEP_S, Waveform};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use recordings::session::Session;

/// Recordings of a device.
const RECORDINGS: usize = 8;
/// Periods of a recording, and its length in s, within.
const PERIODS: f64 = 6.0;
const LENGTH_S: Range<f64> = Range { min: 2.0, max: 20.0 };
/// Ticks that it may have at most, besides what leads to it: all of its length down to ticks of 50 µs.
const MOST: f64 = 400_000.0;
/// Amplitude, of the training's.
const AMPLITUDE: Range<f64> = Range { min: 0.15, max: 1.0 };
/// Frequency, of the training's; drawn evenly in its logarithm.
const FREQUENCY: Range<f64> = Range { min: 0.4, max: 2.5 };
/// Frequency of one recording, of the training's, at which what a lag leaves open is seen.
const FASTER: Range<f64> = Range { min: 2.5, max: 40.0 };
/// A period of that recording has so many ticks at least, unless the training's own has fewer.
const LEAST_TICKS: f64 = 20.0;
/// The device's gain on another day, a standard deviation: that of a ceramic whose strain changes by 0.3 % a kelvin,
/// and which is 2 K warmer or colder.
const GAIN: f64 = 0.006;
/// A step of a staircase is held for so long at least, s: who makes one waits until the actuator has settled.
const LEAST_HOLD_S: f64 = 0.1;
/// Where a board has been running, the actuator has rested for so long, s; drawn evenly in its logarithm.
const RESTED_S: Range<f64> = Range { min: 0.5, max: 5.0 };
/// A reversal is a retreat by so much of the voltage's span.
const LARGE: f64 = 0.25;

/// Ways of a recording to begin, which every waveform has for one device or another.
const RESTS: usize = 4;

/// What follows each telling of a device's recordings, beside the estimates of its table.
pub fn recordings(
    device: &Device,
    table: &Admitted,
    unscaled: &IntervalParameters,
    problem: &Problem,
    seed: u64,
) -> Vec<Recording> {
    let mut draw = ChaCha8Rng::seed_from_u64(seed);
    let shift = draw.random_range(0..RESTS);
    (0..RECORDINGS)
        .flat_map(|number| one((number, (number + shift) % RESTS), device, table, unscaled, problem, &mut draw))
        .collect()
}

fn one(
    (number, rests): (usize, usize),
    device: &Device,
    table: &Admitted,
    unscaled: &IntervalParameters,
    problem: &Problem,
    draw: &mut ChaCha8Rng,
) -> Vec<Recording> {
    let range = problem.training_voltages();
    let voltage = voltage(number, problem, draw);
    let Some(&first) = voltage.first() else { return Vec::new() };
    let mut even = |range: Range<f64>| draw.random_range(range.min..range.max);
    // Half of the recordings are of a board that has been running; it rests where the user's recordings begin, or
    // at an end.
    let begins = || problem.training().next().and_then(|session| session.voltage.first().copied()).unwrap_or(first);
    let rest = match rests {
        2 => Some(begins()),
        3 => Some(if even(range) < range.middle() { range.min } else { range.max }),
        _ => None,
    };
    let (before, from) = rest.map_or_else(Default::default, |rest| {
        lead_in(rest, first, range, log_even(&mut even, RESTED_S), problem.extent().tick)
    });
    let voltage = [before, voltage].concat();
    let past = match number % 2 {
        0 => vec![(voltage[0], 3.0)],
        _ => vec![(even(range), 0.0), (even(range), 0.0), (voltage[0], 0.5)],
    };
    let normal: f64 = StandardNormal.sample(draw);
    let gain = 1.0 + GAIN * normal;
    let truth: Vec<f64> = device.respond(&past, &voltage).iter().map(|y| gain * y).collect();
    let instants = (0..voltage.len() as u32).collect();
    let read = device.read(&truth, draw.random());
    judged(table, unscaled, &Session::new(String::new(), voltage, instants, read, problem.extent().tick), from)
}

/// The voltages of a recording, V a tick.
fn voltage(number: usize, problem: &Problem, draw: &mut ChaCha8Rng) -> Vec<f64> {
    let range = problem.training_voltages();
    let (half, tick_s) = (0.5 * range.span(), problem.extent().tick);
    let mut even = |range: Range<f64>| draw.random_range(range.min..range.max);
    let frequencies: Vec<f64> = problem.training().map(|session| frequency(&session.voltage, tick_s)).collect();
    let which = even(Range { min: 0.0, max: frequencies.len() as f64 }) as usize;
    let trained = frequencies.get(which).copied().unwrap_or(1.0);
    let hertz = match number {
        3 => (log_even(&mut even, FASTER) * trained).min(trained.max(1.0 / (LEAST_TICKS * tick_s))),
        _ => log_even(&mut even, FREQUENCY) * trained,
    };
    let amplitude = half * even(AMPLITUDE);
    let offset = range.middle() + (half - amplitude) * even(Range { min: -1.0, max: 1.0 });
    let duration_s = LENGTH_S.clamp(PERIODS / hertz).min(MOST * tick_s);
    // Every fourth recording is as the training was.
    let waveform = match number {
        0 => Waveform::AmplitudeModulated { amplitude, hertz, swell_hz: hertz / 5.0 },
        1 => Waveform::Staircase { amplitude, steps: 5, hold_s: (0.05 / hertz).max(LEAST_HOLD_S) },
        2 => Waveform::Multisine { amplitude, from_hz: 0.3 * hertz, to_hz: 3.0 * hertz, tones: 8 },
        3 => Waveform::Sine { amplitude, hertz, offset: 0.0 },
        4 => Waveform::MoveAndRest { amplitude, move_s: 0.2 / hertz, rest_s: 0.4 / hertz },
        5 => Waveform::Triangle { amplitude, hertz, offset: 0.0 },
        _ => return again(problem, which),
    };
    // The command is made at the plant's steps.
    let stride = (tick_s / STEP_S).round().max(1.0);
    let command = waveform.command(duration_s / tick_s * stride * STEP_S, draw.random());
    command.iter().step_by(stride as usize).map(|volts| range.clamp(offset + volts)).collect()
}

/// A number of a range, of numbers drawn evenly, that is even in its logarithm.
fn log_even(even: &mut impl FnMut(Range<f64>) -> f64, range: Range<f64>) -> f64 {
    libm::exp(even(Range { min: libm::log(range.min), max: libm::log(range.max) }))
}

/// The voltages of a training session, as far as a recording goes.
fn again(problem: &Problem, which: usize) -> Vec<f64> {
    let ticks = (LENGTH_S.max / problem.extent().tick).min(MOST) as usize;
    problem.training().nth(which).map_or(Vec::new(), |session| session.voltage.iter().copied().take(ticks).collect())
}

/// Frequency of a voltage by its reversals, Hz.
fn frequency(voltage: &[f64], tick_s: f64) -> f64 {
    let span = Range::of_values(voltage.iter().copied()).span();
    let turns = reversals(voltage, LARGE * span).len().max(1) as f64;
    turns / 2.0 / (voltage.len().max(1) as f64 * tick_s)
}
