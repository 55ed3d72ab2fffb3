//! Minimisers of one cost over the unit cube [0, 1]ⁿ behind one interface, so that a comparison gives
//! each the same budget of evaluations.
//!
//! | name | method |
//! |---|---|
//! | `genetic` | the thesis's binary genetic algorithm in rounds of shrinking ranges |
//! | `differential-evolution` | current-to-pbest/1/bin |
//! | `particle-swarm` | global best, constriction coefficients |
//! | `cma-es` | covariance matrix adaptation with restarts of a doubled population |
//! | `local` | downhill from the best start, by Newton's steps or Nelder and Mead's simplex, with pairs of restarts until they find nothing better |
//!
//! The cost may be infinite, for what is inadmissible, anywhere or everywhere; NaN counts as infinite. Random
//! numbers are drawn outside of the evaluations, which may run in parallel: the same seed gives the same result on
//! any number of threads.
//!
//! The methods are written here: `cmaes` 0.2 and `argmin` 0.11 each need an older `rand` beside this crate's, and a
//! budget of evaluations and the limits of the cube are the point of this module.

mod cma_es;
mod differential_evolution;
pub mod ga;
mod gene;
mod genetic;
mod halved;
mod local;
mod newton;
mod optimiser;
mod particle_swarm;
mod scaled;
mod state;

pub use gene::{Gene, Scale};
pub use halved::halved;
pub use optimiser::Optimiser;
use rayon::prelude::*;
pub use scaled::scaled;
use state::Search;
pub use state::{Budget, Minimum, Objective, Quadratic};

/// The costs of many points from that of one, asked in parallel.
pub fn each(cost: impl Fn(&[f64]) -> f64 + Sync) -> impl Fn(&[Vec<f64>]) -> Vec<f64> + Sync {
    move |points| points.par_iter().map(|at| cost(at)).collect()
}

/// Minimises a cost over the unit cube of a dimension. The objective is its costs, of some points, one each in
/// their order, or of a cost that is asked for one point at a time [`each`]; and what it is near a point, where its
/// owner can say.
///
/// `starts` are evaluated first, exactly as they are, and join the first population (`cma-es` and `local` begin at the
/// best of them); the result never costs more than any that the budget sufficed for. A coordinate outside of the cube
/// is limited to it, a start of another dimension is left out. `watch` sees the evaluations made and the best so far
/// whenever some more have been made. Dimension 0 takes one evaluation.
pub fn minimise<'a>(
    optimiser: Optimiser,
    dimension: usize,
    budget: Budget,
    starts: &[Vec<f64>],
    objective: impl Into<Objective<'a>>,
    watch: &'a mut dyn FnMut(usize, &Minimum),
) -> Minimum {
    let mut search = Search::new(dimension, budget, objective.into(), watch);
    if dimension == 0 {
        search.evaluate(vec![Vec::new()]);
        return search.best;
    }
    let starts = search.starts(starts);
    match optimiser {
        Optimiser::Genetic => genetic::run(&mut search, &starts),
        Optimiser::DifferentialEvolution => differential_evolution::run(&mut search, starts),
        Optimiser::ParticleSwarm => particle_swarm::run(&mut search, starts),
        Optimiser::CmaEs => cma_es::run(&mut search),
        Optimiser::Local => local::run(&mut search),
    }
    search.best
}
