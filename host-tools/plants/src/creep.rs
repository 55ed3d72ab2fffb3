//! Creep in the logarithm of time (A. Vieira, *The behavior of piezoelectric ceramics in scanning tunneling
//! microscopes*, IBM J. Res. Dev. 30, 1986): after a step of the strain by h it grows by g·h in each decade. Five
//! first-order elements, a decade apart, driven by the strain of the hysteresis; see H. Jung and D.-G. Gweon, *Creep
//! characteristics of piezoelectric actuators*, Rev. Sci. Instrum. 71, 2000.

use super::hysteresis::STEP_S;

/// Time constants, s.
const TAU_S: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];

/// Elements at rest at 0.
pub struct Creep {
    gain: f64,
    keep: [f64; TAU_S.len()],
    states: [f64; TAU_S.len()],
}

impl Creep {
    /// By the creep a decade, as a fraction of the strain.
    pub fn new(gain: f64) -> Self {
        Self { gain, keep: TAU_S.map(|tau| libm::exp(-STEP_S / tau)), states: [0.0; TAU_S.len()] }
    }

    /// The strain with creep.
    pub fn step(&mut self, strain: f64) -> f64 {
        for (state, keep) in self.states.iter_mut().zip(self.keep) {
            *state += (1.0 - keep) * (strain - *state);
        }
        strain + self.gain * self.states.iter().sum::<f64>()
    }
}
