//! The noise that the logs of a table were read with. The device knows nothing of it but the deadband that was
//! chosen by it.

use serde::{Deserialize, Serialize};

/// One standard deviation each, of the quietest log that was trained on.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// Of the voltage, V.
    pub voltage_v: f64,
    /// Of the sensor, µm.
    pub displacement_um: f64,
}

/// So many standard deviations are no measure any more.
const FAR: f64 = 100.0;

impl Noise {
    /// In words, beside the table's deadband.
    pub fn told(&self, deadband_v: f32) -> String {
        let Self { voltage_v, displacement_um } = *self;
        let times = f64::from(deadband_v) / voltage_v;
        // A deadband that is chosen by the voltage's span is any number of times a small noise.
        let times = if times < FAR { format!("{times:.1} times the voltage's") } else { format!("{deadband_v} V") };
        format!("logs read with noise of {voltage_v:.2e} V and {displacement_um:.2e} µm (1 σ); the deadband is {times}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_said_beside_the_deadband() {
        let said = Noise { voltage_v: 0.005, displacement_um: 0.007 }.told(0.04);
        assert!(
            said.contains("5.00e-3 V and 7.00e-3 µm (1 σ)")
                && said.ends_with("the deadband is 8.0 times the voltage's"),
            "{said}"
        );
        for voltage_v in [0.0, 4e-7] {
            assert!(Noise { voltage_v, displacement_um: 0.0 }.told(0.04).ends_with("the deadband is 0.04 V"));
        }
    }
}
