//! Duhem model in the form of Coleman and Hodgdon, Eq. (3.12), with polynomial f and g, of the voltage u behind a lag
//! (`lagged.rs`). Rate-independent. Its memory is held within the table's deadband (`held.rs`).
//!
//! ```text
//! v = u − centre                                                 V
//! dw/dt = α·|dv/dt|·(f(v) − w) + dv/dt·g(v)                      Eq. (3.12); it prints dy/dt before g for dV/dt
//! f(v) = f1·v + f3·v³,  g(v) = g0 + g2·v²                        |v| ≤ saturation
//! f'(v) = g(v) = f1 + 3·f3·saturation²                        beyond it, so that f' and g have one finite limit
//! y = offset + w                                                 µm
//! ```
//!
//! With `w = f + z`, `dz = −α·|dv|·z + D(v)·dv`, `D = g − f'`: linear, with a closed-form solution over a monotone
//! move, whatever its length. `z = (g0 − f1)·z0 + (g2 − 3·f3)·z2`, where z0 and z2 are the answers to D = 1 and D = v².
//! So the displacement is linear in f1, f3, g0, g2 and the offset, and only α, saturation and centre are not. A
//! tick within ½/α costs one polynomial and no transcendental function. |z0| ≤ 1/α, |z2| ≤ saturation²/α, |z| ≤
//! max|D|/α always.
//!
//! The displacement lags the voltage where g < f'. See [`unmet_condition`] for the model's three conditions.

mod conditions;
mod parameters;

pub use conditions::{DuhemCondition, unmet_condition};
pub use parameters::DuhemParameters;

use super::held::{Held, half_width};
use super::lagged::Lagged;
use super::{Discretisation, Linear, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;

impl Published for DuhemParameters {
    type Coefficients<T: Real> = Lagged<T, Duhem<T>>;
    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Lagged<T, Duhem<T>> {
        Lagged::build(self.lag_s, discretisation.sample_period, Duhem::build(self, discretisation.deadband))
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        self.check_numbers()?;
        let memory = Duhem::<f32>::build(self, 0.0).largest_memory();
        if !memory.is_finite() {
            return Err("the hysteresis must have a finite bound");
        }
        Ok(())
    }
}

/// Per-tick coefficients of the Duhem model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Duhem<T> {
    /// Of the play that decides when the memory moves, V.
    half_width: T,
    alpha: T,
    inverse_alpha: T,
    inside: Range<T>,
    tail_slope: T,
    centre: T,
    offset: T,
    f1: T,
    f3: T,
    d0: T,
    d2: T,
}

/// Voltage and hysteresis of a running model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DuhemState<T> {
    /// u of the last tick, V.
    input: T,
    held: Held<T, Answers<T>>,
    /// The three functions of the equation at that u.
    answers: Answers<T>,
}

/// z0 and z2.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Answers<T> {
    /// To D = 1, V.
    z0: T,
    /// To D = v², V³.
    z2: T,
}

/// φ_1, φ_2, φ_3 of −x, x ≥ 0: φ_k = Σ (−x)^j/(j + k)!, so that ∫₀^w exp(−α(w − s))·s^k ds = k!·w^(k+1)·φ_(k+1)(−α·w).
#[inline]
fn phi<T: Real>(x: T) -> [T; 3] {
    let (one, half) = (T::one(), T::of(0.5));
    if x <= half {
        // φ_3 = 1/6·(1 − x/4·(1 − x/5·(… 1 − x/12))): the rest is below 1e-12 of it.
        let mut series = one;
        for divisor in [12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0] {
            series = one - x * (one / T::of(divisor)) * series;
        }
        let phi3 = series * (one / T::of(6.0));
        let phi2 = half - x * phi3;
        [one - x * phi2, phi2, phi3]
    } else {
        let phi1 = -(-x).exp_m1() / x;
        let phi2 = (one - phi1) / x;
        [phi1, phi2, (half - phi2) / x]
    }
}

impl<T: Real> Duhem<T> {
    /// Coefficients with the memory held until the voltage has gone back by more than 1.5 times the `deadband`, V; the
    /// lag is not among them. Checks nothing: see [`DuhemParameters::check`].
    pub fn build(parameters: &DuhemParameters, deadband: T) -> Self {
        let p = parameters;
        let (f1, f3, saturation) = (T::of(p.f1_um_per_v), T::of(p.f3_um_per_v3), T::of(p.saturation_v));
        let three = T::of(3.0);
        Self {
            half_width: half_width(deadband),
            alpha: T::of(p.alpha_per_v),
            inverse_alpha: T::one() / T::of(p.alpha_per_v),
            inside: Range { min: -saturation, max: saturation },
            tail_slope: three * saturation * saturation,
            centre: T::of(p.voltage_centre_v),
            offset: T::of(p.offset_um),
            f1,
            f3,
            d0: T::of(p.g0_um_per_v) - f1,
            d2: T::of(p.g2_um_per_v3) - three * f3,
        }
    }

