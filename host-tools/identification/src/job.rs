//! The whole identification: logs in; every candidate model with its table, the one that was chosen, and
//! the doubts out.

use crate::candidate::{Candidate, CandidateError, TableContext};
use crate::cost::Cost;
use crate::delay;
use crate::division::Parts;
use crate::doubt::Doubt;
use crate::family::{LONGEST_DELAY, LONGEST_LAG};
use crate::fit::{Identification, Progress};
use crate::job_error::JobError;
use crate::learnt::Learnt;
use crate::model_choice::{Choice, ModelChoice, Reason, with_contained};
use crate::prepared::Prepared;
use crate::problem::{Conditions, Problem};
use crate::search::SearchOptions;
use crate::second_choice::second_choice;
use crate::suspicion::{doubts, no_better};
use crate::validate::Baseline;
use calibration::CalibrationOptions;
use estimator_core::{Digest, Model, Range};
use log_survey::{
    Character, Flaw, Implausible, ahead, falls, flaws, gravest, held_in_turns, other_scale, repaired, sound,
};
use recordings::log::Log;
use recordings::prepare::{AutoOr, PrepareError, PrepareOptions};
use recordings::session::Session;
use recordings::{LogUse, Role};
use sha2::{Digest as _, Sha256};

/// What to identify from what.
#[derive(Clone, Debug)]
pub struct Job {
    /// Logs that the parameters, zeros, delay and limits come from; whole, as read.
    pub training: Vec<Log>,
    /// Logs that decide nothing.
    pub held_out: Vec<Log>,
    /// Fraction of each training log that is held out until the model is chosen and judged, and learnt from
    /// then: its end, or stretches all over it where the ends [go beyond](log_survey::ends_go_beyond) what was before.
    pub hold_out: f64,
    /// The chosen model is delivered as it was judged, and not learnt from what was held out.
    pub as_judged: bool,
    /// Preparation of the logs.
    pub prepare: PrepareOptions,
    /// Which model is identified.
    pub model: ModelChoice,
    /// What else is fixed.
    pub conditions: Conditions,
    /// What the board's converters stand for.
    pub calibration: CalibrationOptions,
    /// What the model error is.
    pub cost: Cost,
    /// How models are searched.
    pub search: SearchOptions,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Every model that was identified, simplest first, as it was judged; of the chosen one alone with its traces.
    pub candidates: Vec<Candidate>,
    /// Models without an admissible candidate, and why.
    pub failed: Vec<(Model, CandidateError)>,
    /// Index of the chosen one.
    pub chosen: usize,
    /// Why it was chosen.
    pub reason: Reason,
    /// Why not to trust it.
    pub doubts: Vec<Doubt>,
    /// What every model is to better; `None` where the training voltage does not move.
    pub straight_line: Option<Baseline>,
    /// What every model was judged on.
    pub problem: Problem,
    /// The chosen model as it is delivered.
    pub learnt: Learnt,
}

impl Outcome {
    /// The chosen candidate as it was judged, learnt without what was held out.
    pub fn judged(&self) -> &Candidate {
        &self.candidates[self.chosen]
    }

    /// What the delivered table was learnt from.
    pub fn learnt_from(&self) -> &Problem {
        self.learnt.learnt_from(&self.problem)
    }
}

impl Job {
    /// Generations that it takes at most, for a progress bar.
    pub fn generations(&self) -> u64 {
        match self.model {
            ModelChoice::Is(model) => {
                let once_more = self.learns_once_more() && !model.is_voigt();
                let again = if once_more { self.search.generations_of(&[model]) } else { 0 };
                self.search.generations_of(&with_contained(model, self.search.start)) + again
            }
            ModelChoice::Auto => OF_ALL,
        }
    }

    /// Cuts and divides the logs, and decides zeros and delay from what is fitted to; from the whole of each where
    /// stretches of it are held out.
    ///
    /// # Errors
    /// A log cannot be used.
    pub fn prepare(&self) -> Result<Prepared, JobError> {
        self.prepare_parts(self.hold_out, None)
    }

