//! Jiles and Atherton's equations as R. C. Smith and Z. Ounaies take them for piezoceramics (*A domain wall model for
//! hysteresis in piezoelectric materials*, J. Intell. Mater. Syst. Struct. 11, 2000): polarisation P follows the
//! anhysteretic one as far as pinned domain walls let it.
//!
//! ```text
//! P_an(u)   = coth(u_e/a) − a/u_e,   u_e = u + α·P
//! dP_irr/du = (P_an − P_irr) / (±k − α·(P_an − P_irr)),   + rising, − falling; 0 where it would turn back
//! P         = c·P_an + (1 − c)·P_irr,     h = u + share·P
//! ```

use super::draw::Draw;
use super::hysteresis::Hysteresis;

/// Largest step of the voltage at which the equations are integrated, of the full voltage.
const FINEST: f64 = 1e-3;

/// Polarisation and the numbers.
pub struct JilesAtherton {
    shape: f64,
    coupling: f64,
    pinning: f64,
    reversible: f64,
    share: f64,
    before: f64,
    irreversible: f64,
    polarisation: f64,
}

impl JilesAtherton {
    pub fn new(draw: &mut Draw) -> Self {
        Self {
            shape: draw.about(0.35, 0.1),
            coupling: draw.about(0.1, 0.2),
            pinning: draw.about(0.3, 0.1),
            reversible: draw.about(0.25, 0.15),
            share: draw.about(0.8, 0.1),
            before: 0.0,
            irreversible: 0.0,
            polarisation: 0.0,
        }
    }

    /// The anhysteretic polarisation at an effective voltage: Langevin's function.
    fn anhysteretic(&self, effective: f64) -> f64 {
        let x = effective / self.shape;
        // The series where the two terms nearly cancel.
        if x.abs() < 1e-2 { x / 3.0 } else { 1.0 / libm::tanh(x) - 1.0 / x }
    }
}

impl Hysteresis for JilesAtherton {
    fn step(&mut self, u: f64, _: f64) -> f64 {
        let change = u - self.before;
        let steps = (change.abs() / FINEST).ceil().max(1.0);
        let step = change / steps;
        for _ in 0..steps as usize {
            self.before += step;
            let anhysteretic = self.anhysteretic(self.before + self.coupling * self.polarisation);
            let missing = anhysteretic - self.irreversible;
            if missing * step > 0.0 {
                let pinned = self.pinning.copysign(step) - self.coupling * missing;
                self.irreversible += step * missing / pinned;
            }
            self.polarisation = self.reversible * anhysteretic + (1.0 - self.reversible) * self.irreversible;
        }
        self.before = u;
        u + self.share * self.polarisation
    }
}
