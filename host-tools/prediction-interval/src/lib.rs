//! A ± beside the estimate: the numbers of a table's prediction interval ([`estimator_core::interval`]).
//!
//! What a model is off by on a recording that it was not learnt on cannot be seen in the recordings it was learnt on.
//! So devices are simulated that no model of the catalogue is made of, driven by the user's own voltages and learnt as
//! the actuator was; what their tables are off by on other recordings says how wide the interval has to be for what is
//! known of a tick: how far the voltage has gone where the training never went, how fast it goes, how long ago the
//! displacement was told. What was held out of the training is then to be held as often, too.

mod again;
mod device;
mod gains;
mod held;
mod late;
mod lead_in;
mod memory_at_ends;
mod prototypes;
mod spread;
mod start_memory;
mod told;
mod trial;

pub use held::Judged;

use again::again;
use device::Device;
use estimator_core::{IntervalParameters, Range};
use gains::{Gains, Tried};
use identification::{Candidate, CandidateError, Learnt, Outcome, Problem, SearchOptions, TableContext};
use log_survey::Character;
use memory_at_ends::memory_at_ends;
use rayon::prelude::*;
use recordings::session::Session;
use spread::learnt;
use start_memory::start_memory;
use told::PARTS;
use trial::recordings;

/// Devices that are simulated where nobody says how many.
pub const DEVICES: u32 = 12;

/// Half-width for a deviation of 1 of what is off in any case.
const CERTAIN: f64 = 2.0;
/// What no log can tell a model to be off less than, of the stroke.
const LEAST: f64 = 0.004;
/// Part of the half-width that is there always by which plays have to be off from where they stood in a training of
/// several amplitudes to count as untrained: that alone makes the ± some 12 % wider. A training of one amplitude says
/// nothing of any other, so there they count at once.
const WIDER: f32 = 0.5;
/// A displacement may be told once so many lags and delays have gone by since the start.
const LAGS: f64 = 5.0;

/// An interval, and where its width comes from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Calibration {
    /// What a table says of its interval.
    pub parameters: IntervalParameters,
    /// What the actuator's own recordings have of the half-width where nothing else counts, µm; the rest is
    /// the simulated devices'.
    pub own_um: f64,
}

/// The interval of an identified model, which holds what it was `judged` on as often as it says; `None` without a
/// device that could be learnt, or where the training voltage does not move. `progress` is called after each of the
/// simulated devices, whose searches try as many candidates as `search` has for two numbers.
pub fn calibrate(
    problem: &Problem,
    candidate: &Candidate,
    judged: Judged<'_>,
    context: &TableContext,
    search: &SearchOptions,
    devices: u32,
    progress: impl Fn() + Sync,
) -> Option<Calibration> {
    if devices == 0 || problem.training_voltages().span() <= 0.0 {
        return None;
    }
    let late = late::open(problem, candidate, context, search);
    let tried: Vec<Tried> = (0..devices)
        .into_par_iter()
        .filter_map(|number| {
            let tried = tried(number, problem, candidate, context, search, late);
            progress();
            tried
        })
        .collect();
    let own_um = own(candidate);
    (!tried.is_empty()).then(|| {
        let several = !Character::of(problem.training(), problem.deadband).single_amplitude();
        let gains = Gains::of(&tried, several).at(own_um);
        let parameters = scaled(unscaled(problem, candidate), gains, own_um, several);
        let [memory, misfit] = [parameters.memory_um[0], parameters.misfit_um].map(f64::from);
        let at_ends = memory_at_ends(problem, &candidate.table, memory, misfit) as f32;
        let parameters = IntervalParameters {
            memory_um: parameters.memory_um.map(|um| at_ends.max(1.0) * um),
            memory_at_ends: at_ends.min(1.0),
            ..parameters
        };
        let held_um = held::misfit(judged, &parameters);
        let (misfit_um, own_um) = match held_um > f64::from(parameters.misfit_um) {
            true => (held_um as f32, held_um),
            false => (parameters.misfit_um, own_um),
        };
        let untrained_um = untrained(parameters.untrained_um, misfit_um, several);
        Calibration { parameters: IntervalParameters { misfit_um, untrained_um, ..parameters }, own_um }
    })
}

