//! Strokes that no piezo actuator has: most often a wrong unit in a header, or a wrong sensor's scale.
//!
//! The voltage may be the amplifier's output or its input, so the limits are wide.

use serde::Serialize;

/// A stroke that is doubtful.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Implausible {
    /// The displacement's span, µm.
    pub stroke_um: f64,
    /// The voltage's span, V.
    pub span_v: f64,
}

impl Implausible {
    /// Most that an actuator with a lever reaches, µm; a stack strains by some 0.1 %.
    pub const LARGEST_UM: f64 = 2_000.0;
    /// Least that a volt gives, µm: the d33 of a single plate is some 0.25 nm/V (hard ceramics) to 0.6
    /// nm/V (soft ones).
    pub const LEAST_UM_PER_V: f64 = 2e-4;
    /// Most that a volt gives, µm: the largest stroke by an amplifier's input of 0 … 10 V.
    pub const MOST_UM_PER_V: f64 = 200.0;

    /// Of a displacement's span, µm, and a voltage's, V; `None` where an actuator can have them.
    pub fn of(stroke_um: f64, span_v: f64) -> Option<Self> {
        let of = Self { stroke_um, span_v };
        let plausible =
            stroke_um <= Self::LARGEST_UM && (Self::LEAST_UM_PER_V..=Self::MOST_UM_PER_V).contains(&of.um_per_v());
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
        for (stroke_um, span_v) in
            [(15.0, 100.0), (45.0, 3.6), (2_000.0, 150.0), (2_000.0, 10.0), (400.0, 7.5), (0.3, 200.0), (0.25, 1_000.0)]
        {
            assert_eq!(Implausible::of(stroke_um, span_v), None, "{stroke_um} µm of {span_v} V");
        }
        for (stroke_um, span_v) in [(10_000.0, 40.0), (3_000.0, 1_000.0), (1_000.0, 4.0), (0.015, 100.0)] {
            assert!(Implausible::of(stroke_um, span_v).is_some(), "{stroke_um} µm of {span_v} V");
        }
    }
}
