//! The search of what a model's structure is not linear in, and the choice among the structures of a model.

use crate::family::Family;
use crate::fit::{Convergence, Fit, Identification, Progress};
use crate::search::{Budget, Minimum, Optimiser, minimise};
use estimator_core::{Model, Parameters, VoigtParameters};

/// A structure with so many searched numbers has minima that one method alone misses, a resonance above all,
const MANY: usize = 6;
/// and is searched by this one, too.
const SECOND: Optimiser = Optimiser::DifferentialEvolution;
/// A richer structure must better the simpler one's cost by this factor.
const BETTER: f64 = 0.97;

impl Identification<'_> {
    /// Of several structures each is started from the one before it, and the simplest that no other betters counts.
    /// They share the budget by what they search.
    pub(super) fn projected(&self, model: Model, structures: &[Box<dyn Family>], progress: Progress<'_>) -> Fit {
        let mut best: Option<Fit> = None;
        let mut evaluations = 0;
        for (index, family) in structures.iter().enumerate() {
            let allowed = match self.budget {
                None => self.options.evaluations as usize * self.shares(family.as_ref()),
                Some(budget) => {
                    let shares: usize = structures.iter().skip(index).map(|family| self.shares(family.as_ref())).sum();
                    let left = budget.saturating_sub(evaluations);
                    (left * self.shares(family.as_ref()) / shares).max(left.min(1))
                }
            };
            if allowed == 0 && best.is_some() {
                break;
            }
            let methods = self.methods(family.as_ref());
            let found = self.structure(model, family.as_ref(), &methods, allowed, best.as_ref(), progress);
            evaluations += found.evaluations;
            if best.as_ref().is_none_or(|best| found.cost < BETTER * best.cost) {
                best = Some(found);
            }
        }
        // Only the Voigt family has no structures, and it does not come here.
        let best = best.expect("a model has a structure");
        Fit { evaluations, ..best }
    }

    /// What a structure's search takes beside another's: numbers by methods.
    fn shares(&self, family: &dyn Family) -> usize {
        family.genes().len().max(1) * self.methods(family).len()
    }

    fn methods(&self, family: &dyn Family) -> Vec<Optimiser> {
        let second = (family.genes().len() >= MANY && self.options.optimiser != SECOND).then_some(SECOND);
        std::iter::once(self.options.optimiser).chain(second).collect()
    }

    /// Searches one structure by some methods with so many evaluations in all, from its own starts and from the middle
    /// or where a simpler one ended.
    pub(super) fn structure(
        &self,
        model: Model,
        family: &dyn Family,
        methods: &[Optimiser],
        evaluations: usize,
        simpler: Option<&Fit>,
        progress: Progress<'_>,
    ) -> Fit {
        let problem = self.problem;
        let genes = family.genes();
        let values =
            |at: &[f64]| genes.iter().zip(at).map(|(gene, &fraction)| gene.value(fraction)).collect::<Vec<_>>();
        let parameters = |at: &[f64]| family.project(&values(at), problem);
        let cost = |at: &[f64]| {
            let found = parameters(at);
            found.map_or(f64::INFINITY, |found| family.burden(&values(at)) * problem.cost_of(&found, self.cost))
        };
        let known = simpler.iter().flat_map(|fit| &fit.genes).map(|(gene, value)| gene.fraction(*value)).collect();
        let whole = |start: Vec<f64>| start.into_iter().chain(std::iter::repeat(0.5)).take(genes.len()).collect();
        let mut starts: Vec<Vec<f64>> = family.starts().into_iter().chain([known]).map(whole).collect();
        let mut convergence = simpler.map_or(Vec::new(), |fit| fit.convergence.clone());
        let (mut least, mut shown) = (f64::INFINITY, (f64::INFINITY, None));
        let mut watch = |_: usize, best: &Minimum| {
            if best.cost < least {
                least = best.cost;
                shown = match parameters(&best.at) {
                    Some(found) => (problem.cost_of(&found, self.cost), problem.held_out_of(&found, self.cost)),
                    None => shown,
                };
            }
            convergence.push(Convergence { training: shown.0, validation: shown.1 });
            progress(model, shown.0);
        };
        let budget = Budget { evaluations: evaluations / methods.len().max(1), seed: self.options.seed.into() };
        let mut best: Option<Minimum> = None;
        let mut made = 0;
        for &method in methods {
            let found = minimise(method, genes.len(), budget, &starts, &cost, &mut watch);
            made += found.evaluations;
            if best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
            starts.extend(best.iter().map(|best| best.at.clone()));
        }
        let at = best.map_or(Vec::new(), |best| best.at);
        let (parameters, cost) = match parameters(&at) {
            Some(found) => (found, problem.cost_of(&found, self.cost)),
            None => (Parameters::Voigt(VoigtParameters::default()), f64::INFINITY),
        };
        Fit {
            model,
            parameters,
            genes: genes.iter().copied().zip(values(&at)).collect(),
            cost,
            minimised: self.cost,
            evaluations: made,
            convergence,
            space: None,
        }
    }
}
