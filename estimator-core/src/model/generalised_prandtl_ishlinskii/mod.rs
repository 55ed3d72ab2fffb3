//! A generalised Prandtl–Ishlinskii operator in a chain: what a piezo actuator does between the amplifier's terminals and its
//! tip, a stage after the other.
//!
//! ```text
//! V ─ delay ─ lag with slew limit ─► u ─► N play operators p_i ─► Σ g_i(p_i) ─────┐
//!                                    └──► creep x_j: τ_j ẋ_j = u − x_j ─► Σ c_j x_j ─┴─ + offset ─► w ─► w + κ·w² ─ resonance ─► y
//! ```
//!
//! - **Hysteresis.** Every Preisach operator is a superposition of functions of play operators (Brokate and Sprekels,
//!   *Hysteresis and Phase Transitions*, 1996, ch. 2), so asymmetry and dependence on amplitude need no more than functions
//!   g_i instead of the weights of Prandtl and Ishlinskii (Eq. 3.9). Here g_i' is a polynomial in Bernstein's basis over what
//!   p_i can reach, with coefficients of at least 0: each g_i rises, the displacement rises with the voltage, and an inverse exists.
//! - **Creep** is a chain of Kelvin–Voigt elements (Eq. 3.20) with times a decade apart, which is log-time creep as far as
//!   a log can tell.
//! - **Rate dependence** is the amplifier's, a delay and a first-order lag whose rate is limited, and the mechanism's, a
//!   resonance. The bound of the displacement is the resonance's input's: what swings beyond is left to the table's limits.
//! - **Curvature** κ is the asymmetry that a loop's whole has, as opposed to its branches. It comes before the resonance: a
//!   linear mechanism follows the ceramic's nonlinear strain.
//!
//! With everything else fixed w is linear in the weights, which are found by non-negative least squares.

mod parameters;
mod play_function;

pub use parameters::GeneralisedPrandtlIshlinskiiParameters;

use super::play::play;
use super::relaxation::{Lag, Relaxation, Relaxed};
use super::resonance::{Resonance, ResonanceState};
use super::{Linear, Recursion, solve};
use crate::admissible::{Inadmissible, within};
use crate::math::Real;
use crate::range::Range;
use parameters::{CREEPS, PLAYS};
use play_function::Element;

/// How far beyond the span the voltage is foreseen, as a fraction of it.
const FORESEEN: f32 = 0.05;
/// Voltages that the delay line remembers; a power of 2.
const LINE: usize = 16;

/// Per-tick coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GeneralisedPrandtlIshlinskii<T> {
    /// Voltages that the functions of the plays are laid out over, V.
    span: Range<T>,
    /// Whole ticks of the delay, and the weight of the voltage a tick older.
    delay: usize,
    older: T,
    /// Ticks by which the input is seen ahead of time, where the delay is below 0.
    ahead: T,
    /// What an input ahead of time may be, V.
    foreseen: Range<T>,
    /// Most a tick, V; none without a limit.
    slew: Option<T>,
    lag: Lag<T>,
    resonance: Option<Resonance<T>>,
    plays: usize,
    degree: usize,
    elements: [Element<T>; PLAYS],
    creeps: usize,
    /// Creep elements and what each gives, µm/V.
    creep: [(Relaxation<T>, T); CREEPS],
    curvature: T,
    offset: T,
}

/// What it remembers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GeneralisedPrandtlIshlinskiiState<T> {
    line: [T; LINE],
    newest: usize,
    input: Relaxed<T>,
    /// The input as far ahead as it is foreseen: it moves no memory, since it may not come true.
    seen: T,
    plays: [T; PLAYS],
    creep: [Relaxed<T>; CREEPS],
    /// Of use where there is one.
    resonance: ResonanceState<T>,
}

