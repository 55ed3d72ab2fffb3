//! What a table's estimates are off by in a session, each time since the displacement was told, beside the parts of
//! its interval.

use estimator_core::interval::{Interval, IntervalState};
use estimator_core::{Admitted, Estimator, IntervalParameters};
use recordings::session::Session;
use std::collections::VecDeque;
use validation::ZERO_WINDOW_S;

/// Parts of a recording after which the displacement is told.
const TOLD: [f64; 4] = [0.0, 0.25, 0.5, 0.75];
/// Samples of a recording that count, evenly over what follows.
const SAMPLES: usize = 60;

/// Parts of a half-width whose gains are found.
pub const PARTS: usize = 6;

/// An error, and what the interval has there, µm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample {
    /// Absolute error since the displacement was told, as the sensor reads it.
    pub error: f64,
    /// Misfit, memory of the start, rate, plays that moved, displacement gone, drift.
    pub parts: [f64; PARTS],
}

/// The samples that follow one telling of one recording.
pub type Recording = Vec<Sample>;

/// What follows a telling.
struct Telling {
    /// The error that is told, µm.
    off_um: f64,
    state: IntervalState<f64>,
    recording: Recording,
    /// Of so many readings one is a sample.
    every: usize,
}

/// The estimates beside what a session's sensor reads where it is judged, after each telling. The first comes at the
/// tick `from`, or with the first reading after it; the mean error over the [`ZERO_WINDOW_S`] before is what is told.
pub fn judged(table: &Admitted, interval: &IntervalParameters, session: &Session, from: usize) -> Vec<Recording> {
    let interval = Interval::<f64>::build(interval, table.voltage_range_v.of(), table.sample_period());
    let mut estimator = Estimator::<f64>::new(table);
    let zero = f64::from(table.voltage_zero_v);
    let mut begun: Option<IntervalState<f64>> = None;
    let mut step = |volts: f64| {
        let estimate = estimator.tick_volts(volts + zero).displacement;
        interval.step(begun.get_or_insert_with(|| interval.begin(volts, estimate)), volts, estimate);
        (estimate, begun)
    };
    if let Some(rest) = session.rested_v {
        step(rest);
    }
    let Session { voltage, instants, displacement, lead_in, .. } = session;
    let ticks = voltage.len().saturating_sub(1);
    let window = (ZERO_WINDOW_S / table.sample_period::<f64>()).round().max(1.0) as usize;
    let mut due = TOLD.map(|part| from + (part * ticks.saturating_sub(from) as f64) as usize).into_iter().peekable();
    let left = |tick: usize| instants.len() - instants.partition_point(|&instant| instant as usize <= tick);
    let mut readings = instants.iter().zip(displacement).skip(*lead_in).map(|(&at, &um)| (at as usize, um)).peekable();
    // Ticks of the window, and the error at each, µm.
    let mut before: VecDeque<(usize, f64)> = VecDeque::new();
    let mut told: Vec<Telling> = Vec::new();
    let mut read = 0_usize;
    // Behind a gap nothing is told before the window is full again; of a log that is read seldom each reading fills it.
    let gap = window.max(2 * (session.interval_s() / session.tick_s) as usize);
    let (mut last, mut full) = (0, 0);
    for (tick, &volts) in voltage.iter().enumerate().take(ticks) {
        let (estimate, state) = step(volts);
        // An estimate is of the tick that follows; the first has none.
        while readings.next_if(|(at, _)| *at <= tick).is_some() {}
        let off = readings.next_if(|(at, _)| *at == tick + 1).map(|(_, reading)| estimate - reading);
        for Telling { off_um, state, recording, every } in &mut told {
            interval.step(state, volts, estimate);
            if let Some(off) = off
                && read.is_multiple_of(*every)
                && let Some(parts) = interval.parts(state)
            {
                let error = (off - *off_um).abs();
                let of = [parts.misfit, parts.memory, parts.rate, parts.moved, parts.gain, parts.drift];
                recording.push(Sample { error, parts: of });
            }
        }
        let Some(off) = off else { continue };
        read += 1;
        full = if tick > last + gap { tick + window } else { full };
        last = tick;
        before.push_back((tick, off));
        while before.front().is_some_and(|(at, _)| at + window <= tick) {
            before.pop_front();
        }
        if tick >= full
            && due.next_if(|at| *at <= tick).is_some()
            && let Some(mut state) = state
        {
            while due.next_if(|at| *at <= tick).is_some() {}
            interval.tell_at_rest(&mut state);
            let off_um = before.iter().map(|(_, off)| off).sum::<f64>() / before.len() as f64;
            let every = (left(tick) / SAMPLES).max(1);
            told.push(Telling { off_um, state, recording: Vec::new(), every });
        }
    }
    told.into_iter().map(|telling| telling.recording).filter(|recording| !recording.is_empty()).collect()
}
