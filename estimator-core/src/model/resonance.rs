//! A lightly damped mechanical resonance, `ÿ + 2ζω·ẏ + ω²·y = ω²·w`, exact for an input that runs straight
//! within a tick.
//!
//! On a straight input with slope r the steady answer is `w − 2ζr/ω`, moving with r; what differs from it swings
//! freely, turned and shrunk by `exp(A·t_s)` a tick. With `φ = ω·t_s`, `√ = √(1 − ζ²)`, `S = e^(−ζφ)·sin(φ√)/√`, `C =
//! e^(−ζφ)·cos(φ√)`, the velocity v in µm a tick, and w → w + Δw, that is
//!
//! ```text
//! y ← y + (S/φ)·v − h·(y − w) + k·Δw     h = 1 − C − ζS,   k = 1 − 2ζh/φ − S/φ
//! v ← v − e·v − φS·(y − w) + h·Δw        e = 1 − C + ζS
//! ```
//!
//! Written as what a tick adds, because of what an `f32` rounds: a velocity that is off by δ every tick moves the
//! displacement by δ/φ², and this rounds a velocity of the size that it has, φ times a displacement, not one from which
//! Δw was taken and put back.
//!
//! **Bound.** With `g` the answer to an impulse and `Λ` the hat that is 1 at a tick and 0 at its neighbours, the answer
//! to an input that runs straight from tick to tick is a sum over the ticks,
//!
//! ```text
//! y(n) = Σ h_k·w(n−k),   h_k = ∫ g(t)·Λ(t/t_s − k) dt,   Σ h_k = 1
//! Σ |h_k| ≤ ∫ |g(t)| dt = (1 + q)/(1 − q),   q = exp(−πζ/√(1 − ζ²))
//! ```
//!
//! because the hats add up to 1, and every half swing of `g` is q times the one before. So an input within ± R about a
//! middle, whatever its sequence, draws the displacement no further than ± R·(1 + q)/(1 − q) about it: 1/ζ times 2/π
//! where the damping is small. An input that swings with the resonance comes close to it. The velocity stays within ±
//! R·∫ |g′(t)| dt ≤ R·2φ/(1 − q) a tick.

use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;

/// What a tick of the resonance adds to displacement and velocity, by their coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resonance<T> {
    /// The angle φ by which its state turns in a tick, rad.
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

/// Part of the swing's square that a tick takes away at least: the coefficients of an f32 then have the loss to
/// within a thousandth.
const LEAST_LOSS: f32 = 1.0 / 4096.0;
/// Least φ, a 400th of a turn: 5 Hz at 2 kHz. What is slower an f32 damps less and less as it should.
const LEAST_ANGLE: f32 = core::f32::consts::TAU / 400.0;
/// Roundings of an f32 that a tick makes at most in each of the two, each of half a unit in the last place of the
/// largest number in it.
const ROUNDINGS: f32 = 16.0;

/// Displacement (µm), velocity (µm a tick) and the input of a tick ago (µm).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ResonanceState<T> {
    input: T,
    displacement: T,
    /// µm a tick.
    velocity: T,
}

impl<T: Real> ResonanceState<T> {
    /// Long at rest at this displacement (µm): velocity 0.
    pub fn rest(displacement: T) -> Self {
        Self { input: displacement, displacement, velocity: T::zero() }
    }

    /// The same state for ticks that are so many times as long.
    #[must_use]
    pub fn of_longer_ticks(self, times: T) -> Self {
        Self { velocity: self.velocity * times, ..self }
    }
}

impl<T: Real> Resonance<T> {
    /// `hertz`: natural frequency, above 0 and below half the tick rate; `damping`: ζ, above 0 and below 1;
    /// `sample_period`: of a tick, s.
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

    /// Whether it swings, and swings out, in this number type: no number overflows, the frequency is a 400th of the
    /// tick rate at least and below half of it, and a tick takes at least 1/4096 of the swing's square.
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

    /// How far the displacement can swing beyond the range of the input, as a multiple of it about its middle, at least
    /// 1: what the sum of `|h_k|` is at most.
    pub fn gain(&self) -> T {
        self.gain
    }

    /// The displacements (µm) that a sequence of inputs of this range (µm) can lead to, with what an f32 rounds.
    ///
    /// # Errors
    /// It does not pass the [check](Self::check).
    pub fn reach(&self, input: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        self.check()?;
        let (half, middle) = (input.span() * T::of(0.5), input.middle());
        let swing = half * self.gain;
        // A displacement that is off dies out as a swing does: 1/loss of it add up, of the square's loss twice that. A
        // velocity that is off acts as an input that is off by 1/φ² of it would. 1/(1 − q) is half of gain + 1.
        let of_displacement = T::of(2.0) / self.loss() * (middle.abs() + swing);
        let velocity = self.angle * half * (self.gain + T::one());
        let of_velocity = self.gain / (self.angle * self.angle) * velocity;
        let rounding = T::of(ROUNDINGS * 0.5 * f32::EPSILON) * (of_displacement + of_velocity);
        Ok(Range { min: middle - swing - rounding, max: middle + swing + rounding })
    }

    /// The displacement (µm) a tick later, when the input (µm) has gone straight to `input`.
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

/// Sine and cosine of an angle from 0 to π: Taylor's series of a quarter of it, doubled twice. libm's for f32 computes
/// in f64, which the target has no unit for.
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
mod tests;
