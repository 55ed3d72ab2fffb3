//! Maxwell-slip model, Eq. (3.10) (thesis 3.2.1): a spring and N elasto-slide elements in parallel, with the voltage in
//! the place of the force.
//!
//! ```text
//! V     = v_zero + k_0·y + Σ k_i·(y − y_bi)                     V      k_0, k_i > 0
//! y_bi  = y ∓ W_i/k_i   where   |k_i·(y − y_bi)| ≥ W_i          µm     the element slips
//! ```
//!
//! The thesis prints the condition of slipping as `<`, the same as that of sticking; it is `≥`.
//!
//! Each block `y_bi` is a play operator of the displacement with half-width `δ_i = W_i/k_i`, so the voltage of a given
//! displacement is evaluated directly ([`MaxwellSlip::voltage`], the exact inverse). A tick solves it for the
//! displacement:
//!
//! - While the first m elements (in the order of δ) slip in direction ±, `y = (V − v_zero − Σ_{i≤m} ±W_i + Σ_{i>m}
//!   k_i·y_bi)/K_m` with `K_m = k_0 + Σ_{i>m} k_i`.
//! - Plays of one input obey `|y_bi − y_bj| ≤ |δ_i − δ_j|`, so the points `y_bi ± δ_i` at which elements begin to slip
//!   are in the order of δ, in either direction. One pass that stops at the first element that sticks finds m.
//!
//! The result is exact and absolute: nothing is summed from tick to tick. Rate-independent; V is the voltage behind a
//! lag (`lagged.rs`). `k_0 > 0` keeps it bounded.

use super::lagged::{self, Lagged};
use super::play::play;
use super::{Discretisation, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::list::List;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use serde::{Deserialize, Serialize};

/// Most elements of the model.
pub const ELEMENTS: usize = 10;

/// Stiffnesses and saturations of Eq. (3.10), with voltage in the place of force.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaxwellSlipParameters {
    /// Time constant of the input lag, s; 0 is none. Below 0 the time by which the displacement is ahead of a tick
    /// after its voltage: at most a tick of it counts.
    pub lag_s: f32,
    /// Stiffness k_i of the elements, V/µm.
    pub stiffness_v_per_um: List<ELEMENTS>,
    /// Saturation W_i of the elements, V, such that `W_i/k_i` increases.
    pub saturation_v: List<ELEMENTS>,
    /// Stiffness k_0 of the spring that never slips, V/µm.
    pub base_stiffness_v_per_um: f32,
    /// Voltage of the relaxed actuator at displacement 0, V.
    pub offset_v: f32,
}

impl Published for MaxwellSlipParameters {
    type Coefficients<T: Real> = Lagged<T, MaxwellSlip<T>>;
    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Lagged<T, MaxwellSlip<T>> {
        Lagged::build(self.lag_s, discretisation.sample_period, MaxwellSlip::build(self))
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        lagged::check(self.lag_s)?;
        let (stiffness, saturation) = (&self.stiffness_v_per_um, &self.saturation_v);
        if stiffness.len() != saturation.len() {
            return Err("saturation_v must be as many as stiffness_v_per_um");
        }
        let all = stiffness.iter().chain(saturation.iter()).chain([&self.base_stiffness_v_per_um, &self.offset_v]);
        if !all.clone().all(|number| number.is_finite()) {
            return Err("stiffness_v_per_um, saturation_v, base_stiffness_v_per_um and offset_v must be finite");
        }
        if stiffness.iter().chain(saturation.iter()).any(|number| *number <= 0.0) {
            return Err("stiffness_v_per_um and saturation_v must be positive");
        }
        if self.base_stiffness_v_per_um <= 0.0 {
            return Err("base_stiffness_v_per_um must be positive");
        }
        let yields = || saturation.iter().zip(stiffness.iter()).map(|(w, k)| w / k);
        if !yields().zip(yields().skip(1)).all(|(a, b)| a < b) || !yields().all(f32::is_finite) {
            return Err("saturation_v over stiffness_v_per_um must be finite and increase");
        }
        Ok(())
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
struct Element<T> {
    stiffness: T,
    /// Elongation at which it slips, W/k, µm.
    yield_um: T,
    /// 1/(k_0 + Σ k of the elements behind this one), µm/V.
    compliance_beyond: T,
}

/// Yield displacements (µm) and compliances (µm/V) that a tick solves Eq. (3.10) with.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MaxwellSlip<T> {
    count: usize,
    elements: [Element<T>; ELEMENTS],
    /// 1/(k_0 + Σ k), µm/V.
    compliance: T,
    base_compliance: T,
    base_stiffness: T,
    /// Σ W, V.
    saturation: T,
    offset: T,
}

/// Where the blocks stand, µm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MaxwellSlipState<T> {
    blocks: [T; ELEMENTS],
}

