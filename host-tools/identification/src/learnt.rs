//! The chosen model as it is delivered: learnt once more from all of the training logs where parts of them were held
//! out to judge it.

use crate::candidate::{Candidate, CandidateError, TableContext};
use crate::fit::{Fit, Identification, Progress};
use crate::prepared::Prepared;
use crate::problem::Problem;
use estimator_core::{Provenance, Table};
use recordings::{LogUse, Role};

/// The table that a job delivers, and what it was learnt from.
#[derive(Clone, Debug)]
pub struct Learnt {
    /// The chosen model, with its errors on what it was learnt from now; of errors on what it had not seen its table
    /// states those of the judged one.
    pub candidate: Candidate,
    /// What its table holds besides.
    pub context: TableContext,
    /// What each log was used for.
    pub logs: Vec<LogUse>,
    /// Sessions of the whole logs; `None` where the judged candidate is what is delivered.
    pub whole: Option<Problem>,
}

impl Learnt {
    /// What its table was learnt from; `judged_on` is what the judged one was.
    pub fn learnt_from<'p>(&'p self, judged_on: &'p Problem) -> &'p Problem {
        self.whole.as_ref().unwrap_or(judged_on)
    }

    /// What was found on the whole logs; `judged_by` is what each log was used for when the candidate was judged.
    ///
    /// # Errors
    /// No table can be made of it.
    pub(crate) fn from_wholes(
        fit: Fit,
        wholes: Prepared,
        judged: &Candidate,
        judged_by: Vec<LogUse>,
    ) -> Result<Self, CandidateError> {
        let Prepared { problem, context, mut logs, .. } = wholes;
        let of_whole = |log: &LogUse| logs.iter().any(|of| of.role == Role::Training && of.sha256 == log.sha256);
        let parts: Vec<LogUse> =
            judged_by.into_iter().filter(|log| log.role == Role::HeldOut && of_whole(log)).collect();
        logs.extend(parts.into_iter().map(|log| LogUse { role: Role::JudgedThenLearnt, ..log }));
        let candidate = Candidate::new(&problem, fit, &context)?;
        let Provenance { validation_mae_um, validation_max_um, .. } = judged.table.provenance;
        let provenance = Provenance { validation_mae_um, validation_max_um, ..candidate.table.provenance };
        let table = Table { provenance, ..*candidate.table }.admit()?;
        Ok(Self { candidate: Candidate { table, ..candidate }, context, logs, whole: Some(problem) })
    }
}

/// What is learnt from more counts unless it is off by so many times as much: what is drawn to priors may be off more.
const AS_FAR: f64 = 1.1;

impl Identification<'_> {
    /// The model of a fit on more of the same logs: as if it had not been searched before, since what was held out may
    /// ask for another structure; of the Voigt family, whose search takes long, from where it ended. It is the fit
    /// itself where what is found is further off.
    pub(crate) fn anew(&self, fit: &Fit, progress: Progress<'_>) -> Fit {
        let found = match fit.model.is_voigt() {
            true => vec![self.again(fit, self.options.evaluations as usize * fit.genes.len())],
            false => self.run(&[fit.model], progress),
        };
        let no_worse = |found: &Fit| self.off(found) < self.off(fit) * if fit.model.is_voigt() { 1.0 } else { AS_FAR };
        found.into_iter().find(no_worse).unwrap_or_else(|| fit.clone())
    }
}
