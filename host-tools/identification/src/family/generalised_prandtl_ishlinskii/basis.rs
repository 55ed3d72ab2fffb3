//! The functions that the slopes of a generalised Prandtl–Ishlinskii model are made of.
//!
//! Eight Bernstein polynomials of degree 7 over the span, tabulated as the model tabulates its functions: between two knots
//! the slope runs straight. Coefficients of at least 0 give slopes of at least 0. Fewer polynomials describe the middle of
//! the span wrongly at full stroke, and lag and creep are bent to hide it.

use estimator_core::Range;

/// How many functions a slope is made of.
pub const FUNCTIONS: usize = 8;
/// Knots at which the model holds slopes.
pub const KNOTS: usize = 9;

/// A value of each function.
pub type Values = [f64; FUNCTIONS];

/// The functions over a span.
pub struct Basis {
    first: f64,
    knots_per_volt: f64,
    spacing: f64,
    /// Value at each knot, µm, and slope there, µm from one knot to the next.
    knots: [(Values, Values); KNOTS],
}

impl Basis {
    /// Functions that each rise by about 1 µm over the span (V).
    pub fn new(span: Range<f64>) -> Self {
        let intervals = (KNOTS - 1) as f64;
        let mut knots = [([0.0; FUNCTIONS], [0.0; FUNCTIONS]); KNOTS];
        for knot in 0..KNOTS {
            let slopes = polynomials(knot as f64 / intervals).map(|slope| FUNCTIONS as f64 * slope / intervals);
            let values = match knot.checked_sub(1).and_then(|before| knots.get(before)) {
                Some((values, steep)) => std::array::from_fn(|j| values[j] + 0.5 * (steep[j] + slopes[j])),
                None => [0.0; FUNCTIONS],
            };
            knots[knot] = (values, slopes);
        }
        let spacing = span.span() / intervals;
        Self { first: span.min, knots_per_volt: 1.0 / spacing, spacing, knots }
    }

    /// Adds the functions at a voltage, times a weight.
    #[inline]
    pub fn add(&self, voltage: f64, weight: f64, sum: &mut Values) {
        let at = (voltage - self.first) * self.knots_per_volt;
        let inside = at.clamp(0.0, (KNOTS - 1) as f64);
        let knot = (inside as usize).min(KNOTS - 2);
        let (part, beyond) = (inside - knot as f64, at - inside);
        let ((values, steep), (_, next)) = (&self.knots[knot], &self.knots[knot + 1]);
        for j in 0..FUNCTIONS {
            let slope = steep[j] + (next[j] - steep[j]) * part;
            sum[j] += weight * (values[j] + 0.5 * part * (steep[j] + slope) + beyond * slope);
        }
    }

    /// Slopes at the knots (µm/V) of the functions with these coefficients.
    pub fn slopes(&self, coefficients: &[f64]) -> [f64; KNOTS] {
        self.knots.map(|(_, slopes)| slopes.iter().zip(coefficients).map(|(s, c)| s * c).sum::<f64>() / self.spacing)
    }
}

/// Bernstein's polynomials at a part of the span; their sum is 1.
fn polynomials(part: f64) -> Values {
    let degree = (FUNCTIONS - 1) as f64;
    let mut choose = 1.0;
    std::array::from_fn(|j| {
        let j = j as f64;
        let value = choose * libm::pow(part, j) * libm::pow(1.0 - part, degree - j);
        choose *= (degree - j) / (j + 1.0);
        value
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_are_the_integrals_of_their_slopes() {
        let basis = Basis::new(Range { min: -20.0, max: 60.0 });
        let coefficients = [0.3, 0.0, 1.0, 2.0, 0.5, 0.0, 0.1, 4.0];
        let at = |voltage: f64| {
            let mut sum = [0.0; FUNCTIONS];
            basis.add(voltage, 1.0, &mut sum);
            sum.iter().zip(&coefficients).map(|(f, c)| f * c).sum::<f64>()
        };
        for (knot, slope) in basis.slopes(&coefficients).into_iter().enumerate() {
            let voltage = -20.0 + 10.0 * knot as f64;
            let found = (at(voltage + 1e-5) - at(voltage - 1e-5)) / 2e-5;
            assert!((found - slope).abs() < 1e-4, "{voltage} V: {found} instead of {slope} µm/V");
        }
        assert_eq!(at(-20.0), 0.0);
    }
}
