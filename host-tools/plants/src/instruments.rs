//! The reading of the voltage and the displacement sensor.

use super::draw::Draw;

/// How a recording is read.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Instruments {
    /// Sensor noise, nm rms.
    pub noise_nm: f64,
    /// The sensor drifts by a rate of this order, nm/s: a normal number times it, another in each recording.
    pub drift_nm_per_s: f64,
    /// Bits of the voltage reading over ±110 % of the full voltage; `None` reads it exactly.
    pub adc_bits: Option<u8>,
}

impl Default for Instruments {
    /// 10 nm, 5 nm/s, 12 bit.
    fn default() -> Self {
        Self { noise_nm: 10.0, drift_nm_per_s: 5.0, adc_bits: Some(12) }
    }
}

impl Instruments {
    /// Instruments that add neither noise, nor drift, nor steps.
    pub const EXACT: Self = Self { noise_nm: 0.0, drift_nm_per_s: 0.0, adc_bits: None };

    /// Adds noise and drift to positions (µm) that are so many s apart.
    pub(super) fn read(&self, positions: &mut [f64], period_s: f64, seed: u64) {
        let mut draw = Draw::new(!seed);
        let drift = 1e-3 * self.drift_nm_per_s * draw.normal() * period_s;
        for (index, position) in positions.iter_mut().enumerate() {
            *position += 1e-3 * self.noise_nm * draw.normal() + drift * index as f64;
        }
    }

    /// A voltage (V) as it is read.
    pub(super) fn quantised(&self, voltage: f64, full_v: f64) -> f64 {
        let Some(bits) = self.adc_bits else { return voltage };
        let half = 1.1 * full_v;
        let step = 2.0 * half / f64::from((1u32 << bits) - 1);
        ((voltage + half) / step).round().clamp(0.0, 2.0 * half / step) * step - half
    }
}
