//! The slopes of the two functions that fit some sessions best, the other stages given.

use crate::basis::FUNCTIONS;
use crate::blocks::{Balanced, Blocks};
use crate::columns::Stages;
use crate::course::Course;
use crate::priors::Scale;
use recordings::session::Session;

/// The weights that fit the sessions best, for one shape of the plays.
pub struct Solution {
    /// Coefficients of the functions of the reversible part, at least 0, µm.
    pub reversible: Vec<f64>,
    /// Coefficients of the functions of the envelope, at least 0, µm.
    pub envelope: Vec<f64>,
    /// Mean of the sessions' constants, µm.
    pub offset: f64,
    /// Logarithm of the mean square errors, those of the blocks weighed.
    pub total: f64,
}

impl Solution {
    /// Whose common columns are those of the reversible part, then those of the envelope.
    pub fn of(balanced: &Balanced) -> Self {
        let (reversible, envelope) = balanced.common().split_at(FUNCTIONS);
        Self {
            reversible: reversible.to_vec(),
            envelope: envelope.to_vec(),
            offset: balanced.offset(),
            total: balanced.total,
        }
    }
}

/// The coefficients that fit sessions best, each on its course; `None` where they have none. `floor` is the least slope
/// of the reversible part, µm/V.
pub fn solve(sessions: &[(&Session, &Course)], stages: &Stages<'_>, scale: Scale, floor: f64) -> Option<Solution> {
    let mut blocks = Blocks::new(2, 0, sessions, scale);
    for (number, (session, course)) in sessions.iter().enumerate() {
        let mut rows = blocks.of(number);
        stages.walk(session, course, |index, columns: &[_; 2], input| {
            let target = session.displacement[index] - floor * (input - stages.span.min);
            rows.add(session.instants[index], index < course.settled, columns.as_flattened(), target);
        });
        rows.finish();
    }
    Some(Solution::of(&blocks.balanced(&[])?))
}
