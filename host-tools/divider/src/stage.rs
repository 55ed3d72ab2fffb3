//! The operational amplifier between the board's output and an amplifier's input that takes more than the pin gives.
//!
//! ```text
//! A2 ──[4.7 kΩ]──┬──────────── + ┐
//!             [68 nF]            ├──────┬── amplifier's input
//!               GND       ┌─── − ┘      │
//!                         ├────[RF]─────┘
//!   3.3 V ──────────[RO]──┤
//!     GND ──────────[RG]──┘
//!
//! output = pin·(1 + RF/RG + RF/RO) − 3.3 V·RF/RO
//! ```
//!
//! RO goes to the board's own 3.3 V: a board without power gives the amplifier 0 V, not the lowest voltage.

use crate::choice::ordered;
use crate::series::Series;
use crate::{DividerError, OUTPUT_PIN_V, REFERENCE_V};
use serde::Serialize;

/// What RF may be, Ω: the operational amplifier drives it, and its input current does not show on it.
const FEEDBACK: (f64, f64) = (1e4, 1e5);

/// Three resistors around an operational amplifier, Ω.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Stage {
    /// From its output to its inverting input.
    pub rf: f64,
    /// From there to ground; `None` where there is none.
    pub rg: Option<f64>,
    /// From there to the board's 3.3 V; `None` where there is none.
    pub ro: Option<f64>,
}

impl Stage {
    /// Output's change by the pin's, and the output with the pin at 0 V, V, where the board has so many
    /// volts of supply.
    fn line(&self, supply_v: f64) -> (f64, f64) {
        let of = |r: Option<f64>| r.map_or(0.0, |r| self.rf / r);
        (1.0 + of(self.rg) + of(self.ro), -supply_v * of(self.ro))
    }

    /// Voltage at the amplifier's input by that of the pin, V.
    pub fn output(&self, pin_v: f64) -> f64 {
        let (gain, offset) = self.line(REFERENCE_V);
        gain * pin_v + offset
    }

    /// Voltage of the pin by that at the amplifier's input, V.
    pub fn pin(&self, output_v: f64) -> f64 {
        let (gain, offset) = self.line(REFERENCE_V);
        (output_v - offset) / gain
    }

    /// Voltage at the amplifier's input with the pin at 0 V and at 3.3 V.
    pub fn span(&self) -> (f64, f64) {
        (self.output(0.0), self.output(REFERENCE_V))
    }

    /// Part of what the DAC's buffer reaches that the amplifier's voltages, V, use.
    pub fn used(&self, (low, high): (f64, f64)) -> f64 {
        (self.pin(high) - self.pin(low)) / (OUTPUT_PIN_V.1 - OUTPUT_PIN_V.0)
    }

    /// Lowest and highest voltage at the amplifier's input that any code gives, V, where each resistor may be off by
    /// `part` of its value.
    pub fn output_within(&self, part: f64) -> (f64, f64) {
        let corners = (0..8u8).flat_map(|bits| {
            let off = |bit: u8| if bits & bit == 0 { 1.0 - part } else { 1.0 + part };
            let real = Self { rf: self.rf * off(1), rg: self.rg.map(|r| r * off(2)), ro: self.ro.map(|r| r * off(4)) };
            [real.output(0.0), real.output(REFERENCE_V)]
        });
        corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)))
    }

    /// The resistors that make the amplifier's voltages, V, of what the DAC's buffer reaches, and use most of that.
    ///
    /// # Errors
    /// There are none.
    pub fn choose((one, other): (f64, f64), series: Series) -> Result<Self, DividerError> {
        let (low, high) = ordered(one, other)?;
        let values = series.values();
        let or_none = || values.iter().copied().map(Some).chain([None]);
        let mut best: Option<(f64, Self)> = None;
        for &rf in values.iter().filter(|rf| (FEEDBACK.0..=FEEDBACK.1).contains(*rf)) {
            for ro in or_none() {
                // With a larger RG the gain is smaller, and the ends come nearer to the pin's: the largest that fits
                // is the best.
                let fits = |rg: Option<f64>| {
                    let stage = Self { rf, rg, ro };
                    stage.pin(low) >= OUTPUT_PIN_V.0 && stage.pin(high) <= OUTPUT_PIN_V.1
                };
                let Some(rg) = [None].into_iter().chain(values.iter().rev().copied().map(Some)).find(|rg| fits(*rg))
                else {
                    continue;
                };
                let stage = Self { rf, rg, ro };
                let used = stage.used((low, high));
                if best.is_none_or(|(other, _)| used > other) {
                    best = Some((used, stage));
                }
            }
        }
        best.map(|(_, stage)| stage).ok_or(DividerError::NoStage { low, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverting input by its equation: it stands where the other one does, and the currents into it are
    /// none in sum.
    #[test]
    fn no_current_is_left_at_the_inverting_input() {
        let stage = Stage { rf: 35_700.0, rg: Some(13_900.0), ro: Some(10_000.0) };
        for pin in [0.0, 0.2, 1.65, 3.1] {
            let output = stage.output(pin);
            let current = (output - pin) / 35_700.0 + (REFERENCE_V - pin) / 10_000.0 - pin / 13_900.0;
            assert!(current.abs() < 1e-15, "{current} A at {pin} V");
            assert!((stage.pin(output) - pin).abs() < 1e-12);
        }
    }

    #[test]
    fn the_amplifier_s_voltages_lie_within_the_buffer_s_reach_and_use_it() {
        for span in [(0.0, 10.0), (-10.0, 10.0), (-5.0, 5.0), (0.0, 5.0), (-2.0, 12.0)] {
            for (series, used) in [(Series::E24, 0.95), (Series::E96, 0.985)] {
                let stage = Stage::choose(span, series).unwrap();
                let (low, high) = (stage.pin(span.0), stage.pin(span.1));
                assert!(low >= OUTPUT_PIN_V.0 && high <= OUTPUT_PIN_V.1, "{span:?}: {low} … {high} V by {stage:?}");
                assert!(stage.used(span) >= used, "{span:?}: {low} … {high} V by {stage:?}");
                let (least, most) = stage.output_within(0.01);
                assert!(least < stage.span().0 && most > stage.span().1 && most < 1.4 * stage.span().1);
            }
        }
        // Nothing takes the lower end away where the pin need not go there.
        let stage = Stage::choose((2.0, 10.0), Series::E96).unwrap();
        assert_eq!(stage.ro, None, "{stage:?}");
    }

    #[test]
    fn without_power_it_gives_nothing() {
        let stage = Stage::choose((-10.0, 10.0), Series::E96).unwrap();
        let (_, offset) = stage.line(0.0);
        assert_eq!(offset.abs(), 0.0, "with pin and 3.3 V at 0 V");
        assert!(stage.output(0.0) < -10.0, "with the 3.3 V there");
    }

    #[test]
    fn an_input_of_less_than_the_pin_s_is_shifted_and_one_beyond_every_gain_refused() {
        let stage = Stage::choose((-1.0, 1.0), Series::E96).unwrap();
        assert!(stage.pin(-1.0) >= OUTPUT_PIN_V.0 && stage.used((-1.0, 1.0)) > 0.4, "{stage:?}");
        assert!(matches!(Stage::choose((0.0, 1e3), Series::E96), Err(DividerError::NoStage { .. })));
        assert!(matches!(Stage::choose((3.0, 3.0), Series::E96), Err(DividerError::NoSpan(..))));
    }
}
