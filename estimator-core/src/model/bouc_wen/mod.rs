//! Bouc-Wen hysteresis, symmetric or not, of the voltage u behind a lag (`lagged.rs`). Rate-independent. Its memory is
//! held within the table's deadband (`held.rs`).
//!
//! ```text
//! dh/du = A − |h|^n·(β·sgn(h·du) + γ + δ·sgn(du))         V; h' = A·u' − β·|u'|·h·|h|^(n−1) − γ·u'·|h|^n for δ = 0
//! y = offset + d1·u + d2·u² + c·h                         µm; a displacement that lags the voltage has c < 0
//! ```
//!
//! Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249 (in the thesis: Section 3.2.2, a special case of Eq. 3.11). δ is the
//! `sgn(du)` term of the generalised form of Song and Der Kiureghian, J. Eng. Mech. 132 (2006) 610: rising and falling
//! branches saturate at different |h|. d2 is the asymmetry of the unhysteretic part. `A` only scales `h`: set it to 1
//! unless a published set has another, and never identify it beside c.
//!
//! **Bound.** With β + γ > |δ| and β ≥ |δ|, `h` stays within `−(A/(β+γ−δ))^(1/n) … (A/(β+γ+δ))^(1/n)`: at either end
//! the loading branch has slope 0, and the other branch leads inwards.
//!
//! How h is integrated: `branch.rs`.

mod branch;

use super::held::{Held, half_width};
use super::lagged::{self, Lagged};
use super::{Discretisation, Linear, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use branch::{Branch, Power};
use serde::{Deserialize, Serialize};

/// Bouc-Wen parameters as Wen (1976) writes them, with δ of Song and Der Kiureghian (2006); what
/// [`check`](Published::check) holds of them makes h bounded.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoucWenParameters {
    /// Time constant of the input lag, s; 0 is none. Below 0 the time by which the displacement is ahead of a tick
    /// after its voltage: at most a tick of it counts.
    pub lag_s: f32,
    /// A, slope dh/du at h = 0, V/V; above 0.
    pub a: f32,
    /// β, V^−n, at least |δ|: what slows h where the voltage moves it away from 0.
    pub beta: f32,
    /// γ, V^−n, signed: what slows h on loading and unloading alike; β + γ exceeds |δ|.
    pub gamma: f32,
    /// δ, V^−n, signed: what slows a rise more than a fall; 0 is the symmetric model.
    pub delta: f32,
    /// n, no unit, 1 to 8: how sharply loading ends; 1 has an exact step.
    pub n: f32,
    /// Displacement without hysteresis at 0 V, µm.
    pub offset_um: f32,
    /// d1, µm/V: slope of the displacement without hysteresis at 0 V.
    pub d1_um_per_v: f32,
    /// d2, µm/V²: half of how fast that slope changes.
    pub d2_um_per_v2: f32,
    /// c, µm per volt of h; signed.
    pub c_um_per_v: f32,
}

impl Published for BoucWenParameters {
    type Coefficients<T: Real> = Lagged<T, BoucWen<T>>;
    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Lagged<T, BoucWen<T>> {
        let model = BoucWen::build(self, discretisation.deadband);
        Lagged::build(self.lag_s, discretisation.sample_period, model)
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        let Self { lag_s, a, beta, gamma, delta, n, offset_um, d1_um_per_v, d2_um_per_v2, c_um_per_v } = *self;
        lagged::check(lag_s)?;
        let all = [a, beta, gamma, delta, n, offset_um, d1_um_per_v, d2_um_per_v2, c_um_per_v];
        if !all.iter().all(|number| number.is_finite()) {
            return Err("every parameter must be finite");
        }
        if a <= 0.0 {
            return Err("a must be above 0");
        }
        if !(1.0..=8.0).contains(&n) {
            return Err("n must be from 1 to 8");
        }
        if beta < delta.abs() {
            return Err("beta must be at least |delta|");
        }
        if beta + gamma <= delta.abs() {
            return Err("beta + gamma must exceed |delta|");
        }
        let limits = BoucWen::<f32>::build(self, 0.0).limits();
        if !(limits.min.is_finite() && limits.max.is_finite() && limits.span() > 0.0) {
            return Err("the hysteresis must have a finite bound");
        }
        Ok(())
    }
}

/// Per-tick coefficients of the Bouc-Wen model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BoucWen<T> {
    /// Of the play that decides when the memory moves, V.
    half_width: T,
    power: Power<T>,
    rising: Branch<T>,
    falling: Branch<T>,
    offset: T,
    d1: T,
    d2: T,
    c: T,
}

