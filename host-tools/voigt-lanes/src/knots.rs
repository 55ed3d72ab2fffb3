//! Knots over the voltage between which the affine map of a tick is interpolated: one exponential and one power a
//! tick become a few multiplications. Only the search does so: the errors that are reported of a result are those of
//! the model itself.
//!
//! The knots are spaced evenly over the voltage range, shifted by less than one interval so that one of them stands at
//! 0 V, where the drive has its cusp. Terms between knots are weighted means of the knots' terms, so that what is
//! proven of the model over [`Knots::covered`] holds of the interpolation.

use estimator_core::{Range, Real};

/// Number of knots.
pub const KNOTS: usize = 257;
/// Number of intervals between them.
const INTERVALS: u32 = KNOTS as u32 - 1;

/// Where the knots stand.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Knots {
    /// Voltage of the first, V.
    first: f64,
    /// Distance from one knot to the next, V.
    step: f64,
}

/// A voltage between two knots.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Position {
    /// Index of the lower knot, below `KNOTS - 1`.
    pub knot: u32,
    /// Of the upper one, 0 … 1.
    pub weight: f64,
}

impl Knots {
    /// Knots over a voltage range (V).
    pub fn over(voltage: Range<f64>) -> Self {
        // One interval is spare, for the shift that puts a knot at 0 V.
        let step = voltage.span() / f64::from(INTERVALS - 1);
        let crosses_zero = voltage.min < 0.0 && 0.0 < voltage.max;
        let first = if crosses_zero { (voltage.min / step).floor() * step } else { voltage.min };
        Self { first, step }
    }

    /// From the first knot to the last, V: the voltage range and less than one interval more on either side.
    pub fn covered(&self) -> Range<f64> {
        Range { min: self.first, max: self.first + f64::from(INTERVALS) * self.step }
    }

    /// Voltage of a knot, V.
    pub fn voltage(&self, knot: usize) -> f64 {
        self.first + knot as f64 * self.step
    }

    /// Where a voltage (V) stands; at the nearest end beyond the knots.
    pub fn position(&self, voltage: f64) -> Position {
        let knots = (voltage - self.first) * (1.0 / self.step);
        let knot = knots.to_u32_saturating();
        if knots >= 0.0 && knot < INTERVALS {
            Position { knot, weight: knots - f64::from(knot) }
        } else if knots > 0.0 {
            Position { knot: INTERVALS - 1, weight: 1.0 }
        } else {
            Position { knot: 0, weight: 0.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_cover_the_range_and_one_stands_at_zero() {
        for range in [Range { min: -20.0, max: 20.0 }, Range { min: -3.0, max: 17.0 }, Range { min: 4.0, max: 9.0 }] {
            let knots = Knots::over(range);
            let covered = knots.covered();
            assert!(covered.min <= range.min && range.max <= covered.max, "{covered:?}");
            if range.min < 0.0 {
                assert!((0..KNOTS).any(|knot| knots.voltage(knot) == 0.0));
            }
            for (volts, below, above) in [(range.min, 0, 1), (range.max, INTERVALS - 2, INTERVALS)] {
                assert!((below..above).contains(&knots.position(volts).knot), "{range:?} {volts}");
            }
            let middle = 0.3 * range.min + 0.7 * range.max;
            let Position { knot, weight } = knots.position(middle);
            let [low, high] = [knot, knot + 1].map(|knot| knots.voltage(knot as usize));
            assert!((low + weight * (high - low) - middle).abs() < 1e-12);
            assert_eq!(knots.position(range.max + 100.0), Position { knot: INTERVALS - 1, weight: 1.0 });
            assert_eq!(knots.position(range.min - 100.0), Position { knot: 0, weight: 0.0 });
        }
    }
}
