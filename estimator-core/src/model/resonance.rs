//! A lightly damped mechanical resonance, `ÿ + 2ζω·ẏ + ω²·y = ω²·w`, exact for an input that runs straight within a tick.
//!
//! On a straight input with slope r the steady answer is `w − 2ζr/ω`, moving with r; what differs from it swings freely. So a
//! tick is: subtract the steady answer, turn and shrink the rest by `exp(A·t_s)`, add the steady answer a tick later.
//!
//! **Bound.** With `g` the answer to an impulse and `Λ` the hat that is 1 at a tick and 0 at its neighbours, the answer to an
//! input that runs straight from tick to tick is a sum over the ticks,
//!
//! ```text
//! y(n) = Σ h_k·w(n−k),   h_k = ∫ g(t)·Λ(t/t_s − k) dt,   Σ h_k = 1
//! Σ |h_k| ≤ ∫ |g(t)| dt = (1 + q)/(1 − q),   q = exp(−πζ/√(1 − ζ²))
//! ```
//!
//! because the hats add up to 1, and every half swing of `g` is q times the one before. So an input within ± R about a middle,
//! whatever its sequence, draws the displacement no further than ± R·(1 + q)/(1 − q) about it: 1/ζ times 2/π where the damping
//! is small. An input that swings with the resonance comes close to it.

use crate::math::Real;
use crate::range::Range;

/// Per-tick coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resonance<T> {
    /// 2ζ/(ω·t_s): how far the steady answer lags, in changes a tick.
    lag: T,
    /// exp(A·t_s) on displacement and velocity, the latter in µm a tick.
    free: [[T; 2]; 2],
    /// The frequency is below half the tick rate.
    below_half: bool,
    /// (1 + q)/(1 − q): how far beyond its input's range it can swing.
    gain: T,
}

/// Part of the swing's square that a tick takes away at least: the coefficients of an f32 then have the loss to within a
/// thousandth.
const LEAST_LOSS: f32 = 1.0 / 4096.0;
/// Roundings of an f32 that a tick makes at most, each of half a unit in the last place of the largest number in it.
const ROUNDINGS: f32 = 16.0;

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
        let pi = T::of(core::f32::consts::PI);
        let angle = two * pi * hertz * sample_period;
        // √(1 − ζ²) as exp(ln(…)/2).
        let root = ((T::one() - damping * damping).ln() / two).exp();
        let (sin, cos) = sin_cos(angle * root);
        let shrunk = (-damping * angle).exp();
        let (sin, cos) = (shrunk * sin / root, shrunk * cos);
        // 1 − q.
        let dies = -(-pi * damping / root).exp_m1();
        Self {
            lag: two * damping / angle,
            below_half: angle < pi,
            gain: (two - dies) / dies,
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

    /// How far the displacement can swing beyond the range of the input, as a multiple of it about its middle, at least 1:
    /// what the sum of `|h_k|` is at most.
    pub fn gain(&self) -> T {
        self.gain
    }

    /// The displacements that a sequence of inputs of this range can lead to, with what an f32 rounds; `None` where it is not
    /// [sound](Self::sound).
    pub fn reach(&self, input: Range<T>) -> Option<Range<T>> {
        if !self.sound() {
            return None;
        }
        let [[a, b], [c, d]] = self.free;
        let (half, middle) = (input.span() * T::of(0.5), input.middle());
        let swing = half * self.gain;
        // What a tick rounds dies out as a swing does: 1/loss of it add up, of the square's loss twice that.
        let lasting = T::of(2.0) / (T::one() - (a * d - b * c));
        let rounding = T::of(ROUNDINGS * 0.5 * f32::EPSILON) * lasting * (middle.abs() + swing);
        Some(Range { min: middle - swing - rounding, max: middle + swing + rounding })
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

    /// Answers to a hat, one after the other, until nothing of them is left.
    fn hats<T: Real>(resonance: &Resonance<T>, ticks: usize) -> Vec<T> {
        let mut state = ResonanceState::rest(T::zero());
        let mut hat = core::iter::once(T::one());
        (0..ticks).map(|_| resonance.step(&mut state, hat.next().unwrap_or(T::zero()))).collect()
    }

    #[test]
    fn the_gain_is_at_least_the_sum_of_its_answers_and_little_more_where_a_swing_has_many_ticks() {
        for z in [0.003, 0.02, 0.1, 0.33, 0.7, 0.95] {
            for f in [18.0, 100.0, 340.0, 700.0, 990.0] {
                let resonance = Resonance::build(f, z, TICK);
                let sum: f64 = hats(&resonance, 200_000).iter().map(|h| h.abs()).sum();
                assert!(sum <= resonance.gain() * (1.0 + 1e-9), "{f} Hz, {z}: {sum} above {}", resonance.gain());
                // The hat itself takes away what is near half the tick rate.
                let least = if f <= 100.0 { 0.95 } else { 0.3 };
                assert!(sum >= least * resonance.gain(), "{f} Hz, {z}: {sum} far below {}", resonance.gain());
            }
        }
    }

    /// The worst input there is, the signs of the answers backwards, in an `f32`.
    #[test]
    fn the_worst_input_stays_within_reach_in_single_precision_and_comes_close() {
        let input = Range { min: -4.0f32, max: 16.0 };
        for (f, z) in [(18.0, 0.0025), (100.0, 0.02), (340.0, 0.003), (340.0, 0.3), (900.0, 0.05)] {
            let resonance = Resonance::build(f, z, TICK as f32);
            let reach = resonance.reach(input).unwrap();
            let answers = hats(&resonance, 40_000);
            let mut state = ResonanceState::rest(input.middle());
            let drive = |h: &f32| if *h > 0.0 { input.max } else { input.min };
            let found = Range::of_values(answers.iter().rev().map(drive).map(|w| resonance.step(&mut state, w)));
            assert!(reach.hull(found) == reach, "{f} Hz, {z}: {found:?} beyond {reach:?}");
            let sum: f64 = hats(&Resonance::build(f.into(), z.into(), TICK), 40_000).iter().map(|h| h.abs()).sum();
            let most = f64::from(input.middle()) + f64::from(input.span()) / 2.0 * sum;
            assert!((f64::from(found.max) - most).abs() < 5e-3 * most, "{f} Hz, {z}: {} of {most}", found.max);
        }
    }

    #[test]
    fn what_an_f32_cannot_damp_has_no_reach() {
        let at = |f, z| Resonance::build(f, z, TICK as f32).reach(Range { min: 0.0, max: 1.0 });
        assert!(at(340.0, 1e-6).is_none() && at(1e30, 0.05).is_none() && at(1e-40, 0.05).is_none());
        assert!(at(1500.0, 0.05).is_none() && at(340.0, f32::NAN).is_none() && at(340.0, 0.003).is_some());
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
