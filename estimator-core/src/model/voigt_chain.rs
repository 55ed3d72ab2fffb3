//! Kelvin-Voigt chain: Voigt elements in series, Eq. (3.20), for creep and relaxation of many time constants.
//!
//! ```text
//! y(t) = F/k_m + Σ F/k_i·(1 − exp(−k_i·t/b_i))           Eq. (3.20), step of height F; k_m is the instantaneous spring
//! y = offset + gain_0·V + Σ gain_i·x_i + g·x_e      µm, V; gain_i = 1/k_i, τ_i = b_i/k_i
//! dx_i/dt = (V − x_i)/τ_i,   dx_e/dt = (V_ext − x_e)/τ_1
//! x_i ← x_i + (V − x_i)·k_i,   k_i = 1 − exp(−t_s/τ_i)     one tick, exact for a voltage held over it; k_i by expm1
//! ```
//!
//! (Eq. 3.20 prints the exponent without its minus.) The sum takes this tick's voltage and the `x_i` a tick later.
//!
//! **Extremum term.** The chain is linear and has no hysteresis; the thesis recommends extremum terms for other models
//! too (6.2). `g` weighs the voltage at the last reversal, which as in Eq. (5.3) acts through an element's lag, here
//! the fastest one's. It is of either sign, 0 before the first reversal, and left out where g = 0.
//!
//! **Resolution.** Every element is a [`Relaxation`], whose compensated sum leaves the relative rounding of `k`, of the
//! difference and of the product, so that with n elements and no extremum term `f32` stays within
//! `(n + 16)·2⁻²⁴·(|offset| + Σ gain·max|V|)` of `f64`, for any τ; the tests assert it over 100 s up to τ = 100 s.

use super::relaxation::{Relaxation, Relaxed};
use super::{Discretisation, Linear, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::extremum::{Tracker, between_codes};
use crate::list::List;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use serde::{Deserialize, Serialize};

const ELEMENTS: usize = 20;

/// A published chain of 1 to 20 elements.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VoigtChainParameters {
    /// Displacement at 0 V after a long rest, µm.
    pub offset_um: f32,
    /// 1/k_m: what follows the voltage at once, µm/V; at least 0.
    pub instantaneous_um_per_v: f32,
    /// 1/k_i: static gains of the elements, µm/V; at least 0.
    pub gains_um_per_v: List<ELEMENTS>,
    /// b_i/k_i: time constants of the elements, s; above 0, increasing, as many as gains.
    pub times_s: List<ELEMENTS>,
    /// Voltages between which an element may stand at the start, V: a known displacement says no more than that.
    pub memory_v: Range,
    /// g: what a volt of the last reversal adds, µm/V; 0 for a chain without the extremum term.
    pub voltage_extremum_um_per_v: f32,
    /// Retreat that counts as a reversal, V; at least 0.
    pub deadband_v: f32,
}

impl Published for VoigtChainParameters {
    type Coefficients<T: Real> = VoigtChain<T>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> VoigtChain<T> {
        VoigtChain::build(self, discretisation.sample_period)
    }

    fn between_codes(self, step: f32) -> Self {
        Self { deadband_v: between_codes(self.deadband_v, step), ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        let Self { offset_um, instantaneous_um_per_v, gains_um_per_v: gains, times_s: times, memory_v, .. } = self;
        let sum = gains.iter().fold(*instantaneous_um_per_v, |sum, gain| sum + gain);
        if !(offset_um.is_finite() && sum.is_finite()) {
            return Err("offset_um, instantaneous_um_per_v and gains_um_per_v must be finite");
        }
        if gains.is_empty() || gains.len() != times.len() {
            return Err("gains_um_per_v and times_s must be equally many, at least one");
        }
        if *instantaneous_um_per_v < 0.0 || gains.iter().any(|&gain| gain < 0.0) || sum <= 0.0 {
            return Err("instantaneous_um_per_v and gains_um_per_v must be at least 0 and not all 0");
        }
        let increasing = times.iter().scan(0.0, |last, &time| Some(core::mem::replace(last, time) < time));
        if !increasing.into_iter().all(|rises| rises) || times.last().is_some_and(|time| time.is_infinite()) {
            return Err("times_s must be finite and increase from above 0");
        }
        if !(memory_v.min.is_finite() && memory_v.max.is_finite() && memory_v.min <= memory_v.max) {
            return Err("memory_v must be a finite range");
        }
        if !(self.voltage_extremum_um_per_v.is_finite() && self.deadband_v.is_finite() && self.deadband_v >= 0.0) {
            return Err("voltage_extremum_um_per_v and deadband_v must be finite, deadband_v at least 0");
        }
        Ok(())
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
struct Element<T> {
    gain: T,
    relaxation: Relaxation<T>,
}

/// Per-tick coefficients of the chain.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoigtChain<T> {
    count: usize,
    offset: T,
    instantaneous: T,
    elements: [Element<T>; ELEMENTS],
    static_gain: T,
    memory: Range<T>,
    /// g, with the fastest element's lag.
    extremum: Element<T>,
    deadband: T,
}

/// The voltages (V) that the chain remembers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoigtChainState<T> {
    voltage: T,
    elements: [Relaxed<T>; ELEMENTS],
    extremum: Relaxed<T>,
    tracker: Tracker<T>,
}

impl<T: Real> VoigtChain<T> {
    /// Coefficients for ticks of `sample_period` seconds. Checks nothing: see [`VoigtChainParameters::check`].
    pub fn build(parameters: &VoigtChainParameters, sample_period: T) -> Self {
        let p = parameters;
        let relaxation = |time: f32| Relaxation::build(T::of(time), sample_period);
        let fastest = relaxation(p.times_s.first().copied().unwrap_or(1.0));
        let mut elements = [Element { gain: T::zero(), relaxation: fastest }; ELEMENTS];
        let mut static_gain = T::of(p.instantaneous_um_per_v);
        for (element, (&gain, &time)) in elements.iter_mut().zip(p.gains_um_per_v.iter().zip(p.times_s.iter())) {
            *element = Element { gain: T::of(gain), relaxation: relaxation(time) };
            static_gain = static_gain + element.gain;
        }
        Self {
            count: p.gains_um_per_v.len().min(p.times_s.len()),
            offset: T::of(p.offset_um),
            instantaneous: T::of(p.instantaneous_um_per_v),
            elements,
            static_gain,
            memory: p.memory_v.of(),
            extremum: Element { gain: T::of(p.voltage_extremum_um_per_v), relaxation: fastest },
            deadband: T::of(p.deadband_v),
        }
    }

