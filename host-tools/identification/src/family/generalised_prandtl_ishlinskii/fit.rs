//! The least squares of one candidate: every session whole, from its first sample on, its start and its rest each with a
//! noise of its own.
//!
//! ```text
//! total = Σ_b ν_b·ln c_b / Σ_b ν_b       c_b mean square error of block b, µm²
//! ```
//!
//! Least squares weighs each block by 1/c_b, which are found by turns. What an unknown start leaves behind makes the start's
//! block loud, and it then says little. It is never believed to be quieter than its session's rest: a start at which nothing
//! moves, read by a coarse sensor, has no error at all. Each session has a constant of its own, for drift and for the sensor's zero.
//!
//! A session whose voltage moves from its first sample on may have begun in creep that nobody saw. What that leaves are decays,
//! Σ_t a_t·exp(−t/T_t), one for each element of creep. Their sizes are solved for, under a prior that is narrow and has wide
//! tails (Cauchy's): most such sessions begin at rest and have none, and where one has, they are large.

use super::basis::FUNCTIONS;
use super::candidate::{CREEP_TIMES, WORTH};
use super::columns::{COLUMNS, Stages};
use super::course::Course;
use least_squares::{Normal, Sign, Waiting};
use recordings::session::Session;

/// What the start's block counts beside the rest's: few periods, and the least certain.
const START: f64 = 0.3;
/// Turns between coefficients and noise.
const TURNS: usize = 3;
/// A part of the quietest block's noise that every block's is believed to have beside its own.
const QUIET: f64 = 0.1;
/// Scale of the prior of a decay's size, of the stroke.
const DECAY: f64 = 1e-3;
/// A decay whose time constant is more than so many times as long as its session is nothing but the session's constant.
const LONG: f64 = 5.0;
/// Least root mean square error that a block is believed to have, of the stroke.
const LEAST: f64 = 1e-4;
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

