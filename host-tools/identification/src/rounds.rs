//! Rounds of the genetic algorithm whose ranges shrink around the best so far, for the Voigt family.

use crate::family::voigt::Kernel;
use crate::fit::{Convergence, Fit, Identification, Progress};
use crate::search::Gene;
use crate::search::ga::{self, Best};
use crate::search::space::Space;
use std::cell::Cell;

impl Identification<'_> {
    /// Searches a space; `seeds` are candidates in gene values that join the first population.
    pub(super) fn genetic(&self, space: &Space, seeds: &[Vec<f64>], progress: Progress<'_>) -> Fit {
        let (problem, options) = (self.problem, self.options);
        let (asked, kernel) = (Cell::new(0), Kernel::new(problem, self.cost));
        let mut genes = space.genes.clone();
        let mut seeds = seeds.to_vec();
        let mut best: Option<Best> = None;
        let mut convergence: Vec<Convergence> = Vec::new();
        let mut shown = (f64::INFINITY, None);
        for round in 0..options.rounds.max(1) {
            let seed = (u64::from(options.seed) << 32) | (u64::from(round) << 8) | u64::from(!seeds.is_empty());
            let costs = |candidates: &[Vec<f64>]| {
                asked.set(asked.get() + candidates.len());
                let candidates: Vec<_> = candidates.iter().map(|values| space.parameters(values)).collect();
                kernel.costs(&candidates)
            };
            let found = ga::run(&genes, &options.settings(), seed, &seeds, costs, |_, best| {
                if best.cost < shown.0 {
                    shown = (best.cost, problem.held_out(&space.published(&best.genes), self.cost));
                }
                convergence.push(Convergence { training: shown.0, validation: shown.1 });
                progress(space.model, shown.0);
            });
            if best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
            let Some(best) = &best else { break };
            genes = narrowed(&space.genes, &best.genes, options.shrink, round + 1);
            // What the narrowing leaves outside is lost as a seed; the best lies inside.
            seeds = vec![best.genes.clone()];
        }
        // The first of at least one round has set it.
        let best = best.expect("at least one round was run");
        Fit {
            model: space.model,
            parameters: Some(space.published(&best.genes)),
            solved: 0,
            genes: space.genes.iter().copied().zip(best.genes).collect(),
            cost: best.cost,
            minimised: self.cost,
            evaluations: asked.get(),
            convergence,
            structure: 0,
            space: Some(space.clone()),
        }
    }
}

/// The ranges of a round: the original ones shrunk so many times around the best.
fn narrowed(genes: &[Gene], best: &[f64], shrink: f64, times: u32) -> Vec<Gene> {
    genes.iter().zip(best).map(|(gene, &value)| gene.around(value, libm::pow(shrink, f64::from(times)))).collect()
}