impl<T: Real> GeneralisedPrandtlIshlinskii<T> {
    /// Coefficients for ticks of `sample_period` seconds.
    pub fn build(parameters: &GeneralisedPrandtlIshlinskiiParameters, sample_period: T) -> Self {
        let p = parameters;
        let span: Range<T> = p.span_v.of();
        let plays = p.half_widths_v.len();
        let degree = p.weights_um.len().checked_div(plays).unwrap_or(0).clamp(1, 3);
        let nothing = Element { half_width: T::zero(), first: T::zero(), per_volt: T::zero(), weights: [T::zero(); 3] };
        let mut elements = [nothing; PLAYS];
        for ((element, &r), weights) in elements.iter_mut().zip(p.half_widths_v.iter()).zip(p.weights_um.chunks(degree))
        {
            let half_width = T::of(r);
            let travel = span.span() - T::of(2.0) * half_width;
            *element = Element { half_width, first: span.min + half_width, per_volt: T::one() / travel, ..nothing };
            for (to, &from) in element.weights.iter_mut().zip(weights) {
                *to = T::of(from);
            }
        }
        let mut creep = [(Relaxation::build(T::one(), sample_period), T::zero()); CREEPS];
        for (to, (&time, &gain)) in creep.iter_mut().zip(p.creep_times_s.iter().zip(p.creep_um_per_v.iter())) {
            *to = (Relaxation::build(T::of(time), sample_period), T::of(gain));
        }
        let whole = p.delay_ticks.max(0.0) as usize;
        Self {
            span,
            delay: whole.min(LINE - 2),
            older: T::of(p.delay_ticks.max(0.0) - whole as f32),
            ahead: T::of((-p.delay_ticks).max(0.0)),
            foreseen: Range {
                min: span.min - T::of(FORESEEN) * span.span(),
                max: span.max + T::of(FORESEEN) * span.span(),
            },
            slew: (p.slew_v_per_s > 0.0).then(|| T::of(p.slew_v_per_s) * sample_period),
            lag: Lag::build(T::of(p.lag_s), sample_period),
            resonance: (p.resonance_hz > 0.0)
                .then(|| Resonance::build(T::of(p.resonance_hz), T::of(p.damping), sample_period)),
            plays: plays.min(PLAYS),
            degree,
            elements,
            creeps: p.creep_times_s.len().min(CREEPS),
            creep,
            curvature: T::of(p.curvature_per_um),
            offset: T::of(p.offset_um),
        }
    }

    /// The resonance, if it has one: what the sum of the columns goes through.
    pub fn resonance(&self) -> Option<Resonance<T>> {
        self.resonance
    }

    /// At rest at a voltage, the plays' memory `bias` half-widths above it, as far as the span allows: −1 after a rise, 1
    /// after a fall from its ends.
    fn rest(&self, voltage: T, bias: T) -> GeneralisedPrandtlIshlinskiiState<T> {
        let mut state = self.fresh(voltage);
        for (memory, element) in state.plays.iter_mut().zip(&self.elements) {
            let left = Range { min: element.first, max: self.span.max - element.half_width };
            *memory = play(left.clamp(voltage + bias * element.half_width), voltage, element.half_width);
        }
        state
    }

    /// At a known displacement. What no memory can have left is a lag's: the actuator is still on its way to this voltage.
    fn arrive(&self, voltage: T, known: T) -> GeneralisedPrandtlIshlinskiiState<T> {
        let one = T::one();
        let at = |voltage: T, bias: T| self.displacement(&self.rest(voltage, bias));
        if known < at(voltage, -one) {
            let lowest = self.span.include(voltage).min;
            self.rest(solve(known, lowest, voltage, |voltage| at(voltage, -one)), -one)
        } else if known > at(voltage, one) {
            let highest = self.span.include(voltage).max;
            self.rest(solve(known, voltage, highest, |voltage| at(voltage, one)), one)
        } else {
            self.rest(voltage, solve(known, -one, one, |bias| at(voltage, bias)))
        }
    }

    fn fresh(&self, voltage: T) -> GeneralisedPrandtlIshlinskiiState<T> {
        GeneralisedPrandtlIshlinskiiState {
            line: [voltage; LINE],
            newest: 0,
            input: Relaxed::at(voltage),
            seen: voltage,
            plays: [voltage; PLAYS],
            creep: [Relaxed::at(voltage); CREEPS],
            resonance: ResonanceState::rest(T::zero()),
        }
    }

    /// What the resonance takes in: the displacement at rest.
    fn displacement(&self, state: &GeneralisedPrandtlIshlinskiiState<T>) -> T {
        let mut sum = self.offset;
        for (element, &memory) in self.elements.iter().zip(&state.plays).take(self.plays) {
            sum = sum + element.function(play(memory, state.seen, element.half_width), self.degree);
        }
        for (&(_, gain), x) in self.creep.iter().zip(&state.creep).take(self.creeps) {
            sum = sum + gain * x.value;
        }
        self.bend(sum)
    }

