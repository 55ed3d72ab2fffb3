//! A generalised Prandtl–Ishlinskii operator in a chain: what a piezo actuator does between the amplifier's terminals
//! and its tip, a stage after the other.
//!
//! ```text
//! V ─ delay ─ lag with slew limit ─► u ─┬─► q(u) ─────────────────────────────────────────────┐
//!                                       └─► play operators p_i ─► h = Σ a_i g_i(p_i) ┬────────┴─ + offset ─ resonance ─► y
//!                                                                                    └► creep c_j: τ_j ċ_j = h − c_j ─► Σ γ_j c_j ─┘
//! ```
//!
//! - **Hysteresis.** A Prandtl–Ishlinskii operator (Eq. 3.9) whose plays stand behind envelope functions g_i, which
//!   give it asymmetry and saturation (Al Janaideh, Rakheja and Su, *IEEE/ASME Transactions on Mechatronics* 16(4),
//!   2011, for envelopes inside the plays; Brokate and Sprekels, *Hysteresis and Phase Transitions*, 1996, ch. 2, for
//!   functions behind them), and a reversible part q. Slopes and weights are at least 0: the displacement rises with
//!   the voltage, and an inverse exists. One g for all half-widths ties minor loops to major ones, so that a log of one
//!   amplitude says something of others; with one for each, the operator has a density over half-widths and centres, as
//!   Preisach's has.
//! - **Creep** is a chain of Kelvin–Voigt elements (Eq. 3.20) with times a decade apart, which is log-time creep as far
//!   as a log can tell. It follows the hysteretic part: domains go on switching, the lattice does not.
//! - **Rate dependence** is the amplifier's, a delay and a first-order lag whose rate is limited, and the mechanism's,
//!   a resonance. Lag and resonance are exact for an input that runs straight within a tick. The bound of the
//!   displacement is that of the resonance's input; how far any sequence of inputs makes it swing beyond is known
//!   (`resonance.rs`), and where that is more than the table's limits, it is held at them.
//!
//! With everything but the slopes fixed the displacement is linear in them.

mod curve;
mod parameters;
mod start;

pub use parameters::GeneralisedPrandtlIshlinskiiParameters;

use super::play::play;
use super::relaxation::{RampLag, RampLagged, Relaxation, Relaxed};
use super::resonance::{Resonance, ResonanceState};
use super::{Discretisation, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use curve::{Curve, Layout};
use parameters::{CREEPS, PLAYS};

/// How far beyond the span the voltage is foreseen, as a fraction of it.
const FORESEEN: f32 = 0.05;
/// Voltages that the delay line remembers; a power of 2.
const LINE: usize = 16;

impl Published for GeneralisedPrandtlIshlinskiiParameters {
    type Coefficients<T: Real> = GeneralisedPrandtlIshlinskii<T>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> GeneralisedPrandtlIshlinskii<T> {
        GeneralisedPrandtlIshlinskii::build(self, discretisation.sample_period)
    }

    fn delay_ticks(&self) -> f32 {
        self.delay_ticks + 1.0
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        self.check_numbers()
    }
}

/// Per-tick coefficients of the chain: delay, lag with slew limit, plays, envelope, creep and resonance.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GeneralisedPrandtlIshlinskii<T> {
    /// Voltages that the functions are laid out over, V.
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
    lag: RampLag<T>,
    resonance: Option<Resonance<T>>,
    /// Of the reversible part, and of the envelopes.
    layouts: [Layout<T>; 2],
    reversible: Curve<T>,
    plays: usize,
    elements: [Element<T>; PLAYS],
    creeps: usize,
    /// Creep elements and what each gives of what drives it.
    creep: [(Relaxation<T>, T); CREEPS],
    /// Sum of what the creep elements give.
    creep_gain: T,
    rest_memory: T,
    offset: T,
}

/// A play, and what stands behind it.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Element<T> {
    /// Half-width r_i of the play, V.
    half_width: T,
    /// Times the play's weight.
    envelope: Curve<T>,
}

/// The delay line, the input's lag, every play, every creep element and the resonance.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GeneralisedPrandtlIshlinskiiState<T> {
    line: [T; LINE],
    newest: usize,
    input: RampLagged<T>,
    plays: [T; PLAYS],
    /// µm, as the hysteretic part that drives them.
    creep: [Relaxed<T>; CREEPS],
    /// Of use where there is one.
    resonance: ResonanceState<T>,
}