impl<T: Real> MaxwellSlip<T> {
    /// Coefficients of a set without a [fault](MaxwellSlipParameters::check); the lag is not among them.
    pub fn build(parameters: &MaxwellSlipParameters) -> Self {
        let base_stiffness = T::of(parameters.base_stiffness_v_per_um);
        let nothing = Element { stiffness: T::zero(), yield_um: T::zero(), compliance_beyond: T::zero() };
        let mut elements = [nothing; ELEMENTS];
        let mut saturation = T::zero();
        let pairs = parameters.stiffness_v_per_um.iter().zip(parameters.saturation_v.iter());
        for (element, (&k, &w)) in elements.iter_mut().zip(pairs) {
            *element = Element { stiffness: T::of(k), yield_um: T::of(w) / T::of(k), compliance_beyond: T::zero() };
            saturation = saturation + T::of(w);
        }
        let count = parameters.stiffness_v_per_um.len().min(parameters.saturation_v.len());
        let mut stiffness = base_stiffness;
        for element in elements.iter_mut().take(count).rev() {
            element.compliance_beyond = T::one() / stiffness;
            stiffness = stiffness + element.stiffness;
        }
        Self {
            count,
            elements,
            compliance: T::one() / stiffness,
            base_compliance: T::one() / base_stiffness,
            base_stiffness,
            saturation,
            offset: T::of(parameters.offset_v),
        }
    }

    /// The exact inverse, one tick: takes the displacement (µm), returns the voltage (V) that holds it. The memory is
    /// the one that [`step`](Recursion::step) has, so that either may go on with it.
    #[inline]
    pub fn voltage(&self, state: &mut MaxwellSlipState<T>, displacement: T) -> T {
        let mut voltage = self.offset + self.base_stiffness * displacement;
        for (block, element) in state.blocks.iter_mut().zip(&self.elements).take(self.count) {
            *block = play(*block, displacement, element.yield_um);
            voltage = voltage + element.stiffness * (displacement - *block);
        }
        voltage
    }

    /// Voltages (V) that hold the elements at `θ·W_i` each are `offset + k_0·y + θ·ΣW`: the blocks of this θ.
    fn stretched(&self, displacement: T, theta: T) -> MaxwellSlipState<T> {
        let mut state = MaxwellSlipState { blocks: [T::zero(); ELEMENTS] };
        for (block, element) in state.blocks.iter_mut().zip(&self.elements).take(self.count) {
            *block = displacement - theta * element.yield_um;
        }
        state
    }

    /// What the displacement (µm) can be for voltages of this range (V).
    ///
    /// The elements hold back ±ΣW at most, whatever they remember, and the spring takes the rest. The bound is attained
    /// by [`begin`](Recursion::begin) at an end of the range. Widened by the rounding of the sums, which does not build
    /// up: a block's error enters the next displacement with weights whose sum is below 1 − k_0/K.
    pub fn reach(&self, voltage: Range<T>) -> Range<T> {
        let end = |from: T, sign: T| {
            let outer = (from - self.offset + sign * self.saturation) * self.base_compliance;
            let magnitude = from.abs() + self.offset.abs() + self.saturation + outer.abs() / self.compliance;
            outer + sign * T::of(64.0) * T::epsilon() * magnitude * self.base_compliance
        };
        Range { min: end(voltage.min, -T::one()), max: end(voltage.max, T::one()) }
    }
}

impl<T: Real> Recursion<T> for MaxwellSlip<T> {
    type State = MaxwellSlipState<T>;

    const REMEMBERS: bool = true;

    /// With the displacement known, every element is stretched by the same fraction θ of its yield displacement, −1…1,
    /// 1 on the ascending major branch. With nothing known, the actuator has come to this voltage from the relaxed
    /// state.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let Some(displacement) = displacement else {
            let mut state = self.stretched(T::zero(), T::zero());
            self.step(&mut state, voltage);
            return state;
        };
        let drive = voltage - self.offset;
        let wanted = drive - self.base_stiffness * displacement;
        // Comparisons that a NaN fails, so that it begins in the middle.
        if wanted > self.saturation {
            self.stretched((drive - self.saturation) * self.base_compliance, T::one())
        } else if wanted < -self.saturation {
            self.stretched((drive + self.saturation) * self.base_compliance, -T::one())
        } else if wanted.abs() <= self.saturation && self.saturation > T::zero() {
            self.stretched(displacement, wanted / self.saturation)
        } else {
            self.stretched(drive * self.base_compliance, T::zero())
        }
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        let mut drive = voltage - self.offset;
        let elements = || self.elements.iter().take(self.count);
        for (&block, element) in state.blocks.iter().zip(elements()) {
            drive = drive + element.stiffness * block;
        }
        let mut displacement = drive * self.compliance;
        let first = state.blocks.first().copied().unwrap_or(T::zero());
        let up = displacement > first;
        let edge = |block: T, yield_um: T| if up { block + yield_um } else { block - yield_um };
        let mut slipping = 0;
        for (&block, element) in state.blocks.iter().zip(elements()) {
            let edge = edge(block, element.yield_um);
            let slips = if up { displacement > edge } else { displacement < edge };
            if !slips {
                break;
            }
            drive = drive - element.stiffness * edge;
            displacement = drive * element.compliance_beyond;
            slipping += 1;
        }
        for (block, element) in state.blocks.iter_mut().zip(elements()).take(slipping) {
            *block = if up { displacement - element.yield_um } else { displacement + element.yield_um };
        }
        displacement
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage), limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}
