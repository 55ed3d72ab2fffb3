//! Generalised Prandtl–Ishlinskii models: delay, lag, the law of the weights over the half-widths, creep and the memory
//! at rest are searched, and where the logs are fast enough slew limit and resonance; the slopes of the two functions
//! are solved for.
//!
//! One law over the half-widths, a_i = exp(−r_i/(ρR))·Δr_i/R, is what makes a recording of one amplitude say something
//! of others. The search knows no other weights; those of its best, and its envelopes, are then
//! [freed](play_columns::freed) as far as the logs say so. What one recording cannot tell apart is drawn towards what
//! actuators are like.

mod candidate;
mod curvature;
mod late;

pub use candidate::{LONGEST_DELAY, LONGEST_LAG};
pub use late::Late;

use super::AnyFamily;
use crate::cost::{Cost, Feedback};
use crate::problem::Problem;
use crate::search::{Gene, Quadratic, halved, scaled};
use candidate::{CREEP, Extra, Family, MEMORY, SLEW, Values};
use estimator_core::{GeneralisedPrandtlIshlinskiiParameters, List, Parameters, Published, Range};
use log_survey::Character;
use play_columns::{CREEP_TIMES, CREEPS, Course, Envelopes, FUNCTIONS, Freed, PLAYS, Solution, creep, freed, solve};
use recordings::session::Session;
use std::sync::Arc;

/// The shortest of delay and lag together that is tried beside freed weights, ticks.
const SHORTEST: f64 = 0.1;
/// So often the memory at rest is looked for between what was tried of it, and so far from where it was found before.
const TURNS: usize = 4;
const NEAR: f64 = 0.25;
/// Rounds of lateness and memory at most, and what another must gain in the logarithm of the mean square error.
const ROUNDS: usize = 3;
const GAIN: f64 = 0.02;
/// A slew limit that makes the errors smaller by no more than this part of them is idle.
const IDLE: f64 = 0.03;

/// A slew limit or a resonance that is there makes the error several times less; by chance, or drift, a resonance far
/// above the logs had 4 % less.
const MUST_BETTER: f64 = 0.9;

/// Longest interval of readings, s, at which a resonance is looked for.
const SWINGS_S: f64 = 2e-3;

/// Simplest first. A single frequency cannot tell a slew limit or a resonance from hysteresis; a log that is read too
/// seldom shows no resonance.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    let single = Character::of(problem.training(), problem.deadband).single_frequency();
    let swings = problem.training().any(|session| session.interval_s() <= SWINGS_S);
    let extras: &[Extra] = match (single, swings) {
        (true, _) => &[Extra::Nothing],
        (false, false) => &[Extra::Nothing, Extra::Slew],
        (false, true) => &[Extra::Nothing, Extra::Slew, Extra::Resonance],
    };
    let courses: Arc<[Course]> = Course::of_all(problem.training(), problem.deadband).into();
    extras.iter().map(|&extra| Box::new(Family::new(extra, courses.clone(), problem)) as AnyFamily).collect()
}

impl Family {
    fn solve(&self, values: &Values, problem: &Problem) -> Option<Solution> {
        let sessions = self.sessions(problem);
        let (plays, creep) = (self.weighed(values.law), creep(values.gains));
        solve(&sessions, &self.stages(values, &plays, &creep), self.scale, self.least_slope())
    }

    /// Weights, sought `from` these on, and where it `creeps` the gains of the creep, as the logs have them.
    fn freed(
        &self,
        values: &Values,
        from: [f64; PLAYS],
        sessions: &[(&Session, &Course)],
        creeps: bool,
    ) -> Option<Freed> {
        let (plays, creep) = (self.weighed(values.law), creep(values.gains));
        freed(sessions, &self.stages(values, &plays, &creep), from, self.scale, self.least_slope(), creeps)
    }

    /// The same without a slew limit that makes the fit hardly better: one that did not act in the training would cut
    /// whatever is faster.
    fn without_idle_limit(&self, values: Values, problem: &Problem) -> Option<Values> {
        let without = Values { slew_v_per_s: 0.0, ..values };
        if values.slew_v_per_s == 0.0 {
            return Some(values);
        }
        let with = self.solve(&values, problem)?.total;
        let idle = self.solve(&without, problem).is_some_and(|without| without.total - with < 2.0 * IDLE);
        Some(if idle { without } else { values })
    }

    /// The model whose plays weigh so much, or have these envelopes of their `own`.
    fn parameters(
        &self,
        values: &Values,
        (weights, gains): ([f64; PLAYS], [f64; CREEPS]),
        own: Option<&Envelopes>,
        solution: &Solution,
    ) -> Option<Parameters> {
        let floor = self.least_slope();
        let slopes = |coefficients: &[f64], floor: f64| {
            self.basis.slopes(coefficients).map(|slope| (slope + floor).max(0.0) as f32)
        };
        let envelope = own.map_or(vec![&solution.envelope[..]], |own| own.iter().map(|of| &of[..]).collect());
        let [hertz, damping] = values.resonance;
        let span_v = Range { min: self.span.min as f32, max: self.span.max as f32 };
        // Its ends are rounded, so that half of it may be less than what half of the span is rounded to.
        let half_width = |(r, _): (f64, f64)| (r as f32).min(0.5 * span_v.span());
        let parameters = GeneralisedPrandtlIshlinskiiParameters {
            span_v,
            // The model's displacement is that of the next tick.
            delay_ticks: (values.delay_ticks - 1.0) as f32,
            slew_v_per_s: values.slew_v_per_s as f32,
            lag_s: values.lag_s as f32,
            resonance_hz: hertz as f32,
            damping: damping as f32,
            reversible_um_per_v: List::collect(slopes(&solution.reversible, floor))?,
            envelope_um_per_v: List::collect(envelope.into_iter().flat_map(|of| slopes(of, 0.0)))?,
            half_widths_v: List::collect(self.plays.map(half_width))?,
            weights: List::collect(own.map_or(weights, |_| [1.0; PLAYS]).map(|weight| weight as f32))?,
            creep_times_s: List::collect(CREEP_TIMES.map(|time| time as f32))?,
            creep_gains: List::collect(gains.map(|gain| gain as f32))?,
            rest_memory: values.rest_memory as f32,
            offset_um: solution.offset as f32,
        };
        parameters.check().is_ok().then_some(Parameters::GeneralisedPrandtlIshlinskii(parameters))
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        self.searched()
    }

