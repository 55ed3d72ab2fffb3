//! Generalised Prandtl–Ishlinskii models: delay, lag, the law of the weights over the half-widths, creep and the memory at rest
//! are searched, and where the logs are fast enough slew limit and resonance; the slopes of the two functions are solved for.
//!
//! One law over the half-widths, a_i = exp(−r_i/(ρR))·Δr_i/R, is what makes a recording of one amplitude say something of
//! others. The search knows no other weights; those of its best candidate are then [freed] from the law as far as the logs
//! say so. What one recording cannot tell apart is drawn towards what actuators are like.

mod basis;
mod columns;
mod course;
mod fit;
mod freed;

use super::AnyFamily;
use crate::cost::{Cost, Feedback};
use crate::problem::Problem;
use crate::search::Gene;
use basis::{Basis, FUNCTIONS};
use columns::Stages;
use course::Course;
use estimator_core::{GeneralisedPrandtlIshlinskiiParameters, List, Parameters, Published, Range};
use fit::Solution;
use freed::{Freed, freed};
use log_survey::Character;
use recordings::session::Session;
use std::sync::Arc;

/// Play operators beside the reversible part.
const PLAYS: usize = 15;
/// The smallest half-width, of half the span.
const NARROWEST: f64 = 0.02;
/// Time constants of creep, s, a decade apart.
const CREEP_TIMES: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];
/// Least slope of the reversible part, of the stroke over the span: without any the inverse has no unique answer.
const FLOOR: f64 = 1e-3;

/// Periods that a recording is worth, for what weighs a prior against it.
const WORTH: f64 = 20.0;
/// Mean of the exponential prior of delay and lag, s: at a single frequency they do what hysteresis does.
const LATE: f64 = 2e-3;
/// Where somebody says what they are together, the prior is normal, with this part of it for a standard deviation, and half a
/// tick at least.
const SAID: f64 = 0.05;

/// Longest interval of readings, s, at which a resonance is looked for.
const SWINGS_S: f64 = 2e-3;
/// The highest natural frequency that is looked for, of the readings' frequency.
const HIGHEST: f64 = 0.45;

/// How far the voltage goes within this time, s, does not depend on how short the tick is, as it does at a step.
const SUSTAINED_S: f64 = 0.1;
/// The slowest slew limit that is searched, of that.
const SLOWEST: f64 = 0.05;

/// What the model has besides hysteresis, creep and lag.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extra {
    Nothing,
    Slew,
    Resonance,
}

/// What is fixed before the search.
struct Family {
    extra: Extra,
    /// Of the training sessions, in their order.
    courses: Arc<[Course]>,
    basis: Basis,
    span: Range<f64>,
    /// Half-widths, V, and Δr_i/R.
    plays: [(f64, f64); PLAYS],
    stroke: f64,
    tick: f64,
    /// The least from one reading of a session to the next, s.
    interval_s: f64,
    /// Slew limits that are searched, V/s.
    slews: Range<f64>,
}

/// Simplest first. A single frequency cannot tell a slew limit or a resonance from hysteresis; a log that is read too seldom shows
/// no resonance.
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

/// A candidate's values by name.
struct Values {
    delay_ticks: f64,
    lag_s: f64,
    /// ρ.
    law: f64,
    /// Gains of the fastest and of the slowest creep.
    creep: [f64; 2],
    rest_memory: f64,
    slew_v_per_s: f64,
    /// Hz and ζ; 0 without.
    resonance: [f64; 2],
}

impl Values {
    /// Minus twice the logarithm of the prior, for each of the periods that a recording is worth. `said_s`: what delay and lag are
    /// together, where somebody says so.
    fn unlikely(&self, tick: f64, said_s: Option<f64>) -> f64 {
        let [fast, slow] = self.creep.map(libm::log);
        let square = |x: f64| x * x;
        let late_s = self.delay_ticks * tick + self.lag_s;
        let late = said_s.map_or(late_s / LATE, |said| square((late_s - said) / (SAID * said).max(0.5 * tick))) / WORTH;
        let law = 0.06 * square(libm::log(self.law) + 0.8);
        let creep = 0.03 * square(fast - slow) + 0.025 * (square(fast + 4.0) + square(slow + 4.0));
        late + law + creep + 0.02 * square(self.rest_memory)
    }
}

