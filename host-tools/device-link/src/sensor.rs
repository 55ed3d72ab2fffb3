//! A displacement sensor on the board's second channel: codes to µm.

use estimator_core::AdcCode;
use protocol::Sample;

/// `displacement = zero + (full − zero)·code/full_scale`: what the ends of the channel stand for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sensor {
    /// Displacement at code 0, µm.
    pub zero_um: f64,
    /// Displacement at full scale, µm.
    pub full_um: f64,
    /// The channel's largest code.
    pub full_scale: u16,
}

impl Sensor {
    /// The displacement that it showed at a sample's tick, µm; `None` where the board has no such channel.
    pub fn um(&self, sample: &Sample) -> Option<f64> {
        Some(self.displacement(AdcCode(sample.sensor?)))
    }

    /// The displacement of a code, µm.
    pub fn displacement(&self, AdcCode(code): AdcCode) -> f64 {
        self.zero_um + (self.full_um - self.zero_um) * f64::from(code) / f64::from(self.full_scale)
    }

    /// Whether a sample's code stands at an end of the channel, where the displacement may have been any farther:
    /// within a 128th of it, as the firmware judges the monitor's.
    pub fn saturated(&self, sample: &Sample) -> bool {
        let margin = self.full_scale / 128;
        sample.sensor.is_some_and(|code| code <= margin || code >= self.full_scale - margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_um_and_the_ends_are_saturation() {
        let sensor = Sensor { zero_um: 25.0, full_um: -5.0, full_scale: 65_520 };
        let of = |code| Sample {
            code: 1,
            sensor: code,
            displacement: 0.0,
            half_width: None,
            dac: 0,
            status: Default::default(),
            faults: Default::default(),
        };
        assert_eq!(sensor.um(&of(Some(32_760))), Some(10.0));
        assert_eq!(sensor.um(&of(None)), None);
        let saturated =
            [None, Some(511), Some(512), Some(65_008), Some(65_009)].map(|code| sensor.saturated(&of(code)));
        assert_eq!(saturated, [false, true, false, false, true]);
    }
}
