//! A candidate: its values by name, their prior, and the stages of the model that follow from them and from what is
//! fixed before the search.

use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::Range;
use log_survey::Character;
use play_columns::{Basis, CREEPS, Course, PLAYS, Scale, Stages, WORTH};
use recordings::session::Session;
use std::sync::Arc;

/// The longest delay that is searched, ticks.
pub const LONGEST_DELAY: f64 = 15.0;
/// The longest lag behind it, ticks.
pub const LONGEST_LAG: f64 = 100.0;
/// Least slope of the reversible part, of the stroke over the span: without any the inverse has no unique answer.
const FLOOR: f64 = 1e-3;

/// Mode of the log-normal prior of delay and lag together, s, and its deviation towards longer ones, a factor of three:
/// at a single frequency they do what hysteresis does, and amplifiers that are loaded with an actuator have corners of
/// 100 Hz to 1 kHz.
const LATE: f64 = 5e-4;
const LATE_WITHIN: f64 = 1.1;
/// The deviation of shorter ones, a factor of ten: a monitor's voltage has the amplifier's corner behind it, and what
/// is left may be the tenth of a millisecond of a sensor.
const SOONER_WITHIN: f64 = 2.3;
/// Where somebody says what they are together, the prior is normal, with this part of it for a standard deviation, and
/// half a tick at least.
const SAID: f64 = 0.05;

/// The highest natural frequency that is looked for, of the readings' frequency.
const HIGHEST: f64 = 0.45;

/// How far the voltage goes within this time, s, does not depend on how short the tick is, as it does at a step.
const SUSTAINED_S: f64 = 0.1;
/// The searched coordinate that an idle limit leaves the model without.
pub const SLEW: &str = "slew";
/// The searched coordinate of which a log that begins amid a swing says nothing.
pub const MEMORY: &str = "memory";
/// The searched coordinates that freed gains take the place of.
pub const CREEP: [&str; 2] = ["creep_fast", "creep_slow"];
/// The slowest slew limit that is searched, of that.
const SLOWEST: f64 = 0.05;

/// What the model has besides hysteresis, creep and lag.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extra {
    Nothing,
    Slew,
    Resonance,
}

/// What is fixed before the search.
pub struct Family {
    pub extra: Extra,
    /// Of the training sessions, in their order.
    pub courses: Arc<[Course]>,
    pub basis: Basis,
    pub span: Range<f64>,
    /// Half-widths, V, and Δr_i/R.
    pub plays: [(f64, f64); PLAYS],
    pub scale: Scale,
    /// Creep gains that several frequencies or rests tell from a loop's width are freed in the end.
    pub frees_creep: bool,
    pub tick: f64,
    /// The least from one reading of a session to the next, s.
    pub interval_s: f64,
    /// Slew limits that are searched, V/s.
    pub slews: Range<f64>,
}

/// A candidate's values by name.
#[derive(Clone, Copy, Debug)]
pub struct Values {
    pub delay_ticks: f64,
    pub lag_s: f64,
    /// How slowly weights fall with the half-width r: exp(−r/(ρ·radius)).
    pub law: f64,
    /// Gains of the creep elements, fastest first.
    pub gains: [f64; CREEPS],
    pub rest_memory: f64,
    pub slew_v_per_s: f64,
    /// Hz and ζ; 0 without.
    pub resonance: [f64; 2],
}

impl Values {
    /// Minus twice the logarithm of the prior, for each of the periods that a recording is worth. `said_s`: what delay
    /// and lag are together, where somebody says so.
    pub fn unlikely(&self, tick: f64, said_s: Option<f64>) -> f64 {
        let [fast, slow] = [self.gains[0], self.gains[CREEPS - 1]].map(libm::log);
        let square = |x: f64| x * x;
        let late_s = self.delay_ticks * tick + self.lag_s;
        let longer = libm::log(late_s / LATE);
        let late = match said_s {
            Some(said) => square((late_s - said) / (SAID * said).max(0.5 * tick)),
            None => square(longer / if longer > 0.0 { LATE_WITHIN } else { SOONER_WITHIN }),
        } / WORTH;
        let law = 0.06 * square(libm::log(self.law) + 0.8);
        let creep = 0.03 * square(fast - slow) + 0.025 * (square(fast + 4.0) + square(slow + 4.0));
        late + law + creep + 0.02 * square(self.rest_memory)
    }
}

