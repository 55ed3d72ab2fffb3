//! Preisach densities straight from first-order reversal curves, Eq. (3.17)–(3.19), where the training logs have them.
//! Densities that come out negative, as noise makes them, are clipped.

use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::model::{SIDE, densities_from_reversal_curves};
use estimator_core::{List, Parameters, PreisachParameters, Published};
use log_survey::ReversalCurves;

/// The model on a grid over the curves' voltages.
pub struct Family(ReversalCurves);

impl Family {
    /// Of the curves of the training logs; `None` where there are too few.
    pub fn new(problem: &Problem) -> Option<Self> {
        ReversalCurves::of(problem.training(), problem.training_voltages()).map(Self)
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        Vec::new()
    }

    fn project(&self, _values: &[f64], _problem: &Problem) -> Option<Parameters> {
        let Self(curves) = self;
        let (side, span) = (curves.count().min(SIDE), curves.span());
        let node = |index: usize| span.min + span.span() * index as f64 / side as f64;
        // A curve from its reversal, so that its start is 0.
        let curve = |from: usize, to: usize| -curves.everett(node(from), node(to));
        let densities = densities_from_reversal_curves(side, curve)?;
        let parameters = PreisachParameters {
            lag_s: 0.0,
            lower_v: span.min as f32,
            upper_v: span.max as f32,
            densities_um: List::collect(densities.iter().map(|&mass| (mass as f32).max(0.0)))?,
            offset_um: curves.lowest_um() as f32,
        };
        parameters.check().is_ok().then_some(Parameters::Preisach(parameters))
    }

    fn solved(&self, found: &Parameters) -> usize {
        let Parameters::Preisach(of) = found else { return 0 };
        of.densities_um.len() + ["offset"].len()
    }
}
