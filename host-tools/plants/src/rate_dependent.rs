//! Plays whose thresholds grow with the rate of the voltage: the rate-dependent Prandtl–Ishlinskii operator of M. Al
//! Janaideh, S. Rakheja and C.-Y. Su, *A generalized rate dependent play operator for characterizing hysteresis*, 2009,
//! with the logarithmic dynamic threshold that they found for piezoceramics.
//!
//! ```text
//! r_i(u̇) = r_i + c·ln(1 + |u̇|/v₀)          |u̇| through a lag of 1 ms, so that it is one of the voltage and not of its steps
//! h(u)    = u + Σ w_i·p_i,   w_i ∝ exp(−r_i/ρ)
//! ```

use super::draw::Draw;
use super::hysteresis::Hysteresis;

const PLAYS: usize = 24;
/// Lag of the rate, s.
const RATE_LAG_S: f64 = 1e-3;

/// Plays whose thresholds grow with the rate of the voltage, as the module says.
pub struct RateDependent {
    plays: [f64; PLAYS],
    weights: [f64; PLAYS],
    /// c, of the full voltage.
    growth: f64,
    /// v₀, full voltages a second.
    from: f64,
    before: f64,
    rate: f64,
}

impl RateDependent {
    pub fn new(draw: &mut Draw) -> Self {
        let (share, decay) = (draw.about(0.55, 0.1), draw.about(0.3, 0.15));
        let mut weights: [f64; PLAYS] = std::array::from_fn(|index| libm::exp(-threshold(index) / decay));
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight *= share / total);
        Self {
            plays: [0.0; PLAYS],
            weights,
            growth: draw.about(0.02, 0.2),
            from: draw.about(4.0, 0.2),
            before: 0.0,
            rate: 0.0,
        }
    }
}

/// Of a play at rest.
fn threshold(index: usize) -> f64 {
    (index as f64 + 0.5) / PLAYS as f64
}

impl Hysteresis for RateDependent {
    fn step(&mut self, u: f64, seconds: f64) -> f64 {
        let rate = (u - self.before).abs() / seconds;
        self.rate += (1.0 - libm::exp(-seconds / RATE_LAG_S)) * (rate - self.rate);
        self.before = u;
        let wider = self.growth * libm::log1p(self.rate / self.from);
        let mut sum = u;
        for (index, (play, weight)) in self.plays.iter_mut().zip(&self.weights).enumerate() {
            let r = threshold(index) + wider;
            *play = play.clamp(u - r, u + r);
            sum += weight * *play;
        }
        sum
    }
}