impl Family {
    fn new(extra: Extra, courses: Arc<[Course]>, problem: &Problem) -> Self {
        let tick = problem.extent().tick;
        let span = problem.training_voltages();
        let radius = 0.5 * span.span();
        let half_width = |i: usize| libm::pow(NARROWEST, 1.0 - i as f64 / (PLAYS - 1) as f64);
        let before = |i: usize| if i == 0 { 0.0 } else { half_width(i - 1) };
        Self {
            extra,
            courses,
            basis: Basis::new(span),
            span,
            plays: std::array::from_fn(|i| (radius * half_width(i), half_width(i) - before(i))),
            stroke: problem.stroke().span(),
            tick,
            interval_s: problem.training().map(Session::interval_s).fold(f64::INFINITY, f64::min).max(tick),
            slews: slews(problem, tick),
        }
    }

    fn values(&self, values: &[f64]) -> Option<Values> {
        let mut values = values.iter().copied();
        let mut next = || values.next();
        Some(Values {
            delay_ticks: next()?,
            lag_s: next()? * self.tick,
            law: next()?,
            creep: [next()?, next()?],
            rest_memory: next()?,
            slew_v_per_s: if self.extra == Extra::Nothing { 0.0 } else { next()? },
            resonance: if self.extra == Extra::Resonance { [next()?, next()?] } else { [0.0, 0.0] },
        })
    }

    /// Half-width and weight of each play, by the law.
    fn weighed(&self, law: f64) -> [(f64, f64); PLAYS] {
        let radius = 0.5 * self.span.span();
        self.plays.map(|(r, share)| (r, libm::exp(-r / (law * radius)) * share))
    }

    /// Weight of each play, by the law.
    fn law(&self, values: &Values) -> [f64; PLAYS] {
        self.weighed(values.law).map(|(_, weight)| weight)
    }

    /// The gain of each creep element, between the fastest's and the slowest's.
    fn creep(&self, [fast, slow]: [f64; 2]) -> [(f64, f64); CREEP_TIMES.len()] {
        let last = (CREEP_TIMES.len() - 1) as f64;
        std::array::from_fn(|i| {
            let part = i as f64 / last;
            (CREEP_TIMES[i], (1.0 - part) * fast + part * slow)
        })
    }

    fn least_slope(&self) -> f64 {
        FLOOR * self.stroke / self.span.span()
    }

    fn stages<'a>(&'a self, values: &Values, plays: &'a [(f64, f64)], creep: &'a [(f64, f64)]) -> Stages<'a> {
        let [hertz, damping] = values.resonance;
        Stages {
            basis: &self.basis,
            span: self.span,
            delay_ticks: values.delay_ticks,
            lag_s: values.lag_s,
            slew_v_per_s: values.slew_v_per_s,
            plays,
            creep,
            rest_memory: values.rest_memory,
            resonance: (hertz > 0.0).then_some((hertz, damping)),
        }
    }

    fn solve(&self, values: &Values, problem: &Problem) -> Option<Solution> {
        let sessions = self.sessions(problem);
        let (plays, creep) = (self.weighed(values.law), self.creep(values.creep));
        fit::solve(&sessions, &self.stages(values, &plays, &creep), self.stroke, self.least_slope())
    }

    fn sessions<'a>(&'a self, problem: &'a Problem) -> Vec<(&'a Session, &'a Course)> {
        problem.training().zip(self.courses.iter()).collect()
    }

    /// The model whose plays weigh so much.
    fn parameters(&self, values: &Values, weights: [f64; PLAYS], solution: &Solution) -> Option<Parameters> {
        let floor = self.least_slope();
        let slopes = |coefficients: &[f64], floor: f64| {
            List::collect(self.basis.slopes(coefficients).map(|slope| (slope + floor).max(0.0) as f32))
        };
        let creep = self.creep(values.creep);
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
            reversible_um_per_v: slopes(&solution.reversible, floor)?,
            envelope_um_per_v: slopes(&solution.envelope, 0.0)?,
            half_widths_v: List::collect(self.plays.map(half_width))?,
            weights: List::collect(weights.map(|weight| weight as f32))?,
            creep_times_s: List::collect(CREEP_TIMES.map(|time| time as f32))?,
            creep_gains: List::collect(creep.map(|(_, gain)| gain as f32))?,
            rest_memory: values.rest_memory as f32,
            offset_um: solution.offset as f32,
        };
        parameters.check().is_ok().then_some(Parameters::GeneralisedPrandtlIshlinskii(parameters))
    }
}

