//! An envelope of its own for each play, freed from the common one as far as the logs say otherwise.
//!
//! ```text
//! minimise Σ_b c_b⁻¹·mse_b(q, e) + d/10·Σ_ij ((e_ij − a_i·e_j)/s_ij)²
//! s_ij = max(a_i·e_j, 0.3·mean a·e)        all at least 0
//! ```
//!
//! a_i and e_j are the weights and the common envelope found before, the creep's gains stay. What depends on half-
//! width and centre together, as a Preisach density may, no product of the two describes. On eleven simulated devices
//! of other classes, learnt from several amplitudes, frequencies and holds, it leaves a sixth less error on other
//! recordings; at best a fifth of it (relays whose centres lie the higher the wider their loops are), at worst a
//! twentieth more.

use crate::PLAYS;
use crate::basis::FUNCTIONS;
use crate::freeing::{Envelopes, Freed, Freeing, LEAST, Readings};
use crate::priors::Prior;
use crate::solution::Solution;

/// What the draw towards the common envelope weighs beside that of a weight towards its law: there are nine times as
/// many numbers.
const OF_A_WEIGHT: f64 = 0.1;

impl Freeing<'_> {
    /// The envelopes beside what was found with a common one, and the solution that belongs to them, whose envelope is
    /// still the common one; `None` where there is no hysteresis, or the least squares have no solution.
    pub(crate) fn own(&self, readings: &[Readings], found: &Freed) -> Option<(Envelopes, Solution)> {
        let common = &found.solution.envelope;
        let by_common = found.weights.iter().flat_map(|weight| common.iter().map(move |e| weight * e));
        let least = LEAST * by_common.clone().sum::<f64>() / (PLAYS * FUNCTIONS) as f64;
        if least == 0.0 {
            return None;
        }
        let weight = OF_A_WEIGHT * self.draw();
        let towards = |(function, towards): (usize, f64)| Prior {
            column: FUNCTIONS + function,
            less: None,
            towards,
            within: towards.max(least),
            weight,
        };
        let priors: Vec<Prior> = by_common.enumerate().map(towards).collect();
        let balanced = self.solve(readings, &priors, [1, PLAYS * FUNCTIONS], |_, _, plays, row| {
            row.extend(plays.as_flattened());
            0.0
        })?;
        let (reversible, own) = balanced.common().split_at(FUNCTIONS);
        let mut envelopes = [[0.0; FUNCTIONS]; PLAYS];
        envelopes.as_flattened_mut().copy_from_slice(own);
        let solution = Solution {
            reversible: reversible.to_vec(),
            envelope: common.clone(),
            offset: balanced.offset(),
            total: balanced.total,
        };
        Some((envelopes, solution))
    }
}
