//! The choice once more, where what was held out contradicts it.
//!
//! Cross-validation sees the part that is fitted to. Where that holds less than the rest, as where a log's amplitudes or
//! frequencies follow one another, the model that does best there may be far off elsewhere. The delivered table is learnt from the whole
//! logs, and so it may be chosen by them: the model that was chosen and the one that did best on what was held out are learnt from
//! them, and cross-validation in them decides between the two.

use crate::candidate::{Candidate, TableContext};
use crate::cross_validation::{CrossValidation, Undecided, eligible};
use crate::fit::{Fit, Identification};
use crate::learnt::Learnt;
use crate::model_choice::Reason;
use estimator_core::Model;

/// A model contradicts the choice where it was off on what was held out, without offset, by less than this part of what the chosen one was.
const CONTRADICTS: f64 = 0.67;

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

/// The second choice among candidates that were judged by `identification`, where it is another than the first, which `first` is as it
/// would be delivered; `learn` makes that of a candidate.
pub fn second_choice(
    identification: &Identification<'_>,
    context: &TableContext,
    candidates: &[Candidate],
    (chosen, first): (usize, &Learnt),
    learn: impl FnOnce(&Candidate) -> Option<Learnt>,
) -> Option<Second> {
    let whole = Identification { problem: first.whole.as_ref()?, ..*identification };
    let rival = rival(identification, candidates, chosen)?;
    let learnt = learn(&candidates[rival])?;
    let fits = [&first.candidate.fit, &learnt.candidate.fit].map(Clone::clone);
    let tried = eligible(whole.problem, whole.cost, &fits);
    let (model, validated) = match CrossValidation::of(&whole, &tried, || ()) {
        Ok(validated) => (validated.score().model, Some(validated)),
        Err(Undecided::ByFar) => (tried.iter().min_by(|(_, a), (_, b)| a.total_cmp(b))?.0.model, None),
        Err(Undecided::Undivided | Undecided::WithoutParts) => return None,
    };
    if model != candidates[rival].fit.model {
        return None;
    }
    let judged = Candidate::new(identification.problem, candidates[rival].fit.clone(), context).ok()?;
    let reason = Reason::OnceMore { validated, first: candidates[chosen].fit.model };
    Some(Second { chosen: rival, judged, learnt, reason })
}

/// The model that contradicts the choice on what was held out the most, of those that may be chosen.
fn rival(identification: &Identification<'_>, candidates: &[Candidate], chosen: usize) -> Option<usize> {
    let off = |candidate: &Candidate| candidate.held_out_figures().map(|figures| figures.mae_without_offset_um);
    let fits: Vec<Fit> = candidates.iter().map(|candidate| candidate.fit.clone()).collect();
    let eligible = eligible(identification.problem, identification.cost, &fits);
    let may_be_chosen: Vec<Model> = eligible.into_iter().map(|(fit, _)| fit.model).collect();
    let others = candidates.iter().enumerate().filter(|(_, candidate)| may_be_chosen.contains(&candidate.fit.model));
    let (rival, least) = others
        .filter_map(|(index, candidate)| Some((index, off(candidate)?)))
        .min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (least < CONTRADICTS * off(&candidates[chosen])?).then_some(rival)
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