/// Voltage and hysteresis of a running model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BoucWenState<T> {
    /// u of the last tick, V.
    input: T,
    held: Held<T, T>,
    /// h at u, V, within [`BoucWen::limits`]; what is kept of it stands where [`Held`] last moved.
    pub hysteresis: T,
}

impl<T: Real> BoucWen<T> {
    /// Coefficients with the memory held until the voltage has gone back by more than 1.5 times the `deadband`, V; the
    /// lag is not among them. Checks nothing: see [`BoucWenParameters::check`].
    pub fn build(parameters: &BoucWenParameters, deadband: T) -> Self {
        let p = parameters;
        let (a, n) = (T::of(p.a), T::of(p.n));
        let (beta, gamma, delta) = (T::of(p.beta), T::of(p.gamma), T::of(p.delta));
        let mut rising = Branch::new(a, beta + gamma + delta, gamma - beta + delta, n);
        let mut falling = Branch::new(a, beta + gamma - delta, gamma - beta - delta, n);
        rising.measure(n, falling.limit);
        falling.measure(n, rising.limit);
        Self {
            half_width: half_width(deadband),
            power: match p.n {
                1.0 => Power::One,
                2.0 => Power::Two,
                _ => Power::General(n),
            },
            rising,
            falling,
            offset: T::of(p.offset_um),
            d1: T::of(p.d1_um_per_v),
            d2: T::of(p.d2_um_per_v2),
            c: T::of(p.c_um_per_v),
        }
    }

    /// The values of h that can be, V.
    pub fn limits(&self) -> Range<T> {
        Range { min: -self.falling.limit, max: self.rising.limit }
    }

    /// h (V) after a monotone move of the input (V) from h.
    #[inline]
    pub fn follow(&self, h: T, change: T) -> T {
        let after = if change > T::zero() {
            self.rising.travel(h, change, self.power)
        } else if change < T::zero() {
            -self.falling.travel(-h, -change, self.power)
        } else {
            h
        };
        self.limits().clamp(after)
    }

    /// The displacement (µm) at an input and a hysteresis (V).
    fn sum(&self, u: T, hysteresis: T) -> T {
        self.offset + u * (self.d1 + self.d2 * u) + self.c * hysteresis
    }

    /// What the displacement (µm) can be for voltages of this range (V); `None` without a bound.
    ///
    /// The parabola over the range and h anywhere within its limits.
    pub fn reach(&self, voltage: Range<T>) -> Option<Range<T>> {
        let h = self.limits();
        if !(h.min <= h.max && h.span().is_finite()) {
            return None;
        }
        let parabola = |u: T| u * (self.d1 + self.d2 * u);
        let vertex = if self.d2 == T::zero() { voltage.min } else { -self.d1 / (self.d2 + self.d2) };
        let mut reach = Range::empty();
        for u in [voltage.min, voltage.max, voltage.clamp(vertex)] {
            for h in [h.min, h.max] {
                reach = reach.include(self.offset + parabola(u) + self.c * h);
            }
        }
        Some(reach)
    }
}

impl<T: Real> Recursion<T> for BoucWen<T> {
    type State = BoucWenState<T>;

    const REMEMBERS: bool = true;

    /// h is the one that gives the displacement, within its limits; their middle where the displacement is unknown.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let limits = self.limits();
        let middle = (limits.min + limits.max) * T::of(0.5);
        let hysteresis = match displacement {
            Some(displacement) if self.c != T::zero() => {
                limits.clamp((displacement - self.sum(voltage, T::zero())) / self.c)
            }
            _ => middle,
        };
        BoucWenState { input: voltage, held: Held::new(voltage, hysteresis), hysteresis }
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        self.advance(state, voltage);
        self.sum(state.input, state.hysteresis)
    }

    /// Without what would be kept.
    #[inline]
    fn peek(&self, state: &Self::State, voltage: T) -> T {
        self.sum(voltage, state.held.shown(voltage, |h, from, to| self.follow(h, to - from)))
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(self.reach(voltage).ok_or(Inadmissible::NoBound)?, limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

/// Columns: `u`, `u²`, `h`, 1; weights: `d1_um_per_v`, `d2_um_per_v2`, `c_um_per_v`, `offset_um`.
impl<T: Real> Linear<T> for BoucWen<T> {
    #[inline]
    fn advance(&self, state: &mut Self::State, voltage: T) {
        state.input = voltage;
        state.hysteresis = state.held.step(voltage, self.half_width, |h, from, to| self.follow(h, to - from));
    }

    fn columns(&self, state: &Self::State, mut each: impl FnMut(T)) {
        let u = state.input;
        [u, u * u, state.hysteresis, T::one()].into_iter().for_each(&mut each);
    }
}
