//! What recordings determine of an actuator, and what they do not: what a table says of it, with standard errors.
//!
//! ```text
//! Σ⁻¹ = Σ_b nₑ/(n·s²)·JᵀJ + D⁻²    J = ∂ŷ/∂θ at the readings of block b, s = √(π/2) times their mean absolute error
//! se(φ)² = ∇φᵀ Σ ∇φ                 φ what the actuator does in an experiment, by the table
//! nₑ = n / (1 + 2 Σ_k ρ_k)          ρ the errors' autocorrelation, until it first falls below 0
//! ```
//!
//! (Seber and Wild, *Nonlinear Regression*, 1989, ch. 2 and 6.) That one nₑ holds for all takes the derivatives to be
//! as slow as the errors, which those of a loop are whose error repeats with it. A session's blocks are its start,
//! which nobody knows, and what follows; each has its own noise, as in the fit, and a constant of the session's, for
//! drift and the sensor's zero, says nothing. A model's single numbers say little: those of neighbouring plays stand in
//! for one another, and no log tells them apart. What the actuator does in an experiment is told by all of them
//! together, and is what a user means. D takes every number to be known to its own size beforehand, so that what the
//! logs do not see has a large standard error, and not an infinite one.
//!
//! Creep is asked for over seconds, and what a model makes of it is drawn from what is faster, where the logs do not
//! rest. So its standard error has what the estimate was off by in their rests, as another rest would be; without any
//! it says nothing.
//!
//! ```text
//! se² + (1 + 1/n)·Σ e²/n            e what the estimate is off by more at the end of a rest, for a move over the range
//! ```
//!
//! It is the errors of the readings that speak here, as if the model were right. What the model itself is wrong by, the
//! interval beside the estimate says.

mod experiment;
mod judged;
mod numbers;
mod rests;

pub use experiment::Experiment;

use estimator_core::{Admitted, Range, Table};
use judged::{Judged, effective, mean_absolute};
use log_survey::reversals::reversals;
use nalgebra::{DMatrix, DVector};
use numbers::{Number, numbers};
use rayon::prelude::*;
use recordings::session::{Session, one_of_each};
use rests::missed;
use serde::Serialize;

/// Readings that are looked at, at most: more say the same.
const READINGS: usize = 20_000;
/// What of a condition can be told in f64, by its square.
const WORST_CONDITION: f64 = 1e8;
/// How much wider than the table's the limits may be, at either end, of what lies between them.
const WIDENED_BY: [f32; 5] = [1.0, 0.3, 0.1, 0.03, 0.0];
/// A block is not believed to be quieter than this part of what follows the starts.
const QUIET: f64 = 0.1;
/// What is known to this part of the stroke is told well.
const OF_STROKE: f64 = 0.005;
/// A log as fast as an experiment goes at least so far in a quarter of the experiment's period, of its way: a half of
/// what a sine does.
const AS_FAR: f64 = 0.35;
/// A swing shows what one does that goes so many times as far, or as little.
const ALIKE: f64 = 1.5;
/// What the logs leave of the standard error that there was before them, at most, where they tell something.
const LEFT: f64 = 0.1;

/// What the training logs determine.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Determination {
    /// Readings of the training.
    pub readings: usize,
    /// As many independent readings would say as much.
    pub effective_readings: f64,
    /// Mean absolute error behind the starts, without a constant of each session's, µm: a few readings that are far
    /// off count once.
    pub mae_um: f64,
    /// Numbers of the model that were looked at.
    pub numbers: usize,
    /// Numbers that could not be moved without breaking a rule; what they are uncertain by is missing.
    pub held: usize,
    /// Largest by smallest singular value of the readings' derivatives by the numbers, each of its own size; 10⁸ where
    /// two cannot be told apart at all.
    pub condition: f64,
    /// What the actuator does, experiment by experiment.
    pub found: Vec<Found>,
}

/// What the actuator does in an experiment, by the table.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Found {
    /// What was done to the table's actuator.
    pub experiment: Experiment,
    /// What is read off it, µm.
    pub value_um: f64,
    /// Its standard error, µm.
    pub standard_error_um: f64,
    /// The same before any log, where every number is known to its own size, µm.
    pub before_um: f64,
    /// How much of it is the logs' and not the model's.
    pub told: Told,
}

