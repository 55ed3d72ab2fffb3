//! What the displacement of a generalised Prandtl–Ishlinskii model is a sum of, along a session.
//!
//! The model's own stages, with a basis where the model has its two functions: its displacement is the weighted sum of
//! these columns (the test `what_is_found_is_what_the_model_runs` holds that). Voltage and sensor are taken at the same
//! instant: what the model predicts ahead of the voltage is not the fit's concern, and would bend the hysteresis.

use crate::basis::{Basis, FUNCTIONS, Values};
use crate::course::Course;
use estimator_core::model::{RampLag, RampLagged, play};
use estimator_core::{Range, Resonance, ResonanceState};
use pulp::{Arch, NullaryFnOnce};
use recordings::session::Session;

/// What is given before the columns are.
pub struct Stages<'a> {
    /// The functions that the columns belong to.
    pub basis: &'a Basis,
    /// What they are laid out over, V.
    pub span: Range<f64>,
    /// Ticks from voltage to actuator.
    pub delay_ticks: f64,
    /// First-order lag, s; 0 for none.
    pub lag_s: f64,
    /// Fastest change, V/s; 0 for no limit.
    pub slew_v_per_s: f64,
    /// Half-width (V) and weight of each play.
    pub plays: &'a [(f64, f64)],
    /// Time constant (s) and gain of each creep element.
    pub creep: &'a [(f64, f64)],
    /// Memory at rest, −2 … 1, as the model's parameter has it.
    pub rest_memory: f64,
    /// Frequency (Hz) and damping of what the sum goes through.
    pub resonance: Option<(f64, f64)>,
}

/// Lag, creep and slew limit for a step of one length.
struct Dynamics {
    /// Length of the step, s.
    period: f64,
    lag: RampLag<f64>,
    /// k and β ([`RampLag`]) and gain of each creep element.
    creep: Vec<(f64, f64, f64)>,
    /// V; infinite without a limit.
    most: f64,
    resonance: Option<Resonance<f64>>,
}

/// What the walk remembers of so many parts, of which the first, the reversible one, neither drives creep nor creeps.
struct Memory<const N: usize> {
    input: RampLagged<f64>,
    /// Half-width, weight and memory of each play.
    plays: Vec<(f64, f64, f64)>,
    /// What drove the creep a step ago.
    driven: [Values; N],
    /// Output of each creep element.
    creep: Vec<[Values; N]>,
    swings: Option<[[ResonanceState<f64>; FUNCTIONS]; N]>,
    /// Of the step before, s.
    period: f64,
}

