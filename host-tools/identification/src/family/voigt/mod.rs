//! The Voigt family where it is to be searched like any other model: all that it has is searched, nothing projected.

mod kernel;
mod run;

pub use kernel::Kernel;

use crate::cost::Cost;
use crate::problem::Problem;
use crate::search::Gene;
use crate::search::space::Space;
use estimator_core::{Parameters, VoigtParameters};

/// A model of the family.
pub struct Family<'a> {
    /// The coordinates that are searched, and their ranges.
    pub space: &'a Space,
    /// Candidates to start from, in gene values.
    pub seeds: &'a [Vec<f64>],
    /// What computes the candidates' costs.
    pub kernel: &'a Kernel<'a>,
}

impl super::Family for Family<'_> {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        self.space.genes.clone()
    }

    fn starts(&self) -> Vec<Vec<f64>> {
        let fractions =
            |seed: &Vec<f64>| self.space.genes.iter().zip(seed).map(|(gene, &value)| gene.fraction(value)).collect();
        self.seeds.iter().map(fractions).collect()
    }

    fn project(&self, values: &[f64], _problem: &Problem) -> Option<Parameters> {
        Some(self.space.published(values))
    }

    fn costs(&self, candidates: &[Vec<f64>], _problem: &Problem, _cost: Cost) -> Vec<f64> {
        let candidates: Vec<VoigtParameters<f64>> = candidates.iter().map(|of| self.space.parameters(of)).collect();
        self.kernel.costs(&candidates)
    }

    fn solved(&self, _found: &Parameters) -> usize {
        0
    }
}
