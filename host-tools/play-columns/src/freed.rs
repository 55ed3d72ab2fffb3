//! The weights of the plays and the gains of the creep, freed from their laws as far as the logs say otherwise.
//!
//! ```text
//! minimise Σ_b c_b⁻¹·mse_b(q, e, a, γ) + d·Σ_i ((a_i − a⁰_i)/s_i)² + Σ_k ((γ_{k+1} − γ_k)/(0.3·mean γ⁰))²/20
//! a⁰_i = exp(−r_i/(ρR))·Δr_i/R,   s_i = max(a⁰_i, 0.3·mean a⁰)        all at least 0; γ⁰ as searched
//! ```
//!
//! by Gauss and Newton, all together: q and e coefficients of the two functions, a weights, γ gains; c_b are the
//! noises of the blocks (see [`Blocks`]). The law says how an actuator answers amplitudes that were not recorded; the
//! draw d towards it is weak where several were, and strong where there was one. Gains that lie evenly over log time
//! follow a creep that does not, or a rate dependence, only where they are wrong at other times. On eleven simulated
//! devices of other classes, learnt from several amplitudes, frequencies and a hold, all of it together leaves a sixth
//! less error on other recordings than weights and functions by turns beside searched gains; at best two thirds less,
//! at worst a tenth more.

use crate::basis::FUNCTIONS;
use crate::blocks::{Balanced, Blocks};
use crate::columns::Stages;
use crate::course::Course;
use crate::priors::{Prior, Scale};
use crate::solution::Solution;
use crate::{CREEPS, PLAYS, WORTH, creep};
use recordings::session::Session;

/// Most steps of Gauss and Newton with the creep's gains; without, one is as good as three.
const STEPS: usize = 6;
/// How often a step that makes it worse is halved.
const HALVED: usize = 3;
/// A step that gains less in the logarithm of the mean square error is the last.
const GAIN: f64 = 1e-3;
/// d, where the training has several amplitudes, and where it has one.
const SEVERAL: f64 = 0.05;
const ONE: f64 = 0.5;
/// A weight may be off by at least this part of the mean.
const LEAST: f64 = 0.3;
/// Deviation of the gains of two creep elements a decade apart from one another, of their mean.
const UNLIKE: f64 = 0.3;
/// The reversible part and each play.
const PARTS: usize = 1 + PLAYS;

/// What weights and gains are freed to.
pub struct Freed {
    /// Of each play.
    pub weights: [f64; PLAYS],
    /// Of each creep element.
    pub gains: [f64; CREEPS],
    /// What belongs to them.
    pub solution: Solution,
    /// Logarithm of the mean square error, and what is unlikely of weights and gains.
    pub cost: f64,
}

/// The readings of a session, each play on its own.
struct Readings {
    columns: Vec<[[f64; FUNCTIONS]; PARTS]>,
    /// What the sensor read, µm.
    targets: Vec<f64>,
}

/// What weights and gains are found in.
struct Freeing<'a> {
    sessions: &'a [(&'a Session, &'a Course)],
    /// With the plays' weights by their law, and the creep's gains as searched.
    stages: &'a Stages<'a>,
    scale: Scale,
    /// The least slope of the reversible part, µm/V.
    floor: f64,
    /// Whether gains are freed, too.
    creep: bool,
}

/// Frees the weights of the stages' plays, which are sought `from` these on, and the gains of their `creep` or not.
/// `floor` is the least slope of the reversible part, µm/V. `None` where the least squares have no solution, or the
/// stages have not [`PLAYS`] plays and [`CREEPS`] elements of creep.
pub fn freed(
    sessions: &[(&Session, &Course)],
    stages: &Stages<'_>,
    from: [f64; PLAYS],
    scale: Scale,
    floor: f64,
    creep: bool,
) -> Option<Freed> {
    let gains: Vec<f64> = stages.creep.iter().map(|(_, gain)| *gain).collect();
    let gains: [f64; CREEPS] = gains.try_into().ok().filter(|_| stages.plays.len() == PLAYS)?;
    let freeing = Freeing { sessions, stages, scale, floor, creep };
    let mut readings = freeing.read(gains);
    let mut best = freeing.at(&readings, from, gains)?;
    for _ in 0..if creep { STEPS } else { 1 } {
        let Some((weights, gains)) = freeing.step(&readings, &best) else { break };
        let mut part = 1.0;
        let mut better = None;
        for _ in 0..=HALVED {
            let between = |from: f64, to: f64| from + part * (to - from);
            let weights = std::array::from_fn(|i| between(best.weights[i], weights[i]));
            let gains: [f64; CREEPS] = std::array::from_fn(|k| between(best.gains[k], gains[k]));
            let others = (gains != best.gains).then(|| freeing.read(gains));
            let next = freeing.at(others.as_ref().unwrap_or(&readings), weights, gains);
            if let Some(next) = next.filter(|next| next.cost < best.cost) {
                better = Some((next, others));
                break;
            }
            part *= 0.5;
        }
        let Some((next, others)) = better else { break };
        let gained = best.cost - next.cost;
        best = next;
        readings = others.unwrap_or(readings);
        if gained < GAIN {
            break;
        }
    }
    Some(best)
}

impl Freeing<'_> {
    /// The best functions for such weights and gains.
    fn at(&self, readings: &[Readings], weights: [f64; PLAYS], gains: [f64; CREEPS]) -> Option<Freed> {
        let found = self.solve(readings, &[], [2, 0], |_, _, plays, row| {
            row.extend(sum(plays, &weights));
            0.0
        })?;
        let solution = Solution::of(&found);
        let drawn = [&weights[..], &gains].concat();
        let unlikely = self.priors(0).map(|prior| prior.unlikely(&drawn));
        let cost = solution.total + unlikely.sum::<f64>() / self.sessions.len() as f64;
        Some(Freed { weights, gains, solution, cost })
    }

    /// Where the displacement's straight line at `best` has its least squares.
    fn step(&self, readings: &[Readings], best: &Freed) -> Option<([f64; PLAYS], [f64; CREEPS])> {
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

    /// What draws weights and gains, whose first column is this one.
    fn priors(&self, first: usize) -> impl Iterator<Item = Prior> {
        let by_law = self.stages.plays.iter().map(|(_, weight)| *weight);
        let least = LEAST * by_law.clone().sum::<f64>() / PLAYS as f64;
        let weight = if self.scale.several_amplitudes { SEVERAL } else { ONE };
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
    fn read(&self, gains: [f64; CREEPS]) -> Vec<Readings> {
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
    fn solve(
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
