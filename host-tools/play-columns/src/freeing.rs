//! What is [freed](crate::freed): weights and gains beside the functions that belong to them, and the least squares of
//! their steps.

use crate::basis::FUNCTIONS;
use crate::blocks::{Balanced, Blocks};
use crate::columns::Stages;
use crate::course::Course;
use crate::priors::{Prior, Scale};
use crate::solution::Solution;
use crate::{CREEPS, PLAYS, WORTH, creep};
use recordings::session::Session;

/// d, where the training has several amplitudes, and where it has one.
const SEVERAL: f64 = 0.05;
const ONE: f64 = 0.5;
/// A weight may be off by at least this part of the mean.
pub(crate) const LEAST: f64 = 0.3;
/// Deviation of the gains of two creep elements a decade apart from one another, of their mean.
const UNLIKE: f64 = 0.3;
/// The reversible part and each play.
const PARTS: usize = 1 + PLAYS;

/// Coefficients of each play's envelope, its weight in them, µm.
pub type Envelopes = [[f64; FUNCTIONS]; PLAYS];

/// What weights and gains are freed to.
pub struct Freed {
    /// Of each play.
    pub weights: [f64; PLAYS],
    /// Of each creep element.
    pub gains: [f64; CREEPS],
    /// Envelopes of the plays' own, which hold their weights; `None` where the solution's is that of all.
    pub own: Option<Envelopes>,
    /// What belongs to them.
    pub solution: Solution,
    /// Logarithm of the mean square error with a common envelope, and what is unlikely of weights and gains.
    pub cost: f64,
}

/// The readings of a session, each play on its own.
pub(crate) struct Readings {
    columns: Vec<[[f64; FUNCTIONS]; PARTS]>,
    /// What the sensor read, µm.
    targets: Vec<f64>,
}

/// What weights and gains are found in.
pub(crate) struct Freeing<'a> {
    pub sessions: &'a [(&'a Session, &'a Course)],
    /// With the plays' weights by their law, and the creep's gains as searched.
    pub stages: &'a Stages<'a>,
    pub scale: Scale,
    /// The least slope of the reversible part, µm/V.
    pub floor: f64,
    /// Whether gains are freed, too.
    pub creep: bool,
}

