//! What the search asks of a model's family: what is searched, what follows from it, and what a candidate costs.

use crate::cost::Cost;
use crate::problem::Problem;
use crate::search::{Gene, Quadratic};
use crate::trial::Trial;
use estimator_core::Parameters;
use rayon::prelude::*;

/// What a tick of delay or lag must gain, as a fraction of the cost: at a single frequency they do
/// what hysteresis does.
const DELAYED: f64 = 3e-3;

/// How long after its voltage the displacement comes, ticks: `lag_s = (late − 1)·t_s`, for the recursion gives it a
/// tick after. Below a tick that is a look-ahead, beyond it a lag.
pub fn lateness() -> Gene {
    Gene::logarithmic("late", "time from the voltage to its displacement", "ticks", 0.05, 101.0)
}

/// The lag of that lateness, s; below 0 it is a look-ahead.
pub fn lag_s(late: f64, sample_period: f64) -> f32 {
    ((late - 1.0) * sample_period) as f32
}

/// The [burden](Family::burden) of a lateness.
pub fn lateness_burden(late: f64) -> f64 {
    1.0 + DELAYED * late
}

/// How a model's candidates are made.
pub trait Family: Sync {
    /// The parameters that are found.
    type Found: Trial;

    /// What is searched.
    fn genes(&self) -> Vec<Gene>;

    /// The whole parameter set that fits best with these searched values, in the order of the genes; `None` where
    /// there is none.
    fn project(&self, values: &[f64], problem: &Problem) -> Option<Self::Found>;

    /// The parameters that are kept of the best candidate, with what is too dear for each: those that fit best, where
    /// there is nothing of the kind.
    fn finish(&self, values: &[f64], problem: &Problem) -> Option<Self::Found> {
        self.project(values, problem)
    }

    /// Whether the parameters that were kept have what a gene stands for: what was too dear is no longer in them.
    fn has(&self, _gene: &Gene, _found: &Self::Found) -> bool {
        true
    }

    /// The projection with what the search minimises. It need not be an error: candidates are only compared.
    fn candidate(&self, values: &[f64], problem: &Problem, cost: Cost) -> Option<(Self::Found, f64)> {
        let found = self.project(values, problem)?;
        let size = self.burden(values) * problem.cost(&found, cost);
        Some((found, size))
    }

    /// What the search minimises of some candidates, in their order; infinite where there is no solution.
    fn costs(&self, candidates: &[Vec<f64>], problem: &Problem, cost: Cost) -> Vec<f64> {
        let of = |values: &Vec<f64>| self.candidate(values, problem, cost).map_or(f64::INFINITY, |(_, size)| size);
        candidates.par_iter().map(of).collect()
    }

    /// It is taken instead of a simpler structure where it is off, once the logs have settled, by less than this factor
    /// times what that is.
    fn must_better(&self) -> f64 {
        0.97
    }

    /// Whether [`quadratic`](Self::quadratic) says something.
    fn smooth(&self) -> bool {
        false
    }

    /// What the search's cost is near a point, in parts of the genes' ranges; `None` where nobody can say.
    fn quadratic(&self, _at: &[f64], _problem: &Problem) -> Option<Quadratic> {
        None
    }

    /// How many of the numbers found were solved for by least squares. Numbers that are laid out before the search
    /// (spans, thresholds, grids, creep times, orders, scales, limits) do not count, and numbers that follow from
    /// one count once.
    fn solved(&self, found: &Self::Found) -> usize;

    /// Where to start, as fractions of the genes' ranges; genes that are left out start in the middle.
    fn starts(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// A factor on the cost, from 1 up, that prefers the simpler of two candidates which the logs can
    /// hardly tell apart.
    fn burden(&self, _values: &[f64]) -> f64 {
        1.0
    }
}

/// A family of a model of the catalogue.
pub type AnyFamily = Box<dyn Family<Found = Parameters>>;