    /// Lags of half a tick, of five and of thirty.
    fn starts(&self) -> Vec<Vec<f64>> {
        [0.25, 0.55, 0.82].map(|lag| vec![0.1, lag, 0.45, 0.65, 0.65, 0.2]).to_vec()
    }

    /// Mean square errors of the sessions' blocks beside what actuators are like, whatever the cost of the search is.
    fn candidate(&self, values: &[f64], problem: &Problem, _cost: Cost) -> Option<(Parameters, f64)> {
        let values = self.values(values)?;
        let solution = self.solve(&values, problem)?;
        let found = self.parameters(&values, (self.law(&values), values.gains), None, &solution)?;
        Some((found, libm::exp(0.5 * (solution.total + values.unlikely(self.tick, problem.lag_s)))))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        Some(self.candidate(values, problem, Cost::from(Feedback::Simulation))?.0)
    }

    /// Without what did not act, and with weights freed from the law, where the logs give any. What the law misses
    /// looks like a lag and a memory at rest: both are found once more beside weights of their own. Logs of which none
    /// begins at rest say nothing of that memory, and it is the one between a rise's and a fall's. In the end creep's
    /// gains and the plays' envelopes are freed; one frequency says no more of them than how wide its loop is.
    fn finish(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let sessions = self.sessions(problem);
        let (rests, mut values) = (self.rests(), self.values(values)?);
        if !rests {
            values.rest_memory = 0.0;
        }
        let values = self.without_idle_limit(values, problem)?;
        let tried = |values: Values| {
            let freed = self.freed(&values, self.law(&values), &sessions, false)?;
            let cost = freed.cost + values.unlikely(self.tick, problem.lag_s);
            Some((Tried { values, freed, cost }, cost))
        };
        let (mut best, _) = tried(values)?;
        // Either is found at what the other was, until that gains no more.
        for turn in 0..ROUNDS {
            let before = best.cost;
            best = later(&best.values, self.tick, tried).unwrap_or(best);
            best = rests.then(|| remembering(&best.values, turn, tried)).flatten().unwrap_or(best);
            if !rests || before - best.cost < GAIN {
                break;
            }
        }
        let Tried { values, freed, .. } = best;
        let creeping = self.frees_creep.then(|| self.freed(&values, freed.weights, &sessions, true)).flatten();
        let Freed { weights, gains, own, solution, .. } = creeping.unwrap_or(freed);
        self.parameters(&values, (weights, gains), own.as_ref(), &solution)
    }

    fn has(&self, gene: &Gene, found: &Parameters) -> bool {
        let Parameters::GeneralisedPrandtlIshlinskii(of) = found else { return true };
        match gene.name {
            SLEW => of.slew_v_per_s > 0.0,
            MEMORY => self.rests(),
            name if CREEP.contains(&name) => !self.frees_creep,
            _ => true,
        }
    }

    fn must_better(&self) -> f64 {
        MUST_BETTER
    }

    fn smooth(&self) -> bool {
        true
    }

    fn quadratic(&self, at: &[f64], problem: &Problem) -> Option<Quadratic> {
        curvature::quadratic(self, at, problem)
    }

    /// Envelopes of the plays' own are drawn to the common one, and count as that.
    fn solved(&self, _found: &Parameters) -> usize {
        2 * FUNCTIONS + PLAYS + ["offset"].len() + if self.frees_creep { CREEPS } else { 0 }
    }
}

/// What was found beside freed weights.
struct Tried {
    values: Values,
    freed: Freed,
    cost: f64,
}

/// Delay and lag together: what the law misses of small loops' width looks like one where only small
/// amplitudes were fast.
fn later(values: &Values, tick_s: f64, tried: impl Fn(Values) -> Option<(Tried, f64)>) -> Option<Tried> {
    let least = SHORTEST / (values.delay_ticks + values.lag_s / tick_s);
    let of =
        |scale: f64| tried(Values { delay_ticks: scale * values.delay_ticks, lag_s: scale * values.lag_s, ..*values });
    scaled(least, of).map(|(_, best)| best)
}

/// The memory at rest: how wide plays weigh shows in the first rise alone, and by the law it makes up for that. At
/// first anywhere, then near what it was.
fn remembering(values: &Values, turn: usize, tried: impl Fn(Values) -> Option<(Tried, f64)>) -> Option<Tried> {
    let found = values.rest_memory;
    let (mut points, turns) = match turn {
        0 => (vec![-2.0, -1.0, 0.0, found, 1.0], TURNS),
        _ => ([-NEAR, 0.0, NEAR].map(|by| (found + by).clamp(-2.0, 1.0)).to_vec(), TURNS / 2),
    };
    points.sort_by(f64::total_cmp);
    halved(&points, turns, |rest_memory| tried(Values { rest_memory, ..*values }))
}

#[cfg(test)]
mod freed_tests;
#[cfg(test)]
mod tests;