impl<T: Real> GeneralisedPrandtlIshlinskii<T> {
    /// Coefficients for ticks of `sample_period` seconds.
    pub fn build(parameters: &GeneralisedPrandtlIshlinskiiParameters, sample_period: T) -> Self {
        let p = parameters;
        let span: Range<T> = p.span_v.of();
        let layouts = [p.reversible_um_per_v.len(), p.knots()].map(|knots| Layout::build(span, knots));
        let [of_reversible, of_envelopes] = &layouts;
        let none = Element { half_width: T::zero(), envelope: Curve::build(of_envelopes, core::iter::empty()) };
        let mut elements = [none; PLAYS];
        let plays = p.half_widths_v.iter().zip(p.weights.iter()).zip(p.envelope_of_each());
        for (element, ((&r, &weight), slopes)) in elements.iter_mut().zip(plays) {
            let slopes = slopes.iter().map(|&slope| T::of(weight) * T::of(slope));
            *element = Element { half_width: T::of(r), envelope: Curve::build(of_envelopes, slopes) };
        }
        let reversible = Curve::build(of_reversible, p.reversible_um_per_v.iter().map(|&slope| T::of(slope)));
        let mut creep = [(Relaxation::build(T::one(), sample_period), T::zero()); CREEPS];
        for (to, (&time, &gain)) in creep.iter_mut().zip(p.creep_times_s.iter().zip(p.creep_gains.iter())) {
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
            lag: RampLag::build(T::of(p.lag_s), sample_period),
            resonance: (p.resonance_hz > 0.0)
                .then(|| Resonance::build(T::of(p.resonance_hz), T::of(p.damping), sample_period)),
            layouts,
            reversible,
            plays: p.half_widths_v.len().min(PLAYS),
            elements,
            creeps: p.creep_times_s.len().min(CREEPS),
            creep,
            creep_gain: creep.iter().fold(T::zero(), |sum, (_, gain)| sum + *gain),
            rest_memory: T::of(p.rest_memory),
            offset: T::of(p.offset_um),
        }
    }

    /// q at a voltage.
    #[inline]
    fn reversible(&self, input: T) -> T {
        let [layout, _] = &self.layouts;
        self.reversible.at(layout.place(input))
    }

    /// h with the input at a voltage that the memories of the plays may not have seen yet.
    #[inline]
    fn hysteretic(&self, plays: &[T; PLAYS], input: T) -> T {
        let [_, layout] = &self.layouts;
        let elements = self.elements.iter().zip(plays).take(self.plays);
        elements.fold(T::zero(), |sum, (element, &memory)| {
            sum + element.envelope.at(layout.place(play(memory, input, element.half_width)))
        })
    }

    /// The displacement with creep as it is, without the resonance.
    fn at_rest(&self, state: &GeneralisedPrandtlIshlinskiiState<T>, voltage: T) -> T {
        self.sum(voltage, self.hysteretic(&state.plays, voltage), &state.creep)
    }

