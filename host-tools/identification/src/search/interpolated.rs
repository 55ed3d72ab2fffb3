//! The search's accelerator: a model of the Voigt family whose affine map of a tick is interpolated over the voltage.
//!
//! One exponential and one power a tick become a multiplication and an addition each, some five times faster. Only the
//! search runs it: the errors that are reported of a result are those of the model itself.
//!
//! The knots are spaced evenly over the voltage range, shifted by less than one interval so that one of them stands at
//! 0 V, where the drive has its cusp. Terms between knots are weighted means of the knots' terms, so that what is proven
//! of the model over [`covered`] holds of the interpolation.

use estimator_core::{Inadmissible, Range, Real, Recursion, Voigt, VoigtState, VoigtTerms};

/// Number of knots.
const KNOTS: usize = 257;
/// Number of intervals between them.
const INTERVALS: u32 = KNOTS as u32 - 1;

/// A model of the Voigt family with its terms at the knots.
#[derive(Clone, PartialEq, Debug)]
pub struct Interpolated {
    model: Voigt<f64>,
    /// Voltage of the first knot, V.
    first: f64,
    /// Knots per V.
    per_volt: f64,
    knots: Box<[VoigtTerms<f64>; KNOTS]>,
}

/// From the first knot to the last, V: the voltage range and less than one interval more on either side.
fn covered(voltage: Range<f64>) -> Range<f64> {
    // One interval is spare, for the shift that puts a knot at 0 V.
    let step = interval(voltage);
    let crosses_zero = voltage.min < 0.0 && 0.0 < voltage.max;
    let first = if crosses_zero { (voltage.min / step).floor() * step } else { voltage.min };
    Range { min: first, max: first + f64::from(INTERVALS) * step }
}

fn interval(voltage: Range<f64>) -> f64 {
    voltage.span() / f64::from(INTERVALS - 1)
}

impl Interpolated {
    /// Tabulates a model over a voltage range (V).
    pub fn new(model: Voigt<f64>, voltage: Range<f64>) -> Self {
        let (first, step) = (covered(voltage).min, interval(voltage));
        let knot = |index: usize| model.terms(first + index as f64 * step);
        Self { first, per_volt: 1.0 / step, knots: Box::new(std::array::from_fn(knot)), model }
    }

    /// The affine map at a voltage (V); at the nearest end beyond the knots.
    #[inline]
    fn terms(&self, voltage: f64) -> VoigtTerms<f64> {
        let knots = (voltage - self.first) * self.per_volt;
        let index = knots.to_u32_saturating();
        let (index, weight) = if knots >= 0.0 && index < INTERVALS {
            (index as usize, knots - f64::from(index))
        } else if knots > 0.0 {
            (INTERVALS as usize - 1, 1.0)
        } else {
            (0, 0.0)
        };
        let (left, right) = (&self.knots[index], &self.knots[index + 1]);
        let mean = |l: f64, r: f64| l + weight * (r - l);
        VoigtTerms { a: mean(left.a, right.a), c: mean(left.c, right.c), m: mean(left.m, right.m) }
    }
}

impl Recursion<f64> for Interpolated {
    type State = VoigtState<f64>;

    fn begin(&self, voltage: f64, displacement: Option<f64>) -> VoigtState<f64> {
        self.model.rest(self.terms(voltage), displacement)
    }

    #[inline]
    fn step(&self, state: &mut VoigtState<f64>, voltage: f64) -> f64 {
        self.model.step_with(state, voltage, self.terms(voltage))
    }

    fn bound(&self, voltage: Range<f64>, limits: Range<f64>) -> Result<Range<f64>, Inadmissible<f64>> {
        self.model.bound(covered(voltage), limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(self.clone())
    }

    fn set_displacement(&self, state: &mut VoigtState<f64>, displacement: f64) -> bool {
        self.model.set_displacement(state, displacement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Discretisation, Scheme, VoigtParameters};

    /// Table 4.6's simulation set.
    const VOIGT: VoigtParameters<f64> = VoigtParameters {
        alpha_um: 1139.296,
        beta_v: 749.755,
        lambda_per_v: 0.00772,
        b_ohm: 90777.126,
        p: 0.754,
        g_um_per_s: 0.0,
        h: 0.0,
        e_m_per_s: 0.0,
        f: 0.0,
    };

    #[test]
    fn it_is_exact_at_its_knots_and_covers_the_range() {
        let discretisation = Discretisation { sample_period: 5e-4, scheme: Scheme::ForwardEuler, deadband: 0.0 };
        let model = Voigt::build(&VOIGT, &discretisation);
        for range in [Range { min: -20.0, max: 20.0 }, Range { min: -3.0, max: 17.0 }, Range { min: 4.0, max: 9.0 }] {
            let interpolated = Interpolated::new(model, range);
            let covered = covered(range);
            assert!(covered.min <= range.min && range.max <= covered.max, "{covered:?}");
            for (k, knot) in interpolated.knots.iter().enumerate() {
                let v = interpolated.first + k as f64 / interpolated.per_volt;
                assert!((interpolated.terms(v).a - knot.a).abs() < 1e-12 && (model.terms(v).a - knot.a).abs() < 1e-12);
            }
            if range.min < 0.0 {
                assert_eq!(interpolated.terms(0.0).c, 0.0, "the drive's cusp lies on a knot");
            }
            let worst = (0..=1000)
                .map(|i| range.min + range.span() * f64::from(i) / 1000.0)
                .map(|v| (interpolated.terms(v).a - model.terms(v).a).abs())
                .fold(0.0, f64::max);
            assert!(worst < 1e-6, "{worst}");
        }
    }
}
