//! A lightly damped mechanical resonance, `ÿ + 2ζω·ẏ + ω²·y = ω²·w`, exact for an input that runs straight within a tick.
//!
//! On a straight input with slope r the steady answer is `w − 2ζr/ω`, moving with r; what differs from it swings freely, turned
//! and shrunk by `exp(A·t_s)` a tick. With `φ = ω·t_s`, `√ = √(1 − ζ²)`, `S = e^(−ζφ)·sin(φ√)/√`, `C = e^(−ζφ)·cos(φ√)`, the velocity v
//! in µm a tick, and w → w + Δw, that is
//!
//! ```text
//! y ← y + (S/φ)·v − h·(y − w) + k·Δw     h = 1 − C − ζS,   k = 1 − 2ζh/φ − S/φ
//! v ← v − e·v − φS·(y − w) + h·Δw        e = 1 − C + ζS
//! ```
//!
//! Written as what a tick adds, because of what an `f32` rounds: a velocity that is off by δ every tick moves the displacement by
//! δ/φ², and this rounds a velocity of the size that it has, φ times a displacement, not one from which Δw was taken and put back.
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
//! is small. An input that swings with the resonance comes close to it. The velocity stays within ± R·∫ |g′(t)| dt ≤ R·2φ/(1 − q) a tick.

use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;

/// Per-tick coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resonance<T> {
    /// φ.
    angle: T,
    /// (1 + q)/(1 − q): how far beyond its input's range it can swing.
    gain: T,
    /// S/φ: displacement of a velocity.
    drift: T,
    /// h: part of the way to the input, and velocity of the input's change.
    follow: T,
    /// k: displacement of the input's change.
    change: T,
    /// e: part of the velocity.
    brake: T,
    /// φS: velocity of the way to the input.
    pull: T,
}

