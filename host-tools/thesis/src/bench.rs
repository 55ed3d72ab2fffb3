//! What the items are reproduced on: the synthetic rig's logs or the user's own, prepared once, and the models that
//! have been identified on them, each once.

use crate::error::ThesisError;
use comparison::Say;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::validate::Figures;
use identification::{
    Candidate, CandidateError, Job, JobError, Prepared, Problem, Progress, SearchOptions, StraightLine, identify,
};
use recordings::log::Log;
use recordings::prepare::{AutoOr, PrepareOptions};
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};
use report::{Grid, shown};
use serde::Serialize;

/// Seeds where nothing else is said: a look, not a result.
pub const QUICK_SEEDS: u32 = 1;

/// Logs and what was identified on them.
pub struct Bench {
    /// Logs, preparation, conditions, search.
    pub job: Job,
    /// The logs at the tick.
    pub prepared: Prepared,
    /// The rig that the logs are of; `None` for the user's own.
    pub rig: Option<Rig>,
    /// How an error becomes a sentence of a section.
    pub say: Say,
    /// Seeds of devices and searches where an item is over several.
    pub seeds: u32,
    /// Models that are learnt where an item learns them on many devices.
    pub models: Vec<Model>,
    found: Vec<Attempt>,
}

/// A model that was searched for.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// Which model it is.
    pub model: Model,
    /// What was minimised.
    pub cost: Feedback,
    /// What was found, or why nothing.
    pub result: Result<Candidate, CandidateError>,
}

/// A row of an item beside the straight line's errors, µm.
#[derive(Serialize)]
struct BesideLine<'a, R> {
    #[serde(flatten)]
    row: &'a R,
    straight_line_mae_um: Option<f64>,
    straight_line_max_um: Option<f64>,
}

impl Attempt {
    /// The candidate that was found; `None` where none is admissible.
    pub fn candidate(&self) -> Option<&Candidate> {
        self.result.as_ref().ok()
    }

    /// Why nothing was found.
    pub fn failed(&self) -> Option<&CandidateError> {
        self.result.as_ref().err()
    }
}

impl Bench {
    /// Prepares a job's logs.
    ///
    /// # Errors
    /// The logs cannot be prepared, or nothing is held out.
    pub fn new(job: Job, rig: Option<Rig>, say: Say) -> Result<Self, ThesisError> {
        let prepared = job.prepare()?;
        if prepared.problem.validation().next().is_none() {
            return Err(ThesisError::NothingHeldOut);
        }
        Ok(Self { job, prepared, rig, say, seeds: QUICK_SEEDS, models: Model::ALL.to_vec(), found: Vec::new() })
    }

    /// The thesis's logs from a rig: what is modelled, what is held out.
    pub fn logs_of(rig: &Rig) -> (Vec<Log>, Vec<Log>) {
        EXCITATIONS.into_iter().map(|excitation| rig.log(excitation)).partition(|log| log.name != VALIDATION)
    }

    /// Preparation of the rig's logs, whose zeros are known.
    pub fn zeroed(options: &PrepareOptions) -> PrepareOptions {
        let known = |zero| if zero == AutoOr::Auto { AutoOr::Given(0.0) } else { zero };
        PrepareOptions {
            voltage_zero: known(options.voltage_zero),
            displacement_zero: known(options.displacement_zero),
            ..options.clone()
        }
    }

    /// The sessions that models are fitted to.
    pub fn problem(&self) -> &Problem {
        &self.prepared.problem
    }

    /// How models are searched.
    pub fn search(&self) -> &SearchOptions {
        &self.job.search
    }