    /// The largest |w − f| that can be, µm.
    pub fn largest_memory(&self) -> T {
        let (at_centre, at_end) = (self.d0.abs(), self.excess(self.inside.max).abs());
        self.inverse_alpha * if at_centre > at_end { at_centre } else { at_end }
    }

    /// D = g − f' within saturation, µm/V.
    fn excess(&self, v: T) -> T {
        self.d0 + self.d2 * v * v
    }

    /// The answer of f to its cubic coefficient: v³, straight on beyond saturation.
    fn cubic(&self, v: T) -> T {
        let s = self.inside.clamp(v);
        s * s * s + self.tail_slope * (v - s)
    }

    fn f(&self, v: T) -> T {
        self.f1 * v + self.f3 * self.cubic(v)
    }

    fn decay(&self, Answers { z0, z2 }: Answers<T>, distance: T) -> Answers<T> {
        let retention = T::one() + (-self.alpha * distance).exp_m1();
        Answers { z0: z0 * retention, z2: z2 * retention }
    }

    /// A monotone move from v by `change`, within saturation.
    #[inline]
    fn travel(&self, Answers { z0, z2 }: Answers<T>, v: T, change: T) -> Answers<T> {
        let x = self.alpha * change.abs();
        let [phi1, phi2, phi3] = phi(x);
        let two = T::of(2.0);
        Answers {
            z0: z0 + phi1 * (change - x * z0),
            z2: z2 + phi1 * (change * v * v - x * z2) + change * change * two * (v * phi2 + change * phi3),
        }
    }

    /// A monotone move from one input (V) to another, wherever they lie.
    #[inline]
    fn follow(&self, mut answers: Answers<T>, from: T, to: T) -> Answers<T> {
        let (from, to) = (from - self.centre, to - self.centre);
        let (enter, leave) = (self.inside.clamp(from), self.inside.clamp(to));
        if enter == leave {
            return if from == to { answers } else { self.decay(answers, (to - from).abs()) };
        }
        if from != enter {
            answers = self.decay(answers, (enter - from).abs());
        }
        answers = self.travel(answers, enter, leave - enter);
        if to == leave { answers } else { self.decay(answers, (to - leave).abs()) }
    }

    /// The displacement (µm) at an input (V).
    fn sum(&self, u: T, Answers { z0, z2 }: Answers<T>) -> T {
        self.offset + self.f(u - self.centre) + (self.d0 * z0 + self.d2 * z2)
    }

    /// What the displacement (µm) can be for voltages of this range (V); `None` without a bound.
    ///
    /// f, which does not fall, over the range, and the hysteresis at its largest.
    pub fn reach(&self, voltage: Range<T>) -> Option<Range<T>> {
        let memory = self.largest_memory();
        memory.is_finite().then(|| Range {
            min: self.offset + self.f(voltage.min - self.centre) - memory,
            max: self.offset + self.f(voltage.max - self.centre) + memory,
        })
    }
}

impl<T: Real> Recursion<T> for Duhem<T> {
    type State = DuhemState<T>;

    const REMEMBERS: bool = true;

    /// On f where the displacement is unknown; else off it by no more than |D|/α at this voltage, which a long monotone
    /// move could leave there.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let mut answers = Answers { z0: T::zero(), z2: T::zero() };
        let v = self.inside.clamp(voltage - self.centre);
        let excess = self.excess(v);
        if let Some(displacement) = displacement
            && excess != T::zero()
        {
            let bound = Range { min: -self.inverse_alpha, max: self.inverse_alpha };
            answers.z0 = bound.clamp((displacement - self.sum(voltage, answers)) / excess);
            answers.z2 = v * v * answers.z0;
        }
        DuhemState { input: voltage, held: Held::new(voltage, answers), answers }
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        self.advance(state, voltage);
        self.sum(state.input, state.answers)
    }

    /// Without what would be kept.
    #[inline]
    fn peek(&self, state: &Self::State, voltage: T) -> T {
        self.sum(voltage, state.held.shown(voltage, |answers, from, to| self.follow(answers, from, to)))
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage).ok_or(Inadmissible::NoBound)?, limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

/// Columns and weights: `v − z0` (`f1_um_per_v`), `v³ − 3·z2` (`f3_um_per_v3`; v³ straight on beyond
/// saturation), `z0` (`g0_um_per_v`), `z2` (`g2_um_per_v3`), 1 (`offset_um`).
impl<T: Real> Linear<T> for Duhem<T> {
    #[inline]
    fn advance(&self, state: &mut Self::State, voltage: T) {
        state.input = voltage;
        state.answers = state.held.step(voltage, self.half_width, |answers, from, to| self.follow(answers, from, to));
    }

    fn columns(&self, state: &Self::State, mut each: impl FnMut(T)) {
        let (v, Answers { z0, z2 }) = (state.input - self.centre, state.answers);
        [v - z0, self.cubic(v) - T::of(3.0) * z2, z0, z2, T::one()].into_iter().for_each(&mut each);
    }
}
