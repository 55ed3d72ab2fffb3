//! Preisach models: the lateness is searched; the densities and the offset are projected. Where the logs have
//! first-order reversal curves, the densities that follow from these alone come first, and least squares over all
//! samples must better them.

use super::AnyFamily;
use super::model_family::{lag_s, lateness, lateness_burden};
use super::projection::Projection;
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::model::CELLS;
use estimator_core::{List, Parameters, PreisachParameters, Published};
use least_squares::Sign;

/// The model on a grid over the table's voltages.
pub struct Family;

/// The structures that are tried, the simplest first.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    let curves = super::reversal_curves::Family::new(problem).map(|family| Box::new(family) as AnyFamily);
    curves.into_iter().chain([Box::new(Family) as AnyFamily]).collect()
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        vec![lateness()]
    }

    fn burden(&self, values: &[f64]) -> f64 {
        lateness_burden(values.first().copied().unwrap_or(0.0))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let &[late] = values else { return None };
        let range = problem.voltage_range();
        let base = PreisachParameters {
            lag_s: lag_s(late, problem.extent().tick),
            lower_v: range.min as f32,
            upper_v: range.max as f32,
            densities_um: List::collect([0.0; CELLS])?,
            offset_um: 0.0,
        };
        let unknowns: Vec<usize> = (0..CELLS).collect();
        let projection = Projection {
            problem,
            model: &base.build(&problem.discretisation()),
            unknowns: &unknowns,
            signs: &[Sign::NonNegative; CELLS],
        };
        let (found, offset) = projection.solve(|y| y)?;
        let parameters = PreisachParameters {
            densities_um: List::collect(found.iter().map(|&mass| mass as f32))?,
            offset_um: offset as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::Preisach(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        CELLS + ["offset"].len()
    }
}
