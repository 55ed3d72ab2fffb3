//! A constant sensor delay, estimated from the training logs by cross-validation.
//!
//! Each delay that is tried is judged by how well a Voigt model, identified with it on one part of the training logs,
//! simulates the other part: with several logs each is left out once, a single log is halved. At a single frequency the
//! model's own lag does what a delay does, so the estimate runs to whatever bound it is given; it is bounded by what
//! the sensor can have, and the result says when it ended there.

use crate::cost::Cost;
use crate::fit::{Progress, identify};
use crate::problem::{Conditions, Problem};
use crate::search::{SearchOptions, Start};
use estimator_core::Model;
use log_survey::{Flaw, measured};
use recordings::log::Log;
use recordings::prepare::{PrepareError, PrepareOptions, Recipe};

/// A sensor's delay as it was estimated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Delay {
    /// The delay in whole ticks.
    pub ticks: u32,
    /// It is the largest that was tried.
    pub at_bound: bool,
}

/// How a delay is looked for.
#[derive(Clone, Debug)]
pub struct DelaySearch {
    /// The largest delay tried, ticks.
    largest: u32,
    /// Ticks between two delays that are tried.
    step: u32,
    conditions: Conditions,
    cost: Cost,
    search: SearchOptions,
}

/// Errors within this factor of the least are alike, and the shortest delay among them counts: a search finds a minimum
/// to a few per cent, and a delay that gains no more is not determined by the logs.
const ALIKE: f64 = 1.03;
/// Delays tried between none and the largest.
const TRIED: u32 = 10;

impl DelaySearch {
    /// A search like the identification's, of one model and from random starts.
    pub fn new(prepare: &PrepareOptions, conditions: Conditions, cost: Cost, search: &SearchOptions) -> Self {
        let largest = (prepare.max_delay * 1e3 / f64::from(prepare.tick_us)).round() as u32;
        Self {
            largest,
            step: largest.div_ceil(TRIED).max(1),
            conditions,
            cost,
            search: SearchOptions { start: Start::Random, ..search.clone() },
        }
    }

    /// Generations that it takes at most with so many logs, for a progress bar.
    pub fn generations(&self, logs: usize) -> u64 {
        let folds = if logs == 1 { 2 } else { logs as u64 };
        let tried = u64::from(self.largest / self.step) + 1;
        tried * folds * self.search.generations_of(&[Model::Voigt])
    }

    /// Estimates the delay of training logs that were cut; `flaws` of each are left out.
    ///
    /// # Errors
    /// A part of a log cannot be brought to the tick.
    pub fn estimate(
        &self,
        training: &[Log],
        flaws: &[Vec<Flaw>],
        recipe: &Recipe,
        progress: Progress<'_>,
    ) -> Result<Delay, PrepareError> {
        let (mut errors, folds) = (Vec::new(), folds(training, flaws));
        for ticks in (0..=self.largest).step_by(self.step as usize) {
            let recipe = Recipe { delay_ticks: ticks, ..recipe.clone() };
            let session = |(log, flaws): &Flawed<'_>| measured(&recipe, log, flaws).map(|(session, _)| session);
            let sessions = |logs: &[Flawed<'_>]| logs.iter().map(session).collect::<Result<Vec<_>, _>>();
            let mut error = 0.0;
            for (fitted, judged) in &folds {
                let problem = Problem::new(sessions(fitted)?, sessions(judged)?, self.conditions);
                let fits = identify(&problem, &[Model::Voigt], self.cost, &self.search, progress);
                let admissible = fits.first().filter(|fit| fit.cost.is_finite()).and_then(|fit| fit.parameters);
                error += admissible.and_then(|found| problem.held_out(&found, self.cost)).unwrap_or(f64::INFINITY);
            }
            errors.push((ticks, error));
        }
        let least = errors.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
        let ticks = errors.iter().find(|(_, error)| *error <= ALIKE * least).map_or(0, |(ticks, _)| *ticks);
        Ok(Delay { ticks, at_bound: ticks > 0 && ticks + self.step > self.largest })
    }
}

/// A log, or a part of one, and the flaws of the whole.
type Flawed<'f> = (Log, &'f [Flaw]);

/// What is fitted to and what is judged on.
fn folds<'f>(logs: &[Log], flaws: &'f [Vec<Flaw>]) -> Vec<(Vec<Flawed<'f>>, Vec<Flawed<'f>>)> {
    let logs: Vec<Flawed<'f>> = logs.iter().cloned().zip(flaws.iter().map(Vec::as_slice)).collect();
    if let [(log, flaws)] = &logs[..] {
        let (first, second) = log.split(0.5);
        let (first, second) = ((first, *flaws), (second, *flaws));
        return vec![(vec![first.clone()], vec![second.clone()]), (vec![second], vec![first])];
    }
    let without = |index: usize| logs.iter().enumerate().filter(move |(i, _)| *i != index).map(|(_, log)| log.clone());
    (0..logs.len()).map(|index| (without(index).collect(), vec![logs[index].clone()])).collect()
}
