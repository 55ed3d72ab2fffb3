//! A constant sensor delay, estimated from the training logs by cross-validation.
//!
//! Each delay that is tried is judged by how well a Voigt model, identified with it on one part of the training logs,
//! simulates the other part: with several logs each is left out once, a single log is halved. At a single frequency the
//! model's own lag does what a delay does, so the estimate runs to whatever bound it is given; it is bounded by what the
//! sensor can have, and the result says when it ended there.

use super::fit::{Progress, SearchOptions, Start, identify};
use super::job::{Job, sessions};
use super::problem::Problem;
use crate::log::Log;
use crate::prepare::Recipe;
use anyhow::Result;
use estimator_core::Model;

/// The estimate.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Delay {
    /// Ticks.
    pub ticks: u32,
    /// It is the largest that was tried.
    pub at_bound: bool,
}

/// Delays tried between none and the largest.
const TRIED: u32 = 10;

/// Estimates the delay of logs that were cut.
pub fn estimate(training: &[Log], recipe: &Recipe, job: &Job, progress: Progress<'_>) -> Result<Delay> {
    let search = search(job);
    let (largest, step) = (largest(job), step(job));
    let mut best = (f64::INFINITY, 0);
    for ticks in (0..=largest).step_by(step as usize) {
        let recipe = Recipe { delay_ticks: ticks, ..recipe.clone() };
        let mut error = 0.0;
        for (fitted, judged) in folds(training) {
            let (fitted, judged) = (sessions(&recipe, &fitted)?, sessions(&recipe, &judged)?);
            let problem = Problem::new(fitted, judged, job.scheme, job.deadband, job.limit);
            let fits = identify(&problem, &[Model::Voigt], job.cost, &search, progress);
            error += fits.first().and_then(|fit| problem.held_out(&fit.parameters)).unwrap_or(f64::INFINITY);
        }
        if error < best.0 {
            best = (error, ticks);
        }
    }
    Ok(Delay { ticks: best.1, at_bound: best.1 > 0 && best.1 + step > largest })
}

/// Generations that the estimate takes at most, for a progress bar.
pub fn generations(job: &Job) -> u64 {
    let folds = if job.training.len() == 1 { 2 } else { job.training.len() as u64 };
    let tried = u64::from(largest(job) / step(job)) + 1;
    tried * folds * search(job).generations_of(&[Model::Voigt])
}

/// A shorter search than the identification's: only the order of the errors counts.
fn search(job: &Job) -> SearchOptions {
    SearchOptions {
        generations: job.search.generations.min(40),
        rounds: job.search.rounds.min(3),
        start: Start::Random,
        ..job.search.clone()
    }
}

/// The largest delay tried, ticks.
fn largest(job: &Job) -> u32 {
    (job.prepare.max_delay * 1e3 / f64::from(job.prepare.tick_us)).round() as u32
}

/// Ticks between two delays that are tried.
fn step(job: &Job) -> u32 {
    largest(job).div_ceil(TRIED).max(1)
}

/// What is fitted to and what is judged on.
fn folds(logs: &[Log]) -> Vec<(Vec<Log>, Vec<Log>)> {
    if let [log] = logs {
        let (first, second) = log.split(0.5);
        return vec![(vec![first.clone()], vec![second.clone()]), (vec![second], vec![first])];
    }
    let without = |index: usize| logs.iter().enumerate().filter(move |(i, _)| *i != index).map(|(_, log)| log.clone());
    (0..logs.len()).map(|index| (without(index).collect(), vec![logs[index].clone()])).collect()
}
