//! What a device's table is off on recordings that it was not learnt on, beside what the interval is made of there.

use crate::device::Device;
use estimator_core::interval::{Interval, IntervalState};
use estimator_core::{Admitted, Estimator, IntervalParameters, Range};
use identification::Problem;
use identification::reversals::{first_cycle, reversals};
use identification::validate::ZERO_WINDOW_S;
use plants::{STEP_S, Waveform};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range as Ticks;

/// Part of a recording after which the displacement is told; twice, and besides at its start and over its first full cycle. At
/// no even part of it: a periodic voltage would be met where it is fastest, or at a jump.
const TOLD: Range<f64> = Range { min: 0.05, max: 0.8 };
/// Samples of a recording that count, over what follows.
const SAMPLES: usize = 60;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Recordings of a device; those beyond the first have a training log's voltage.
const RECORDINGS: usize = 8;
const WAVEFORMS: usize = 6;
/// Periods of a recording, and its length in s, within.
const PERIODS: f64 = 6.0;
const LENGTH_S: Range<f64> = Range { min: 2.0, max: 20.0 };
/// Ticks that it may have at most.
const MOST: f64 = 40_000.0;
/// Amplitude, of the training's.
const AMPLITUDE: Range<f64> = Range { min: 0.15, max: 1.0 };
/// Frequency, of the training's; drawn evenly in its logarithm.
const FREQUENCY: Range<f64> = Range { min: 0.4, max: 2.5 };
/// The recordings whose voltage jumps, or moves in a part of its period.
const JUMPS: [usize; 2] = [1, 4];
/// The device's gain on another day, a standard deviation.
const GAIN: f64 = 0.01;
/// A reversal is a retreat by so much of the voltage's span.
const LARGE: f64 = 0.25;
/// A log with so many of them has a frequency; one with fewer is a step or a rest.
const OFTEN: usize = 3;

/// Parts of a half-width whose gains are found; which of them is that of the plays that moved.
pub const PARTS: usize = 5;
pub const MOVED: usize = 2;

/// An error, and what the interval has there: µm, of an interval whose gains are 1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample {
    /// Absolute error since the displacement was told.
    pub error: f64,
    /// Memory of the start.
    pub memory: f64,
    /// Misfit, rate, plays that moved, displacement gone, drift.
    pub parts: [f64; PARTS],
}

/// What follows one telling of one recording.
#[derive(Clone, PartialEq, Debug)]
pub struct Recording {
    /// The voltage is a training log's own.
    pub as_trained: bool,
    /// Half-width that the device's own logs account for, µm.
    pub own_um: f64,
    /// In the order of time.
    pub samples: Vec<Sample>,
}

/// Recordings of a device beside the estimates of its table; `own_um` is what its logs have of the half-width, µm.
pub fn recordings(
    device: &Device,
    table: &Admitted,
    unscaled: &IntervalParameters,
    problem: &Problem,
    own_um: f64,
    seed: u64,
) -> Vec<Recording> {
    let mut draw = ChaCha8Rng::seed_from_u64(seed);
    let of = |number| {
        let recording = |samples| Recording { as_trained: number >= WAVEFORMS, own_um, samples };
        one(number, device, table, unscaled, problem, &mut draw).into_iter().map(recording).collect::<Vec<_>>()
    };
    (0..RECORDINGS).flat_map(of).collect()
}

fn one(
    number: usize,
    device: &Device,
    table: &Admitted,
    unscaled: &IntervalParameters,
    problem: &Problem,
    draw: &mut ChaCha8Rng,
) -> Vec<Vec<Sample>> {
    let range = problem.training_voltages();
    let voltage = voltage(number, problem, draw);
    let Some(&first) = voltage.first() else { return Vec::new() };
    let mut even = |range: Range<f64>| draw.random_range(range.min..range.max);
    let past = match number % 2 {
        0 => vec![(first, 3.0)],
        _ => vec![(even(range), 0.0), (even(range), 0.0), (first, 0.5)],
    };
    let normal: f64 = StandardNormal.sample(draw);
    let gain = 1.0 + GAIN * normal;
    let truth: Vec<f64> = device.respond(&past, &voltage).iter().map(|y| gain * y).collect();
    judged(table, unscaled, &voltage, &truth, draw)
}

