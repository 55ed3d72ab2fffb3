//! The choice once more, where what was held out speaks against the first.
//!
//! Cross-validation sees the part that is fitted to. Where that holds less than the rest, as where half of a log is too
//! little to tell two models apart, the model that does best there may be far off elsewhere. The delivered table is
//! learnt from the whole logs, and so it may be chosen by them: where the first choice is far off on what was held out,
//! by another model's error there or by its own in training, it and the models that were nearest there are learnt from
//! the whole logs, and cross-validation in them decides.

use crate::candidate::{Candidate, TableContext};
use crate::cross_validation::{CrossValidation, OF_A_NUMBER, Undecided, eligible};
use crate::fit::{Fit, Identification};
use crate::learnt::Learnt;
use crate::model_choice::Reason;
use crate::suspicion::far;
use estimator_core::Model;

/// A model contradicts the first choice where it was off on what was held out, without offset, by less than this part
/// of what that was.
const CONTRADICTS: f64 = 0.67;
/// Models that were off there by no more than so many times what the first choice was are chosen among, and
const WITHIN: f64 = 2.0;
/// at most so many of them, the nearest.
const RIVALS: usize = 3;

/// What is delivered instead of what was chosen first.
pub struct Second {
    /// Its index among the candidates.
    pub chosen: usize,
    /// It as it was judged.
    pub judged: Candidate,
    /// It as it is delivered.
    pub learnt: Learnt,
    /// Why it is.
    pub reason: Reason,
}

/// The second choice among candidates that were judged by `identification`, where it is another than the first, which
/// `first` is as it would be delivered; `learn` makes that of a candidate.
pub fn second_choice(
    identification: &Identification<'_>,
    context: &TableContext,
    candidates: &[Candidate],
    (chosen, first): (usize, &Learnt),
    learn: impl FnOnce(&Candidate) -> Option<Learnt>,
) -> Option<Second> {
    let whole = Identification { problem: first.whole.as_ref()?, ..*identification };
    let rivals = rivals(identification, candidates, chosen)?;
    let again = |fit: &Fit| whole.again(fit, OF_A_NUMBER * fit.genes.len().max(1));
    let of_rivals = rivals.iter().map(|&rival| again(&candidates[rival].fit));
    let fits: Vec<Fit> = std::iter::once(first.candidate.fit.clone()).chain(of_rivals).collect();
    let tried = eligible(whole.problem, whole.cost, &fits);
    let (model, validated) = match CrossValidation::of(&whole, &tried, || ()) {
        Ok(validated) => (validated.score().model, Some(validated)),
        Err(Undecided::ByFar) => (tried.iter().min_by(|(_, a), (_, b)| a.total_cmp(b))?.0.model, None),
        Err(Undecided::Undivided | Undecided::WithoutParts) => return None,
    };
    let second = rivals.into_iter().find(|&rival| candidates[rival].fit.model == model)?;
    let learnt = learn(&candidates[second])?;
    let judged = Candidate::new(identification.problem, candidates[second].fit.clone(), context).ok()?;
    let reason = Reason::OnceMore { validated, first: candidates[chosen].fit.model };
    Some(Second { chosen: second, judged, learnt, reason })
}

/// The models among which the choice is made once more besides the first, of those that may be chosen; `None` where
/// nothing speaks against the first.
fn rivals(identification: &Identification<'_>, candidates: &[Candidate], chosen: usize) -> Option<Vec<usize>> {
    let (first, first_off) = (&candidates[chosen], candidates[chosen].held_out_off_um()?);
    let fits: Vec<Fit> = candidates.iter().map(|candidate| candidate.fit.clone()).collect();
    let eligible = eligible(identification.problem, identification.cost, &fits);
    let may_be_chosen: Vec<Model> = eligible.into_iter().map(|(fit, _)| fit.model).collect();
    let mut others: Vec<(usize, f64)> = candidates
        .iter()
        .enumerate()
        .filter(|&(index, candidate)| index != chosen && may_be_chosen.contains(&candidate.fit.model))
        .filter_map(|(index, candidate)| Some((index, candidate.held_out_off_um()?)))
        .collect();
    others.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let contradicted = others.first().is_some_and(|(_, least)| *least < CONTRADICTS * first_off);
    let training = first.training_off_um().unwrap_or(0.0);
    let untaught = far(training, first_off, identification.problem.stroke().span());
    let near = others.into_iter().take_while(|(_, off)| *off <= WITHIN * first_off).take(RIVALS);
    (contradicted || untaught).then(|| near.map(|(index, _)| index).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::Feedback;
    use crate::fixtures::session;
    use crate::problem::Problem;
    use crate::{Conditions, SearchOptions};
    use calibration::CalibrationOptions;
    use estimator_core::Digest;
    use recordings::prepare::PrepareOptions;
    use recordings::rig::{EXCITATIONS, Rig};

    /// What tables of a rig's logs hold besides what is identified.
    fn context() -> TableContext {
        let rig = Rig { duration: 0.6, ..Rig::default() };
        let recipe = PrepareOptions::default().resolve(&[rig.log(EXCITATIONS[0])]);
        TableContext { recipe, calibration: CalibrationOptions::default(), logs: Digest::default(), seed: 0 }
    }

    /// Of Voigt's model, which knows no loop of another amplitude, and one that does, each may be the first choice.
    #[test]
    fn what_was_held_out_overrules_a_first_choice_that_it_contradicts_and_no_other() {
        let sessions: Vec<_> = EXCITATIONS.into_iter().take(4).map(session).collect();
        let judged_on = Problem::new(sessions[..2].to_vec(), sessions[2..].to_vec(), Conditions::default());
        let whole = Problem::new(sessions, Vec::new(), Conditions::default());
        let options = SearchOptions { evaluations: 40, ..SearchOptions::default() };
        let on =
            |problem| Identification { problem, cost: Feedback::Simulation.into(), options: &options, budget: None };
        let context = context();
        let models = [Model::Voigt, Model::GeneralisedPrandtlIshlinskii];
        let candidates: Vec<Candidate> = on(&judged_on)
            .brief(&models, &mut |_, _| ())
            .into_iter()
            .map(|fit| Candidate::new(&judged_on, fit, &context).unwrap())
            .collect();
        let learn = |candidate: &Candidate| {
            let candidate = Candidate::new(&whole, candidate.fit.clone(), &context).ok()?;
            Some(Learnt { candidate, context: context.clone(), logs: Vec::new(), whole: Some(whole.clone()) })
        };
        let second = |chosen: usize| {
            let first = learn(&candidates[chosen]).unwrap();
            second_choice(&on(&judged_on), &context, &candidates, (chosen, &first), learn)
        };
        let of_voigt = second(0).unwrap();
        assert_eq!((of_voigt.chosen, of_voigt.learnt.candidate.fit.model), (1, models[1]));
        assert_eq!((of_voigt.judged.fit.model, of_voigt.judged.held_out.len()), (models[1], 2));
        assert!(matches!(of_voigt.reason, Reason::OnceMore { first: Model::Voigt, .. }), "{:?}", of_voigt.reason);
        assert!(second(1).is_none(), "nothing contradicts it");
    }
}
