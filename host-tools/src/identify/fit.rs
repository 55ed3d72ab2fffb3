//! Identification of one model or of the whole family: rounds of the genetic algorithm whose ranges shrink around the
//! best so far, the richer models started from the simpler ones' solutions.

use super::family::{self, BlackBoxInputs, Family};
use super::ga::{self, Best, Elitism, Selection, Settings};
use super::problem::Problem;
use super::space::{Gene, Ranges, Space};
use crate::optimise::{Budget, Minimum, Optimiser, minimise};
use crate::session::Feedback;
use clap::Args;
use estimator_core::{Model, Parameters, VoigtParameters};
use serde::{Deserialize, Serialize};

/// Where the first population of a model comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Random; and once more with the solutions of the simpler models among it. The better result counts.
    Family,
    /// Random only, as the thesis.
    Random,
}

/// How the search runs. The thesis's own setting is `--ranges table-4.5 --mutation 0.15 --elitism aside --generations
/// 400 --rounds 1 --start random`.
#[derive(Args, Clone, PartialEq, Debug, Serialize, Deserialize)]
#[command(next_help_heading = "Genetic algorithm")]
#[serde(deny_unknown_fields)]
pub struct SearchOptions {
    /// What is searched, and where.
    #[arg(long, value_enum, default_value_t = Ranges::Data)]
    pub ranges: Ranges,
    /// Bits a gene.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..=30))]
    pub bits: u32,
    /// Chromosomes (even).
    #[arg(long, default_value_t = 64, value_parser = even)]
    pub population: usize,
    /// Generations a round.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub generations: u32,
    /// Rounds.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=50))]
    pub rounds: u32,
    /// Width of a round's ranges as a fraction of the round's before, around the best so far.
    #[arg(long, default_value_t = 0.7, value_parser = fraction)]
    pub shrink: f64,
    /// Stop a round after so many generations without improvement; 0: never.
    #[arg(long, default_value_t = 0)]
    pub patience: u32,
    /// Bits flipped in a generation, as a fraction of all.
    #[arg(long, default_value_t = 0.02, value_parser = fraction)]
    pub mutation: f64,
    /// Choice of parents.
    #[arg(long, value_enum, default_value_t = Selection::Tournament)]
    pub selection: Selection,
    /// What becomes of the best chromosome.
    #[arg(long, value_enum, default_value_t = Elitism::Reinsert)]
    pub elitism: Elitism,
    /// First population.
    #[arg(long, value_enum, default_value_t = Start::Family)]
    pub start: Start,
    /// Method for the models beyond the Voigt family, of which only a few numbers are searched.
    #[arg(long, value_enum, default_value_t = Optimiser::CmaEs)]
    pub optimiser: Optimiser,
    /// Candidates that the method may try for each number that is searched.
    #[arg(long, default_value_t = 250, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub evaluations: u32,
    /// Seed; the same seed gives the same table on any number of threads.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
}

fn even(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if n % 2 == 0 && (2..=100_000).contains(&n) => Ok(n),
        _ => Err("expected an even number from 2 to 100000".to_owned()),
    }
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("expected a number from 0 to 1".to_owned()),
    }
}

impl SearchOptions {
    fn settings(&self) -> Settings {
        Settings {
            bits: self.bits,
            population: self.population,
            generations: self.generations,
            patience: self.patience,
            mutation: self.mutation,
            selection: self.selection,
            elitism: self.elitism,
        }
    }

    /// Generations that the identification of some models takes at most, for a progress bar.
    pub fn generations_of(&self, models: &[Model]) -> u64 {
        let starts: usize = (0..models.len()).map(|earlier| self.starts(earlier)).sum();
        starts as u64 * u64::from(self.rounds) * (u64::from(self.generations) + 1)
    }

    /// Searches of a model that has so many simpler ones before it.
    fn starts(&self, earlier: usize) -> usize {
        if self.start == Start::Family && earlier > 0 { 2 } else { 1 }
    }
}

/// Errors of the best candidate after a generation (Fig. 4.9, 4.10).
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
    /// Its published parameters.
    pub parameters: Parameters,
    /// The searched coordinates and where the best lies.
    pub genes: Vec<(Gene, f64)>,
    /// Its cost, µm; infinite when no admissible candidate was found.
    pub cost: f64,
    /// After each generation.
    pub convergence: Vec<Convergence>,
    /// Of the Voigt family.
    space: Option<Space>,
}

/// Told of each generation: the model, its best cost so far (µm).
pub type Progress<'a> = &'a mut dyn FnMut(Model, f64);

/// Identifies models one after the other, each started from those before it.
pub fn identify(
    problem: &Problem,
    models: &[Model],
    cost: Feedback,
    options: &SearchOptions,
    progress: Progress<'_>,
) -> Vec<Fit> {
    let mut fits: Vec<Fit> = Vec::new();
    for &model in models {
        let structures = family::of(model, problem);
        if !structures.is_empty() {
            fits.push(project(problem, model, &structures, cost, options, progress));
            continue;
        }
        let space = Space::new(model, options.ranges, problem.extent());
        let values = |fit: &Fit| fit.genes.iter().map(|(_, value)| *value).collect::<Vec<_>>();
        let simpler = fits.iter().filter_map(|fit| Some((fit, fit.space.as_ref()?)));
        let seeds: Vec<Vec<f64>> = simpler.map(|(fit, theirs)| space.adopt(theirs, &values(fit))).collect();
        let mut fit = search(problem, &space, cost, options, &[], progress);
        if options.starts(seeds.len()) > 1 {
            let seeded = search(problem, &space, cost, options, &seeds, progress);
            if seeded.cost < fit.cost {
                fit = seeded;
            }
        }
        fits.push(fit);
    }
    fits
}

