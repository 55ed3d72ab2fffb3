//! Bouc and Wen's equation as T. S. Low and W. Guo take it for a piezoceramic actuator (*Modeling of a three-layer
//! piezoelectric bimorph beam with hysteresis*, J. Microelectromech. Syst. 4, 1995), with any exponent and a cubic.
//!
//! ```text
//! dz = A·du − β·|du|·|z|ⁿ⁻¹·z − γ·du·|z|ⁿ,     h = u − z + κ·u³
//! ```

use super::draw::Draw;
use super::hysteresis::Hysteresis;

/// Largest step of the voltage at which the equation is integrated, of the full voltage.
const FINEST: f64 = 1e-3;

/// z and the numbers.
pub struct BoucWen {
    slope: f64,
    beta: f64,
    gamma: f64,
    exponent: f64,
    cubic: f64,
    before: f64,
    z: f64,
}

impl BoucWen {
    /// By its exponent n ≥ 1.
    pub fn new(exponent: f64, draw: &mut Draw) -> Self {
        let (slope, at_most) = (draw.about(0.4, 0.1), draw.about(0.17, 0.1));
        // z ends at (A/(β + γ))^(1/n).
        let both = slope / libm::pow(at_most, exponent);
        let share = draw.about(0.6, 0.1).min(0.9);
        Self {
            slope,
            beta: share * both,
            gamma: (1.0 - share) * both,
            exponent,
            cubic: 0.08 * draw.normal().clamp(-1.5, 1.5),
            before: 0.0,
            z: 0.0,
        }
    }
}

impl Hysteresis for BoucWen {
    fn step(&mut self, u: f64, _: f64) -> f64 {
        let change = u - self.before;
        let steps = (change.abs() / FINEST).ceil().max(1.0);
        let step = change / steps;
        for _ in 0..steps as usize {
            let size = self.z.abs();
            let power = libm::pow(size, self.exponent);
            let against = if size > 0.0 { power * self.z.signum() } else { 0.0 };
            self.z += self.slope * step - self.beta * step.abs() * against - self.gamma * step * power;
        }
        self.before = u;
        u - self.z + self.cubic * u * u * u
    }
}