/// The coefficients that fit sessions best, each on its course; their stroke is `stroke` µm. `floor` is the least slope of the
/// reversible part, µm/V.
pub fn solve(sessions: &[(&Session, &Course)], stages: &Stages<'_>, stroke: f64, floor: f64) -> Option<Solution> {
    let mut blocks = Blocks::new(COLUMNS, sessions, stroke);
    for (number, (session, course)) in sessions.iter().enumerate() {
        let mut rows = blocks.of(number);
        stages.walk(session, course, |index, values, input| {
            let target = session.displacement[index] - floor * (input - stages.span.min);
            rows.add(session.instants[index], index < course.settled, values, target);
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
    /// Of the sessions' strokes, µm.
    stroke: f64,
    /// Time constants, in ticks, of the decays that each session begins with.
    decays: Vec<Vec<f64>>,
    blocks: Vec<Block>,
}

/// The start and the rest of a session that is being added.
pub struct Rows<'a> {
    to: &'a mut Vec<Block>,
    decays: &'a [f64],
    start: Block,
    rest: Block,
}

impl Rows<'_> {
    /// A reading: its tick, its columns, and what they are to make.
    pub fn add(&mut self, tick: u32, start: bool, values: &[f64], target: f64) {
        let own = std::iter::once(1.0).chain(self.decays.iter().map(|time| libm::exp(-f64::from(tick) / time)));
        (if start { &mut self.start } else { &mut self.rest }).add(values, own, target);
    }

    /// The session is whole.
    pub fn finish(self) {
        self.to.extend([self.start, self.rest].into_iter().filter_map(Block::finish));
    }
}

impl Blocks {
    /// For sessions that have so many columns in common, beside those that each has for itself, and a stroke (µm).
    pub fn new(common: usize, sessions: &[(&Session, &Course)], stroke: f64) -> Self {
        let decays = sessions.iter().map(|(session, course)| if course.at_rest { Vec::new() } else { decays(session) });
        Self { common, stroke, decays: decays.collect(), blocks: Vec::new() }
    }

    /// Where the readings of a session go, by its number.
    pub fn of(&mut self, session: usize) -> Rows<'_> {
        let before: usize = self.decays[..session].iter().map(Vec::len).sum();
        let decays = self.common + self.decays.len() + before;
        let own = [self.common + session].into_iter().chain(decays..decays + self.decays[session].len());
        let columns: Vec<usize> = (0..self.common).chain(own).collect();
        let [start, rest] = [true, false].map(|of_start| Block::new(columns.clone(), of_start));
        Rows { to: &mut self.blocks, decays: &self.decays[session], start, rest }
    }

    /// The coefficients of all blocks, each weighed by its own noise; `None` where they have none.
    pub fn balanced(&self, priors: &[Prior]) -> Option<Balanced> {
        let (sessions, decays) = (self.decays.len(), self.decays.iter().map(Vec::len).sum::<usize>());
        let columns = self.common + sessions + decays;
        let signs = [vec![Sign::NonNegative; self.common], vec![Sign::Free; sessions + decays]].concat();
        let scale = DECAY * self.stroke;
        let mut weights: Vec<f64> = self.blocks.iter().map(|block| block.share).collect();
        let mut found = vec![0.0; columns];
        let mut errors = Vec::new();
        for turn in 0..TURNS {
            let mut normal = Normal::new(columns).ridge(RIDGE);
            for (block, weight) in self.blocks.iter().zip(&weights) {
                normal.merge(&block.normal, &block.columns, weight / block.rows);
            }
            // At first the weights are no noises yet.
            let decays = (self.common + sessions..columns).map(|column| Prior {
                column,
                towards: 0.0,
                within: if turn > 1 { scale.hypot(found[column]) } else { scale },
                weight: 2.0 / WORTH,
            });
            for prior in decays.chain(priors.iter().copied()).filter(|_| turn > 0) {
                let mut row = vec![0.0; columns];
                row[prior.column] = 1.0 / prior.within;
                normal.add(&row, prior.towards / prior.within, prior.weight);
            }
            found = normal.solve(&signs)?;
            errors = self.errors(&found);
            let quietest = errors.iter().copied().fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
            let weigh = |(block, error): (&Block, &f64)| block.share / (error + QUIET * quietest);
            weights = self.blocks.iter().zip(&errors).map(weigh).collect();
        }
        let shares: f64 = self.blocks.iter().map(|block| block.share).sum();
        let logarithms = self.blocks.iter().zip(&errors).map(|(block, error)| block.share * libm::log(*error));
        let mut constants = found.split_off(self.common);
        let unlikely =
            constants.split_off(sessions).into_iter().map(|decay| libm::log1p((decay / scale) * (decay / scale)));
        let total = logarithms.sum::<f64>() / shares + 2.0 / WORTH * unlikely.sum::<f64>() / sessions as f64;
        total.is_finite().then_some(Balanced { found, constants, total })
    }
}

/// Time constants, in ticks, of the decays that a session may begin with.
fn decays(session: &Session) -> Vec<f64> {
    let longest = LONG * session.voltage.len() as f64;
    CREEP_TIMES.iter().map(|time| time / session.tick_s).filter(|ticks| (1.0..longest).contains(ticks)).collect()
}

impl Blocks {
    /// The mean square error that each block is believed to have, µm².
    fn errors(&self, found: &[f64]) -> Vec<f64> {
        let least = (LEAST * self.stroke) * (LEAST * self.stroke);
        let own: Vec<f64> = self.blocks.iter().map(|block| block.mean_square_error(found).max(least)).collect();
        // Behind a start stands the rest of its session, where there is any.
        let rest = |at: usize| if self.blocks[at].of_start { own.get(at + 1).copied().unwrap_or(0.0) } else { 0.0 };
        (0..own.len()).map(|at| own[at].max(rest(at))).collect()
    }
}

/// A part of a session: normal equations of the columns, of the session's constant and of its decays.
struct Block {
    normal: Normal,
    /// Where each of its columns stands among those of all sessions.
    columns: Vec<usize>,
    row: Vec<f64>,
    waiting: Waiting,
    rows: f64,
    share: f64,
    /// Whether it is a session's start, which the session's rest follows.
    of_start: bool,
}

impl Block {
    fn new(columns: Vec<usize>, of_start: bool) -> Self {
        let (normal, waiting) = (Normal::new(columns.len()), Waiting::of_weight(1.0));
        let share = if of_start { START } else { 1.0 };
        Self { normal, columns, row: Vec::new(), waiting, rows: 0.0, share, of_start }
    }

    fn add(&mut self, values: &[f64], own: impl Iterator<Item = f64>, target: f64) {
        self.row.clear();
        self.row.extend_from_slice(values);
        self.row.extend(own);
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
