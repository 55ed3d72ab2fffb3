//! Cross-validation inside the training data: each model once more without a part of it, judged on that part.
//!
//! ```text
//! d_i = ln(error without part i / that of the best model)            i = 1 … n
//! s   = √(Σ (d_i − d̄)² / (n (n − 1)))                        standard error of the mean difference
//! ```
//!
//! What follows from these errors is [`crate::validate::score`]'s.

use crate::cost::Cost;
use crate::fit::{Fit, Identification};
use crate::left_out::{LeftOut, parts};
use crate::problem::{Problem, errors_once_settled};
use crate::trial::Trial;
use crate::validate::score::{Score, choose, difference};
use crate::validate::statistics::{geometric_mean, mean};
use estimator_core::Model;
use log_survey::Character;
use model_error::{errors_from, mean_size};
use rayon::prelude::*;
use recordings::session::Session;
use serde::Serialize;
use std::sync::{Mutex, PoisonError};

/// Candidates for each searched number, from where the fit to everything ended.
pub(crate) const OF_A_NUMBER: usize = 12;
/// A model that is off in the training, once settled and in simulation, by so many times the least is not tried:
/// without a part it will not be the best.
const HOPELESS: f64 = 6.0;
/// Models whose many weights no law ties to each other: a single amplitude teaches them its loop, and nothing beyond.
const FREE: [Model; 2] = [Model::Preisach, Model::Narx];

/// What cross-validation says.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct CrossValidation {
    /// What was left out.
    pub left_out: LeftOut,
    /// Every model that was tried, the least error first; never empty.
    pub scores: Vec<Score>,
    /// Index of the chosen one among them.
    pub chosen: usize,
    /// The training logs have several amplitudes, so that models of many free weights were tried.
    pub amplitudes: bool,
}

/// Why the least error in training decides instead.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Undecided {
    /// It is the least by far.
    ByFar,
    /// The training data are too short to leave a part out.
    Undivided,
    /// Without a part of the training data no model was found.
    WithoutParts,
}

impl CrossValidation {
    /// Of the fits to everything that may be chosen, as [`eligible`] says it of them.
    ///
    /// # Errors
    /// Why the least error in training decides: fewer than two could be the best, the data are too short to be divided,
    /// or without a part none is found.
    pub(crate) fn of(
        identification: &Identification<'_>,
        eligible: &[(&Fit, f64)],
        progress: impl FnMut() + Send,
    ) -> Result<Self, Undecided> {
        let problem = identification.problem;
        let least = eligible.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
        let tried: Vec<&Fit> =
            eligible.iter().filter(|(_, error)| *error <= HOPELESS * least).map(|(fit, _)| *fit).collect();
        let (left_out, parts) = parts(problem);
        if tried.len() < 2 {
            return Err(Undecided::ByFar);
        }
        if parts.len() < 2 {
            return Err(Undecided::Undivided);
        }
        let progress = Mutex::new(progress);
        let without = |part, fit| {
            let error = error(&Identification { problem: part, ..*identification }, left_out, fit);
            progress.lock().unwrap_or_else(PoisonError::into_inner)();
            error
        };
        let errors: Vec<Vec<f64>> =
            tried.par_iter().map(|fit| parts.par_iter().map(|part| without(part, fit)).collect()).collect();
        let mut scores: Vec<Score> = tried
            .iter()
            .zip(errors)
            .map(|(fit, parts_um)| Score {
                model: fit.model,
                parameters: fit.numbers(),
                error_um: geometric_mean(&parts_um),
                parts_um,
            })
            .filter(|score| score.error_um.is_finite())
            .collect();
        scores.sort_by(|a, b| a.error_um.total_cmp(&b.error_um));
        let chosen = choose(&scores).ok_or(Undecided::WithoutParts)?;
        Ok(Self { left_out, scores, chosen, amplitudes: several_amplitudes(problem) })
    }

    /// How many times as large as the best's a score's errors are, in the logarithm: the mean over the parts and
    /// its standard error.
    pub fn by(&self, score: &Score) -> (f64, f64) {
        self.scores.first().map_or((0.0, 0.0), |best| difference(score, best))
    }

    /// The chosen model's score.
    pub fn score(&self) -> &Score {
        &self.scores[self.chosen]
    }
}

/// The fits that may be chosen, admissible and of a model that the logs' amplitudes can determine, and how far each is
/// off in the training once it has settled, µm.
pub fn eligible<'f>(problem: &Problem, cost: Cost, fits: &'f [Fit]) -> Vec<(&'f Fit, f64)> {
    let amplitudes = several_amplitudes(problem);
    let eligible = fits.iter().filter(|fit| fit.cost.is_finite() && (amplitudes || !FREE.contains(&fit.model)));
    let off = |fit: &'f Fit| Some((fit, problem.error_once_settled(&fit.parameters?, cost)));
    eligible.filter_map(off).collect()
}

fn several_amplitudes(problem: &Problem) -> bool {
    !Character::of(problem.training(), problem.deadband).single_amplitude()
}

