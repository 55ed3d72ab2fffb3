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
use least_squares::{Normal, Sign, Waiting};
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
    let mut blocks = Blocks::new(COLUMNS, sessions.len());
    for (number, (session, course)) in sessions.iter().enumerate() {
        let mut rows = blocks.of(number);
        stages.walk(session, course, |index, values, input| {
            let target = session.displacement[index] - floor * (input - stages.span.min);
            rows.add(index < course.settled, values, target);
        });
        rows.finish();
    }
    let Balanced { mut found, constants, total } = blocks.balanced(&[])?;
    let envelope = found.split_off(FUNCTIONS);
    let offset = constants.iter().sum::<f64>() / constants.len() as f64;
    Some(Solution { reversible: found, envelope, offset, total })
}

/// What a coefficient is drawn towards.
#[derive(Clone, Copy)]
pub struct Prior {
    /// Index of its column among the sessions' common ones.
    pub column: usize,
    /// The value that it is drawn towards.
    pub towards: f64,
    /// How far it may be from there, a standard deviation.
    pub within: f64,
    /// What the draw weighs beside a session.
    pub weight: f64,
}

/// Coefficients under the blocks' own noises.
pub struct Balanced {
    /// Of the sessions' common columns, at least 0.
    pub found: Vec<f64>,
    /// Of each session, µm.
    pub constants: Vec<f64>,
    /// Logarithm of the mean square errors, those of the blocks weighed.
    pub total: f64,
}

/// The starts and the rests of some sessions.
pub struct Blocks {
    common: usize,
    sessions: usize,
    blocks: Vec<Block>,
}

/// The start and the rest of a session that is being added.
pub struct Rows<'a> {
    to: &'a mut Vec<Block>,
    start: Block,
    rest: Block,
}

impl Rows<'_> {
    /// A reading: its columns, and what they are to make.
    pub fn add(&mut self, start: bool, values: &[f64], target: f64) {
        (if start { &mut self.start } else { &mut self.rest }).add(values, target);
    }

    /// The session is whole.
    pub fn finish(self) {
        self.to.extend([self.start, self.rest].into_iter().filter_map(Block::finish));
    }
}

impl Blocks {
    /// For sessions that have so many columns in common, beside the constant that each has.
    pub fn new(common: usize, sessions: usize) -> Self {
        Self { common, sessions, blocks: Vec::new() }
    }

    /// Where the readings of a session go, by its number.
    pub fn of(&mut self, session: usize) -> Rows<'_> {
        let columns: Vec<usize> = (0..self.common).chain([self.common + session]).collect();
        let [start, rest] = [START, 1.0].map(|share| Block::new(columns.clone(), share));
        Rows { to: &mut self.blocks, start, rest }
    }

    /// The coefficients of all blocks, each weighed by its own noise; `None` where they have none.
    pub fn balanced(&self, priors: &[Prior]) -> Option<Balanced> {
        let columns = self.common + self.sessions;
        let signs = [vec![Sign::NonNegative; self.common], vec![Sign::Free; self.sessions]].concat();
        let mut weights: Vec<f64> = self.blocks.iter().map(|block| block.share).collect();
        let mut found = Vec::new();
        let mut errors = Vec::new();
        for turn in 0..TURNS {
            let mut normal = Normal::new(columns).ridge(RIDGE);
            for (block, weight) in self.blocks.iter().zip(&weights) {
                normal.merge(&block.normal, &block.columns, weight / block.rows);
            }
            // At first the weights are no noises yet.
            for prior in priors.iter().filter(|_| turn > 0) {
                let mut row = vec![0.0; columns];
                row[prior.column] = 1.0 / prior.within;
                normal.add(&row, prior.towards / prior.within, prior.weight);
            }
            found = normal.solve(&signs)?;
            errors = self.blocks.iter().map(|block| block.mean_square_error(&found)).collect();
            let quietest = errors.iter().copied().fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
            let weigh = |(block, error): (&Block, &f64)| block.share / (error + QUIET * quietest);
            weights = self.blocks.iter().zip(&errors).map(weigh).collect();
        }
        let shares: f64 = self.blocks.iter().map(|block| block.share).sum();
        let logarithms = self.blocks.iter().zip(&errors).map(|(block, error)| block.share * libm::log(*error));
        let total = logarithms.sum::<f64>() / shares;
        let constants = found.split_off(self.common);
        total.is_finite().then_some(Balanced { found, constants, total })
    }
}

/// A part of a session: normal equations of the columns and of the session's constant.
struct Block {
    normal: Normal,
    /// Where each of its columns stands among those of all sessions.
    columns: Vec<usize>,
    row: Vec<f64>,
    waiting: Waiting,
    rows: f64,
    share: f64,
}

impl Block {
    fn new(columns: Vec<usize>, share: f64) -> Self {
        let (normal, waiting) = (Normal::new(columns.len()), Waiting::of_weight(1.0));
        Self { normal, columns, row: Vec::new(), waiting, rows: 0.0, share }
    }

    fn add(&mut self, values: &[f64], target: f64) {
        self.row.clear();
        self.row.extend_from_slice(values);
        self.row.push(1.0);
        self.waiting.add(&mut self.normal, &self.row, target);
        self.rows += 1.0;
    }

    /// With all its rows; `None` without any.
    fn finish(mut self) -> Option<Self> {
        self.waiting.finish(&mut self.normal);
        (self.rows > 0.0).then_some(self)
    }

    /// Of these coefficients of all sessions' columns.
    fn mean_square_error(&self, found: &[f64]) -> f64 {
        let own: Vec<f64> = self.columns.iter().map(|&column| found.get(column).copied().unwrap_or(0.0)).collect();
        self.normal.residual_sum(&own) / self.rows
    }
}