    /// Whose figures stand in a table.
    pub fn whose(&self) -> &'static str {
        match self.rig {
            Some(_) => "Ours: the synthetic rig. Thesis: its own actuator.",
            None => "Ours: the given logs. Thesis: its own actuator.",
        }
    }

    /// A table whose caption says whose figures it has.
    pub fn grid(&self, caption: &str) -> Grid {
        Grid::new(format!("{caption} {}", self.whose()))
    }

    /// What is held out, in words.
    pub fn held_out(&self) -> String {
        if self.rig.is_some() {
            return "the 10 Hz triangle".to_owned();
        }
        self.problem().validation().map(|session| session.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// The same logs at another tick, with the same zeros and delay.
    ///
    /// # Errors
    /// The logs cannot be brought to it.
    pub fn at_tick(&self, tick_us: u32) -> Result<Prepared, JobError> {
        let recipe = &self.prepared.context.recipe;
        let prepare = PrepareOptions {
            tick_us,
            voltage_zero: AutoOr::Given(recipe.voltage_zero_v),
            displacement_zero: AutoOr::Given(recipe.displacement_zero_um),
            delay: AutoOr::Given(f64::from(recipe.delay_ticks) * recipe.tick_s() * 1e3),
            ..self.job.prepare.clone()
        };
        Job { prepare, ..self.job.clone() }.prepare()
    }

    /// Identifies what has not been identified yet. The Voigt family's extremum models start from the simpler ones, so
    /// that the four are always searched for together.
    pub fn identify(&mut self, cost: Feedback, models: &[Model], progress: Progress<'_>) {
        let missing: Vec<Model> = models.iter().copied().filter(|model| self.attempt(cost, *model).is_none()).collect();
        let mut groups: Vec<Vec<Model>> = Vec::new();
        let mut family = missing.iter().filter(|model| model.is_voigt()).peekable();
        if family.peek().is_some() {
            let all = family.any(|model| *model != Model::Voigt);
            groups.push(if all { Model::VOIGT_FAMILY.to_vec() } else { vec![Model::Voigt] });
        }
        groups.extend(missing.iter().filter(|model| !model.is_voigt()).map(|model| vec![*model]));
        for group in groups {
            let Prepared { problem, context, .. } = &self.prepared;
            for fit in identify(problem, &group, cost, &self.job.search, progress) {
                let model = fit.model;
                if self.attempt(cost, model).is_none() {
                    let result = Candidate::new(problem, fit, context);
                    self.found.push(Attempt { model, cost, result });
                }
            }
        }
    }

    /// Errors of the straight line through the modelling logs over all that is held out.
    pub fn straight_line(&self) -> Option<Figures> {
        self.problem().baseline()?.held_out
    }

    /// Ends a table of models with the straight line's MAE, in this column.
    pub fn baseline(&self, grid: &mut Grid, column: usize) {
        if let Some(figures) = self.straight_line() {
            grid.sparse_row(StraightLine::NAME, [(column, shown(Some(figures.mae_um), 4))]);
        }
    }

    /// Rows as JSON, each beside the straight line's errors on the same held-out logs.
    ///
    /// # Errors
    /// A row cannot be written down.
    pub fn json(&self, rows: &[impl Serialize]) -> serde_json::Result<String> {
        let line = self.straight_line();
        let (mae, max) = (line.map(|figures| figures.mae_um), line.map(|figures| figures.max_um));
        let beside = |row| BesideLine { row, straight_line_mae_um: mae, straight_line_max_um: max };
        serde_json::to_string_pretty(&rows.iter().map(beside).collect::<Vec<_>>())
    }

    /// What came of a search, if it was run.
    pub fn attempt(&self, cost: Feedback, model: Model) -> Option<&Attempt> {
        self.found.iter().find(|attempt| attempt.cost == cost && attempt.model == model)
    }

    /// What was found of a model, if anything.
    pub fn candidate(&self, cost: Feedback, model: Model) -> Option<&Candidate> {
        self.attempt(cost, model).and_then(Attempt::candidate)
    }
}

/// A cost as the thesis calls it.
pub fn cost_name(cost: Feedback) -> &'static str {
    match cost {
        Feedback::Osp => "OSP",
        Feedback::Simulation => "simulation",
        Feedback::MultiStep => "multi-step",
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use ::calibration::CalibrationOptions;
    use identification::{Conditions, ModelChoice};

    /// Half a second of the rig and a search of a moment.
    pub fn small() -> Bench {
        let rig = Rig { duration: 0.5, ..Rig::default() };
        let search =
            SearchOptions { population: 16, generations: 6, rounds: 3, evaluations: 30, ..SearchOptions::default() };
        let (training, held_out) = Bench::logs_of(&rig);
        let job = Job {
            training,
            held_out,
            hold_out: 0.0,
            as_judged: false,
            prepare: Bench::zeroed(&PrepareOptions::default()),
            model: ModelChoice::Auto,
            conditions: Conditions::default(),
            calibration: CalibrationOptions::default(),
            cost: Feedback::Simulation.into(),
            search,
        };
        Bench::new(job, Some(rig), |error| error.to_string()).unwrap()
    }

    #[test]
    fn a_model_is_identified_once_and_voigt_alone_is_that_of_the_family() {
        let (mut alone, mut family) = (small(), small());
        let mut calls = 0;
        alone.identify(Feedback::Osp, &[Model::Voigt], &mut |_, _| calls += 1);
        let once = calls;
        alone.identify(Feedback::Osp, &[Model::Voigt], &mut |_, _| calls += 1);
        assert_eq!((calls, once), (once, 21));
        family.identify(Feedback::Osp, &[Model::Enhanced], &mut |_, _| ());
        let parameters = |bench: &Bench| bench.candidate(Feedback::Osp, Model::Voigt).unwrap().table.parameters;
        assert_eq!(parameters(&alone), parameters(&family));
        assert!(family.candidate(Feedback::Simulation, Model::Voigt).is_none());
    }
}
