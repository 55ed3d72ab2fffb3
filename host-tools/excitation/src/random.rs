//! The part that nobody can have learnt by heart: tones of random phases that swell and fade.
//!
//! ```text
//! x(t) = Σ sin(2π f_k t + φ_k)/√f_k      24 tones evenly apart in log f, from a fiftieth of the highest frequency to half of it
//! a(t) = 0.15 … 1                        two slow waves of other random phases
//! v(t) = middle + half·a(t)·tanh-limited x(t)
//! ```

use super::Request;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const TONES: usize = 24;
/// The lowest tone and the highest, of the highest frequency.
const BAND: (f64, f64) = (0.02, 0.5);
/// Periods of the two waves that swell it, s.
const SWELL_S: (f64, f64) = (5.3, 8.7);

/// A random voltage over time.
pub struct Random {
    tones: Vec<(f64, f64, f64)>,
    swell: [f64; 2],
    middle: f64,
    half: f64,
}

impl Random {
    /// Drawn by the request's seed.
    pub fn new(request: &Request) -> Self {
        let mut draw = ChaCha8Rng::seed_from_u64(request.seed);
        let (low, high) = (BAND.0 * request.up_to_hz, BAND.1 * request.up_to_hz);
        let mut tones: Vec<(f64, f64, f64)> = (0..TONES)
            .map(|k| {
                let hertz = low * libm::pow(high / low, k as f64 / (TONES - 1) as f64);
                (hertz, TAU * draw.random::<f64>(), 1.0 / libm::sqrt(hertz))
            })
            .collect();
        let power: f64 = tones.iter().map(|(_, _, size)| 0.5 * size * size).sum();
        tones.iter_mut().for_each(|(_, _, size)| *size /= libm::sqrt(power));
        Self {
            tones,
            swell: [TAU * draw.random::<f64>(), TAU * draw.random::<f64>()],
            middle: 0.5 * (request.min_v + request.max_v),
            half: 0.5 * request.span_v(),
        }
    }

    /// The voltage at a time (s), V.
    pub fn at(&self, t: f64) -> f64 {
        let sum: f64 = self.tones.iter().map(|(hertz, phase, size)| size * libm::sin(TAU * hertz * t + phase)).sum();
        let [one, other] = self.swell;
        let waves = libm::cos(TAU * t / SWELL_S.0 + one) + libm::cos(TAU * t / SWELL_S.1 + other);
        self.middle + self.half * (0.575 + 0.2125 * waves) * libm::tanh(sum)
    }
}
