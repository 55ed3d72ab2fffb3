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
use super::course::Course;
use least_squares::{Normal, Sign};
use recordings::session::Session;

/// What the start's block counts beside the rest's: few periods, and the least certain.
const START: f64 = 0.3;
/// Turns between coefficients and noise.
const TURNS: usize = 3;
/// A block is not believed to be quieter than this part of the quietest; it keeps one from deciding alone.
const QUIET: f64 = 0.1;
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

/// The coefficients that fit sessions best, each on its course. `floor` is the least slope of the reversible part, µm/V.
pub fn solve(sessions: &[(&Session, &Course)], stages: &Stages<'_>, floor: f64) -> Option<Solution> {
    let columns = COLUMNS + sessions.len();
    let mut blocks: Vec<Block> = Vec::new();
    for (number, (session, course)) in sessions.iter().enumerate() {
        let mut start = Block::new(number, START);
        let mut rest = Block::new(number, 1.0);
        stages.walk(session, course, |index, values, input| {
            let target = session.displacement[index] - floor * (input - stages.span.min);
            (if index < course.settled { &mut start } else { &mut rest }).add(values, target);
        });
        blocks.extend([start, rest].into_iter().filter_map(Block::finish));
    }
    let signs = [vec![Sign::NonNegative; COLUMNS], vec![Sign::Free; sessions.len()]].concat();
    let mut weights: Vec<f64> = blocks.iter().map(|block| block.share).collect();
    let mut found = Vec::new();
    let mut errors = Vec::new();
    for _ in 0..TURNS {
        let mut normal = Normal::new(columns).ridge(RIDGE);
        for (block, weight) in blocks.iter().zip(&weights) {
            normal.merge(&block.normal, &block.columns, weight / block.rows);
        }
        found = normal.solve(&signs)?;
        errors = blocks.iter().map(|block| block.mean_square_error(&found)).collect();
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

/// Rows that are added to the normal equations at once.
const TOGETHER: usize = 64;

/// A part of a session: normal equations of the columns and of the session's constant.
struct Block {
    normal: Normal,
    /// Where each of its columns stands among those of all sessions.
    columns: [usize; COLUMNS + 1],
    /// Rows that wait to be added, and their targets.
    waiting: (Vec<f64>, Vec<f64>),
    rows: f64,
    share: f64,
}

impl Block {
    /// Of the session with this number.
    fn new(session: usize, share: f64) -> Self {
        let columns = std::array::from_fn(|j| if j < COLUMNS { j } else { COLUMNS + session });
        Self { normal: Normal::new(columns.len()), columns, waiting: Default::default(), rows: 0.0, share }
    }

    fn add(&mut self, values: &[f64; COLUMNS], target: f64) {
        let (rows, targets) = &mut self.waiting;
        rows.extend_from_slice(values);
        rows.push(1.0);
        targets.push(target);
        self.rows += 1.0;
        if targets.len() == TOGETHER {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let (rows, targets) = &mut self.waiting;
        self.normal.add_all(rows, targets, 1.0);
        rows.clear();
        targets.clear();
    }

    /// With all its rows; `None` without any.
    fn finish(mut self) -> Option<Self> {
        self.flush();
        (self.rows > 0.0).then_some(self)
    }

    /// Of these coefficients of all sessions' columns.
    fn mean_square_error(&self, found: &[f64]) -> f64 {
        let own = self.columns.map(|column| found.get(column).copied().unwrap_or(0.0));
        self.normal.residual_sum(&own) / self.rows
    }
}