impl Stages<'_> {
    /// Hands over the index of each reading on a session's course, its columns (µm for coefficients of 1) and the input
    /// behind lag and delay (V), from the session's first sample on. Between two steps the voltage of a log slower than
    /// the tick runs straight, as every stage takes it to.
    ///
    /// The columns are those of `N` parts, two at least: the reversible one, then `N` − 1 hysteretic ones with their
    /// creep, each of as many of the plays, in their order, the last perhaps of fewer. Creep and resonance are linear,
    /// so that the parts add up to the model's.
    pub fn walk<const N: usize>(
        &self,
        session: &Session,
        course: &Course,
        each: impl FnMut(usize, &[[f64; FUNCTIONS]; N], f64),
    ) {
        const { assert!(N > 1, "the reversible part, and a hysteretic one") };
        // Wider instructions where the machine has them; each column's are the same.
        Arch::new().dispatch(Walk { stages: self, session, course, each });
    }

    #[inline(always)]
    fn walk_each<const N: usize>(
        &self,
        session: &Session,
        course: &Course,
        mut each: impl FnMut(usize, &[Values; N], f64),
    ) {
        let Some(&first) = session.voltage.first() else { return };
        let rest = session.rested_v.unwrap_or(first);
        let mut memory = self.rest(rest, session.tick_s);
        let mut paces = Paces { stages: self, tick_s: session.tick_s, known: Vec::new() };
        // A jump at the first sample is one, and no ramp towards the second.
        let jump = self.delay_ticks as u32 + 2;
        // A delay of no whole ticks has a jump of the voltage begin within one tick and end in the next.
        let late = [self.delay_ticks.floor(), self.delay_ticks.ceil()].map(|ticks| ticks as u32);
        let mut corners = course.corners.iter().flat_map(|tick| late.map(|late| tick + late)).peekable();
        let mut columns = self.step(&mut memory, paces.of(1), self.delayed(&session.voltage, 0.0, rest));
        let mut tick = 0;
        for &index in &course.readings {
            let instant = session.instants[index];
            while tick < instant {
                while corners.next_if(|&corner| corner <= tick).is_some() {}
                let next = if tick < jump { tick + 1 } else { corners.peek().map_or(instant, |&at| at.min(instant)) };
                let target = self.delayed(&session.voltage, f64::from(next), rest);
                columns = self.step(&mut memory, paces.of(next - tick), target);
                tick = next;
            }
            each(index, &columns, memory.input.value());
        }
    }

    /// The voltage behind the delay at a tick.
    fn delayed(&self, voltage: &[f64], tick: f64, rest: f64) -> f64 {
        let at = tick - self.delay_ticks;
        let whole = at.floor();
        let value = |tick: f64| if tick < 0.0 { rest } else { voltage.get(tick as usize).copied().unwrap_or(rest) };
        let lower = value(whole);
        lower + (at - whole) * (value(whole + 1.0) - lower)
    }

    fn dynamics(&self, period: f64) -> Dynamics {
        Dynamics {
            period,
            lag: RampLag::build(self.lag_s, period),
            creep: self.creep.iter().map(|&(time, gain)| element(time, gain, period)).collect(),
            most: if self.slew_v_per_s > 0.0 { self.slew_v_per_s * period } else { f64::INFINITY },
            resonance: self.resonance.map(|(hertz, damping)| Resonance::build(hertz, damping, period)),
        }
    }

    fn rest<const N: usize>(&self, voltage: f64, period: f64) -> Memory<N> {
        let plays: Vec<_> = self.plays.iter().map(|&(r, weight)| (r, weight, self.rested(voltage, r))).collect();
        let driven = self.hysteretic(&plays);
        let creep = vec![driven; self.creep.len()];
        Memory { input: RampLagged::at(voltage), plays, driven, creep, swings: None, period }
    }

    /// Of each hysteretic part, behind the reversible one's place.
    #[inline(always)]
    fn hysteretic<const N: usize>(&self, plays: &[(f64, f64, f64)]) -> [Values; N] {
        let mut parts = [[0.0; FUNCTIONS]; N];
        let of_a_part = plays.len().div_ceil(N - 1).max(1);
        for (part, plays) in parts[1..].iter_mut().zip(plays.chunks(of_a_part)) {
            *part = match plays {
                &[(_, weight, memory)] => self.basis.at(memory).map(|function| weight * function),
                _ => self.basis.sum(plays.iter().map(|&(_, weight, memory)| (memory, weight))),
            };
        }
        parts
    }

    #[inline(always)]
    fn step<const N: usize>(&self, memory: &mut Memory<N>, dynamics: &Dynamics, target: f64) -> [Values; N] {
        let before = memory.input.value();
        let mut u = dynamics.lag.step(&mut memory.input, target);
        if (u - before).abs() > dynamics.most {
            u = u.clamp(before - dynamics.most, before + dynamics.most);
            memory.input.hold(u);
        }
        for (half_width, _, at) in &mut memory.plays {
            *at = play(*at, u, *half_width);
        }
        let driving: [Values; N] = self.hysteretic(&memory.plays);
        let mut columns = driving;
        for part in 1..N {
            let (driving, driven, crept) = (driving[part], memory.driven[part], &mut columns[part]);
            for (&(share, beta, gain), element) in dynamics.creep.iter().zip(&mut memory.creep) {
                let crept_to = &mut element[part];
                *crept_to = std::array::from_fn(|j| {
                    let target = driving[j] + beta * (driving[j] - driven[j]);
                    crept_to[j] + (target - crept_to[j]) * share
                });
                *crept = std::array::from_fn(|j| crept[j] + gain * crept_to[j]);
            }
        }
        memory.driven = driving;
        columns[0] = self.basis.at(u);
        if let Some(resonance) = &dynamics.resonance {
            let swings = memory.swings.get_or_insert_with(|| columns.map(|part| part.map(ResonanceState::rest)));
            if memory.period != dynamics.period {
                let times = dynamics.period / memory.period;
                *swings = swings.map(|part| part.map(|swing| swing.of_longer_ticks(times)));
            }
            for (column, swing) in columns.as_flattened_mut().iter_mut().zip(swings.as_flattened_mut()) {
                *column = resonance.step(swing, *column);
            }
        }
        memory.period = dynamics.period;
        columns
    }

    /// The play of an actuator that has rested at a voltage.
    fn rested(&self, voltage: f64, half_width: f64) -> f64 {
        let (memory, low) = (self.rest_memory, self.span.min);
        let between = |one: f64, other: f64, part: f64| one + part * (other - one);
        if memory >= 0.0 {
            return between(voltage, play(self.span.middle(), voltage, half_width), memory);
        }
        let risen = play(low, voltage, half_width);
        match memory < -1.0 {
            true => between(risen, play(low + half_width, voltage, half_width), -1.0 - memory),
            false => between(voltage, risen, -memory),
        }
    }
}

/// Steps of the lengths that a walk has taken, few as they are.
struct Paces<'a> {
    stages: &'a Stages<'a>,
    tick_s: f64,
    /// By their number of ticks.
    known: Vec<(u32, Dynamics)>,
}

impl Paces<'_> {
    /// A step of so many ticks.
    #[inline(always)]
    fn of(&mut self, ticks: u32) -> &Dynamics {
        let at = self.known.iter().position(|(known, _)| *known == ticks).unwrap_or_else(|| {
            self.known.push((ticks, self.stages.dynamics(f64::from(ticks) * self.tick_s)));
            self.known.len() - 1
        });
        &self.known[at].1
    }
}

/// A walk that is about to begin.
struct Walk<'a, E, const N: usize> {
    stages: &'a Stages<'a>,
    session: &'a Session,
    course: &'a Course,
    each: E,
}

impl<E: FnMut(usize, &[Values; N], f64), const N: usize> NullaryFnOnce for Walk<'_, E, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.stages.walk_each(self.session, self.course, self.each);
    }
}

/// k, β and gain of a creep element of this time constant (s) for steps of so many s. A sum that carries its lost part
/// is not needed in `f64`.
fn element(time: f64, gain: f64, period: f64) -> (f64, f64, f64) {
    let (part, beta) = RampLag::build(time, period).coefficients();
    (part, beta, gain)
}
