//! The functions that the slopes of a generalised Prandtl–Ishlinskii model are made of.
//!
//! The model holds a slope at each knot. The slope of each function is a hat: 1 at its own knot, falling straight to 0
//! at its neighbours. Coefficients of at least 0 give slopes of at least 0. Smoother functions, Bernstein's polynomials
//! of degree 7, follow a device whose slope changes quickly only at a price: lag and creep are bent to hide what they
//! leave (two to three times the error on recordings unlike the training of simulated relays).

use estimator_core::Range;

/// Knots at which the model holds slopes.
pub const KNOTS: usize = 9;
/// How many functions a slope is made of: one a knot.
pub const FUNCTIONS: usize = KNOTS;

/// A value of each function.
pub type Values = [f64; FUNCTIONS];

/// The functions over a span.
pub struct Basis {
    first: f64,
    knots_per_volt: f64,
    spacing: f64,
    /// Of each interval between two knots.
    intervals: [Interval; KNOTS - 1],
}

/// The functions between two knots, and beyond an outer one: `value + p·slope + p²/2·rise` at a part p of the interval.
#[derive(Clone, Copy)]
struct Interval {
    /// At its first knot, µm.
    value: Values,
    /// Slope at its first knot, µm from one knot to the next.
    slope: Values,
    /// What the slope has grown by at its second knot.
    rise: Values,
}

impl Basis {
    /// Functions that each rise by 1 µm over a span (V), those of its ends by 0.5 µm.
    pub fn new(span: Range<f64>) -> Self {
        let slopes: [Values; KNOTS] =
            std::array::from_fn(|knot| std::array::from_fn(|j| if j == knot { 1.0 } else { 0.0 }));
        let mut value = [0.0; FUNCTIONS];
        let intervals = std::array::from_fn(|knot| {
            let (slope, next) = (slopes[knot], slopes[knot + 1]);
            let interval = Interval { value, slope, rise: std::array::from_fn(|j| next[j] - slope[j]) };
            value = std::array::from_fn(|j| value[j] + 0.5 * (slope[j] + next[j]));
            interval
        });
        let spacing = span.span() / (KNOTS - 1) as f64;
        Self { first: span.min, knots_per_volt: 1.0 / spacing, spacing, intervals }
    }

    /// The sum of the functions at voltages (V), each times its weight.
    ///
    /// The weights of an interval, times 1, p and p²/2, are summed before its functions are evaluated: a few
    /// multiplications for a voltage, however many functions there are.
    #[inline(always)]
    pub fn sum(&self, weighed: impl Iterator<Item = (f64, f64)>) -> Values {
        // A fourth sum of nothing makes each interval's a vector.
        let mut moments = [[0.0; 4]; KNOTS - 1];
        for (voltage, weight) in weighed {
            let (interval, [first, second]) = self.within(voltage);
            let powers = [1.0, first, second, 0.0];
            let sums = &mut moments[interval];
            *sums = std::array::from_fn(|power| sums[power] + weight * powers[power]);
        }
        let mut sum = [0.0; FUNCTIONS];
        for (Interval { value, slope, rise }, [one, first, second, _]) in self.intervals.iter().zip(moments) {
            if one != 0.0 {
                sum = std::array::from_fn(|j| sum[j] + (one * value[j] + first * slope[j] + second * rise[j]));
            }
        }
        sum
    }

    /// The functions at a voltage (V): to the bit their [`sum`](Self::sum) there, of the weight 1.
    #[inline(always)]
    pub fn at(&self, voltage: f64) -> Values {
        let (interval, [first, second]) = self.within(voltage);
        let Interval { value, slope, rise } = &self.intervals[interval];
        std::array::from_fn(|j| value[j] + first * slope[j] + second * rise[j])
    }

    /// The interval that a voltage (V) is in or beyond, and p and p²/2 there.
    #[inline(always)]
    fn within(&self, voltage: f64) -> (usize, [f64; 2]) {
        let at = (voltage - self.first) * self.knots_per_volt;
        let inside = at.clamp(0.0, (KNOTS - 1) as f64);
        let interval = (inside as usize).min(KNOTS - 2);
        let (part, beyond) = (inside - interval as f64, at - inside);
        (interval, [part + beyond, part * (0.5 * part + beyond)])
    }

    /// Slopes at the knots (µm/V) of the functions with these coefficients.
    ///
    /// # Panics
    ///
    /// When there are fewer coefficients than functions.
    pub fn slopes(&self, coefficients: &[f64]) -> [f64; KNOTS] {
        std::array::from_fn(|knot| coefficients[knot] / self.spacing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_are_the_integrals_of_their_slopes() {
        let basis = Basis::new(Range { min: -20.0, max: 60.0 });
        let coefficients = [0.3, 0.0, 1.0, 2.0, 0.5, 0.0, 0.1, 4.0, 1.5];
        let at = |voltage: f64| {
            let sum = basis.sum([(voltage, 0.5), (voltage, 0.5)].into_iter());
            sum.iter().zip(&coefficients).map(|(f, c)| f * c).sum::<f64>()
        };
        for (knot, slope) in basis.slopes(&coefficients).into_iter().enumerate() {
            let voltage = -20.0 + 10.0 * knot as f64;
            let found = (at(voltage + 1e-5) - at(voltage - 1e-5)) / 2e-5;
            assert!((found - slope).abs() < 1e-4, "{voltage} V: {found} instead of {slope} µm/V");
        }
        assert_eq!(at(-20.0), 0.0);
        for voltage in [-31.0, -20.0, 3.7, 60.0, 77.0] {
            assert_eq!(basis.at(voltage), basis.sum([(voltage, 1.0)].into_iter()), "{voltage} V");
        }
    }
}
