//! What the resistors' tolerance costs, and what is left of it where two points are measured.
//!
//! Whatever the three resistors are exactly, the code is a line of the source's voltage. So a line through two measured
//! points has no error of theirs; what is left is how they drift after that.

use crate::Divider;

impl Divider {
    /// The eight dividers whose resistors are each off by a part of their value, up or down.
    fn corners(&self, part: f64) -> impl Iterator<Item = Self> {
        (0..8u8).map(move |bits| {
            let off = |bit: u8| if bits & bit == 0 { 1.0 - part } else { 1.0 + part };
            Self { r1: self.r1 * off(1), r2: self.r2.map(|r| r * off(2)), r3: self.r3.map(|r| r * off(4)) }
        })
    }

    /// The largest error of a voltage between two, V, where each resistor may be off by `part` of its value and the
    /// code is read by the values that are printed on them. The worst is at an end and with each resistor at an end:
    /// the error is a line of the voltage, and goes one way with each resistor.
    pub fn off(&self, (low, high): (f64, f64), part: f64) -> f64 {
        let errors = self.corners(part).flat_map(|real| [low, high].map(|v| (self.source(real.pin(v)) - v).abs()));
        errors.fold(0.0, f64::max)
    }

    /// The largest error of a voltage between two, V, where the 3.3 V are higher by `part` of their value than when the
    /// line was measured: `V·part/(1 + part)`, whatever the resistors.
    pub fn off_by_supply((low, high): (f64, f64), part: f64) -> f64 {
        low.abs().max(high.abs()) * part / (1.0 + part)
    }

    /// Lowest and highest voltage at the pin, V, where each resistor may be off by `part` of its value.
    pub fn pin_within(&self, (low, high): (f64, f64), part: f64) -> (f64, f64) {
        let pins = self.corners(part).flat_map(|real| [low, high].map(|v| real.pin(v)));
        pins.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), pin| (least.min(pin), most.max(pin)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FULL_SCALE, REFERENCE_V, Series};

    /// All that lies between the corners, on a grid of resistors and voltages.
    /// The node's equation with another supply, read by the values of the first.
    #[test]
    fn a_supply_that_is_off_costs_in_proportion_to_the_voltage() {
        let divider = Divider { r1: 20_000.0, r2: Some(6_040.0), r3: Some(8_660.0) };
        let (a, b) = divider.weights();
        let read = |volts: f64, supply: f64| {
            let part_of_full_scale = (a * volts + b * supply) / supply;
            divider.source(part_of_full_scale * REFERENCE_V)
        };
        for volts in [-10.0, -2.0, 5.0, 10.0] {
            let off = (read(volts, 1.01 * REFERENCE_V) - volts).abs();
            assert!((off - Divider::off_by_supply((0.0, volts), 0.01)).abs() < 1e-12, "{off} at {volts} V");
        }
    }

    #[test]
    fn no_resistors_within_their_tolerance_are_worse_than_the_corners() {
        for span in [(-10.0, 10.0), (0.0, 10.0), (-3.0, 13.0)] {
            let divider = Divider::choose(span, Series::E24).unwrap();
            for part in [0.01, 0.001] {
                let (worst, pins) = (divider.off(span, part), divider.pin_within(span, part));
                let steps: Vec<f64> = (0..=10).map(|k| 1.0 + part * (f64::from(k) / 5.0 - 1.0)).collect();
                let mut found: f64 = 0.0;
                for (x, y, z) in steps.iter().flat_map(|x| {
                    steps.iter().flat_map({
                        let steps = &steps;
                        move |y| steps.iter().map(move |z| (x, y, z))
                    })
                }) {
                    let real =
                        Divider { r1: divider.r1 * x, r2: divider.r2.map(|r| r * y), r3: divider.r3.map(|r| r * z) };
                    for k in 0..=8 {
                        let volts = span.0 + (span.1 - span.0) * f64::from(k) / 8.0;
                        let pin = real.pin(volts);
                        found = found.max((divider.source(pin) - volts).abs());
                        assert!(pin >= pins.0 - 1e-12 && pin <= pins.1 + 1e-12, "{pin} V");
                    }
                }
                assert!((found - worst).abs() < 1e-9, "{span:?}, {part}: {found} V, not {worst} V");
            }
        }
    }

    #[test]
    fn two_measured_points_take_all_of_the_tolerance_away() {
        let span = (-10.0, 10.0);
        let divider = Divider::choose(span, Series::E96).unwrap();
        assert!(divider.off(span, 0.01) > 0.1, "there is something to be taken away");
        for real in divider.corners(0.01) {
            let code = |volts: f64| f64::from(FULL_SCALE) * real.pin(volts) / REFERENCE_V;
            let (low, high) = (-8.0, 8.0);
            let gain = (high - low) / (code(high) - code(low));
            for volts in [-10.0, -3.3, 0.0, 7.0, 10.0] {
                let read = low + gain * (code(volts) - code(low));
                assert!((read - volts).abs() < 1e-9, "{read} V, not {volts} V");
            }
        }
    }
}
