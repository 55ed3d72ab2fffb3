//! What the converter sees of the divider while it samples.
//!
//! The STM32G474's converter closes a switch onto 5 pF for 47.5 clocks of 42.5 MHz, sixteen times in a row (`firmware`,
//! `nucleo_g474re/sampling.rs`). What is before the pin must give that charge again meanwhile: the capacitor at the pin
//! does at once, and its resistor has the sampling time to fill it up.

use crate::Divider;
use serde::Serialize;

/// Clocks of the converter while it samples, and their rate, Hz.
const CLOCKS: f64 = 47.5;
const CLOCK_HZ: f64 = 42.5e6;
/// The converter's own capacitor, F (data sheet, "ADC characteristics").
const OWN: f64 = 5e-12;
/// What stands before the pin, Ω and F.
const FILTER: (f64, f64) = (100.0, 4.7e-9);

/// Times and errors of a sample.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Sampling {
    /// How long the converter samples, s.
    pub time_s: f64,
    /// Time constant of the resistor and the capacitor before the pin behind a follower, s.
    pub filter_s: f64,
    /// What is missing at the end of the sampling time of the difference to what was sampled before, as a part of it;
    /// behind a follower.
    pub missing: f64,
    /// The time constant where the divider itself stands in the follower's place, s.
    pub bare_s: f64,
    /// What is missing then.
    pub bare_missing: f64,
}

impl Sampling {
    /// How well the converter's sampling settles behind this divider.
    pub fn of(divider: &Divider) -> Self {
        let (ohms, farads) = FILTER;
        let time_s = CLOCKS / CLOCK_HZ;
        // The two capacitors share what the first one holds, and the rest comes through the resistor.
        let missing = |constant: f64| OWN / (OWN + farads) * (-time_s / constant).exp();
        let filter_s = ohms * farads;
        let bare_s = (divider.impedance() + ohms) * farads;
        Self { time_s, filter_s, missing: missing(filter_s), bare_s, bare_missing: missing(bare_s) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_follower_lets_it_settle_and_the_bare_divider_does_not() {
        let divider = Divider { r1: 20e3, r2: Some(6.04e3), r3: Some(8.66e3) };
        let of = Sampling::of(&divider);
        assert!((of.time_s - 1.118e-6).abs() < 1e-9 && (of.filter_s - 0.47e-6).abs() < 1e-12);
        // Half a step of 12 bits is 1.2e-4 of the range.
        assert!(of.missing < 1.2e-4, "{of:?}");
        assert!(of.bare_missing > 9e-4 && of.bare_s > 10.0 * of.time_s, "{of:?}");
    }
}
