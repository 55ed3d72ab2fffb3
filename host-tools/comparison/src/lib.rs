//! Models side by side: each identified on the same training data, with the same seed, method and budget of
//! evaluations, and judged by its simulation errors (µm) on logs that decided nothing. Zeros and delay are decided
//! once, from the training data.

use estimator_core::{Model, Table};
use identification::{
    Candidate, Doubt, Fit, Identification, Job, JobError, Prepared, Problem, Progress, StraightLine, with_contained,
};
use recordings::LogUse;
use recordings::prepare::Recipe;
use recordings::session::Session;
use serde::{Deserialize, Serialize};
use std::time::Instant;
use validation::{Comparison, Figures};

/// What came of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Matrix {
    /// A model each, in the order asked for.
    pub rows: Vec<Row>,
    /// What every model is to better; `None` where the training voltage does not move.
    pub straight_line: Option<StraightLineErrors>,
    /// How the logs were prepared.
    pub recipe: Recipe,
    /// What each log was used for, the same for every model.
    pub logs: Vec<LogUse>,
    /// Why not to trust the logs or their preparation.
    pub doubts: Vec<Doubt>,
    /// What the models were fitted to and judged on.
    #[serde(skip)]
    pub problem: Problem,
}

/// How a model fared, and at what price.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Which model it is.
    pub model: Model,
    /// Wall-clock time of its own search, s; that of the simpler models it starts from is theirs.
    pub seconds: f64,
    /// Candidates that were evaluated in it.
    pub evaluations: usize,
    /// What a tick of it takes on the target, where that was measured.
    pub instructions: Option<Instructions>,
    /// Its table, where it was identified.
    #[serde(skip)]
    pub table: Option<Box<Table>>,
    /// Its errors, or why it has no admissible candidate.
    #[serde(flatten)]
    pub result: Judgement,
}

/// The straight line through the training logs.
#[derive(Clone, Debug, Serialize)]
pub struct StraightLineErrors {
    /// The line's gain, µm/V.
    pub gain_um_per_v: f64,
    /// Its displacement at 0 V, µm.
    pub offset_um: f64,
    /// Its errors on the held-out log.
    #[serde(flatten)]
    pub errors: Errors,
}

/// How a model did.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Judgement {
    /// Identified, and judged on what was held out.
    Identified(Box<Errors>),
    /// No admissible candidate.
    Failed {
        /// Why it has none.
        failed: String,
    },
}

/// Errors of an identified model.
#[derive(Clone, Debug, Serialize)]
pub struct Errors {
    /// Numbers identified: see [`Fit::numbers`].
    pub parameters: usize,
    /// On what it was fitted to.
    pub training: Part,
    /// On what was held out.
    pub held_out: Part,
}

/// Errors on several logs.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// A log at a time.
    pub logs: Vec<LogErrors>,
    /// Over all, each log weighing the same.
    pub all: Figures,
}

/// Errors on a log.
#[derive(Clone, Debug, Serialize)]
pub struct LogErrors {
    /// The log's file name.
    pub log: String,
    /// Those of the f64 reference.
    pub errors: Figures,
}

/// Instructions per tick on the target.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct Instructions {
    /// Most in a tick.
    pub max: f64,
    /// Mean over ticks.
    pub mean: f64,
}

impl Row {
    /// Its errors, where it was identified.
    pub fn errors(&self) -> Option<&Errors> {
        match &self.result {
            Judgement::Identified(errors) => Some(errors),
            Judgement::Failed { .. } => None,
        }
    }
}

