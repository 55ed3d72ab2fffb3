//! The first-order element `τ·dx/dt = u − x`: creep, an amplifier's lag, a Kelvin–Voigt element.
//!
//! ```text
//! x ← x + (u − x)·k,   k = 1 − exp(−t_s/τ)     one tick, exact for an input held over it; k by expm1
//! ```
//!
//! **Resolution.** With τ = 100 s and 2 kHz, `k` is 5e-6 and a plain `f32` stands still once `k·(u − x)` is below half
//! a unit in the last place of `x`: with 0.7 V to go at 100 V already. `x` therefore carries what its last addition
//! lost into the next (Kahan's compensated sum; two more subtractions and two additions a tick), and no time constant
//! is too long.

use crate::math::Real;

/// The per-tick coefficient of an element.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Relaxation<T> {
    /// k, the part of the way to the input that a tick covers.
    fraction: T,
}

/// What an element remembers, with what its last addition lost: the two together are `value − lost`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Relaxed<T> {
    /// x, in the input's unit.
    pub value: T,
    lost: T,
}

impl<T: Real> Relaxed<T> {
    /// An element that has come to rest at this value.
    pub fn at(value: T) -> Self {
        Self { value, lost: T::zero() }
    }
}

impl<T: Real> Relaxation<T> {
    /// An element of this time constant τ (s, above 0) for ticks of `sample_period` seconds.
    pub fn build(time: T, sample_period: T) -> Self {
        Self { fraction: -(-sample_period / time).exp_m1() }
    }

    /// One tick towards an input.
    #[inline]
    pub fn step(&self, state: &mut Relaxed<T>, input: T) {
        let addend = (input - state.value) * self.fraction - state.lost;
        let sum = state.value + addend;
        state.lost = (sum - state.value) - addend;
        state.value = sum;
    }
}

/// An input lag, or none.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lag<T>(Option<Relaxation<T>>);

impl<T: Real> Lag<T> {
    /// A lag of this time constant (s) for ticks of `sample_period` seconds; none where it is 0.
    pub fn build(time: T, sample_period: T) -> Self {
        Self((time > T::zero()).then(|| Relaxation::build(time, sample_period)))
    }

    /// One tick: takes the input, returns what has come through. Without a lag that is the input itself.
    #[inline]
    pub fn step(&self, state: &mut Relaxed<T>, input: T) -> T {
        match &self.0 {
            Some(relaxation) => relaxation.step(state, input),
            None => *state = Relaxed::at(input),
        }
        state.value
    }
}

/// An input lag that is exact for an input which runs straight from tick to tick, or none.
///
/// ```text
/// x ← x + (X − x)·k,   X = u + β·(u − u'),   β = 1/(e^h − 1) − 1/h,   h = t_s/T     u' the input a tick ago
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RampLag<T>(Option<(Relaxation<T>, T)>);

/// What such a lag remembers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RampLagged<T> {
    output: Relaxed<T>,
    input: T,
}

impl<T: Real> RampLagged<T> {
    /// A lag that has come to rest at this value.
    pub fn at(value: T) -> Self {
        Self { output: Relaxed::at(value), input: value }
    }

    /// x, in the input's unit: what has come through the lag.
    pub fn value(&self) -> T {
        self.output.value
    }

    /// Holds the output at a value that something else limits it to.
    pub fn hold(&mut self, value: T) {
        self.output = Relaxed::at(value);
    }
}

impl<T: Real> RampLag<T> {
    /// A lag of this time constant T (s) for ticks of `sample_period` seconds; none where it is 0.
    pub fn build(time: T, sample_period: T) -> Self {
        Self((time > T::zero()).then(|| (Relaxation::build(time, sample_period), beta(sample_period / time))))
    }

    /// The same for an input that stands still within a tick, as a converter's output does.
    #[must_use]
    pub fn of_held_input(self) -> Self {
        Self(self.0.map(|(relaxation, _)| (relaxation, T::zero())))
    }

    /// k and β of the equation above, for whoever advances many elements of one time constant; 1 and 0 without a lag.
    pub fn coefficients(&self) -> (T, T) {
        self.0.as_ref().map_or((T::one(), T::zero()), |&(Relaxation { fraction }, beta)| (fraction, beta))
    }

    /// One tick: takes the input, returns what has come through. Without a lag that is the input itself.
    #[inline]
    pub fn step(&self, state: &mut RampLagged<T>, input: T) -> T {
        match &self.0 {
            Some((relaxation, beta)) => relaxation.step(&mut state.output, input + *beta * (input - state.input)),
            None => state.output = Relaxed::at(input),
        }
        state.input = input;
        state.output.value
    }
}

/// 1/(e^h − 1) − 1/h, between −1/2 and 0; by its series where the two terms would cancel.
fn beta<T: Real>(h: T) -> T {
    if h < T::one() {
        let square = h * h;
        h * (T::one() - square * (T::one() - square / T::of(42.0)) / T::of(60.0)) / T::of(12.0) - T::of(0.5)
    } else {
        T::one() / h.exp_m1() - T::one() / h
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 100 V, up to τ = 10,000 s, against the closed form.
    #[test]
    fn a_slow_element_arrives_in_single_precision() {
        for time in [0.01f32, 1.0, 100.0, 10_000.0] {
            let element = Relaxation::build(time, 5e-4);
            let mut state = Relaxed::at(0.0f32);
            let ticks = 400_000;
            (0..ticks).for_each(|_| element.step(&mut state, 100.0));
            let expected = -100.0 * f64::exp_m1(-f64::from(ticks) * f64::from(5e-4f32) / f64::from(time));
            let error = (f64::from(state.value) - expected).abs();
            assert!(error < 2e-5 * expected, "{time} s: {} instead of {expected}", state.value);
        }
    }

    #[test]
    fn without_a_lag_the_input_comes_through_to_the_bit() {
        let lag = Lag::build(0.0f32, 5e-4);
        let mut state = Relaxed::at(0.1);
        for input in [33.3, -7.1, 1e-3] {
            assert_eq!(lag.step(&mut state, input), input);
        }
    }

    /// A ramp comes out late by the time constant, whatever the tick.
    #[test]
    fn a_ramp_is_late_by_the_lag() {
        for time in [1e-4f64, 4e-4, 6e-4, 2e-3, 0.5] {
            let lag = RampLag::build(time, 5e-4);
            let mut state = RampLagged::at(0.0);
            let ticks = 40_000;
            (1..=ticks).for_each(|tick| {
                lag.step(&mut state, f64::from(tick) * 0.01);
            });
            let late = (f64::from(ticks) * 0.01 - state.value()) / 0.01 * 5e-4;
            assert!((late - time).abs() < 1e-5 * time, "{late} s instead of {time} s");
        }
    }
}