    /// Displacement per volt after a long rest, µm/V.
    pub fn static_gain(&self) -> T {
        self.static_gain
    }

    fn used(&self) -> impl DoubleEndedIterator<Item = &Element<T>> + ExactSizeIterator {
        self.elements.get(..self.count).unwrap_or(&self.elements).iter()
    }

    /// What the displacement (µm) can be for voltages of this range (V).
    ///
    /// Every `x` is a mean of voltages that were applied or remembered at the start, and every gain is at least 0;
    /// `x_e` is one of 0 and voltages that were applied, and g of either sign.
    pub fn reach(&self, voltage: Range<T>) -> Range<T> {
        let remembered = voltage.hull(self.memory);
        let (slow, at_once) = (self.static_gain - self.instantaneous, self.instantaneous);
        let reversals = voltage.include(T::zero());
        let extremum = Range::of_values([reversals.min, reversals.max].map(|at| self.extremum.gain * at));
        Range {
            min: self.offset + at_once * voltage.min + slow * remembered.min + extremum.min,
            max: self.offset + at_once * voltage.max + slow * remembered.max + extremum.max,
        }
    }
}

impl<T: Real> Recursion<T> for VoigtChain<T> {
    type State = VoigtChainState<T>;

    /// Rested: every element stands at the voltage. A known displacement that differs from the rested one is creep that
    /// has not finished: the slowest element takes the difference as far as `memory_v` lets it, the next slowest what
    /// is left, and so on.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let mut state = VoigtChainState {
            voltage,
            elements: [Relaxed::at(voltage); ELEMENTS],
            extremum: Relaxed::at(T::zero()),
            tracker: Tracker::new(self.deadband),
        };
        let Some(displacement) = displacement else { return state };
        let memory = self.memory.include(voltage);
        let mut remaining = displacement - self.offset - self.static_gain * voltage;
        let used = state.elements.get_mut(..self.count).unwrap_or_default();
        for (element, x) in self.used().zip(used).rev() {
            if element.gain > T::zero() {
                *x = Relaxed::at(memory.clamp(voltage + remaining / element.gain));
                remaining = remaining - element.gain * (x.value - voltage);
            }
        }
        state
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        self.advance(state, voltage);
        let mut displacement = self.offset + self.instantaneous * voltage;
        for (element, x) in self.used().zip(&state.elements) {
            displacement = displacement + element.gain * x.value;
        }
        displacement + self.extremum.gain * state.extremum.value
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage), limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

/// Columns: `V` of this tick, `x_1` … `x_n` and `x_e` a tick later, 1; weights: `instantaneous_um_per_v`,
/// `gains_um_per_v`, `voltage_extremum_um_per_v`, `offset_um`. Where g is 0, so is `x_e`.
impl<T: Real> Linear<T> for VoigtChain<T> {
    #[inline]
    fn advance(&self, state: &mut Self::State, voltage: T) {
        state.voltage = voltage;
        for (element, x) in self.used().zip(&mut state.elements) {
            element.relaxation.step(x, voltage);
        }
        if self.extremum.gain != T::zero() {
            // Only the voltage of a reversal is asked for.
            state.tracker.update(voltage, T::zero());
            self.extremum.relaxation.step(&mut state.extremum, state.tracker.last().voltage);
        }
    }

    fn columns(&self, state: &Self::State, mut each: impl FnMut(T)) {
        each(state.voltage);
        for x in state.elements.iter().take(self.count) {
            each(x.value);
        }
        each(state.extremum.value);
        each(T::one());
    }
}
