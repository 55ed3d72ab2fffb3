//! Prandtl-Ishlinskii model, Eq. (3.6)–(3.9) (thesis 3.1.2), with Kuhnen's superposition of dead zones for loops that
//! are not symmetric about their centre.
//!
//! ```text
//! p_i = max(V − r_i, min(V + r_i, p_i))    V     play operators, r_0 = 0 < r_1 < …, at most 16
//! w   = Σ w_i·p_i + offset                 µm    w_i ≥ 0
//! y   = S(w)                               µm    see `dead_zone`; the identity where there are no dead zones
//! ```
//!
//! Rate-independent; V is the voltage behind a lag (`lagged.rs`). The offset lies inside the superposition, so that
//! `S⁻¹(y)` is linear in the weights: the columns of [`Linear`] are the plays in the order of the thresholds, then 1,
//! and weigh to `w`, not to `y`. With no dead zones the two are the same.
//!
//! The plays of an actuator at rest with a known displacement are taken as `p_i = V + θ·r_i` with one θ of −1…1 for
//! all: −1 is the ascending major branch, 1 the descending. With nothing known they are the virgin ones, Eq. (3.8) with
//! `y_0` = 0.

mod dead_zone;

pub use dead_zone::{DEAD_ZONES, Superposition};

use super::lagged::{self, Lagged};
use super::play::play;
use super::{Discretisation, Linear, Published, Recursion, solve};
use crate::admissible::{Inadmissible, within};
use crate::list::List;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use serde::{Deserialize, Serialize};

/// Most play operators of the model.
pub const PLAYS: usize = 16;

/// Plays of Eq. (3.7) with their weights, and the dead zones of the superposition behind them, Eq. (3.9).
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrandtlIshlinskiiParameters {
    /// Time constant of the input lag, s; 0 is none. Below 0 the time by which the displacement is ahead of a tick
    /// after its voltage: at most a tick of it counts.
    pub lag_s: f32,
    /// Half-widths r_i of the plays, V: 0, then increasing.
    pub thresholds_v: List<PLAYS>,
    /// Slopes w_i of the plays, µm/V: at least 0.
    pub weights_um_per_v: List<PLAYS>,
    /// What is added to the sum of the plays, µm.
    pub offset_um: f32,
    /// Where the dead zones of the superposition end, µm: increasing, 0 among them; or none.
    pub dead_zones_um: List<DEAD_ZONES>,
    /// Slopes beyond the dead zones, no unit.
    pub dead_zone_slopes: List<DEAD_ZONES>,
    /// Voltages between which the actuator has been before the start, V: what its memory may be.
    pub memory_v: Range,
}

impl Published for PrandtlIshlinskiiParameters {
    type Coefficients<T: Real> = Lagged<T, PrandtlIshlinskii<T>>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Lagged<T, PrandtlIshlinskii<T>> {
        Lagged::build(self.lag_s, discretisation.sample_period, PrandtlIshlinskii::build(self))
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        lagged::check(self.lag_s)?;
        let (thresholds, weights) = (&self.thresholds_v, &self.weights_um_per_v);
        if thresholds.len() != weights.len() {
            return Err("weights_um_per_v must be as many as thresholds_v");
        }
        if !thresholds.iter().chain(weights.iter()).chain([&self.offset_um]).all(|number| number.is_finite()) {
            return Err("thresholds_v, weights_um_per_v and offset_um must be finite");
        }
        let increasing = thresholds.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
        if thresholds.first() != Some(&0.0) || !increasing {
            return Err("thresholds_v must increase from 0");
        }
        if weights.iter().any(|weight| *weight < 0.0) || weights.iter().all(|weight| *weight == 0.0) {
            return Err("weights_um_per_v must be at least 0 and not all 0");
        }
        if !(self.memory_v.min.is_finite() && self.memory_v.max.is_finite() && self.memory_v.min <= self.memory_v.max) {
            return Err("memory_v must be ordered");
        }
        if thresholds.iter().any(|r| 2.0 * r > self.memory_v.span()) {
            return Err("thresholds_v must not exceed half of memory_v");
        }
        dead_zone::check(&self.dead_zones_um, &self.dead_zone_slopes)
    }
}

/// Thresholds (V), weights (µm/V) and superposition, as a tick takes them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PrandtlIshlinskii<T> {
    count: usize,
    thresholds: [T; PLAYS],
    weights: [T; PLAYS],
    offset: T,
    superposition: Superposition<T>,
    memory: Range<T>,
}

/// Where each play of Eq. (3.7) stands, V.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PrandtlIshlinskiiState<T> {
    plays: [T; PLAYS],
}

