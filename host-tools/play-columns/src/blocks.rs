//! The least squares of columns and readings: every session whole, from its first sample on, its start and its rest
//! each with a noise of its own.
//!
//! ```text
//! total = Σ_b ν_b·ln c_b / Σ_b ν_b       c_b mean square error of block b, µm²
//! ```
//!
//! Least squares weighs each block by 1/c_b, which are found by turns. What an unknown start leaves behind makes the
//! start's block loud, and it then says little. It is never believed to be quieter than its session's rest: a start at
//! which nothing moves, read by a coarse sensor, has no error at all. Each session has a constant of its own, for drift
//! and for the sensor's zero.
//!
//! A session whose voltage moves from its first sample on may have begun in creep that nobody saw. What that leaves are
//! decays, Σ_t a_t·exp(−t/T_t), one for each element of creep. Their sizes are solved for, under a prior that is narrow
//! and has wide tails (Cauchy's): most such sessions begin at rest and have none, and where one has, they are large.

use crate::basis::FUNCTIONS;
use crate::course::Course;
use crate::priors::{Bend, Prior, Scale, bends};
use crate::{CREEP_TIMES, WORTH};
use least_squares::{Normal, Sign, Waiting};
use nalgebra::{DMatrix, DVector};
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

/// Coefficients under the blocks' own noises.
pub struct Balanced {
    /// Of the sessions' common columns, at least 0; then each session's constant, µm; then its decays.
    coefficients: Vec<f64>,
    /// How many columns are common, and how many sessions there are.
    counts: (usize, usize),
    /// What each block weighed when they were solved for.
    weights: Vec<f64>,
    /// Logarithm of the mean square errors, those of the blocks weighed.
    pub total: f64,
}

impl Balanced {
    /// Of the sessions' common columns, at least 0.
    pub fn common(&self) -> &[f64] {
        &self.coefficients[..self.counts.0]
    }

    /// Mean of the sessions' constants, µm.
    pub fn offset(&self) -> f64 {
        let (common, sessions) = self.counts;
        self.coefficients[common..common + sessions].iter().sum::<f64>() / sessions as f64
    }
}

/// The starts and the rests of some sessions.
pub struct Blocks {
    common: usize,
    /// So many functions of [`FUNCTIONS`] coefficients each are the first of the common columns.
    functions: usize,
    scale: Scale,
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
    /// For sessions that have in common the columns of so many functions, and so many others; each has some of its own.
    pub fn new(functions: usize, others: usize, sessions: &[(&Session, &Course)], scale: Scale) -> Self {
        let common = functions * FUNCTIONS + others;
        let decays = sessions.iter().map(|(session, course)| if course.at_rest { Vec::new() } else { decays(session) });
        Self { common, functions, scale, decays: decays.collect(), blocks: Vec::new() }
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
        let scale = DECAY * self.scale.stroke;
        let mut weights: Vec<f64> = self.blocks.iter().map(|block| block.share).collect();
        let mut balanced = Balanced {
            coefficients: vec![0.0; columns],
            counts: (self.common, sessions),
            weights: Vec::new(),
            total: f64::INFINITY,
        };
        let mut errors = Vec::new();
        for turn in 0..TURNS {
            let mut normal = self.weighed(&weights);
            // At first the weights are no noises yet.
            let within = |column| if turn > 1 { scale.hypot(balanced.coefficients[column]) } else { scale };
            let decays = (self.common + sessions..columns).map(|column| draw(column, within(column)));
            if turn > 0 {
                decays.chain(priors.iter().copied()).for_each(|prior| prior.add(&mut normal));
                self.bends().for_each(|bend| bend.add(&mut normal));
            }
            balanced.coefficients = normal.solve(&signs)?;
            errors = self.errors(&balanced.coefficients);
            let quietest = errors.iter().copied().fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
            let weigh = |(block, error): (&Block, &f64)| block.share / (error + QUIET * quietest);
            let next = self.blocks.iter().zip(&errors).map(weigh).collect();
            balanced.weights = std::mem::replace(&mut weights, next);
        }
        let shares: f64 = self.blocks.iter().map(|block| block.share).sum();
        let logarithms = self.blocks.iter().zip(&errors).map(|(block, error)| block.share * libm::log(*error));
        let decays = balanced.coefficients.iter().skip(self.common + sessions);
        let unlikely = decays.map(|decay| libm::log1p((decay / scale) * (decay / scale)));
        let bent = self.bends().map(|bend| bend.of(&balanced.coefficients)).map(|bend| bend * bend);
        let unlikely = 2.0 * unlikely.sum::<f64>() + bent.sum::<f64>();
        balanced.total = logarithms.sum::<f64>() / shares + unlikely / WORTH / sessions as f64;
        balanced.total.is_finite().then_some(balanced)
    }