/// Part of the swing's square that a tick takes away at least: the coefficients of an f32 then have the loss to within a
/// thousandth.
const LEAST_LOSS: f32 = 1.0 / 4096.0;
/// Least φ, a 400th of a turn: 5 Hz at 2 kHz. What is slower an f32 damps less and less as it should.
const LEAST_ANGLE: f32 = core::f32::consts::TAU / 400.0;
/// Roundings of an f32 that a tick makes at most in each of the two, each of half a unit in the last place of the largest number in it.
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
        let (one, two, half) = (T::one(), T::of(2.0), T::of(0.5));
        let pi = T::of(core::f32::consts::PI);
        let angle = two * pi * hertz * sample_period;
        // √(1 − ζ²) as exp(ln(…)/2).
        let root = ((one - damping * damping).ln() / two).exp();
        let shrunk = (-damping * angle).exp();
        let (sin, cos) = sin_cos(half * angle * root);
        let s = shrunk * two * sin * cos / root;
        // 1 − C, without cancellation where φ is small.
        let missing = shrunk * two * sin * sin - (-damping * angle).exp_m1();
        let (drift, follow) = (s / angle, missing - damping * s);
        // 1 − q.
        let dies = -(-pi * damping / root).exp_m1();
        Self {
            angle,
            gain: (two - dies) / dies,
            drift,
            follow,
            change: one - two * damping / angle * follow - drift,
            brake: missing + damping * s,
            pull: angle * s,
        }
    }

    /// Whether it swings, and swings out, in this number type: no number overflows, the frequency is a 400th of the tick rate at least
    /// and below half of it, and a tick takes at least 1/4096 of the swing's square.
    ///
    /// # Errors
    /// Which of these it is not.
    pub fn check(&self) -> Result<(), Inadmissible<T>> {
        let numbers = [self.gain, self.drift, self.follow, self.change, self.brake, self.pull];
        // False for a NaN.
        let damped = self.angle < T::of(core::f32::consts::PI) && self.loss() >= T::of(LEAST_LOSS);
        if self.angle < T::of(LEAST_ANGLE) {
            Err(Inadmissible::Slow)
        } else if damped && numbers.iter().all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(Inadmissible::Undamped)
        }
    }

    /// Part of the swing's square that a tick takes away, 1 less the determinant of `exp(A·t_s)`.
    fn loss(&self) -> T {
        self.follow + self.brake - self.follow * self.brake - self.drift * self.pull
    }

    /// How far the displacement can swing beyond the range of the input, as a multiple of it about its middle, at least 1:
    /// what the sum of `|h_k|` is at most.
    pub fn gain(&self) -> T {
        self.gain
    }

    /// The displacements that a sequence of inputs of this range can lead to, with what an f32 rounds.
    ///
    /// # Errors
    /// It does not pass the [check](Self::check).
    pub fn reach(&self, input: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        self.check()?;
        let (half, middle) = (input.span() * T::of(0.5), input.middle());
        let swing = half * self.gain;
        // A displacement that is off dies out as a swing does: 1/loss of it add up, of the square's loss twice that. A velocity that is
        // off acts as an input that is off by 1/φ² of it would. 1/(1 − q) is half of gain + 1.
        let of_displacement = T::of(2.0) / self.loss() * (middle.abs() + swing);
        let velocity = self.angle * half * (self.gain + T::one());
        let of_velocity = self.gain / (self.angle * self.angle) * velocity;
        let rounding = T::of(ROUNDINGS * 0.5 * f32::EPSILON) * (of_displacement + of_velocity);
        Ok(Range { min: middle - swing - rounding, max: middle + swing + rounding })
    }

    /// The displacement a tick later, when the input has gone straight to `input`.
    #[inline]
    pub fn step(&self, state: &mut ResonanceState<T>, input: T) -> T {
        let ResonanceState { input: before, displacement, velocity } = *state;
        let (change, away) = (input - before, displacement - before);
        *state = ResonanceState {
            input,
            displacement: displacement + (self.drift * velocity - self.follow * away + self.change * change),
            velocity: velocity + (self.follow * change - self.pull * away - self.brake * velocity),
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

    /// How near an `f32` comes to its worst, and to the `f64`, as parts of the reach; with the feature `micromath` its exp and
    /// ln make other coefficients.
    const NEAR: [f64; 2] = if cfg!(feature = "micromath") { [2e-2, 2e-3] } else { [5e-3, 2e-6] };
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
            for f in [5.0, 18.0, 100.0, 340.0, 700.0, 990.0] {
                if z * f < 0.04 {
                    continue;
                }
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
        for (f, z) in
            [(5.0, 0.01), (5.0, 0.95), (18.0, 0.0025), (100.0, 0.02), (340.0, 0.003), (340.0, 0.3), (900.0, 0.05)]
        {
            let resonance = Resonance::build(f, z, TICK as f32);
            let reach = resonance.reach(input).unwrap();
            let answers = hats(&resonance, 40_000);
            let mut state = ResonanceState::rest(input.middle());
            let drive = |h: &f32| if *h > 0.0 { input.max } else { input.min };
            let found = Range::of_values(answers.iter().rev().map(drive).map(|w| resonance.step(&mut state, w)));
            assert!(reach.hull(found) == reach, "{f} Hz, {z}: {found:?} beyond {reach:?}");
            let sum: f64 = hats(&Resonance::build(f.into(), z.into(), TICK), 40_000).iter().map(|h| h.abs()).sum();
            let most = f64::from(input.middle()) + f64::from(input.span()) / 2.0 * sum;
            assert!((f64::from(found.max) - most).abs() < NEAR[0] * most, "{f} Hz, {z}: {} of {most}", found.max);
        }
    }

    /// What swings from end to end at every tick, and sawtooths, whose mean it must keep: a velocity that is off would pile up.
    #[test]
    fn an_f32_keeps_the_mean_of_a_fast_input_down_to_the_slowest_resonance() {
        let input = Range { min: -4.0f32, max: 16.0 };
        for (f, z) in [5.0, 10.0, 40.0, 300.0].into_iter().flat_map(|f| [0.3, 0.7, 0.9, 0.95].map(|z| (f, z))) {
            let single = Resonance::build(f, z, TICK as f32);
            let double = Resonance::<f64>::build(f.into(), z.into(), TICK);
            let reach = single.reach(input).unwrap();
            for teeth in [2u16, 3, 7, 37, 400] {
                let mut states = (ResonanceState::rest(6.0f32), ResonanceState::rest(6.0f64));
                for tick in 0..60_000u32 {
                    let part = (tick % u32::from(teeth)) as f32 / f32::from(teeth - 1);
                    let w = input.min + input.span() * part;
                    let (one, other) = (single.step(&mut states.0, w), double.step(&mut states.1, w.into()));
                    assert!(reach.contains(one), "{f} Hz, {z}, {teeth} teeth: {one} beyond {reach:?}");
                    let apart = (f64::from(one) - other).abs();
                    assert!(apart <= NEAR[1] * f64::from(reach.span()), "{f} Hz, {z}, {teeth} teeth: {apart} µm apart");
                }
            }
        }
    }

    #[test]
    fn what_an_f32_cannot_damp_has_no_reach() {
        let at = |f, z| Resonance::build(f, z, TICK as f32).reach(Range { min: 0.0, max: 1.0 });
        for (f, z) in [(340.0, 1e-6), (1e30, 0.05), (1500.0, 0.05), (340.0, f32::NAN), (f32::NAN, 0.05), (5.0, 0.005)] {
            assert_eq!(at(f, z), Err(Inadmissible::Undamped), "{f} Hz, {z}");
        }
        for (f, z) in [(1e-40, 0.05), (0.1, 0.95), (0.2, 0.9), (4.9, 0.5)] {
            assert_eq!(at(f, z), Err(Inadmissible::Slow), "{f} Hz, {z}");
        }
        assert!(at(340.0, 0.003).is_ok() && at(5.0, 0.5).is_ok());
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