    #[inline]
    fn sum(&self, input: T, hysteretic: T, creep: &[Relaxed<T>; CREEPS]) -> T {
        let still = self.offset + self.reversible(input) + hysteretic;
        let crept = self.creep.iter().zip(creep).take(self.creeps);
        crept.fold(still, |sum, (&(_, gain), c)| sum + gain * c.value)
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

    /// The voltage behind lag and slew limit.
    #[inline]
    fn lagged(&self, input: &mut RampLagged<T>, target: T) -> T {
        let before = input.value();
        let u = self.lag.step(input, target);
        let Some(most) = self.slew else { return u };
        let allowed = Range { min: before - most, max: before + most };
        if allowed.contains(u) {
            return u;
        }
        let u = allowed.clamp(u);
        input.hold(u);
        u
    }

    /// What the displacement (µm) can be for voltages of this range (V), the resonance's worst swing included.
    ///
    /// # Errors
    /// An `f32` cannot compute the resonance.
    pub fn reach(&self, voltage: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        let still = self.still(voltage);
        match &self.resonance {
            Some(resonance) => resonance.reach(still),
            None => Ok(still),
        }
    }

    /// What drives the resonance, µm: the displacement where there is none.
    fn still(&self, voltage: Range<T>) -> Range<T> {
        // An input seen ahead of time may lie past the range.
        let applied = if self.ahead > T::zero() { voltage.hull(self.foreseen) } else { voltage };
        // Plays and creep may begin anywhere in the span, too.
        let reach = applied.hull(self.span);
        // No play stands below where it rests at the lowest voltage or above where it rests at the highest, and creep
        // lies where its input has been.
        let hysteretic = |input: T, memory: T| {
            let [_, layout] = &self.layouts;
            let elements = self.elements.iter().take(self.plays);
            elements.fold(T::zero(), |sum, element| {
                sum + element.envelope.at(layout.place(input + memory * element.half_width))
            })
        };
        // At the lowest voltage a memory below 0 draws no play further down than the voltage, at the highest none above
        // what −1 does.
        let (zero, one) = (T::zero(), T::one());
        let up = Range { min: zero, max: one }.clamp(self.rest_memory);
        let down = Range { min: zero, max: one }.clamp(self.rest_memory.abs());
        let driven = Range { min: hysteretic(reach.min, up), max: hysteretic(reach.max, -down) };
        let crept = T::one() + self.creep_gain;
        Range {
            min: self.offset + self.reversible(reach.min) + crept * driven.min,
            max: self.offset + self.reversible(reach.max) + crept * driven.max,
        }
    }
}

impl<T: Real> Recursion<T> for GeneralisedPrandtlIshlinskii<T> {
    type State = GeneralisedPrandtlIshlinskiiState<T>;

    fn begin(&self, voltage: T, displacement: Option<T>) -> GeneralisedPrandtlIshlinskiiState<T> {
        match displacement {
            Some(known) => self.arrive(voltage, known),
            None => self.resting(voltage, self.rested(voltage)),
        }
    }

    fn step(&self, state: &mut GeneralisedPrandtlIshlinskiiState<T>, voltage: T) -> T {
        let target = self.delayed(state, voltage);
        let before = state.input.value();
        let u = self.lagged(&mut state.input, target);
        // An input seen ahead of time moves no play, since it may not come true.
        let seen = if self.ahead > T::zero() { self.foreseen.clamp(u + self.ahead * (u - before)) } else { u };
        for (memory, element) in state.plays.iter_mut().zip(&self.elements).take(self.plays) {
            *memory = play(*memory, u, element.half_width);
        }
        let hysteretic = self.hysteretic(&state.plays, seen);
        for (c, (relaxation, _)) in state.creep.iter_mut().zip(&self.creep).take(self.creeps) {
            relaxation.step(c, hysteretic);
        }
        let displacement = self.sum(seen, hysteretic, &state.creep);
        match &self.resonance {
            Some(resonance) => resonance.step(&mut state.resonance, displacement),
            None => displacement,
        }
    }

    /// Without delay, foresight and resonance, most of the memory need not be copied.
    fn peek(&self, state: &GeneralisedPrandtlIshlinskiiState<T>, voltage: T) -> T {
        let lag_only =
            self.delay == 0 && self.older == T::zero() && self.ahead == T::zero() && self.resonance.is_none();
        if !lag_only {
            return self.step(&mut state.clone(), voltage);
        }
        let u = self.lagged(&mut { state.input }, voltage);
        let hysteretic = self.hysteretic(&state.plays, u);
        let mut creep = state.creep;
        for (c, (relaxation, _)) in creep.iter_mut().zip(&self.creep).take(self.creeps) {
            relaxation.step(c, hysteretic);
        }
        self.sum(u, hysteretic, &creep)
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.still(voltage), limits)?;
        // What swings beyond is the clamp's: limits that held the worst of a light damping would be many strokes wide.
        self.reach(voltage).map(|reach| reach.intersection(limits))
    }

    /// The displacement a tick later then needs no voltage that is foreseen. (The inverse of a lag that takes its input
    /// to run straight would swing from tick to tick.)
    fn of_held_voltage(&self) -> Self {
        let (delay, older) =
            if self.ahead > T::zero() { (0, T::one() - self.ahead) } else { (self.delay + 1, self.older) };
        Self { delay, older, ahead: T::zero(), lag: self.lag.of_held_input(), ..*self }
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(Self { delay: 0, older: T::zero(), resonance: None, ..self.of_held_voltage() })
    }
}
