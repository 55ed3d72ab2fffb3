//! Bouc–Wen models: lateness, β, γ and δ are searched, with A = 1 and n = 1; the rest is projected.

use super::model_family::{lag_s, lateness, lateness_burden};
use super::projection::Projection;
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::{BoucWenParameters, Parameters, Published};
use least_squares::Sign;

/// What is fixed before the search.
pub struct Family {
    voltage: f64,
    tick: f64,
}

impl Family {
    /// From the extent of the training logs.
    pub fn new(problem: &Problem) -> Self {
        Self { voltage: problem.training_voltages().span(), tick: problem.extent().tick }
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        vec![
            lateness(),
            Gene::logarithmic("beta", "β times the voltage span", "", 0.1, 100.0),
            Gene::linear("gamma", "γ, of β", "", -0.95, 1.0),
            Gene::linear("delta", "δ, of what β and γ allow", "", -0.95, 0.95),
        ]
    }

    fn burden(&self, values: &[f64]) -> f64 {
        lateness_burden(values.first().copied().unwrap_or(0.0))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let &[late, beta, gamma, delta] = values else { return None };
        let beta = beta / self.voltage;
        let gamma = gamma * beta;
        let base = BoucWenParameters {
            lag_s: lag_s(late, self.tick),
            a: 1.0,
            beta: beta as f32,
            gamma: gamma as f32,
            delta: (delta * beta.min(beta + gamma)) as f32,
            n: 1.0,
            offset_um: 0.0,
            d1_um_per_v: 0.0,
            d2_um_per_v2: 0.0,
            c_um_per_v: 0.0,
        };
        let projection = Projection {
            problem,
            model: &base.build(&problem.discretisation()),
            unknowns: &[0, 1, 2],
            signs: &[Sign::Free; 3],
        };
        let (found, offset) = projection.solve(|y| y)?;
        let &[d1, d2, c] = &found[..] else { return None };
        let parameters = BoucWenParameters {
            offset_um: offset as f32,
            d1_um_per_v: d1 as f32,
            d2_um_per_v2: d2 as f32,
            c_um_per_v: c as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::BoucWen(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        ["d1", "d2", "c", "offset"].len()
    }
}
