//! Identification of one model or of several: the Voigt family by the genetic algorithm, the richer models started from
//! the simpler ones' solutions; the others by variable projection.

use crate::cost::Cost;
use crate::family::{self, BlackBoxInputs, voigt};
use crate::problem::Problem;
use crate::search::SearchOptions;
use crate::search::space::{Gene, Space};
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
    /// Which.
    pub model: Model,
    /// Its published parameters; `None` where no candidate has a solution.
    pub parameters: Option<Parameters>,
    /// The searched coordinates and where the best lies.
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
    /// Of the Voigt family.
    pub(crate) space: Option<Space>,
}

/// Told of each generation: the model, its best cost so far (µm).
pub type Progress<'a> = &'a mut dyn FnMut(Model, f64);

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
    identification.projected(Model::Narx, &family::black_boxes(inputs), progress)
}

/// What is identified from what, and how.
#[derive(Clone, Copy, Debug)]
pub struct Identification<'a> {
    /// The sessions.
    pub problem: &'a Problem,
    /// What is minimised.
    pub cost: Cost,
    /// The search.
    pub options: &'a SearchOptions,
    /// Candidates that may be evaluated for each model, of all its structures and by all methods together; where there
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

    /// By rounds of the genetic algorithm, from random candidates and again with the simpler models' solutions among
    /// them where there are any: the better of the two. Within a budget in one search that starts at the best of those
    /// solutions.
    fn voigt(&self, model: Model, simpler: &[Fit], progress: Progress<'_>) -> Fit {
        let space = Space::new(model, self.options.ranges, self.problem.extent());
        let values = |fit: &Fit| fit.genes.iter().map(|(_, value)| *value).collect::<Vec<_>>();
        let simpler = simpler.iter().filter_map(|fit| Some((fit, fit.space.as_ref()?)));
        let seeds: Vec<Vec<f64>> = simpler.map(|(fit, theirs)| space.adopt(theirs, &values(fit))).collect();
        if let Some(budget) = self.budget {
            let family = voigt::Family { space: &space, seeds: &seeds };
            let found = self.structure(model, &family, &[self.options.optimiser], budget, None, progress);
            return Fit { space: Some(space), ..found };
        }
        let fit = self.genetic(&space, &[], progress);
        if self.options.starts(seeds.len()) == 1 {
            return fit;
        }
        let seeded = self.genetic(&space, &seeds, progress);
        let evaluations = fit.evaluations + seeded.evaluations;
        Fit { evaluations, ..if seeded.cost < fit.cost { seeded } else { fit } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Conditions;
    use crate::cost::{Feedback, Norm};
    use crate::search::Optimiser;
    use recordings::prepare::Recipe;
    use recordings::rig::{EXCITATIONS, Rig};

    /// The rig's 10 Hz logs.
    fn problem() -> Problem {
        let fast = EXCITATIONS.into_iter().filter(|excitation| excitation.name.ends_with("10"));
        let rig = Rig { duration: 0.3, ..Rig::default() };
        let sessions = fast.map(|excitation| Recipe::at_tick(500).session(&rig.log(excitation)).unwrap());
        Problem::new(sessions.collect(), Vec::new(), Conditions::default())
    }

    fn fits(problem: &Problem, models: &[Model], cost: Cost, budget: usize) -> Vec<Fit> {
        let options = SearchOptions::default();
        Identification { problem, cost, options: &options, budget: Some(budget) }.run(models, &mut |_, _| ())
    }

    fn in_norm(norm: Norm) -> Cost {
        Cost { norm, ..Feedback::Simulation.into() }
    }

    #[test]
    fn each_norm_s_fit_is_the_better_one_in_its_own() {
        let problem = problem();
        for model in [Model::Voigt, Model::BoucWen] {
            let [absolute, square] =
                [Norm::L1, Norm::L2].map(|norm| fits(&problem, &[model], in_norm(norm), 3000).remove(0));
            let in_both =
                |fit: &Fit| [Norm::L1, Norm::L2].map(|norm| problem.cost(&fit.parameters.unwrap(), in_norm(norm)));
            let ([mae, rms], [other_mae, other_rms]) = (in_both(&absolute), in_both(&square));
            assert!(mae < other_mae && other_rms < rms, "{model}: MAE {mae} {other_mae}, RMS {rms} {other_rms}");
            assert_eq!((absolute.cost, square.cost), (mae, other_rms), "{model}");
        }
    }

    #[test]
    fn no_model_exceeds_the_budget_and_what_is_searched_spends_it() {
        let problem = problem();
        for (budget, narx, preisach) in [(300, 81, 1), (40, 40, 1)] {
            for fit in fits(&problem, &Model::ALL, in_norm(Norm::L1), budget) {
                let expected = match fit.model {
                    Model::Narx => narx..=narx,
                    Model::Preisach => preisach..=preisach,
                    // Two methods a structure: what does not divide is not spent.
                    _ => budget - 2..=budget,
                };
                assert!(expected.contains(&fit.evaluations), "{}: {} of {budget}", fit.model, fit.evaluations);
            }
        }
    }

    #[test]
    fn evaluations_are_counted_without_a_budget_too() {
        let options = SearchOptions {
            population: 8,
            generations: 3,
            rounds: 2,
            evaluations: 5,
            optimiser: Optimiser::Local,
            ..SearchOptions::default()
        };
        let models = [Model::Voigt, Model::VoltageExtremum, Model::Duhem];
        let found = identify(&problem(), &models, Feedback::Osp, &options, &mut |_, _| ());
        // Eight chromosomes in the first population and three generations of each round; the second has one seed, the
        // extremum model's second search one more in its first.
        let one = 2 * 8 * 4 + 1;
        let evaluations: Vec<usize> = found.iter().map(|fit| fit.evaluations).collect();
        assert_eq!(evaluations, [one, 2 * one + 1, 2 * 5]);
    }
}