/// What was found, with an interval in the delivered table, and where its width comes from; without one where
/// [`calibrate`] has none.
///
/// # Errors
/// The interval breaks a rule.
pub fn with_interval(
    mut outcome: Outcome,
    search: &SearchOptions,
    devices: u32,
    progress: impl Fn() + Sync,
) -> Result<(Outcome, Option<Calibration>), CandidateError> {
    let Learnt { candidate, context, .. } = &outcome.learnt;
    let judged = Judged { problem: &outcome.problem, candidate: outcome.judged() };
    let interval = calibrate(outcome.learnt_from(), candidate, judged, context, search, devices, progress);
    outcome.learnt.candidate = candidate.clone().with_interval(interval.map(|of| of.parameters))?;
    Ok((outcome, interval))
}

/// What the table of a device is off on its recordings; `None` where nothing could be learnt.
fn tried(
    number: u32,
    problem: &Problem,
    candidate: &Candidate,
    context: &TableContext,
    search: &SearchOptions,
    late: Range<f64>,
) -> Option<Tried> {
    let device = Device::drawn(number, context.seed, problem, late);
    let mut numbers = 0..;
    let mut sessions = |sessions: &mut dyn Iterator<Item = &Session>| -> Vec<Session> {
        sessions.zip(&mut numbers).map(|(session, number)| device.session(number, session)).collect()
    };
    let mut theirs = problem.of(sessions(&mut problem.training()), sessions(&mut problem.validation()));
    // Where somebody says what the actuator's lag is, a device's is known, too.
    theirs.lag_s = problem.lag_s.map(|_| device.lag_s());
    let learnt = again(&theirs, candidate, context, search).ok()?;
    let seed = (u64::from(context.seed) << 20) + u64::from(number);
    let recordings = recordings(&device, &learnt.table, &unscaled(&theirs, &learnt), &theirs, seed);
    (!recordings.is_empty()).then(|| Tried { own_um: own(&learnt), recordings })
}

/// What a model's own logs say that it is off by, as a half-width, µm.
fn own(candidate: &Candidate) -> f64 {
    CERTAIN * misfit(candidate)
}

/// What an estimate is off by in any case, µm: the median over the logs of the rms without offset, of what was held
/// out, or where nothing was, of the training. (What fast logs have beyond that belongs to the rate.)
fn misfit(candidate: &Candidate) -> f64 {
    let logs = if candidate.held_out.is_empty() { &candidate.training } else { &candidate.held_out };
    let mut errors: Vec<f64> = logs.iter().map(|log| log.from_its_start().rmse_without_offset_um).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE)
}

/// The interval whose gains are 1, and whose misfit is the stroke.
fn unscaled(problem: &Problem, candidate: &Candidate) -> IntervalParameters {
    let table = &candidate.table;
    let stroke = problem.stroke().span();
    let parameters = IntervalParameters {
        memory_um: start_memory(table),
        rate_ticks: 1.0,
        gain: 1.0,
        drift_um: stroke as f32,
        earliest_s: (LAGS * candidate.late_s()) as f32,
        ..IntervalParameters::constant(stroke as f32)
    };
    learnt(parameters, problem, table.voltage_range_v.of(), misfit(candidate).hypot(LEAST * stroke))
}

/// n (µm) beyond which plays stand as they never stood: farther than any of the training did, and, of several
/// amplitudes, so far that it widens the interval.
fn untrained(beyond: f32, misfit: f32, several_amplitudes: bool) -> f32 {
    beyond.max(if several_amplitudes { WIDER * misfit } else { 0.0 })
}

fn scaled(
    unscaled: IntervalParameters,
    [misfit, memory, rate, moved, gain, drift]: [f64; PARTS],
    own_um: f64,
    several_amplitudes: bool,
) -> IntervalParameters {
    let times = |number: f32, gain: f64| (f64::from(number) * gain) as f32;
    let misfit_um = (misfit * f64::from(unscaled.misfit_um)).hypot(own_um) as f32;
    IntervalParameters {
        misfit_um,
        memory_um: unscaled.memory_um.map(|number| times(number, memory)),
        rate_ticks: times(unscaled.rate_ticks, rate),
        spread_um: unscaled.spread_um.map(|number| times(number, moved)),
        prototype_um: times(unscaled.prototype_um, moved),
        untrained_um: untrained(times(unscaled.untrained_um, moved), misfit_um, several_amplitudes),
        gain: times(unscaled.gain, gain),
        drift_um: times(unscaled.drift_um, drift),
        ..unscaled
    }
}