    /// Slope and curvature of [`total`](Balanced::total) along the last `last` of these blocks' common columns: each is
    /// the change of the displacement with one searched number. `found` is of the same blocks without those columns:
    /// its coefficients above 0, and what each session has for itself, make up for the changes as far as they can.
    /// `None` where they have no answer.
    ///
    /// The curvature is that of Gauss and Newton: of the mean square errors, not of their logarithms.
    pub fn along(&self, found: &Balanced, last: usize) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let first = self.common - last;
        let (common, own) = found.coefficients.split_at(first);
        let coefficients = [common, &vec![0.0; last], own].concat();
        let decays = self.common + self.decays.len()..coefficients.len();
        let scale = DECAY * self.scale.stroke;
        let mut solved = self.weighed(&found.weights);
        for column in decays.clone() {
            draw(column, scale.hypot(coefficients[column])).add(&mut solved);
        }
        self.bends().for_each(|bend| bend.add(&mut solved));
        let making_up = (0..first).filter(|&i| coefficients[i] > 0.0).chain(self.common..coefficients.len());
        let changes: Vec<usize> = (first..self.common).collect();
        let combinations = solved.compensated(&changes, &making_up.collect::<Vec<_>>())?;
        let (mut slope, curvature) = self.weighed(&self.slopes(&coefficients)).along(&coefficients, &combinations);
        for column in decays {
            let decay = coefficients[column];
            let of_unlikely = 2.0 * decay / (scale * scale + decay * decay);
            slope += 2.0 / WORTH / self.decays.len() as f64 * of_unlikely * combinations.row(column).transpose();
        }
        for bend in self.bends() {
            let more = 2.0 / WORTH / self.decays.len() as f64 * bend.of(&coefficients);
            for (column, part) in bend.parts() {
                slope += more * part * combinations.row(column).transpose();
            }
        }
        Some((slope, curvature))
    }

    /// What the functions' slopes bend by.
    fn bends(&self) -> impl Iterator<Item = Bend> {
        bends(self.functions, self.scale)
    }

    /// The rows of all blocks, those of each weighing so much together.
    fn weighed(&self, weights: &[f64]) -> Normal {
        let own: usize = self.decays.iter().map(|decays| 1 + decays.len()).sum();
        let mut normal = Normal::new(self.common + own).ridge(RIDGE);
        for (block, weight) in self.blocks.iter().zip(weights) {
            normal.merge(&block.normal, &block.columns, weight / block.rows);
        }
        normal
    }

    /// What each block has to weigh for the sum of squares to change as the weighed logarithms do.
    fn slopes(&self, found: &[f64]) -> Vec<f64> {
        let errors: Vec<f64> = self.blocks.iter().map(|block| block.mean_square_error(found)).collect();
        let shares: f64 = self.blocks.iter().map(|block| block.share).sum();
        let mut weights: Vec<f64> = self.blocks.iter().map(|block| block.share / shares).collect();
        for at in 0..weights.len() {
            // A start that is believed to be as loud as its rest changes as that does.
            if self.blocks[at].of_start && errors.get(at + 1).is_some_and(|rest| *rest > errors[at]) {
                weights[at + 1] += std::mem::take(&mut weights[at]);
            }
        }
        // At the least that is believed nothing changes.
        let of = |(weight, error): (&f64, f64)| if error > self.least() { weight / error } else { 0.0 };
        weights.iter().zip(errors).map(of).collect()
    }

    /// The least mean square error that a block is believed to have, µm².
    fn least(&self) -> f64 {
        (LEAST * self.scale.stroke) * (LEAST * self.scale.stroke)
    }

    /// The mean square error that each block is believed to have, µm².
    fn errors(&self, found: &[f64]) -> Vec<f64> {
        let own = |block: &Block| block.mean_square_error(found).max(self.least());
        let own: Vec<f64> = self.blocks.iter().map(own).collect();
        // Behind a start stands the rest of its session, where there is any.
        let rest = |at: usize| if self.blocks[at].of_start { own.get(at + 1).copied().unwrap_or(0.0) } else { 0.0 };
        (0..own.len()).map(|at| own[at].max(rest(at))).collect()
    }
}

/// What draws a decay towards 0.
fn draw(column: usize, within: f64) -> Prior {
    Prior { column, less: None, towards: 0.0, within, weight: 2.0 / WORTH }
}

/// Time constants, in ticks, of the decays that a session may begin with.
fn decays(session: &Session) -> Vec<f64> {
    let longest = LONG * session.voltage.len() as f64;
    CREEP_TIMES.iter().map(|time| time / session.tick_s).filter(|ticks| (1.0..longest).contains(ticks)).collect()
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