    /// As [`prepare`](Self::prepare), with this fraction of each log held out, and a delay that was decided before.
    pub(crate) fn prepare_parts(&self, hold_out: f64, known_delay_ticks: Option<u32>) -> Result<Prepared, JobError> {
        let Parts { training, held_out, rests, in_turns } =
            Parts::of(&self.training, &self.held_out, hold_out, &self.prepare)?;
        let flaws = |log: &Log| if self.conditions.repair { flaws(log) } else { Vec::new() };
        let of_training: Vec<Vec<Flaw>> = training.iter().map(flaws).collect();
        let rows = training.iter().zip(&of_training).map(|(log, flaws)| sound(log, flaws));
        let mut recipe = self.prepare.resolve(&rows.collect::<Vec<_>>());
        let longest_s = (LONGEST_DELAY + LONGEST_LAG) * recipe.tick_s();
        if let Some(lag_s) = self.conditions.lag_s.filter(|lag_s| *lag_s > longest_s) {
            return Err(JobError::LagTooLong { lag_s, longest_s });
        }
        let estimated = match (self.prepare.delay, known_delay_ticks) {
            (AutoOr::Auto, None) => {
                let (of, seed) = (self.conditions, self.search.seed);
                Some(delay::estimate(&training, &of_training, &recipe, &self.prepare, of, seed)?)
            }
            _ => None,
        };
        if let Some(ticks) = known_delay_ticks.or(estimated.as_ref().map(|delay| delay.ticks)) {
            recipe.delay_ticks = ticks;
        }
        let uses = |logs: &[Log], role| logs.iter().map(|log| LogUse::new(log, role)).collect::<Vec<_>>();
        let mut beyond_repair = Vec::new();
        let mut session = |log: &Log, flaws: &[Flaw]| -> Result<Session, PrepareError> {
            let (session, left_out) = repaired(&recipe, log, flaws)?;
            if left_out.is_none() {
                beyond_repair.push(log.name.clone());
            }
            Ok(session)
        };
        let mut learnt_from: Vec<Session> =
            training.iter().zip(&of_training).map(|(log, flaws)| session(log, flaws)).collect::<Result<_, _>>()?;
        if let Some(falling) = learnt_from.iter().find(|session| falls(session)) {
            return Err(JobError::FallsWithVoltage { log: falling.name.clone() });
        }
        let mut validation: Vec<Session> =
            held_out.iter().map(|log| session(log, &flaws(log))).collect::<Result<_, _>>()?;
        let other_scale = other_scale(learnt_from.iter().chain(&validation)).map(Doubt::OtherScale);
        for (log, rest) in &rests {
            let mut session = session(log, &flaws(log))?;
            let learnt = rest.start_s - session.start_s;
            session.lead_in = session.instants.partition_point(|&instant| f64::from(instant) * session.tick_s < learnt);
            validation.push(session);
        }
        let held_out: Vec<Log> = held_out.into_iter().chain(rests.into_iter().map(|(_, rest)| rest)).collect();
        let mut logs = [uses(&training, Role::Training), uses(&held_out, Role::HeldOut)].concat();
        for (at, (session, log)) in learnt_from.iter_mut().zip(&training).enumerate().filter(|_| in_turns) {
            let (kept, held, stretches) = held_in_turns(session, hold_out);
            *session = kept;
            validation.push(held);
            logs[at].stretches = Some(stretches);
            logs.push(LogUse { stretches: Some(stretches), ..LogUse::new(log, Role::HeldOut) });
        }
        Ok(Prepared {
            problem: Problem::new(learnt_from, validation, self.conditions)
                .read_by(&self.calibration, recipe.voltage_zero_v),
            context: TableContext {
                recipe,
                calibration: self.calibration.clone(),
                logs: digest(&training, in_turns.then_some(hold_out)),
                seed: self.search.seed,
            },
            logs,
            of_logs: [self.estimates(), self.run_ahead(), self.flawed(&beyond_repair), Vec::from_iter(other_scale)]
                .concat(),
            of_delay: estimated.and_then(|delay| delay.doubt),
        })
    }

    /// Identifies the models, chooses one and doubts it.
    ///
    /// # Errors
    /// A log cannot be used, or the model that counts has no admissible candidate.
    pub fn run(&self, progress: Progress<'_>) -> Result<Outcome, JobError> {
        let prepared = self.prepare()?;
        prepared.teaches()?;
        let Prepared { problem, context, logs, of_logs, of_delay } = prepared;
        let identification = Identification { problem: &problem, cost: self.cost, options: &self.search, budget: None };
        let Choice { fits, chosen } = identification.choose(self.model, progress);
        let (model, mut reason) = chosen.ok_or(JobError::NothingFound)?;
        let (mut candidates, mut failed) = (Vec::new(), Vec::new());
        for fit in fits {
            let of = fit.model;
            match Candidate::new(&problem, fit, &context) {
                Ok(candidate) if of == model => candidates.push(candidate),
                Ok(candidate) => candidates.push(candidate.without_traces()),
                Err(error) => failed.push((of, error)),
            }
        }
        let Some(mut chosen) = candidates.iter().position(|candidate| candidate.table.model() == model) else {
            let why = failed.into_iter().find(|(failed, _)| *failed == model);
            return Err(why.map_or(JobError::NothingFound, |(model, source)| JobError::Failed { model, source }));
        };
        let mut learnt = self.learnt(&candidates[chosen], context.clone(), logs.clone(), progress)?;
        if reason != Reason::AskedFor && self.held_out.is_empty() {
            let learn = |candidate: &Candidate| self.learnt(candidate, context.clone(), logs, progress).ok();
            let first = (chosen, &learnt);
            if let Some(second) = second_choice(&identification, &context, &candidates, first, learn) {
                candidates[chosen] = candidates[chosen].clone().without_traces();
                candidates[second.chosen] = second.judged;
                (chosen, learnt, reason) = (second.chosen, second.learnt, second.reason);
            }
        }
        let learnt_from = learnt.learnt_from(&problem);
        let character = Character::of(learnt_from.training(), learnt_from.deadband);
        let of_model = doubts(&learnt.candidate, &candidates[chosen], &character, self.cost, self.conditions.lag_s);
        let mut doubts = [of_logs, of_model].concat();
        doubts.extend(of_delay);
        doubts.extend(self.implausible().map(Doubt::ImplausibleStroke));
        doubts.extend(self.calibration.assumed().map(|converters| Doubt::CalibrationAssumed { converters }));
        doubts.extend(learnt_from.baseline().and_then(|line| no_better(&learnt.candidate, &line)));
        doubts.sort_by_key(Doubt::rank);
        let straight_line = problem.baseline();
        Ok(Outcome { candidates, failed, chosen, reason, doubts, straight_line, problem, learnt })
    }

