//! Identification of one model or of several: the Voigt family by the genetic algorithm, the richer models started from
//! the simpler ones' solutions; the others by variable projection.

use crate::cost::Cost;
use crate::family::{self, AnyFamily, BlackBoxInputs, voigt};
use crate::problem::Problem;
use crate::search::SearchOptions;
use crate::search::space::Space;
use crate::search::{Gene, Optimiser};
use estimator_core::{Model, Parameters};
use serde::Serialize;

/// Errors of the best candidate after a generation (Fig. 4.9, 4.10), in the cost's norm.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Convergence {
    /// Cost on the training sessions, µm.
    pub training: f64,
    /// Simulation error on what was held out, µm; `None` where nothing was.
    pub validation: Option<f64>,
}

/// An identified model.
#[derive(Clone, PartialEq, Debug)]
pub struct Fit {
    /// Which model it is.
    pub model: Model,
    /// Its published parameters; `None` where no candidate has a solution.
    pub parameters: Option<Parameters>,
    /// The searched coordinates that the model has, and where the best lies.
    pub genes: Vec<(Gene, f64)>,
    /// Numbers of the parameters that were solved for by least squares.
    pub solved: usize,
    /// Its cost, µm; infinite when no admissible candidate was found.
    pub cost: f64,
    /// What that cost is.
    pub minimised: Cost,
    /// Candidates that were evaluated for it, those without a solution or not admissible among them.
    pub evaluations: usize,
    /// After each generation.
    pub convergence: Vec<Convergence>,
    /// Which of the model's structures it is; 0 of the Voigt family, which has none.
    pub(crate) structure: usize,
    /// The space that was searched, of a model of the Voigt family.
    pub(crate) space: Option<Space>,
}

impl Fit {
    /// Numbers that were identified from the logs: those searched and those solved for by least squares.
    pub fn numbers(&self) -> usize {
        self.genes.len() + self.solved
    }
}

/// Told of each generation: the model, its best cost so far (µm).
pub type Progress<'a> = &'a mut (dyn FnMut(Model, f64) + Send);

/// Identifies models one after the other, each started from those before it.
pub fn identify(
    problem: &Problem,
    models: &[Model],
    cost: impl Into<Cost>,
    options: &SearchOptions,
    progress: Progress<'_>,
) -> Vec<Fit> {
    Identification { problem, cost: cost.into(), options, budget: None }.run(models, progress)
}

/// Identifies the NARX model with these inputs alone, of the degree from 1 to 3 that costs least.
pub fn identify_black_box(
    problem: &Problem,
    inputs: BlackBoxInputs,
    cost: impl Into<Cost>,
    options: &SearchOptions,
    progress: Progress<'_>,
) -> Fit {
    let identification = Identification { problem, cost: cost.into(), options, budget: None };
    identification.projected(Model::Narx, &family::black_boxes(inputs, problem), progress)
}

/// What searches again from where another fit ended.
const NEARBY: Optimiser = Optimiser::Local;
/// Candidates a number that suffice it where a family says what its cost is near a point: little is left for restarts,
/// which found nothing better from there.
const SMOOTH: usize = 20;

/// What is identified from what, and how.
#[derive(Clone, Copy, Debug)]
pub struct Identification<'a> {
    /// The sessions that it is fitted to.
    pub problem: &'a Problem,
    /// What is minimised.
    pub cost: Cost,
    /// How it is searched.
    pub options: &'a SearchOptions,
    /// Candidates that may be evaluated for each model, of all its structures together; where there
    /// is none the options say it, of the Voigt family by generations, of the others by evaluations a number.
    pub budget: Option<usize>,
}