impl Freeing<'_> {
    /// The best functions for such weights and gains.
    pub fn at(&self, readings: &[Readings], weights: [f64; PLAYS], gains: [f64; CREEPS]) -> Option<Freed> {
        let found = self.solve(readings, &[], [2, 0], |_, _, plays, row| {
            row.extend(sum(plays, &weights));
            0.0
        })?;
        let solution = Solution::of(&found);
        let drawn = [&weights[..], &gains].concat();
        let unlikely = self.priors(0).map(|prior| prior.unlikely(&drawn));
        let cost = solution.total + unlikely.sum::<f64>() / self.sessions.len() as f64;
        Some(Freed { weights, gains, own: None, solution, cost })
    }

    /// Where the displacement's straight line at `best` has its least squares.
    pub fn step(&self, readings: &[Readings], best: &Freed) -> Option<([f64; PLAYS], [f64; CREEPS])> {
        let envelope = &best.solution.envelope;
        let crept = if self.creep { self.crept(&best.weights, envelope) } else { Vec::new() };
        let creeps = if self.creep { CREEPS } else { 0 };
        let priors: Vec<Prior> = self.priors(2 * FUNCTIONS).collect();
        let found = self.solve(readings, &priors, [2, PLAYS + creeps], |session, reading, plays, row| {
            let functions = sum(plays, &best.weights);
            let crept = crept.get(session).map_or(&[][..], |readings| &readings[reading]);
            row.extend(functions);
            row.extend(plays.iter().map(|play| dot(play, envelope)));
            row.extend(crept);
            // A product's straight line has it once for each factor.
            dot(&functions, envelope) + dot(crept, &best.gains)
        })?;
        let (weights, gains) = found.common()[2 * FUNCTIONS..].split_at(PLAYS);
        Some((weights.try_into().ok()?, gains.try_into().unwrap_or(best.gains)))
    }

    /// d: what a draw towards a law weighs beside a session.
    pub fn draw(&self) -> f64 {
        if self.scale.several_amplitudes { SEVERAL } else { ONE }
    }

    /// What draws weights and gains, whose first column is this one.
    fn priors(&self, first: usize) -> impl Iterator<Item = Prior> {
        let by_law = self.stages.plays.iter().map(|(_, weight)| *weight);
        let least = LEAST * by_law.clone().sum::<f64>() / PLAYS as f64;
        let weight = self.draw();
        let of_play = move |(play, towards): (usize, f64)| Prior {
            column: first + play,
            less: None,
            towards,
            within: towards.max(least),
            weight,
        };
        let within = UNLIKE * self.stages.creep.iter().map(|(_, gain)| gain).sum::<f64>() / CREEPS as f64;
        let of_creep = move |k: usize| Prior {
            column: first + PLAYS + k,
            less: Some(first + PLAYS + k - 1),
            towards: 0.0,
            within,
            weight: 1.0 / WORTH,
        };
        let creeps = if self.creep { 1..CREEPS } else { 0..0 };
        by_law.enumerate().map(of_play).chain(creeps.map(of_creep))
    }

    /// Each play a part of its own, of the weight 1, with creep of these gains.
    pub fn read(&self, gains: [f64; CREEPS]) -> Vec<Readings> {
        let (plays, creep) = (self.plays([1.0; PLAYS]), creep(gains));
        let stages = Stages { plays: &plays, creep: &creep, ..*self.stages };
        let of = |(session, course): &(&Session, &Course)| {
            let count = course.readings.len();
            let mut readings = Readings { columns: Vec::with_capacity(count), targets: Vec::with_capacity(count) };
            stages.walk(session, course, |index, columns, input| {
                readings.columns.push(*columns);
                let least = self.floor * (input - self.stages.span.min);
                readings.targets.push(session.displacement[index] - least);
            });
            readings
        };
        self.sessions.iter().map(of).collect()
    }

    /// The stages' plays with these weights.
    fn plays(&self, weights: [f64; PLAYS]) -> Vec<(f64, f64)> {
        self.stages.plays.iter().zip(weights).map(|(&(half_width, _), weight)| (half_width, weight)).collect()
    }

    /// What each creep element would add to each reading of each session at a gain of 1.
    fn crept(&self, weights: &[f64; PLAYS], envelope: &[f64]) -> Vec<Vec<[f64; CREEPS]>> {
        let plays = self.plays(*weights);
        let of = |(session, course): &(&Session, &Course)| {
            let mut crept = vec![[0.0; CREEPS]; course.readings.len()];
            let mut add = |gains: [f64; CREEPS], each: &mut dyn FnMut(&mut [f64; CREEPS], f64)| {
                let creep = creep(gains);
                let mut crept = crept.iter_mut();
                let stages = Stages { plays: &plays, creep: &creep, ..*self.stages };
                stages.walk(session, course, |_, columns: &[_; 2], _| {
                    if let Some(crept) = crept.next() {
                        each(crept, dot(&columns[1], envelope));
                    }
                });
            };
            add([0.0; CREEPS], &mut |crept, without| *crept = [-without; CREEPS]);
            for k in 0..CREEPS {
                let alone = std::array::from_fn(|of| if of == k { 1.0 } else { 0.0 });
                add(alone, &mut |crept, with| crept[k] += with);
            }
            crept
        };
        self.sessions.iter().map(of).collect()
    }

    /// The least squares of so many functions, the reversible part first, and of so many other columns. `columns` adds
    /// all but that part's to a row, by session, reading and the columns of the plays, and returns what its target has
    /// beside the sensor's reading.
    pub fn solve(
        &self,
        readings: &[Readings],
        priors: &[Prior],
        [functions, others]: [usize; 2],
        columns: impl Fn(usize, usize, &[[f64; FUNCTIONS]], &mut Vec<f64>) -> f64,
    ) -> Option<Balanced> {
        let mut blocks = Blocks::new(functions, others, self.sessions, self.scale);
        let mut row = Vec::new();
        for (number, (read, (session, course))) in readings.iter().zip(self.sessions).enumerate() {
            let mut rows = blocks.of(number);
            let of_readings = read.columns.iter().zip(&read.targets).zip(&course.readings).enumerate();
            for (reading, (([reversible, plays @ ..], &target), &index)) in of_readings {
                row.clear();
                row.extend_from_slice(reversible);
                let more = columns(number, reading, plays, &mut row);
                rows.add(session.instants[index], index < course.settled, &row, target + more);
            }
            rows.finish();
        }
        blocks.balanced(priors)
    }
}

/// The functions of all plays, each times its weight.
fn sum(plays: &[[f64; FUNCTIONS]], weights: &[f64; PLAYS]) -> [f64; FUNCTIONS] {
    std::array::from_fn(|function| weights.iter().zip(plays).map(|(weight, play)| weight * play[function]).sum())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