impl<T: Real> PrandtlIshlinskii<T> {
    /// Coefficients of a set without a [fault](PrandtlIshlinskiiParameters::check); the lag is not among them.
    pub fn build(parameters: &PrandtlIshlinskiiParameters) -> Self {
        let mut model = Self {
            count: parameters.thresholds_v.len().min(parameters.weights_um_per_v.len()),
            thresholds: [T::zero(); PLAYS],
            weights: [T::zero(); PLAYS],
            offset: T::of(parameters.offset_um),
            superposition: Superposition::build(&parameters.dead_zones_um, &parameters.dead_zone_slopes),
            memory: parameters.memory_v.of(),
        };
        model.thresholds.iter_mut().zip(parameters.thresholds_v.iter()).for_each(|(to, &from)| *to = T::of(from));
        model.weights.iter_mut().zip(parameters.weights_um_per_v.iter()).for_each(|(to, &from)| *to = T::of(from));
        model
    }

    /// The superposition that is applied to the weighted sum.
    pub fn superposition(&self) -> &Superposition<T> {
        &self.superposition
    }

    fn plays(&self, play: impl Fn(T) -> T) -> PrandtlIshlinskiiState<T> {
        let mut state = PrandtlIshlinskiiState { plays: [T::zero(); PLAYS] };
        for (to, &threshold) in state.plays.iter_mut().zip(&self.thresholds).take(self.count) {
            *to = play(threshold);
        }
        state
    }

    /// Displacement (µm) of plays that are a function of the threshold.
    fn displacement_of(&self, play: impl Fn(T) -> T) -> T {
        let plays = self.thresholds.iter().zip(&self.weights).take(self.count);
        self.superposition.apply(plays.fold(self.offset, |sum, (&threshold, &weight)| sum + weight * play(threshold)))
    }

    /// What the displacement (µm) can be for voltages of this range (V).
    ///
    /// No play stands below r above the lowest voltage, nor above r below the highest, of the range or the memory, and
    /// `S` increases. Widened by the rounding of the sums.
    pub fn reach(&self, voltage: Range<T>) -> Range<T> {
        let rounding = T::of(64.0) * T::epsilon();
        let plays = || self.thresholds.iter().zip(&self.weights).take(self.count);
        let end = |from: T, sign: T| {
            let mut sum = self.offset;
            let mut magnitude = self.offset.abs();
            for (&threshold, &weight) in plays() {
                sum = sum + weight * (from - sign * threshold);
                magnitude = magnitude + weight * (from.abs() + threshold);
            }
            let outer = sum + sign * rounding * magnitude;
            self.superposition.apply(outer) + sign * rounding * self.superposition.magnitude(outer)
        };
        let hull = voltage.hull(self.memory);
        Range { min: end(hull.min, -T::one()), max: end(hull.max, T::one()) }
    }
}

impl<T: Real> Recursion<T> for PrandtlIshlinskii<T> {
    type State = PrandtlIshlinskiiState<T>;

    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let left = |memory: T, threshold: T| {
            let range = Range { min: self.memory.min + threshold, max: self.memory.max - threshold };
            play(range.clamp(memory), voltage, threshold)
        };
        // From rest, Eq. (3.8): relaxed at 0 V, or as near to it as the memory goes.
        let Some(displacement) = displacement else { return self.plays(|threshold| left(T::zero(), threshold)) };
        let at = |theta: T| self.displacement_of(|threshold| left(voltage + theta * threshold, threshold));
        let theta = solve(displacement, -T::one(), T::one(), at);
        self.plays(|threshold| left(voltage + theta * threshold, threshold))
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        let mut sum = self.offset;
        let plays = state.plays.iter_mut().zip(&self.thresholds).zip(&self.weights).take(self.count);
        for ((memory, &threshold), &weight) in plays {
            *memory = play(*memory, voltage, threshold);
            sum = sum + weight * *memory;
        }
        self.superposition.apply(sum)
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage), limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

impl<T: Real> Linear<T> for PrandtlIshlinskii<T> {
    fn advance(&self, state: &mut Self::State, voltage: T) {
        for (memory, &threshold) in state.plays.iter_mut().zip(&self.thresholds).take(self.count) {
            *memory = play(*memory, voltage, threshold);
        }
    }

    /// The plays (V), then 1: they weigh to what the superposition is applied to.
    fn columns(&self, state: &Self::State, mut each: impl FnMut(T)) {
        state.plays.iter().take(self.count).for_each(|&play| each(play));
        each(T::one());
    }
}