/// Of a model that is fitted without a part on that part, µm.
fn error(without: &Identification<'_>, what: LeftOut, fit: &Fit) -> f64 {
    let found = without.again(fit, OF_A_NUMBER * fit.genes.len().max(1));
    found.parameters.map_or(f64::INFINITY, |parameters| on_left_out(without.problem, what, &parameters, without.cost))
}

/// Simulation error on what a problem was left without in the norm of a cost, µm: on a whole log beside its own
/// constant, on a stretch of a log beside the constant of what was kept of it.
pub fn on_left_out(problem: &Problem, what: LeftOut, trial: &impl Trial, cost: Cost) -> f64 {
    let model = trial.model(&problem.discretisation());
    let on = |(out, kept): (&Session, Option<&Session>)| {
        let errors = errors_from(out.lead_in, out, model.clone());
        let constant = kept.map_or_else(|| mean(&errors), |kept| mean(&errors_once_settled(kept, &model)));
        mean_size(&errors, constant, cost.norm)
    };
    let kept = problem.training().map(Some).filter(|_| what == LeftOut::Blocks).chain(std::iter::repeat(None));
    let sizes: Vec<f64> = problem.validation().zip(kept).map(on).collect();
    cost.norm.error(mean(&sizes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::Feedback;
    use crate::fixtures::{duhem, session};
    use crate::{Conditions, SearchOptions};
    use recordings::rig::EXCITATIONS;

    fn search<'p>(problem: &'p Problem, options: &'p SearchOptions) -> Identification<'p> {
        Identification { problem, cost: Feedback::Simulation.into(), options, budget: None }
    }

    fn fit(model: Model, cost: f64) -> Fit {
        Fit {
            model,
            parameters: Some(duhem()),
            genes: Vec::new(),
            solved: 0,
            cost,
            minimised: Feedback::Simulation.into(),
            evaluations: 1,
            convergence: Vec::new(),
            structure: 0,
            space: None,
        }
    }

    #[test]
    fn on_one_amplitude_models_of_free_weights_neither_win_nor_set_the_measure() {
        let one = session(EXCITATIONS[1]);
        let fits = [fit(Model::Narx, 0.001), fit(Model::BoucWen, 0.1), fit(Model::Duhem, f64::INFINITY)];
        let models = |sessions: Vec<Session>| {
            let problem = Problem::new(sessions, Vec::new(), Conditions::default());
            eligible(&problem, Feedback::Simulation.into(), &fits).iter().map(|(fit, _)| fit.model).collect::<Vec<_>>()
        };
        assert_eq!(models(vec![one.clone()]), [Model::BoucWen]);
        let mut small = one.clone();
        small.voltage.iter_mut().for_each(|voltage| *voltage *= 0.3);
        assert_eq!(models(vec![one, small]), [Model::Narx, Model::BoucWen]);
    }

    #[test]
    fn whole_logs_are_left_out_where_there_are_three() {
        let sessions: Vec<Session> = EXCITATIONS.into_iter().take(3).map(session).collect();
        let problem = Problem::new(sessions, Vec::new(), Conditions::default());
        let options = SearchOptions { evaluations: 30, ..SearchOptions::default() };
        let search = search(&problem, &options);
        let fits = search.brief(&Model::ALL, &mut |_, _| ());
        assert_eq!(fits.len(), Model::ALL.len());
        let of = |models: [Model; 2]| {
            let fits: Vec<Fit> = fits.iter().filter(|fit| models.contains(&fit.model)).cloned().collect();
            CrossValidation::of(&search, &eligible(&problem, search.cost, &fits), || ())
        };
        let said = of([Model::PrandtlIshlinskii, Model::Duhem]).unwrap();
        assert_eq!((said.left_out, said.scores.len()), (LeftOut::Logs, 2));
        for score in &said.scores {
            assert_eq!((score.parts_um.len(), score.error_um), (3, geometric_mean(&score.parts_um)));
        }
        assert!(said.scores[0].error_um <= said.scores[1].error_um);
        let mut far = eligible(&problem, search.cost, &fits);
        far.retain(|(fit, _)| [Model::GeneralisedPrandtlIshlinskii, Model::Voigt].contains(&fit.model));
        far.iter_mut().filter(|(fit, _)| fit.model == Model::Voigt).for_each(|(_, off)| *off *= 10.0);
        let alone = CrossValidation::of(&search, &far, || ());
        assert_eq!(alone, Err(Undecided::ByFar), "one that has a chance is no choice");
    }

    #[test]
    fn logs_too_short_to_be_divided_are_told_from_a_model_far_ahead() {
        let mut short = session(EXCITATIONS[0]);
        short.instants.truncate(10);
        short.displacement.truncate(10);
        let problem = Problem::new(vec![short], Vec::new(), Conditions::default());
        let options = SearchOptions::default();
        let fits = [fit(Model::BoucWen, 0.1), fit(Model::Duhem, 0.1)];
        let tried = fits.each_ref().map(|fit| (fit, 0.1));
        let of = |count| CrossValidation::of(&search(&problem, &options), &tried[..count], || ()).unwrap_err();
        assert_eq!((of(2), of(1)), (Undecided::Undivided, Undecided::ByFar));
    }
}
