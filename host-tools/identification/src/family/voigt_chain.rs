//! Kelvin–Voigt chains: the shortest and the longest time are searched, those between are spaced evenly on a
//! logarithmic scale; gains and offset are projected, and in the second structure the weight of the voltage at
//! the last reversal.

use super::AnyFamily;
use super::projection::Projection;
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::model::Lagged;
use estimator_core::{List, Parameters, Published, Range, VoigtChain, VoigtChainParameters};
use least_squares::Sign;

/// Kelvin–Voigt elements of a chain.
const ELEMENTS: usize = 10;

/// What is fixed before the search.
pub struct Family {
    memory: Range,
    tick: f64,
    deadband: f64,
    extremum: bool,
}

/// Without and with the extremum term.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    [false, true].map(|extremum| Box::new(Family::new(problem, extremum)) as AnyFamily).into()
}

impl Family {
    fn new(problem: &Problem, extremum: bool) -> Self {
        let Range { min, max } = problem.voltage_range();
        Self {
            memory: Range { min: min as f32, max: max as f32 },
            tick: problem.extent().tick,
            deadband: problem.deadband,
            extremum,
        }
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        vec![
            Gene::logarithmic("shortest", "shortest time constant", "s", 0.2 * self.tick, 0.1),
            Gene::logarithmic("longest", "longest time constant", "s", 0.2, 100.0),
        ]
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let &[shortest, longest] = values else { return None };
        let time = |i: usize| (shortest * libm::pow(longest / shortest, i as f64 / (ELEMENTS - 1) as f64)) as f32;
        let base = VoigtChainParameters {
            offset_um: 0.0,
            instantaneous_um_per_v: 0.0,
            gains_um_per_v: List::collect([0.0; ELEMENTS])?,
            times_s: List::collect((0..ELEMENTS).map(time))?,
            memory_v: self.memory,
            // Any but 0 has the column.
            voltage_extremum_um_per_v: if self.extremum { 1.0 } else { 0.0 },
            deadband_v: self.deadband as f32,
        };
        let unknowns: Vec<usize> = (0..=ELEMENTS + usize::from(self.extremum)).collect();
        let mut signs = vec![Sign::NonNegative; ELEMENTS + 1];
        signs.resize(unknowns.len(), Sign::Free);
        let projection = Projection {
            problem,
            model: &Lagged::<f64, _>::build(0.0, self.tick, VoigtChain::build(&base, self.tick)),
            unknowns: &unknowns,
            signs: &signs,
        };
        let (found, offset) = projection.solve(|y| y)?;
        let (instantaneous, rest) = found.split_first()?;
        let (gains, extremum) = rest.split_at_checked(ELEMENTS)?;
        let parameters = VoigtChainParameters {
            offset_um: offset as f32,
            instantaneous_um_per_v: *instantaneous as f32,
            gains_um_per_v: List::collect(gains.iter().map(|&gain| gain as f32))?,
            voltage_extremum_um_per_v: extremum.first().map_or(0.0, |&weight| weight as f32),
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::VoigtChain(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        ELEMENTS + ["instantaneous", "offset"].len() + usize::from(self.extremum)
    }
}
