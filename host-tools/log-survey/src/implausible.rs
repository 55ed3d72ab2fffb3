//! Strokes that no piezo actuator has: most often a wrong unit in a header, or a wrong sensor's scale.
//!
//! Piezo ceramics strain by 0.2 % at most: a stack has 1 … 500 µm, levers up to some 2 mm; a volt at the amplifier's output gives
//! 1 nm (shear, low voltage) to 1 µm, at its input some 10 times as much.

use serde::Serialize;

/// Most that levers reach, µm.
const LARGEST_UM: f64 = 2_000.0;
/// Least and most that a volt gives, µm.
const LEAST_UM_PER_V: f64 = 1e-3;
const MOST_UM_PER_V: f64 = 20.0;

/// A stroke that is doubtful.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Implausible {
    /// The displacement's span, µm.
    pub stroke_um: f64,
    /// The voltage's, V.
    pub span_v: f64,
}

impl Implausible {
    /// Of a displacement's span, µm, and a voltage's, V; `None` where an actuator can have them.
    pub fn of(stroke_um: f64, span_v: f64) -> Option<Self> {
        let of = Self { stroke_um, span_v };
        let plausible = stroke_um <= LARGEST_UM && (LEAST_UM_PER_V..=MOST_UM_PER_V).contains(&of.um_per_v());
        (span_v > 0.0 && stroke_um > 0.0 && !plausible).then_some(of)
    }

    /// What a volt gives, µm.
    pub fn um_per_v(&self) -> f64 {
        self.stroke_um / self.span_v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_is_doubted_where_no_actuator_has_it() {
        for (stroke_um, span_v) in [(15.0, 100.0), (45.0, 3.6), (2_000.0, 150.0), (0.3, 200.0)] {
            assert_eq!(Implausible::of(stroke_um, span_v), None, "{stroke_um} µm of {span_v} V");
        }
        for (stroke_um, span_v) in [(10_000.0, 40.0), (3_000.0, 1_000.0), (0.015, 100.0)] {
            assert!(Implausible::of(stroke_um, span_v).is_some(), "{stroke_um} µm of {span_v} V");
        }
    }
}
