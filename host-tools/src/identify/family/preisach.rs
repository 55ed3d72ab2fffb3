//! Preisach models: nothing is searched; the densities and the offset are projected.

use super::projection::Projection;
use crate::identify::problem::Problem;
use crate::identify::space::Gene;
use crate::least_squares::Sign;
use estimator_core::model::CELLS;
use estimator_core::{List, Parameters, Preisach, PreisachParameters};

/// The model on a grid over the table's voltages.
pub struct Family;

impl super::Family for Family {
    fn genes(&self) -> Vec<Gene> {
        Vec::new()
    }

    fn project(&self, _values: &[f64], problem: &Problem) -> Option<Parameters> {
        let range = problem.voltage_range();
        let base = PreisachParameters {
            lower_v: range.min as f32,
            upper_v: range.max as f32,
            densities_um: List::collect([0.0; CELLS])?,
            offset_um: 0.0,
        };
        let unknowns: Vec<usize> = (0..CELLS).collect();
        let projection = Projection {
            problem,
            model: &Preisach::<f64>::build(&base, problem.extent().tick),
            unknowns: &unknowns,
            signs: &[Sign::NonNegative; CELLS],
            resonance: None,
        };
        let (found, offset) = projection.solve(|y| y)?;
        let parameters = PreisachParameters {
            densities_um: List::collect(found.iter().map(|&mass| mass as f32))?,
            offset_um: offset as f32,
            ..base
        };
        parameters.fault().is_none().then_some(Parameters::Preisach(parameters))
    }
}
