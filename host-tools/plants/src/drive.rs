//! What stands between the commanded voltage and the ceramic, and between its strain and the position.

use super::hysteresis::STEP_S;
use std::f64::consts::TAU;

/// An amplifier: slew limit, then a first-order lag; at rest at 0 V.
pub struct Drive {
    most: f64,
    keep: f64,
    slewed: f64,
    voltage: f64,
}

impl Drive {
    pub fn new(slew_v_per_s: Option<f64>, lag_s: f64) -> Self {
        let most = slew_v_per_s.map_or(f64::INFINITY, |slew| slew * STEP_S);
        let keep = if lag_s > 0.0 { libm::exp(-STEP_S / lag_s) } else { 0.0 };
        Self { most, keep, slewed: 0.0, voltage: 0.0 }
    }

    /// The voltage at the ceramic, V.
    pub fn step(&mut self, command: f64) -> f64 {
        self.slewed += (command - self.slewed).clamp(-self.most, self.most);
        self.voltage = self.keep * self.voltage + (1.0 - self.keep) * self.slewed;
        self.voltage
    }

    /// The voltage at the ceramic after the last step, V.
    pub fn voltage(&self) -> f64 {
        self.voltage
    }
}

/// A resonance of the mechanics.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resonance {
    /// Its frequency, Hz.
    pub hertz: f64,
    /// Its damping ratio.
    pub damping: f64,
}

/// ÿ + 2ζω·ẏ + ω²·y = ω²·x, semi-implicit Euler, which is stable at 10 kHz far beyond 1 kHz.
pub struct Mechanics {
    omega: f64,
    damping: f64,
    position: f64,
    speed: f64,
}

impl Mechanics {
    pub fn new(resonance: Resonance) -> Self {
        Self { omega: TAU * resonance.hertz, damping: resonance.damping, position: 0.0, speed: 0.0 }
    }

    pub fn step(&mut self, wanted: f64) -> f64 {
        let pull = self.omega * self.omega * (wanted - self.position);
        self.speed += STEP_S * (pull - 2.0 * self.damping * self.omega * self.speed);
        self.position += STEP_S * self.speed;
        self.position
    }
}
