//! Duhem models: lateness and α are searched, the voltage at which f saturates follows from the training's; the
//! rest is projected.

use super::model_family::{lag_s, lateness, lateness_burden};
use super::projection::Projection;
use crate::problem::Problem;
use crate::search::Gene;
use calibration::drive::RANGE_MARGIN;
use estimator_core::{DuhemParameters, Parameters, Published};
use least_squares::Sign;

/// Distance from the centre beyond which f is straight, of the training's span: the ends of the table's voltages, up to
/// which f must not fall; further out the bend of a loop that saturates would let it fall.
const SATURATION: f64 = 0.5 + RANGE_MARGIN;

/// What is fixed before the search.
pub struct Family {
    span: f64,
    centre: f64,
    tick: f64,
}

impl Family {
    /// From the extent of the training logs.
    pub fn new(problem: &Problem) -> Self {
        let range = problem.training_voltages();
        Self { span: range.span(), centre: 0.5 * (range.min + range.max), tick: problem.extent().tick }
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        vec![lateness(), Gene::logarithmic("alpha", "α times the voltage span", "", 0.1, 100.0)]
    }

    fn burden(&self, values: &[f64]) -> f64 {
        lateness_burden(values.first().copied().unwrap_or(0.0))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let &[late, alpha] = values else { return None };
        let base = DuhemParameters {
            lag_s: lag_s(late, self.tick),
            alpha_per_v: (alpha / self.span) as f32,
            saturation_v: (SATURATION * self.span) as f32,
            voltage_centre_v: self.centre as f32,
            offset_um: 0.0,
            f1_um_per_v: 0.0,
            f3_um_per_v3: 0.0,
            g0_um_per_v: 0.0,
            g2_um_per_v3: 0.0,
        };
        let projection = Projection {
            problem,
            model: &base.build(&problem.discretisation()),
            unknowns: &[0, 1, 2, 3],
            signs: &[Sign::Free; 4],
        };
        let (found, offset) = projection.solve(|y| y)?;
        let &[f1, f3, g0, g2] = &found[..] else { return None };
        let parameters = DuhemParameters {
            offset_um: offset as f32,
            f1_um_per_v: f1 as f32,
            f3_um_per_v3: f3 as f32,
            g0_um_per_v: g0 as f32,
            g2_um_per_v3: g2 as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::Duhem(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        ["f1", "f3", "g0", "g2", "offset"].len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Family as _;
    use super::*;
    use crate::Conditions;
    use recordings::session::Session;

    /// Half as steep at the ends as in the middle.
    #[test]
    fn a_loop_that_saturates_has_a_model() {
        let voltage: Vec<f64> = (0..4_000).map(|k| 20.0 * libm::sin(f64::from(k) * 6.283e-3)).collect();
        let displacement = voltage.iter().map(|v| 0.2 * (v - v.powi(3) / 2_400.0)).collect();
        let session = Session::new("log".into(), voltage, (0..4_000).collect(), displacement, 5e-4);
        let problem = Problem::new(vec![session], vec![], Conditions::default());
        assert!(Family::new(&problem).project(&[1.0, 3.0], &problem).is_some());
    }
}
