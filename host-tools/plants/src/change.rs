//! What makes a device another than the one that was learnt.

/// Gain of a warming actuator: the piezoelectric coefficient's change with temperature, 1/K.
const GAIN_PER_K: f64 = -0.003;
/// Thermal expansion as the sensor sees it, µm/K.
const DRIFT_UM_PER_K: f64 = 0.05;

/// A change of gain, thresholds, zero and temperature. The displacement (µm) at time t (s) becomes
///
/// ```text
/// y·gain·(1 − 0.003/K·ΔT) + offset + 0.05 µm/K·ΔT,     ΔT = kelvin_per_s·t
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Change {
    /// Factor on the displacement.
    pub gain: f64,
    /// Factor on the thresholds of the hysteresis.
    pub coercive: f64,
    /// Added to the displacement, µm.
    pub offset_um: f64,
    /// Ramp of the temperature, K/s.
    pub kelvin_per_s: f64,
}

impl Change {
    /// As it was learnt.
    pub const NONE: Self = Self { gain: 1.0, coercive: 1.0, offset_um: 0.0, kelvin_per_s: 0.0 };

    /// It warms up while it is recorded.
    pub const fn warming(kelvin_per_s: f64) -> Self {
        Self { kelvin_per_s, ..Self::NONE }
    }

    /// It pushes against a spring of so much of its own stiffness, with a preload that moves its zero (µm):
    /// the stroke is divided by 1 + that (PI Ceramic, *Piezo Technology*, "Displacement under load").
    pub fn load(stiffness: f64, offset_um: f64) -> Self {
        Self { gain: 1.0 / (1.0 + stiffness), offset_um, ..Self::NONE }
    }

    /// It has aged: less gain and wider thresholds, each by a fraction.
    pub fn ageing(fraction: f64) -> Self {
        Self { gain: 1.0 - fraction, coercive: 1.0 + fraction, ..Self::NONE }
    }

    /// The displacement (µm) at a time (s).
    pub(super) fn of(&self, displacement: f64, seconds: f64) -> f64 {
        let kelvin = self.kelvin_per_s * seconds;
        displacement * self.gain * (1.0 + GAIN_PER_K * kelvin) + self.offset_um + DRIFT_UM_PER_K * kelvin
    }
}