/// How much logs tell of an experiment.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Told {
    /// The standard error is at most half a percent of the stroke.
    Well,
    /// It is more, and at most a tenth of what it was before them; or the logs show what is asked for, in rests.
    Partly,
    /// What is known is mostly what the model takes for granted.
    Not,
    /// No log's voltage goes nearly as fast: number and standard error are those of a law that only slower
    /// ones have shown.
    Slower,
    /// No log's voltage goes about as far from one turn to the next: number and standard error are those of a law
    /// that only other swings have shown.
    OtherSwings,
    /// No log's voltage rests as long behind a move: number and standard error are those of a law that only what is
    /// quicker has shown.
    Restless,
}

/// Why it is not known what logs determine of a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unknown {
    /// There are no two readings, or their voltage rests.
    NothingRead,
    /// The model fits without an error, which says nothing of how uncertain its numbers are.
    Exact,
    /// The model has no number that a log could tell.
    NoNumber,
    /// No number of the model can be moved, or no table be made with wider limits, without breaking a rule.
    Held,
    /// A small change of the numbers changes the estimate by more than can be computed with.
    Unstable,
}

/// What the training sessions determine of a table that was identified from them. An experiment that is too fast for
/// the amplifier, as far as the table says how fast it is, is none: its answer could be neither recorded nor needed.
///
/// # Errors
/// Why that is not known.
pub fn determination(table: &Admitted, sessions: &[&Session]) -> Result<Determination, Unknown> {
    let fastest = fastest(table);
    let table = with_widest_limits(table).ok_or(Unknown::Held)?;
    let judged: Vec<Judged> = sessions.iter().map(|session| Judged::of(&table, session)).collect();
    let readings: usize = judged.iter().map(|judged| judged.errors.len()).sum();
    let settled: Vec<f64> = judged.iter().flat_map(|judged| &judged.errors[judged.start..]).copied().collect();
    let mae_um = mean_absolute(&settled);
    let effective: f64 = judged.iter().flat_map(Judged::blocks).map(effective).sum();
    let voltages = Range::of_values(sessions.iter().flat_map(|session| session.voltage.iter().copied()));
    let (numbers, held) = numbers(&table);
    if readings < 2 || voltages.span() <= 0.0 {
        return Err(Unknown::NothingRead);
    }
    if mae_um <= 0.0 {
        return Err(Unknown::Exact);
    }
    if numbers.is_empty() {
        return Err(if held > 0 { Unknown::Held } else { Unknown::NoNumber });
    }
    let every = readings.div_ceil(READINGS);
    let mut experiments = Experiment::all().to_vec();
    experiments.retain(|experiment| experiment.steepest(voltages.span()) <= fastest);
    let before: Vec<f64> = experiments.iter().map(|experiment| experiment.run(&table, voltages)).collect();
    let weights: Vec<Vec<f64>> = judged.iter().map(|judged| judged.weights(every, QUIET * mae_um)).collect();
    // Of each number the change of the readings, each by its weight, and of the experiments' results, for as
    // much as itself.
    let changes: Vec<(Vec<f64>, Vec<f64>)> = numbers
        .par_iter()
        .map(|Number { changed, step }| {
            let read = sessions.iter().zip(&judged).zip(&weights).flat_map(|((session, before), weights)| {
                let after = Judged::of(changed, session).errors;
                let both = one_of_each(every, after.len()).zip(weights);
                both.map(|(at, weight)| (after[at] - before.errors[at]) / step * weight).collect::<Vec<f64>>()
            });
            let read = read.collect();
            let results = experiments.iter().zip(&before);
            (read, results.map(|(experiment, before)| (experiment.run(changed, voltages) - before) / step).collect())
        })
        .collect();
    let looked_at = changes.first().map_or(0, |(read, _)| read.len());
    let read = DMatrix::from_fn(looked_at, numbers.len(), |reading, number| changes[number].0[reading]);
    let information = read.tr_mul(&read);
    let precision = &information + DMatrix::identity(numbers.len(), numbers.len());
    let precision = precision.cholesky().ok_or(Unknown::Unstable)?;
    let eigenvalues = information.symmetric_eigenvalues();
    let stroke = before.first().map_or(0.0, |stroke| stroke.abs());
    let found = experiments.iter().enumerate().map(|(index, &experiment)| {
        let gradient = DVector::from_iterator(numbers.len(), changes.iter().map(|(_, results)| results[index]));
        let by_readings = gradient.dot(&precision.solve(&gradient)).max(0.0);
        let missed: Option<Vec<f64>> = experiment.rest_s().map(|rest_s| {
            let of = sessions.iter().zip(&judged);
            of.flat_map(|(session, judged)| missed(session, judged, voltages.span(), rest_s)).collect()
        });
        // A model without creep is none to be off in it.
        let by_rests = missed.as_deref().filter(|_| by_readings > 0.0).map_or(0.0, as_another);
        let standard_error_um = (by_readings + by_rests).sqrt();
        let value_um = before[index];
        let before_um = gradient.norm();
        let slower = experiment.swing(voltages.span()).is_some_and(|(swing_v, period_s)| {
            sessions.iter().all(|session| farthest(session, 0.25 * period_s) < AS_FAR * swing_v)
        });
        let unlike = experiment
            .smaller(voltages.span())
            .is_some_and(|swing_v| sessions.iter().all(|session| !swings_about(session, swing_v)));
        let told = if slower {
            Told::Slower
        } else if unlike {
            Told::OtherSwings
        } else if missed.as_deref().is_some_and(<[f64]>::is_empty) {
            Told::Restless
        } else if standard_error_um <= OF_STROKE * stroke {
            Told::Well
        } else if missed.is_some() || standard_error_um <= LEFT * before_um {
            Told::Partly
        } else {
            Told::Not
        };
        Found { experiment, value_um, standard_error_um, before_um, told }
    });
    Ok(Determination {
        readings,
        effective_readings: effective,
        mae_um,
        numbers: numbers.len(),
        held,
        condition: (eigenvalues.max() / eigenvalues.min()).abs().sqrt().min(WORST_CONDITION),
        found: found.collect(),
    })
}

