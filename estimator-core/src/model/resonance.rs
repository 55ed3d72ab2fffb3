//! A lightly damped mechanical resonance, `ÿ + 2ζω·ẏ + ω²·y = ω²·w`, exact for an input that runs straight within a tick.
//!
//! On a straight input with slope r the steady answer is `w − 2ζr/ω`, moving with r; what differs from it swings freely. So a
//! tick is: subtract the steady answer, turn and shrink the rest by `exp(A·t_s)`, add the steady answer a tick later.

use crate::math::Real;

/// Per-tick coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resonance<T> {
    /// 2ζ/(ω·t_s): how far the steady answer lags, in changes a tick.
    lag: T,
    /// exp(A·t_s) on displacement and velocity, the latter in µm a tick.
    free: [[T; 2]; 2],
    /// The frequency is below half the tick rate.
    below_half: bool,
}

/// Part of the swing's square that a tick takes away at least: an f32 does not see less.
const LEAST_LOSS: f32 = 1.0 / 1_048_576.0;

/// What it remembers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ResonanceState<T> {
    input: T,
    displacement: T,
    /// µm a tick.
    velocity: T,
}

impl<T: Real> ResonanceState<T> {
    /// At rest.
    pub fn rest(displacement: T) -> Self {
        Self { input: displacement, displacement, velocity: T::zero() }
    }
}

impl<T: Real> Resonance<T> {
    /// `hertz`: natural frequency, above 0 and below half the tick rate; `damping`: ζ, above 0 and below 1.
    pub fn build(hertz: T, damping: T, sample_period: T) -> Self {
        let two = T::of(2.0);
        let angle = two * T::of(core::f32::consts::PI) * hertz * sample_period;
        // √(1 − ζ²) as exp(ln(…)/2).
        let root = ((T::one() - damping * damping).ln() / two).exp();
        let (sin, cos) = sin_cos(angle * root);
        let shrunk = (-damping * angle).exp();
        let (sin, cos) = (shrunk * sin / root, shrunk * cos);
        Self {
            lag: two * damping / angle,
            below_half: angle < T::of(core::f32::consts::PI),
            free: [[cos + damping * sin, sin / angle], [-angle * sin, cos - damping * sin]],
        }
    }

    /// Whether it swings, and swings out, in this number type: no number overflows, the frequency is below half the tick rate,
    /// and a tick takes at least a part of 2⁻²⁰ of the swing.
    pub fn sound(&self) -> bool {
        let [[a, b], [c, d]] = self.free;
        let finite = [self.lag, a, b, c, d].iter().all(|x| x.is_finite());
        finite && self.below_half && a * d - b * c <= T::one() - T::of(LEAST_LOSS)
    }

    /// The displacement a tick later, when the input has gone straight to `input`.
    #[inline]
    pub fn step(&self, state: &mut ResonanceState<T>, input: T) -> T {
        let change = input - state.input;
        let behind = self.lag * change;
        let swing = state.displacement - (state.input - behind);
        let speed = state.velocity - change;
        let [[a, b], [c, d]] = self.free;
        *state = ResonanceState {
            input,
            displacement: (input - behind) + (a * swing + b * speed),
            velocity: change + (c * swing + d * speed),
        };
        state.displacement
    }
}

/// Sine and cosine of an angle from 0 to π: Taylor's series of a quarter of it, doubled twice. libm's for f32 computes in f64,
/// which the target has no unit for.
fn sin_cos<T: Real>(angle: T) -> (T, T) {
    let x = angle * T::of(0.25);
    let square = x * x;
    // Σ (−x²)ⁿ/(2n+1)!·x and Σ (−x²)ⁿ/(2n)!, from the last term on.
    let series = |first: u16| {
        (0..8u16).rev().fold(T::one(), |sum, n| {
            let k = 2 * n + first;
            T::one() - square * sum / T::of(f32::from(k * (k + 1)))
        })
    };
    let mut sin = x * series(2);
    let mut cos = series(1);
    for _ in 0..2 {
        (sin, cos) = (T::of(2.0) * sin * cos, T::one() - T::of(2.0) * sin * sin);
    }
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 5e-4;

    #[test]
    fn a_step_response_is_the_closed_form() {
        let (f, z) = (340.0, 0.03);
        let resonance = Resonance::build(f, z, TICK);
        let mut state = ResonanceState::rest(0.0);
        // The input steps between the ticks; the answer to a straight rise within the first tick comes as two ramps.
        let omega = 2.0 * core::f64::consts::PI * f;
        let damped = omega * (1.0 - z * z).sqrt();
        let ramp = |t: f64| {
            if t <= 0.0 {
                return 0.0;
            }
            let free = (-z * omega * t).exp()
                * (2.0 * z / omega * (damped * t).cos() + (2.0 * z * z - 1.0) / damped * (damped * t).sin());
            t - 2.0 * z / omega + free
        };
        for k in 1..400 {
            let t = f64::from(k) * TICK;
            let exact = (ramp(t) - ramp(t - TICK)) / TICK;
            let found = resonance.step(&mut state, 1.0);
            assert!((found - exact).abs() < 1e-6, "tick {k}: {found} {exact}");
        }
    }

    #[test]
    fn sine_and_cosine_are_the_library_s() {
        for k in 0..=1000 {
            let angle = core::f64::consts::PI * f64::from(k) / 1000.0;
            let (sin, cos) = sin_cos(angle);
            assert!((sin - angle.sin()).abs() < 1e-13 && (cos - angle.cos()).abs() < 1e-13, "{angle}");
            let (sin, cos) = sin_cos(angle as f32);
            let (sin, cos) = (f64::from(sin), f64::from(cos));
            assert!((sin - angle.sin()).abs() < 1e-6 && (cos - angle.cos()).abs() < 1e-6, "{angle}");
        }
    }

    #[test]
    fn it_settles_at_its_input_and_f32_follows() {
        let resonance = Resonance::build(100.0f32, 0.05, 5e-4);
        let mut state = ResonanceState::rest(-3.0);
        let last = (0..20_000).map(|_| resonance.step(&mut state, 7.0)).last();
        assert!(last.is_some_and(|y| (y - 7.0).abs() < 1e-4), "{last:?}");
    }
}
