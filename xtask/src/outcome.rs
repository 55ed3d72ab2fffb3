//! How checks went.

use serde::{Deserialize, Serialize};

use crate::{step::Step, stopwatch::Spent};

/// How a check went.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub enum Outcome {
    /// Nothing was wrong, after so much time.
    Passed(Spent),
    /// Something was, after so much time.
    Failed(Spent),
    /// It was asked to be left out.
    Skipped,
    /// One before it had failed.
    NotRun,
}

impl Outcome {
    /// Whether something was wrong.
    pub fn failed(&self) -> bool {
        matches!(self, Self::Failed(_))
    }

    /// The line of a check that went so.
    pub fn describe(&self, step: &Step) -> String {
        let name = step.name;
        match self {
            Self::Passed(spent) => format!("{name:9} {spent}  passed"),
            Self::Failed(spent) => format!("{name:9} {spent}  FAILED"),
            Self::Skipped => format!("{name:9} SKIPPED, by --skip"),
            Self::NotRun => format!("{name:9} NOT RUN, after a failure above"),
        }
    }
}

/// `N passed, N failed`, and how many were skipped if any were; those a failure kept from running count as skipped.
pub fn count(outcomes: &[Outcome]) -> String {
    let passed = outcomes.iter().filter(|outcome| matches!(outcome, Outcome::Passed(_))).count();
    let failed = outcomes.iter().filter(|outcome| outcome.failed()).count();
    let skipped = outcomes.len() - passed - failed;
    let mut line = format!("{passed} passed, {failed} failed");
    if skipped > 0 {
        line += &format!(", {skipped} skipped");
    }
    line
}