/// How fast the amplifier can be at most, V/s, by the slew limit of the drive or what is stated of the amplifier;
/// infinite where nothing is.
fn fastest(table: &Table) -> f64 {
    let stated = [table.drive.map(|drive| drive.limits.slew_v_per_s), table.amplifier_slew_v_per_s];
    stated.into_iter().flatten().map(f64::from).fold(f64::INFINITY, f64::min)
}

/// The table without interval and drive, which have no part in it, and with the widest limits that it is admitted
/// with, since limits must not keep a number from moving: the feedback of an extremum term goes the further, the
/// wider they are.
fn with_widest_limits(table: &Admitted) -> Option<Admitted> {
    let limits = table.displacement_limits_um;
    WIDENED_BY.into_iter().find_map(|part| {
        let widened = Range { min: limits.min - part * limits.span(), max: limits.max + part * limits.span() };
        Table { interval: None, drive: None, displacement_limits_um: widened, ..**table }.admit().ok()
    })
}

/// How far the voltage of a session goes in a time at most, V.
fn farthest(session: &Session, seconds: f64) -> f64 {
    let ticks = (seconds / session.tick_s).round().max(1.0) as usize;
    let pairs = session.voltage.iter().zip(session.voltage.iter().skip(ticks));
    pairs.map(|(from, to)| (to - from).abs()).fold(0.0, f64::max)
}

/// Whether the voltage of a session goes about so far (V) and as far back, from where it begins or turns to where it
/// turns or ends. A sine that begins at its middle goes half as far at first, and not back by that.
fn swings_about(session: &Session, swing_v: f64) -> bool {
    let mut turns = vec![0];
    turns.extend(reversals(&session.voltage, swing_v / ALIKE));
    turns.extend(session.voltage.len().checked_sub(1));
    let alike = |from: usize, to: usize| {
        (swing_v / ALIKE..=ALIKE * swing_v).contains(&(session.voltage[to] - session.voltage[from]).abs())
    };
    turns.windows(3).any(|turns| alike(turns[0], turns[1]) && alike(turns[1], turns[2]))
}

/// The variance of another of some numbers about 0; 0 of none.
fn as_another(numbers: &[f64]) -> f64 {
    let count = numbers.len().max(1) as f64;
    (1.0 + 1.0 / count) * numbers.iter().map(|number| number * number).sum::<f64>() / count
}