/// The voltages of a recording, V a tick.
fn voltage(number: usize, problem: &Problem, draw: &mut ChaCha8Rng) -> Vec<f64> {
    let range = problem.training_voltages();
    let (half, tick_s) = (0.5 * range.span(), problem.extent().tick);
    let mut even = |range: Range<f64>| draw.random_range(range.min..range.max);
    let log_even = |even: &mut dyn FnMut(Range<f64>) -> f64, range: Range<f64>| {
        libm::exp(even(Range { min: libm::log(range.min), max: libm::log(range.max) }))
    };
    let frequencies: Vec<f64> = problem.training().map(|session| frequency(&session.voltage, tick_s)).collect();
    let which = even(Range { min: 0.0, max: frequencies.len() as f64 }) as usize;
    // A jump is as fast as a voltage can be; what jumps is as slow as the slowest of the training.
    let slowest = slowest(problem, &frequencies);
    let of_training = if JUMPS.contains(&number) { slowest } else { frequencies.get(which).copied().unwrap_or(1.0) };
    let hertz = of_training * log_even(&mut even, FREQUENCY);
    let amplitude = half * even(AMPLITUDE);
    let offset = range.middle() + (half - amplitude) * even(Range { min: -1.0, max: 1.0 });
    let duration_s = LENGTH_S.clamp(PERIODS / hertz).min(MOST * tick_s);
    // Those behind the waveforms are as the training was.
    let waveform = match number {
        0 => Waveform::AmplitudeModulated { amplitude, hertz, swell_hz: hertz / 5.0 },
        1 => Waveform::Staircase { amplitude, steps: 5, hold_s: 0.05 / hertz },
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

/// The voltages of a training session, as far as a recording goes.
fn again(problem: &Problem, which: usize) -> Vec<f64> {
    let ticks = (LENGTH_S.max / problem.extent().tick).min(MOST) as usize;
    problem.training().nth(which).map_or(Vec::new(), |session| session.voltage.iter().copied().take(ticks).collect())
}

/// The least of the training logs' frequencies, Hz: of those that turn often enough to have one, where there are any.
fn slowest(problem: &Problem, frequencies: &[f64]) -> f64 {
    let periodic = problem.training().map(|session| turns(&session.voltage) >= OFTEN);
    let least = |of: &mut dyn Iterator<Item = f64>| of.fold(f64::INFINITY, f64::min);
    let of_periodic = least(&mut frequencies.iter().zip(periodic).filter(|(_, is)| *is).map(|(hertz, _)| *hertz));
    if of_periodic.is_finite() { of_periodic } else { least(&mut frequencies.iter().copied()) }
}

/// Large reversals of a voltage.
fn turns(voltage: &[f64]) -> usize {
    let span = Range::of_values(voltage.iter().copied()).span();
    reversals(voltage, LARGE * span).len()
}

/// Frequency of a voltage by its reversals, Hz.
fn frequency(voltage: &[f64], tick_s: f64) -> f64 {
    turns(voltage).max(1) as f64 / 2.0 / (voltage.len().max(1) as f64 * tick_s)
}

/// The estimates beside the truth, after each telling.
fn judged(
    table: &Admitted,
    unscaled: &IntervalParameters,
    voltage: &[f64],
    truth: &[f64],
    draw: &mut ChaCha8Rng,
) -> Vec<Vec<Sample>> {
    let interval = Interval::<f64>::build(unscaled, table.voltage_range_v.of(), table.sample_period());
    let mut estimator = Estimator::<f64>::new(table);
    let ticks = voltage.len().saturating_sub(1);
    let zero = f64::from(table.voltage_zero_v);
    let tellings = tellings(&voltage[..ticks], table.sample_period(), draw);
    let mut begun = None;
    let mut errors: Vec<f64> = Vec::with_capacity(ticks);
    let mut told: Vec<Since> = Vec::new();
    for tick in 0..ticks {
        let estimate = estimator.tick_volts(voltage[tick] + zero).displacement;
        let off = estimate - truth[tick + 1];
        errors.push(off);
        let state = begun.get_or_insert_with(|| interval.begin(voltage[tick], estimate));
        interval.step(state, voltage[tick], estimate);
        for since in &mut told {
            interval.step(&mut since.state, voltage[tick], estimate);
            if tick >= since.next()
                && let Some(parts) = interval.parts(&since.state)
            {
                let error = (off - since.off).abs();
                let of = [parts.misfit, parts.rate, parts.moved, parts.gain, parts.drift];
                since.samples.push(Sample { error, memory: parts.memory, parts: of });
            }
        }
        for over in tellings.iter().filter(|over| over.end == tick + 1) {
            let mut state = *state;
            interval.tell_at_rest(&mut state);
            let off = errors[over.clone()].iter().sum::<f64>() / over.len() as f64;
            let every = ((ticks - tick) as f64 / SAMPLES as f64).max(1.0);
            told.push(Since { off, state, from: tick + 1, every, samples: Vec::new() });
        }
    }
    told.into_iter().map(|since| since.samples).filter(|samples| !samples.is_empty()).collect()
}

/// The ticks over which each displacement is told: the first, some time, and a full cycle where the voltage makes one.
fn tellings(voltage: &[f64], tick_s: f64, draw: &mut ChaCha8Rng) -> Vec<Ticks<usize>> {
    let window = ((ZERO_WINDOW_S / tick_s) as usize).max(1);
    let mut at = || (draw.random_range(TOLD.min..TOLD.max) * voltage.len() as f64) as usize + 1;
    let zeros = [at(), at()].map(|end| end.saturating_sub(window)..end);
    let cycle = first_cycle(voltage, 0.0).filter(|cycle| !cycle.is_empty());
    std::iter::once(0..1).chain(zeros).chain(cycle).collect()
}

/// What follows a telling.
struct Since {
    /// What the estimate was off by when it was told, µm.
    off: f64,
    state: IntervalState<f64>,
    /// The first tick.
    from: usize,
    /// Ticks that have one sample.
    every: f64,
    samples: Vec<Sample>,
}

impl Since {
    /// The tick of the next sample. Each lies elsewhere within its ticks, by the golden section: at even distances they would
    /// fall on one phase of a periodic voltage, of a staircase on every jump or on none.
    fn next(&self) -> usize {
        let sample = self.samples.len() as f64;
        let within = (sample * GOLDEN).fract();
        self.from + ((sample + within) * self.every) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::interval::{PLAYS, PROTOTYPES, SPANS, TRIANGLE};

    /// Twenty samples a period and a jump at each twentieth: what even distances would meet alone.
    #[test]
    fn samples_fall_on_every_phase() {
        let interval = |every| -> Vec<usize> {
            let sample = Sample { error: 0.0, memory: 0.0, parts: [0.0; PARTS] };
            let mut since = since(every);
            (0..SAMPLES)
                .map(|_| {
                    let tick = since.next();
                    since.samples.push(sample);
                    tick
                })
                .collect()
        };
        let ticks = interval(40.0);
        assert!(ticks.windows(2).all(|pair| pair[0] < pair[1]) && ticks[SAMPLES - 1] < 40 * SAMPLES, "{ticks:?}");
        for quarter in 0..4 {
            let there = ticks.iter().filter(|tick| **tick % 40 / 10 == quarter).count();
            assert!((12..=18).contains(&there), "quarter {quarter}: {there} of {ticks:?}");
        }
        assert_eq!(interval(1.0), (0..SAMPLES).collect::<Vec<_>>(), "every tick of a short recording, once");
    }

    fn since(every: f64) -> Since {
        let bare = IntervalParameters {
            memory_um: [0.0; SPANS],
            misfit_um: 1.0,
            rate_ticks: 1.0,
            spread_um: [0.0; TRIANGLE],
            prototypes: [[0; PLAYS]; PROTOTYPES],
            prototype_um: 0.0,
            untrained_um: 0.0,
            gain: 0.0,
            drift_um: 0.0,
            earliest_s: 0.0,
        };
        let interval = Interval::<f64>::build(&bare, Range { min: -1.0, max: 1.0 }, 5e-4);
        Since { off: 0.0, state: interval.begin(0.0, 0.0), from: 0, every, samples: Vec::new() }
    }

    #[test]
    fn a_displacement_is_told_over_a_window_at_no_even_part_and_over_a_cycle() {
        let tick_s = 5e-4;
        let sine: Vec<f64> = (0..12_000).map(|k| libm::sin(std::f64::consts::TAU * f64::from(k) / 2000.0)).collect();
        let mut draw = ChaCha8Rng::seed_from_u64(1);
        let told = tellings(&sine, tick_s, &mut draw);
        assert_eq!(told[0], 0..1);
        assert!(told[1..3].iter().all(|zero| zero.len() == 100 && zero.end < 9700), "{told:?}");
        assert_ne!(told[1], told[2]);
        // Between the first and the third reversal: the tops at a quarter of a period and one later.
        assert_eq!(told[3], 500..2500);
        assert_eq!(tellings(&[1.0; 2000], tick_s, &mut draw).len(), 3, "a voltage that stands makes no cycle");
    }
}