    /// Whether what was held out of the training logs is learnt from in the end.
    fn learns_once_more(&self) -> bool {
        self.hold_out > 0.0 && !self.as_judged
    }

    /// The judged candidate as it is delivered.
    fn learnt(
        &self,
        judged: &Candidate,
        context: TableContext,
        logs: Vec<LogUse>,
        progress: Progress<'_>,
    ) -> Result<Learnt, JobError> {
        if !self.learns_once_more() {
            return Ok(Learnt { candidate: judged.clone(), context, logs, whole: None });
        }
        let whole = |source| JobError::Whole { source: Box::new(source) };
        let wholes = self.prepare_parts(0.0, Some(context.recipe.delay_ticks)).map_err(whole)?;
        let identification =
            Identification { problem: &wholes.problem, cost: self.cost, options: &self.search, budget: None };
        let fit = identification.anew(&judged.fit, progress);
        let model = fit.model;
        Learnt::from_wholes(fit, wholes, judged, logs).map_err(|source| whole(JobError::Failed { model, source }))
    }

    /// A doubt for each log that is no sensor's.
    fn estimates(&self) -> Vec<Doubt> {
        let logs = self.training.iter().chain(&self.held_out).filter(|log| log.displacement_estimated);
        logs.map(|log| Doubt::EstimatedDisplacement { log: log.name.clone() }).collect()
    }

    /// A doubt for each training log whose displacement runs ahead of its voltage.
    fn run_ahead(&self) -> Vec<Doubt> {
        let of = |log: &Log| Some(Doubt::RunsAhead { log: log.name.clone(), by: ahead(&self.prepare.cut(log))? });
        self.training.iter().filter_map(of).collect()
    }

    /// A doubt for each kind of flaw of each log; of those that are `beyond_repair` nothing was left out.
    fn flawed(&self, beyond_repair: &[String]) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        for log in self.training.iter().chain(&self.held_out) {
            for (worst, count) in gravest(&flaws(&self.prepare.cut(log))) {
                let asked = worst.repairable() && self.conditions.repair;
                let most = asked && beyond_repair.contains(&log.name);
                doubts.push(Doubt::Flawed { log: log.name.clone(), worst, count, left_out: asked && !most, most });
            }
        }
        doubts
    }

    /// The stroke of the training logs without their flaws, where it is none of a piezo actuator's.
    fn implausible(&self) -> Option<Implausible> {
        let logs: Vec<_> = self.training.iter().map(|log| self.prepare.cut(log)).collect();
        let rows: Vec<_> = logs.iter().map(|log| sound(log, &flaws(log))).collect();
        let span = |of: fn(&Log) -> &[f64], scale: f64| {
            scale.abs() * Range::of_values(rows.iter().flat_map(|log| of(log)).copied()).span()
        };
        let stroke_um = span(|log| log.displacement.as_deref().unwrap_or_default(), self.prepare.displacement_scale);
        Implausible::of(stroke_um, span(|log| &log.voltage, self.prepare.voltage_scale))
    }
}

/// Callbacks of brief searches of all models and a long one, roughly, for a progress bar.
const OF_ALL: u64 = 1_200;

/// Start of a SHA-256 over the logs' digests and the part of each that was used: what was not held out in stretches,
/// where that is a fraction.
fn digest(logs: &[Log], held_in_turns: Option<f64>) -> Digest {
    let mut hash = Sha256::new();
    for log in logs {
        hash.update(&log.sha256);
        hash.update(log.start_s.to_le_bytes());
        hash.update((log.voltage.len() as u64).to_le_bytes());
    }
    if let Some(hold_out) = held_in_turns {
        hash.update(hold_out.to_le_bytes());
    }
    let hash = hash.finalize();
    Digest(std::array::from_fn(|byte| hash[byte]))
}