impl Family {
    pub fn new(extra: Extra, courses: Arc<[Course]>, problem: &Problem) -> Self {
        let character = Character::of(problem.training(), problem.deadband);
        let tick = problem.extent().tick;
        let span = problem.training_voltages();
        let radius = 0.5 * span.span();
        // Dense for small loops; no two much further apart than an eighth of the radius.
        let half_width = |i: usize| libm::pow((i + 1) as f64 / PLAYS as f64, 2.0);
        let before = |i: usize| if i == 0 { 0.0 } else { half_width(i - 1) };
        Self {
            extra,
            courses,
            basis: Basis::new(span),
            span,
            plays: std::array::from_fn(|i| (radius * half_width(i), half_width(i) - before(i))),
            scale: Scale { stroke: problem.stroke().span(), several_amplitudes: !character.single_amplitude() },
            frees_creep: !character.single_frequency() || character.rests(),
            tick,
            interval_s: problem.training().map(Session::interval_s).fold(f64::INFINITY, f64::min).max(tick),
            slews: slews(problem, tick),
        }
    }

    /// What is searched, in the order of its values.
    pub fn searched(&self) -> Vec<Gene> {
        let mut genes = vec![
            Gene::linear("delay", "delay from voltage to actuator", "ticks", 0.0, LONGEST_DELAY),
            Gene::logarithmic("lag", "first-order lag", "ticks", 0.1, LONGEST_LAG),
            Gene::logarithmic("rho", "half-width at which the plays weigh 1/e, of half the span", "", 0.05, 5.0),
            Gene::logarithmic(CREEP[0], "gain of the creep in 0.01 s", "", 1e-4, 0.3),
            Gene::logarithmic(CREEP[1], "gain of the creep in 100 s", "", 1e-4, 0.3),
            Gene::linear(MEMORY, "memory at rest", "", 0.0, 1.0),
        ];
        if self.extra != Extra::Nothing {
            genes.push(Gene::logarithmic(SLEW, "slew limit", "V/s", self.slews.min, self.slews.max));
        }
        if self.extra == Extra::Resonance {
            let most = HIGHEST / self.interval_s;
            genes.push(Gene::logarithmic("resonance", "natural frequency", "Hz", 0.02 * most, most));
            genes.push(Gene::logarithmic("damping", "ζ of the resonance", "", 0.003, 0.7));
        }
        genes
    }

    pub fn values(&self, values: &[f64]) -> Option<Values> {
        let mut values = values.iter().copied();
        let mut next = || values.next();
        Some(Values {
            delay_ticks: next()?,
            lag_s: next()? * self.tick,
            law: next()?,
            gains: gains([next()?, next()?]),
            rest_memory: next()?,
            slew_v_per_s: if self.extra == Extra::Nothing { 0.0 } else { next()? },
            resonance: if self.extra == Extra::Resonance { [next()?, next()?] } else { [0.0, 0.0] },
        })
    }

    /// Whether a training session begins at rest: others say nothing of the memory there.
    pub fn rests(&self) -> bool {
        self.courses.iter().any(|course| course.at_rest && course.settled > 0)
    }

    /// The training sessions, each with its course.
    pub fn sessions<'a>(&'a self, problem: &'a Problem) -> Vec<(&'a Session, &'a Course)> {
        problem.training().zip(self.courses.iter()).collect()
    }

    /// Half-width and weight of each play, by the law.
    pub fn weighed(&self, law: f64) -> [(f64, f64); PLAYS] {
        let radius = 0.5 * self.span.span();
        self.plays.map(|(r, share)| (r, libm::exp(-r / (law * radius)) * share))
    }

    /// Weight of each play, by the law.
    pub fn law(&self, values: &Values) -> [f64; PLAYS] {
        self.weighed(values.law).map(|(_, weight)| weight)
    }

    pub fn least_slope(&self) -> f64 {
        FLOOR * self.scale.stroke / self.span.span()
    }

    pub fn stages<'a>(&'a self, values: &Values, plays: &'a [(f64, f64)], creep: &'a [(f64, f64)]) -> Stages<'a> {
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
}

/// The gain of each creep element, evenly between the fastest's and the slowest's.
fn gains([fast, slow]: [f64; 2]) -> [f64; CREEPS] {
    std::array::from_fn(|i| {
        let part = i as f64 / (CREEPS - 1) as f64;
        (1.0 - part) * fast + part * slow
    })
}

/// Slew limits that are searched, V/s. The least is a part of what the training's voltage does in a tenth of a second,
/// since a step is as steep as the tick is short; in their middle, where a search begins, is the steepest tick, at
/// which nothing is limited yet.
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