    /// y = w + κ·w².
    fn bend(&self, w: T) -> T {
        w + self.curvature * w * w
    }

    /// The voltage behind the delay.
    fn delayed(&self, state: &mut GeneralisedPrandtlIshlinskiiState<T>, voltage: T) -> T {
        state.newest = (state.newest + 1) % LINE;
        if let Some(newest) = state.line.get_mut(state.newest) {
            *newest = voltage;
        }
        let at = |ticks: usize| state.line.get((state.newest + LINE - ticks) % LINE).copied().unwrap_or(voltage);
        let young = at(self.delay);
        young + self.older * (at(self.delay + 1) - young)
    }

    /// What the displacement (µm) can be for voltages of this range (V); `None` without a bound.
    pub fn reach(&self, voltage: Range<T>) -> Option<Range<T>> {
        // An input seen ahead of time may lie past the range.
        let applied = if self.ahead > T::zero() { voltage.hull(self.foreseen) } else { voltage };
        // Plays and creep may begin anywhere in the span, too.
        let reach = applied.hull(self.span);
        let (mut least, mut most) = (self.offset, self.offset);
        for element in self.elements.iter().take(self.plays) {
            // No play stands below the lowest voltage's or above the highest's.
            least = least + element.function(reach.min + element.half_width, self.degree);
            most = most + element.function(reach.max - element.half_width, self.degree);
        }
        for &(_, gain) in self.creep.iter().take(self.creeps) {
            least = least + gain * reach.min;
            most = most + gain * reach.max;
        }
        // κ must not turn the curve within what can be reached.
        let rises = |w: T| T::one() + T::of(2.0) * self.curvature * w > T::zero();
        let sound = self.resonance.is_none_or(|resonance| resonance.sound());
        (sound && rises(least) && rises(most)).then(|| Range { min: self.bend(least), max: self.bend(most) })
    }
}

impl<T: Real> Recursion<T> for GeneralisedPrandtlIshlinskii<T> {
    type State = GeneralisedPrandtlIshlinskiiState<T>;

    fn begin(&self, voltage: T, displacement: Option<T>) -> GeneralisedPrandtlIshlinskiiState<T> {
        let mut state = self.fresh(voltage);
        match displacement {
            Some(known) => state = self.arrive(voltage, known),
            None => {
                for (state, element) in state.plays.iter_mut().zip(&self.elements) {
                    *state = play(self.span.middle(), voltage, element.half_width);
                }
            }
        }
        state.resonance = ResonanceState::rest(self.displacement(&state));
        state
    }

    fn step(&self, state: &mut GeneralisedPrandtlIshlinskiiState<T>, voltage: T) -> T {
        self.advance(state, voltage);
        let displacement = self.displacement(state);
        match &self.resonance {
            Some(resonance) => resonance.step(&mut state.resonance, displacement),
            None => displacement,
        }
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage).ok_or(Inadmissible::NoBound)?, limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(Self { delay: 0, older: T::zero(), resonance: None, ..*self })
    }
}

impl<T: Real> Linear<T> for GeneralisedPrandtlIshlinskii<T> {
    fn advance(&self, state: &mut GeneralisedPrandtlIshlinskiiState<T>, voltage: T) {
        let target = self.delayed(state, voltage);
        let before = state.input.value;
        let mut u = self.lag.step(&mut state.input, target);
        if let Some(most) = self.slew {
            let allowed = Range { min: before - most, max: before + most };
            if !allowed.contains(u) {
                u = allowed.clamp(u);
                state.input = Relaxed::at(u);
            }
        }
        state.seen = if self.ahead > T::zero() { self.foreseen.clamp(u + self.ahead * (u - before)) } else { u };
        for (state, element) in state.plays.iter_mut().zip(&self.elements).take(self.plays) {
            *state = play(*state, u, element.half_width);
        }
        for (x, (relaxation, _)) in state.creep.iter_mut().zip(&self.creep).take(self.creeps) {
            relaxation.step(x, u);
        }
    }

    fn columns(&self, state: &GeneralisedPrandtlIshlinskiiState<T>, mut each: impl FnMut(T)) {
        for (element, &memory) in self.elements.iter().zip(&state.plays).take(self.plays) {
            let p = play(memory, state.seen, element.half_width);
            element.weighed(p, self.degree).into_iter().take(self.degree).for_each(&mut each);
        }
        state.creep.iter().take(self.creeps).for_each(|x| each(x.value));
        each(T::one());
    }
}
