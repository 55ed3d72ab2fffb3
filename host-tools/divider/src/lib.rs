//! Resistors that bring an amplifier's monitor, or a sensor's output, to the range of the board's converter, and those
//! of the [`Stage`] that brings the board's output to an amplifier's input.
//!
//! ```text
//!                 3.3 V ──[R2]──┐
//! source ──[R1]─────────────────┼──[ follower ]──[100 Ω]──┬── pin
//!                   GND ──[R3]──┘                      [4.7 nF] ── GND
//!
//! pin = V·G1/G + 3.3 V·G2/G,   Gi = 1/Ri,   G = G1 + G2 + G3
//! ```
//!
//! The 3.3 V are the converter's reference too: `code = full scale · pin / 3.3 V`, in which R2's part does not change
//! with them, and the source's goes as one over them. [`Divider::choose`] takes standard values, [`Divider::off`] says
//! what their tolerance costs, [`Divider::off_by_supply`] what the supply's does, and [`Sampling`] what the converter
//! sees. [`InputStage`] and [`OutputStage`] put it into words.

mod choice;
mod input_stage;
mod output_stage;
mod sampling;
pub mod series;
mod stage;
mod tolerance;

pub use choice::DividerError;
pub use input_stage::{Cost, InputStage, Source};
pub use output_stage::{OutputStage, TOLERANCE};
pub use sampling::Sampling;
pub use series::Series;
pub use stage::Stage;

use serde::Serialize;

/// The converter's reference, V, to which R2 goes.
pub const REFERENCE_V: f64 = 3.3;
/// Largest code of the board's ADC, its oversampling included.
pub const FULL_SCALE: u16 = 65_520;
/// Codes of one conversion's step: a conversion is of 12 bits, sixteen are added up.
pub const CODES_A_STEP: f64 = 16.0;
/// Where the pin is to stay, V: the codes beyond are kept for finding a voltage that is out of range.
pub const PIN_V: (f64, f64) = (0.15, 3.15);
/// What of the output pin's range is used, V: without 7 % at either end, which are left to the DAC's own buffer (it
/// reaches 0.2 … 3.1 V; data sheet of the STM32G474, "DAC characteristics").
pub const OUTPUT_PIN_V: (f64, f64) = (0.231, 3.069);

/// Three resistors, Ω.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Divider {
    /// From the source to the node.
    pub r1: f64,
    /// From the reference to the node; `None` where there is none.
    pub r2: Option<f64>,
    /// From the node to ground; `None` where there is none.
    pub r3: Option<f64>,
}

impl Divider {
    /// What of the source and what of the reference the node sees: `pin = a·V + b·3.3 V`.
    fn weights(&self) -> (f64, f64) {
        let of = |r: Option<f64>| r.map_or(0.0, f64::recip);
        let (g1, g2, g3) = (1.0 / self.r1, of(self.r2), of(self.r3));
        let all = g1 + g2 + g3;
        (g1 / all, g2 / all)
    }

    /// Voltage at the pin by that of the source, V.
    pub fn pin(&self, source_v: f64) -> f64 {
        let (a, b) = self.weights();
        a * source_v + b * REFERENCE_V
    }

    /// Voltage of the source by that at the pin, V.
    pub fn source(&self, pin_v: f64) -> f64 {
        let (a, b) = self.weights();
        (pin_v - b * REFERENCE_V) / a
    }

    /// What the source's voltage is at code 0 and at full scale, V.
    pub fn span(&self) -> (f64, f64) {
        (self.source(0.0), self.source(REFERENCE_V))
    }

    /// What the source's voltage seems to be where its wire is off, V; `None` where the node then floats.
    pub fn open(&self) -> Option<f64> {
        let [g2, g3] = [self.r2, self.r3].map(|r| r.map_or(0.0, f64::recip));
        (g2 + g3 > 0.0).then(|| self.source(REFERENCE_V * g2 / (g2 + g3)))
    }

    /// Part of the pin's range that the source's voltages, V, use.
    pub fn used(&self, (low, high): (f64, f64)) -> f64 {
        (self.pin(high) - self.pin(low)).abs() / (PIN_V.1 - PIN_V.0)
    }

    /// Volts of the source a code.
    pub fn volts_a_code(&self) -> f64 {
        let (zero, full) = self.span();
        (full - zero) / f64::from(FULL_SCALE)
    }

    /// The node's own resistance, Ω: all three side by side.
    pub fn impedance(&self) -> f64 {
        let of = |r: Option<f64>| r.map_or(0.0, f64::recip);
        (1.0 / self.r1 + of(self.r2) + of(self.r3)).recip()
    }

    /// What R1 takes at a voltage of the source, W.
    pub fn watts_in_r1(&self, source_v: f64) -> f64 {
        (source_v - self.pin(source_v)).powi(2) / self.r1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The node by its equation: the currents into it are none in sum.
    #[test]
    fn no_current_is_left_at_the_node() {
        let divider = Divider { r1: 20_000.0, r2: Some(6_040.0), r3: Some(8_660.0) };
        for volts in [-10.0, -3.0, 0.0, 4.0, 10.0] {
            let pin = divider.pin(volts);
            let current = (volts - pin) / 20_000.0 + (REFERENCE_V - pin) / 6_040.0 - pin / 8_660.0;
            assert!(current.abs() < 1e-15, "{current} A at {volts} V");
            assert!((divider.source(pin) - volts).abs() < 1e-12);
        }
        let (zero, full) = divider.span();
        assert!((divider.source(1.65) - (zero + 0.5 * (full - zero))).abs() < 1e-12, "a code is a line");
        assert!((divider.impedance() - (1.0f64 / 20_000.0 + 1.0 / 6_040.0 + 1.0 / 8_660.0).recip()).abs() < 1e-9);
        let open = divider.open().unwrap();
        assert!((divider.pin(open) - REFERENCE_V * 8_660.0 / 14_700.0).abs() < 1e-12, "no current through R1");
        assert_eq!(Divider { r2: None, r3: None, ..divider }.open(), None);
        let direct = Divider { r1: 100_000.0, r2: None, r3: Some(3_000.0) };
        assert!((direct.watts_in_r1(103.0) - 0.1).abs() < 1e-9, "100 V over 100 kΩ");
    }
}