impl Identification<'_> {
    /// Identifies models one after the other, each started from those before it.
    pub fn run(&self, models: &[Model], progress: Progress<'_>) -> Vec<Fit> {
        let mut fits: Vec<Fit> = Vec::new();
        for &model in models {
            let structures = family::of(model, self.problem);
            let fit = if structures.is_empty() {
                self.voigt(model, &fits, progress)
            } else {
                self.projected(model, &structures, progress)
            };
            fits.push(fit);
        }
        fits
    }

    /// What fits of one model are told apart by: their cost, but in simulation the problem's
    /// [`error_once_settled`](Problem::error_once_settled), since a sensor's zero and how a log began are no merit of a
    /// fit; infinite where nothing was found.
    pub(crate) fn off(&self, fit: &Fit) -> f64 {
        let found = fit.parameters.filter(|_| fit.cost.is_finite() && self.cost.weight() == 0.0);
        found.map_or(fit.cost, |parameters| self.problem.error_once_settled(&parameters, self.cost))
    }

    /// The model of a fit once more, on other sessions, from where that one ended: one structure and one search of so
    /// many candidates, or of as many as a smooth family needs, whose convergence is not kept.
    pub fn again(&self, fit: &Fit, evaluations: usize) -> Fit {
        let structures = family::of(fit.model, self.problem);
        match structure_of(fit, &structures) {
            Some(at) => {
                let family = &structures[at];
                let enough = if family.smooth() { SMOOTH * family.genes().len() } else { evaluations };
                let found = self.structure(fit.model, family.as_ref(), NEARBY, enough, Some(fit), None);
                Fit { structure: at, ..found }
            }
            None => {
                let (space, seeds) = self.space(fit.model, std::slice::from_ref(fit));
                self.within(space, &seeds, NEARBY, evaluations, None)
            }
        }
    }

    /// By rounds of the genetic algorithm, from random candidates and again with the simpler models' solutions among
    /// them where there are any: the better of the two. Within a budget in one search that starts at the best of them.
    fn voigt(&self, model: Model, simpler: &[Fit], progress: Progress<'_>) -> Fit {
        let (space, seeds) = self.space(model, simpler);
        if let Some(budget) = self.budget {
            return self.within(space, &seeds, self.options.optimiser, budget, Some(progress));
        }
        let fit = self.genetic(&space, &[], progress);
        if self.options.starts(seeds.len()) == 1 {
            return fit;
        }
        let seeded = self.genetic(&space, &seeds, progress);
        let evaluations = fit.evaluations + seeded.evaluations;
        Fit { evaluations, ..if self.off(&seeded) < self.off(&fit) { seeded } else { fit } }
    }

    /// The search space of a model of the Voigt family, and where simpler models' solutions lie in it.
    fn space(&self, model: Model, simpler: &[Fit]) -> (Space, Vec<Vec<f64>>) {
        let space = Space::new(model, self.options.ranges, self.problem.extent());
        let values = |fit: &Fit| fit.genes.iter().map(|(_, value)| *value).collect::<Vec<_>>();
        let simpler = simpler.iter().filter_map(|fit| Some((fit, fit.space.as_ref()?)));
        let seeds = simpler.map(|(fit, theirs)| space.adopt(theirs, &values(fit))).collect();
        (space, seeds)
    }

    /// A model of the Voigt family by one search of so many candidates.
    fn within(
        &self,
        space: Space,
        seeds: &[Vec<f64>],
        method: Optimiser,
        evaluations: usize,
        progress: Option<Progress<'_>>,
    ) -> Fit {
        let kernel = voigt::Kernel::new(self.problem, self.cost);
        let family = voigt::Family { space: &space, seeds, kernel: &kernel };
        let found = self.structure(space.model, &family, method, evaluations, None, progress);
        Fit { space: Some(space), ..found }
    }
}

/// Which of a model's structures a fit goes on in: of those that search all that it was found by, and least besides,
/// its own. (A limit that it was found not to need is not searched again.) `None` of the Voigt family, which has none.
fn structure_of(fit: &Fit, structures: &[AnyFamily]) -> Option<usize> {
    let genes: Vec<Vec<Gene>> = structures.iter().map(|family| family.genes()).collect();
    let all = |at: &usize| fit.genes.iter().all(|(gene, _)| genes[*at].iter().any(|of| of.name == gene.name));
    // Its own before others that search as many.
    let nearest = (0..genes.len()).filter(all).min_by_key(|&at| (genes[at].len(), at != fit.structure));
    nearest.or((!genes.is_empty()).then_some(0))
}