/// Identifies the NARX model with these inputs alone, of the degree from 1 to 3 that costs least.
pub fn identify_black_box(
    problem: &Problem,
    inputs: BlackBoxInputs,
    cost: Feedback,
    options: &SearchOptions,
    progress: Progress<'_>,
) -> Fit {
    project(problem, Model::Narx, &family::black_boxes(inputs), cost, options, progress)
}

fn search(
    problem: &Problem,
    space: &Space,
    cost: Feedback,
    options: &SearchOptions,
    seeds: &[Vec<f64>],
    progress: Progress<'_>,
) -> Fit {
    let mut genes = space.genes.clone();
    let mut seeds = seeds.to_vec();
    let mut best: Option<Best> = None;
    let mut convergence: Vec<Convergence> = Vec::new();
    let mut shown = (f64::INFINITY, None);
    for round in 0..options.rounds.max(1) {
        let seed = (u64::from(options.seed) << 32) | (u64::from(round) << 8) | u64::from(!seeds.is_empty());
        let error = |values: &[f64]| problem.cost(&space.parameters(values), cost);
        let found = ga::run(&genes, &options.settings(), seed, &seeds, error, |_, best| {
            if best.cost < shown.0 {
                shown = (best.cost, problem.held_out(&space.parameters(&best.genes)));
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
        parameters: Parameters::Voigt(space.parameters(&best.genes).map(|x| x as f32)),
        genes: space.genes.iter().copied().zip(best.genes).collect(),
        cost: best.cost,
        convergence,
        space: Some(space.clone()),
    }
}

/// A structure with so many searched numbers has minima that one method alone misses, a resonance above all,
const MANY: usize = 6;
/// and is searched by this one, too.
const SECOND: Optimiser = Optimiser::DifferentialEvolution;
/// A richer structure must better the simpler one's cost by this factor.
const BETTER: f64 = 0.97;

/// Searches what a model beyond the Voigt family is not linear in; the rest is projected. Of several structures each is
/// started from the one before it, and the simplest that no other betters counts.
fn project(
    problem: &Problem,
    model: Model,
    structures: &[Box<dyn Family>],
    feedback: Feedback,
    options: &SearchOptions,
    progress: Progress<'_>,
) -> Fit {
    let mut best = Fit {
        model,
        parameters: Parameters::Voigt(VoigtParameters::default()),
        genes: Vec::new(),
        cost: f64::INFINITY,
        convergence: Vec::new(),
        space: None,
    };
    for family in structures {
        let found =
            search_structure(problem, family.as_ref(), feedback, options, &best, &mut |cost| progress(model, cost));
        if found.cost < BETTER * best.cost {
            best = found;
        }
    }
    best
}

fn search_structure(
    problem: &Problem,
    family: &dyn Family,
    feedback: Feedback,
    options: &SearchOptions,
    simpler: &Fit,
    progress: &mut dyn FnMut(f64),
) -> Fit {
    let genes = family.genes();
    let values = |at: &[f64]| genes.iter().zip(at).map(|(gene, &fraction)| gene.value(fraction)).collect::<Vec<_>>();
    let parameters = |at: &[f64]| family.project(&values(at), problem);
    let cost = |at: &[f64]| {
        let found = parameters(at);
        found.map_or(f64::INFINITY, |found| family.burden(&values(at)) * problem.cost_of(&found, feedback))
    };
    let known: Vec<f64> = simpler.genes.iter().map(|(gene, value)| gene.fraction(*value)).collect();
    let whole = |start: Vec<f64>| start.into_iter().chain(std::iter::repeat(0.5)).take(genes.len()).collect();
    let starts: Vec<Vec<f64>> = family.starts().into_iter().chain([known]).map(whole).collect();
    let mut convergence = simpler.convergence.clone();
    let (mut least, mut shown) = (f64::INFINITY, (f64::INFINITY, None));
    let budget = Budget { evaluations: options.evaluations as usize * genes.len().max(1), seed: options.seed.into() };
    let mut watch = |_: usize, best: &Minimum| {
        if best.cost < least {
            least = best.cost;
            shown = match parameters(&best.at) {
                Some(found) => (problem.cost_of(&found, feedback), problem.held_out_of(&found)),
                None => shown,
            };
        }
        convergence.push(Convergence { training: shown.0, validation: shown.1 });
        progress(shown.0);
    };
    let mut best = minimise(options.optimiser, genes.len(), budget, &starts, &cost, &mut watch);
    if genes.len() >= MANY && options.optimiser != SECOND {
        let again = minimise(SECOND, genes.len(), budget, &[starts, vec![best.at.clone()]].concat(), &cost, &mut watch);
        best = if again.cost < best.cost { again } else { best };
    }
    let (parameters, cost) = match parameters(&best.at) {
        Some(found) => (found, problem.cost_of(&found, feedback)),
        None => (simpler.parameters, f64::INFINITY),
    };
    let values = values(&best.at);
    let genes = genes.into_iter().zip(values).collect();
    Fit { model: simpler.model, parameters, genes, cost, convergence, space: None }
}

/// The ranges of a round: the original ones shrunk so many times around the best.
fn narrowed(genes: &[Gene], best: &[f64], shrink: f64, times: u32) -> Vec<Gene> {
    genes.iter().zip(best).map(|(gene, &value)| gene.around(value, libm::pow(shrink, f64::from(times)))).collect()
}
