//! A rate-independent model behind a first-order lag of its input, or seen ahead of its tick. It takes voltages that
//! stand for a tick and those of a log alike, and its memory is not the displacement.
//!
//! ```text
//! du/dt = (V − u)/lag        amplifier and sensor; no lag, or below 0 (`look_ahead.rs`): u = V
//! y     = the model's displacement at u
//! ```

use super::Recursion;
use super::look_ahead::LookAhead;
use super::relaxation::{Lag, Relaxed};
use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;
use crate::rule::{self, Rule};

/// The longest tick of a table, s.
const LONGEST_TICK_S: f32 = 1.0;

/// What a lag (s) must be.
///
/// # Errors
/// The rule that it breaks.
pub(super) fn check(lag_s: f32) -> Result<(), Rule> {
    rule::check([
        ("lag_s must be finite", lag_s.is_finite()),
        ("lag_s must be at least -1, the longest tick", lag_s >= -LONGEST_TICK_S),
    ])
}

/// Per-tick coefficients of a lag, and the model behind it. The lag computes in `L`: in `f32` before a model whose
/// memory hangs on the last bit of its input, so that every number type remembers the same.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lagged<T, M, L = T> {
    lag: Lag<L>,
    look_ahead: LookAhead<T>,
    model: M,
}

/// The memory of both.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LaggedState<T, S, L = T> {
    /// u, V: the voltage behind the lag.
    input: Relaxed<L>,
    model: S,
    /// The model's displacement a tick ago, µm.
    displacement: T,
}

impl<T: Real, M, L: Real> Lagged<T, M, L> {
    /// A model behind a lag (s), or, where it is below 0, seen ahead by as much, at ticks of `sample_period` seconds.
    pub fn build(lag_s: f32, sample_period: T, model: M) -> Self {
        Self {
            lag: Lag::build(L::of(lag_s), L::nearest(sample_period)),
            look_ahead: LookAhead::build(T::of(lag_s), sample_period),
            model,
        }
    }

    /// The model behind the lag.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// How far ahead of its tick the model is seen.
    pub fn look_ahead(&self) -> LookAhead<T> {
        self.look_ahead
    }

    /// A lag that has come to rest at a voltage, V.
    pub fn at_rest(&self, voltage: T) -> Relaxed<L> {
        Relaxed::at(L::nearest(voltage))
    }

    /// One tick of the lag alone: takes the voltage, returns the one that has come through, V.
    #[inline]
    pub fn input(&self, state: &mut Relaxed<L>, voltage: T) -> T {
        T::nearest(self.lag.step(state, L::nearest(voltage)))
    }
}

impl<T: Real, M: Recursion<T>, L: Real> Recursion<T> for Lagged<T, M, L> {
    type State = LaggedState<T, M::State, L>;

    const REMEMBERS: bool = M::REMEMBERS;

    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let model = self.model.begin(voltage, displacement);
        let displacement = self.model.peek(&model, voltage);
        LaggedState { input: self.at_rest(voltage), model, displacement }
    }

    /// At rest nothing is late, and nothing ahead.
    #[inline]
    fn first(&self, voltage: T, displacement: Option<T>) -> (Self::State, T) {
        let (model, displacement) = self.model.first(voltage, displacement);
        (LaggedState { input: self.at_rest(voltage), model, displacement }, displacement)
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        let input = self.input(&mut state.input, voltage);
        let before = state.displacement;
        state.displacement = self.model.step(&mut state.model, input);
        self.look_ahead.of(state.displacement, before)
    }

    /// Without what would be kept.
    #[inline]
    fn peek(&self, state: &Self::State, voltage: T) -> T {
        let input = self.input(&mut { state.input }, voltage);
        self.look_ahead.of(self.model.peek(&state.model, input), state.displacement)
    }

    /// The model's: u is a mean of voltages.
    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        self.model.bound(voltage, limits)
    }

    fn of_held_voltage(&self) -> Self
    where
        Self: Clone,
    {
        Self { look_ahead: LookAhead::none(), ..self.clone() }
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(Self { lag: self.lag, look_ahead: LookAhead::none(), model: self.model.monotone_part()? })
    }
}
