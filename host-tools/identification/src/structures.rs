//! The search of what a model's structure is not linear in, and the choice among the structures of a model.

use crate::cost::Cost;
use crate::family::{AnyFamily, Family};
use crate::fit::{Convergence, Fit, Identification, Progress};
use crate::problem::Problem;
use crate::search::Gene;
use crate::search::{Budget, Minimum, Objective, Optimiser, minimise};
use estimator_core::Model;

/// Where in its range a gene of which nothing is known begins.
const MIDDLE: f64 = 0.5;
/// A new best is shown, which takes a simulation of every log, where it costs less than this factor times the one that
/// was shown last.
const SHOWN: f64 = 0.99;

/// What the search of one structure has found.
#[derive(Clone, PartialEq, Debug)]
pub struct Found<P> {
    /// The parameters that cost least; `None` where no candidate has a solution.
    pub parameters: Option<P>,
    /// The searched coordinates that the parameters have, and where the best lies.
    pub genes: Vec<(Gene, f64)>,
    /// Numbers of the parameters that were solved for by least squares.
    pub solved: usize,
    /// Its cost, µm; infinite where no candidate is admissible.
    pub cost: f64,
    /// Candidates that were evaluated.
    pub evaluations: usize,
    /// After each generation.
    pub convergence: Vec<Convergence>,
}

/// How one structure is searched.
#[derive(Clone, Copy, Debug)]
pub struct StructureSearch<'a> {
    /// The sessions that they are fitted to.
    pub problem: &'a Problem,
    /// What is minimised.
    pub cost: Cost,
    /// How it chooses candidates.
    pub method: Optimiser,
    /// Candidates that it may evaluate.
    pub evaluations: usize,
    /// Seed of their random numbers.
    pub seed: u32,
}

impl StructureSearch<'_> {
    /// Searches a structure from its own starts and from the middle, or from where a simpler one ended (`known`:
    /// values of its genes, found here by their names). `progress` is told how many candidates have been evaluated
    /// and the best cost so far (µm); where nobody is told, no convergence is kept: each point of it takes a
    /// simulation of every log.
    pub fn run<F: Family + ?Sized>(
        &self,
        family: &F,
        known: &[(Gene, f64)],
        mut progress: Option<&mut dyn FnMut(usize, f64)>,
    ) -> Found<F::Found> {
        let problem = self.problem;
        let genes = family.genes();
        let values =
            |at: &[f64]| genes.iter().zip(at).map(|(gene, &fraction)| gene.value(fraction)).collect::<Vec<_>>();
        let parameters = |at: &[f64]| family.project(&values(at), problem);
        let costs = |points: &[Vec<f64>]| {
            let candidates: Vec<Vec<f64>> = points.iter().map(|at| values(at)).collect();
            family.costs(&candidates, problem, self.cost)
        };
        // Where another problem lays a range out otherwise, a value is the same, and not its part of the range.
        let value = |gene: &Gene| known.iter().find(|(of, _)| of.name == gene.name).map(|(_, value)| *value);
        let known = genes.iter().map(|gene| value(gene).map_or(MIDDLE, |value| gene.fraction(value))).collect();
        let whole = |start: Vec<f64>| start.into_iter().chain(std::iter::repeat(MIDDLE)).take(genes.len()).collect();
        let starts: Vec<Vec<f64>> = family.starts().into_iter().chain([known]).map(whole).collect();
        let mut convergence = Vec::new();
        let (mut least, mut shown) = (f64::INFINITY, (f64::INFINITY, None));
        let budget = Budget { evaluations: self.evaluations, seed: self.seed.into() };
        let mut watch = |made: usize, best: &Minimum| {
            let Some(progress) = &mut progress else { return };
            if best.cost < SHOWN * least {
                least = best.cost;
                shown = match parameters(&best.at) {
                    Some(found) => (problem.cost(&found, self.cost), problem.held_out(&found, self.cost)),
                    None => shown,
                };
            }
            convergence.push(Convergence { training: shown.0, validation: shown.1 });
            progress(made, shown.0);
        };
        let quadratic = |at: &[f64]| family.quadratic(at, problem);
        let objective = Objective { costs: &costs, quadratic: &quadratic };
        let Minimum { at, evaluations, .. } =
            minimise(self.method, genes.len(), budget, &starts, objective, &mut watch);
        let parameters = family.finish(&values(&at), problem);
        let has = |gene: &Gene| parameters.as_ref().is_none_or(|found| family.has(gene, found));
        Found {
            genes: genes.iter().copied().zip(values(&at)).filter(|(gene, _)| has(gene)).collect(),
            solved: parameters.as_ref().map_or(0, |found| family.solved(found)),
            cost: parameters.as_ref().map_or(f64::INFINITY, |found| problem.cost(found, self.cost)),
            parameters,
            evaluations,
            convergence,
        }
    }
}

impl Identification<'_> {
    /// Of several structures each is started from the one before it, and the simplest that no other betters counts.
    /// They share the budget by what they search.
    pub(super) fn projected(&self, model: Model, structures: &[AnyFamily], progress: Progress<'_>) -> Fit {
        let mut best: Option<(Fit, f64)> = None;
        let mut evaluations = 0;
        for (index, family) in structures.iter().enumerate() {
            let allowed = match self.budget {
                None => self.options.evaluations as usize * shares(family),
                Some(budget) => {
                    let of_all: usize = structures.iter().skip(index).map(shares).sum();
                    let left = budget.saturating_sub(evaluations);
                    (left * shares(family) / of_all).max(left.min(1))
                }
            };
            if allowed == 0 && best.is_some() {
                break;
            }
            let simpler = best.as_ref().map(|(fit, _)| fit);
            let found =
                self.structure(model, family.as_ref(), self.options.optimiser, allowed, simpler, Some(progress));
            evaluations += found.evaluations;
            let off = self.off(&found);
            if best.as_ref().is_none_or(|(_, best)| off < family.must_better() * best) {
                best = Some((Fit { structure: index, ..found }, off));
            }
        }
        // Only the Voigt family has no structures, and it does not come here.
        let (best, _) = best.expect("a model has a structure");
        Fit { evaluations, ..best }
    }

    /// Searches one structure by a method with so many evaluations, and goes on from a simpler one.
    pub(super) fn structure(
        &self,
        model: Model,
        family: &dyn Family<Found = estimator_core::Parameters>,
        method: Optimiser,
        evaluations: usize,
        simpler: Option<&Fit>,
        progress: Option<Progress<'_>>,
    ) -> Fit {
        let search =
            StructureSearch { problem: self.problem, cost: self.cost, method, evaluations, seed: self.options.seed };
        let known = simpler.map_or(&[][..], |fit| &fit.genes);
        let found = match progress {
            Some(progress) => search.run(family, known, Some(&mut |_, cost| progress(model, cost))),
            None => search.run(family, known, None),
        };
        let before = simpler.map_or(&[][..], |fit| &fit.convergence);
        Fit {
            model,
            parameters: found.parameters,
            genes: found.genes,
            solved: found.solved,
            cost: found.cost,
            minimised: self.cost,
            evaluations: found.evaluations,
            convergence: [before, &found.convergence].concat(),
            structure: 0,
            space: None,
        }
    }
}

/// What a structure's search takes beside another's: the numbers that are searched.
fn shares(family: &AnyFamily) -> usize {
    family.genes().len().max(1)
}
