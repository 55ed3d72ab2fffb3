//! The model of a candidate, learnt once more.

use identification::{Candidate, CandidateError, Identification, Problem, SearchOptions, TableContext};

/// Numbers for which a device's search tries as many candidates: it begins where the actuator's ended, and fewer leave
/// some devices less well learnt than the actuator is, which widens the interval.
const OF_TWO: usize = 2;

/// The same model learnt from other sessions, or with another lag said, from where the candidate's search ended.
///
/// # Errors
/// What was found breaks a rule.
pub fn again(
    problem: &Problem,
    candidate: &Candidate,
    context: &TableContext,
    search: &SearchOptions,
) -> Result<Candidate, CandidateError> {
    let identification = Identification { problem, cost: candidate.fit.minimised, options: search, budget: None };
    Candidate::new(problem, identification.again(&candidate.fit, OF_TWO * search.evaluations as usize), context)
}