/// Slew limits that are searched, V/s. The least is a part of what the training's voltage does in a tenth of a second, since a step is as
/// steep as the tick is short; in their middle, where a search begins, is the steepest tick, at which nothing is limited yet.
fn slews(problem: &Problem, tick: f64) -> Range<f64> {
    let within = |ticks: usize| {
        let changes = problem.training().flat_map(move |session| {
            let later = session.voltage.iter().skip(ticks);
            session.voltage.iter().zip(later).map(|(from, to)| (to - from).abs())
        });
        changes.fold(0.0, f64::max) / (ticks as f64 * tick)
    };
    let steepest = within(1).max(f64::MIN_POSITIVE);
    let least = SLOWEST * within((SUSTAINED_S / tick).ceil() as usize).clamp(1e-3 * steepest, steepest);
    Range { min: least, max: steepest * (steepest / least) }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        let mut genes = vec![
            Gene::linear("delay", "delay from voltage to actuator", "ticks", 0.0, 15.0),
            Gene::logarithmic("lag", "first-order lag", "ticks", 0.1, 100.0),
            Gene::logarithmic("rho", "half-width at which the plays weigh 1/e, of half the span", "", 0.05, 5.0),
            Gene::logarithmic("creep_fast", "gain of the creep in 0.01 s", "", 1e-4, 0.3),
            Gene::logarithmic("creep_slow", "gain of the creep in 100 s", "", 1e-4, 0.3),
            Gene::linear("memory", "memory at rest", "", 0.0, 1.0),
        ];
        if self.extra != Extra::Nothing {
            genes.push(Gene::logarithmic("slew", "slew limit", "V/s", self.slews.min, self.slews.max));
        }
        if self.extra == Extra::Resonance {
            let most = HIGHEST / self.interval_s;
            genes.push(Gene::logarithmic("resonance", "natural frequency", "Hz", 0.02 * most, most));
            genes.push(Gene::logarithmic("damping", "ζ of the resonance", "", 0.003, 0.7));
        }
        genes
    }

    /// Lags of half a tick, of five and of thirty.
    fn starts(&self) -> Vec<Vec<f64>> {
        [0.25, 0.55, 0.82].map(|lag| vec![0.1, lag, 0.45, 0.65, 0.65, 0.2]).to_vec()
    }

    /// Mean square errors of the sessions' blocks beside what actuators are like, whatever the cost of the search is.
    fn candidate(&self, values: &[f64], problem: &Problem, _cost: Cost) -> Option<(Parameters, f64)> {
        let values = self.values(values)?;
        let solution = self.solve(&values, problem)?;
        let found = self.parameters(&values, self.law(&values), &solution)?;
        Some((found, libm::exp(0.5 * (solution.total + values.unlikely(self.tick, problem.lag_s)))))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        Some(self.candidate(values, problem, Cost::from(Feedback::Simulation))?.0)
    }

    /// With weights freed from the law, where the logs give any.
    fn finish(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let values = self.values(values)?;
        let several = !Character::of(problem.training(), problem.deadband).single_amplitude();
        let law = self.solve(&values, problem)?;
        match freed(self, &values, &law, &self.sessions(problem), several) {
            Some(Freed { weights, solution }) => self.parameters(&values, weights, &solution),
            None => self.parameters(&values, self.law(&values), &law),
        }
    }

    fn solved(&self, _found: &Parameters) -> usize {
        2 * FUNCTIONS + PLAYS + ["offset"].len()
    }
}

#[cfg(test)]
mod tests;
