//! The least squares of one candidate: every session whole, from its first sample on, its start and its rest each with a
//! noise of its own.
//!
//! ```text
//! total = Σ_b ν_b·ln c_b / Σ_b ν_b       c_b mean square error of block b, µm²
//! ```
//!
//! Least squares weighs each block by 1/c_b, which are found by turns. What an unknown start leaves behind makes the start's
//! block loud, and it then says little. Each session has a constant of its own, for drift and for the sensor's zero.

use super::basis::FUNCTIONS;
use super::columns::{COLUMNS, Stages};
use crate::family::projection::settled;
use least_squares::{Normal, Sign};
use recordings::session::Session;

/// What the start's block counts beside the rest's: few periods, and the least certain.
const START: f64 = 0.3;
/// Turns between coefficients and noise.
const TURNS: usize = 3;
/// A block is not believed to be quieter than this part of the quietest; it keeps one from deciding alone.
const QUIET: f64 = 0.1;
/// Most measured instants of a session that count; of more, every n-th.
const ROWS: usize = 4_000;
/// A ridge that is nothing but for columns that are alike.
const RIDGE: f64 = 1e-9;

/// What was found.
pub struct Solution {
    /// Coefficients of the functions of the reversible part, at least 0, µm.
    pub reversible: Vec<f64>,
    /// Of the envelope.
    pub envelope: Vec<f64>,
    /// Mean of the sessions' constants, µm.
    pub offset: f64,
    /// Logarithm of the mean square errors, those of the blocks weighed.
    pub total: f64,
}

/// The coefficients that fit sessions best. `floor` is the least slope of the reversible part, µm/V.
pub fn solve(sessions: &[&Session], stages: &Stages<'_>, floor: f64) -> Option<Solution> {
    let columns = COLUMNS + sessions.len();
    let mut blocks: Vec<Block> = Vec::new();
    for (number, session) in sessions.iter().enumerate() {
        let settled = settled(session);
        let stride = session.instants.len().div_ceil(ROWS);
        let mut start = Block::new(columns, START);
        let mut rest = Block::new(columns, 1.0);
        let mut row = vec![0.0; columns];
        row[COLUMNS + number] = 1.0;
        stages.walk(session, |index, values, input| {
            if index % stride == 0 || (index < settled && settled < ROWS) {
                row[..COLUMNS].copy_from_slice(values);
                let target = session.displacement[index] - floor * (input - stages.span.min);
                (if index < settled { &mut start } else { &mut rest }).add(&row, target);
            }
        });
        blocks.extend([start, rest].into_iter().filter(|block| block.rows > 0.0));
    }
    let signs = [vec![Sign::NonNegative; COLUMNS], vec![Sign::Free; sessions.len()]].concat();
    let mut weights: Vec<f64> = blocks.iter().map(|block| block.share).collect();
    let mut found = Vec::new();
    let mut errors = Vec::new();
    for _ in 0..TURNS {
        let mut normal = Normal::new(columns).ridge(RIDGE);
        blocks.iter().zip(&weights).for_each(|(block, weight)| normal.merge(&block.normal, weight / block.rows));
        found = normal.solve(&signs)?;
        errors = blocks.iter().map(|block| block.normal.residual_sum(&found) / block.rows).collect();
        let quietest = errors.iter().copied().fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
        weights = blocks.iter().zip(&errors).map(|(block, error)| block.share / (error + QUIET * quietest)).collect();
    }
    let shares: f64 = blocks.iter().map(|block| block.share).sum();
    let total = blocks.iter().zip(&errors).map(|(block, error)| block.share * libm::log(*error)).sum::<f64>() / shares;
    let constants = found.split_off(COLUMNS);
    let envelope = found.split_off(FUNCTIONS);
    let offset = constants.iter().sum::<f64>() / constants.len() as f64;
    total.is_finite().then_some(Solution { reversible: found, envelope, offset, total })
}

/// A part of a session.
struct Block {
    normal: Normal,
    rows: f64,
    share: f64,
}

impl Block {
    fn new(columns: usize, share: f64) -> Self {
        Self { normal: Normal::new(columns), rows: 0.0, share }
    }

    fn add(&mut self, row: &[f64], target: f64) {
        self.normal.add(row, target, 1.0);
        self.rows += 1.0;
    }
}