impl Matrix {
    /// The model with the smallest mean absolute error over all that was held out, each log's constant offset aside:
    /// where a sensor's zero lies, no model knows.
    pub fn nearest(&self) -> Option<Model> {
        let errors =
            self.rows.iter().filter_map(|row| Some((row.model, row.errors()?.held_out.all.mae_without_offset_um)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(model, _)| model)
    }

    /// Whether instructions are known of any row.
    pub fn counted(&self) -> bool {
        self.rows.iter().any(|row| row.instructions.is_some())
    }

    /// The held-out logs, by name, in the order of each row's errors.
    pub fn held_out(&self) -> Vec<&str> {
        let first = self.rows.iter().find_map(Row::errors);
        first.map_or(Vec::new(), |errors| errors.held_out.logs.iter().map(|log| log.log.as_str()).collect())
    }
}

/// Callbacks of a model's search, roughly, for a progress bar.
const CALLBACKS: u64 = 700;

/// Calls of `progress` that [`run`] makes, roughly.
pub fn generations(job: &Job, models: &[Model]) -> u64 {
    CALLBACKS * searches(job, models).concat().len() as u64
}

/// Why models cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum ComparisonError {
    /// The logs cannot be prepared.
    #[error(transparent)]
    Job(#[from] JobError),
    /// Nothing is held out.
    #[error("nothing is held out")]
    NothingHeldOut,
}

/// How a row says why it has no table.
pub type Say = fn(&(dyn std::error::Error + 'static)) -> String;

/// Identifies the models, each with at most so many evaluations of candidates, and judges them. The job's own choice of
/// a model is not looked at.
///
/// # Errors
/// Nothing is held out, or the logs cannot be prepared. A model without an admissible candidate is a row.
pub fn run(
    job: &Job,
    models: &[Model],
    budget: usize,
    say: Say,
    progress: Progress<'_>,
) -> Result<Matrix, ComparisonError> {
    let Prepared { problem, context, logs, of_logs, of_delay } = job.prepare()?;
    if problem.validation().next().is_none() {
        return Err(ComparisonError::NothingHeldOut);
    }
    let mut found: Vec<(Fit, f64)> = Vec::new();
    for group in searches(job, models) {
        let mut seconds = vec![0.0; group.len()];
        let mut last = Instant::now();
        // What has passed since the last generation was spent on this one.
        let mut charge = |model: Option<&Model>| {
            let now = Instant::now();
            let index = group.iter().position(|other| Some(other) == model);
            if let Some(spent) = index.and_then(|index| seconds.get_mut(index)) {
                *spent += now.duration_since(last).as_secs_f64();
            }
            last = now;
        };
        let identification =
            Identification { problem: &problem, cost: job.cost, options: &job.search, budget: Some(budget) };
        let fits = identification.run(&group, &mut |model, cost| {
            charge(Some(&model));
            progress(model, cost);
        });
        charge(group.last());
        found.extend(fits.into_iter().zip(seconds));
    }
    let rows = models.iter().filter_map(|model| {
        let (fit, seconds) = found.iter().find(|(fit, _)| fit.model == *model)?;
        let candidate = Candidate::new(&problem, fit.clone(), &context);
        let table = candidate.as_ref().ok().map(|candidate| Box::new(*candidate.table));
        let result = candidate.map(|candidate| errors(&candidate));
        Some(Row {
            model: *model,
            seconds: *seconds,
            evaluations: fit.evaluations,
            instructions: None,
            table,
            result: match result {
                Ok(errors) => Judgement::Identified(Box::new(errors?)),
                Err(error) => Judgement::Failed { failed: say(&error) },
            },
        })
    });
    let rows = rows.collect();
    let straight_line = StraightLine::fit(problem.training()).and_then(|line| straight_line(line, &problem));
    let doubts = of_logs.into_iter().chain(of_delay).collect();
    Ok(Matrix { rows, straight_line, recipe: context.recipe, logs, doubts, problem })
}

/// What is searched for together: the wanted models of the Voigt family with those that they start from, simplest
/// first; and each other by itself.
fn searches(job: &Job, models: &[Model]) -> Vec<Vec<Model>> {
    let wanted: Vec<Model> = models.iter().flat_map(|model| with_contained(*model, job.search.start)).collect();
    let family: Vec<Model> = Model::VOIGT_FAMILY.into_iter().filter(|model| wanted.contains(model)).collect();
    let others = Model::ALL.into_iter().filter(|model| !model.is_voigt() && wanted.contains(model));
    std::iter::once(family).filter(|family| !family.is_empty()).chain(others.map(|model| vec![model])).collect()
}

/// Errors on both parts; `None` without a log in one of them.
fn errors(candidate: &Candidate) -> Option<Errors> {
    let part = |comparisons: &[Comparison], all: Option<Figures>| -> Option<Part> {
        let logs = comparisons.iter().map(|log| LogErrors { log: log.name.clone(), errors: log.figures() }).collect();
        Some(Part { logs, all: all? })
    };
    Some(Errors {
        parameters: candidate.fit.numbers(),
        training: part(&candidate.training, candidate.training_figures())?,
        held_out: part(&candidate.held_out, candidate.held_out_figures())?,
    })
}

/// Errors of the straight line on both parts; `None` without a log in one of them.
fn straight_line(line: StraightLine, problem: &Problem) -> Option<StraightLineErrors> {
    let part = |sessions: &mut dyn Iterator<Item = &Session>| -> Option<Part> {
        let of = |session: &Session| LogErrors { log: session.name.clone(), errors: line.errors(session) };
        let logs: Vec<LogErrors> = sessions.map(of).collect();
        let all = Figures::all(logs.iter().map(|log| &log.errors))?;
        Some(Part { logs, all })
    };
    let errors = Errors {
        parameters: ["gain", "offset"].len(),
        training: part(&mut problem.training())?,
        held_out: part(&mut problem.validation())?,
    };
    Some(StraightLineErrors { gain_um_per_v: line.gain_um_per_v, offset_um: line.offset_um(), errors })
}
