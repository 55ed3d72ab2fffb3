//! Kernels for an emulator to count the instructions of. It counts in [`counted`] alone, on one thread.

use crate::thesis::{self, LENGTH_S, POPULATION};
use estimator_core::Model;
use identification::Problem;
use identification::cost::{Cost, Feedback};
use identification::family::{self, voigt};
use identification::search::Gene;
use std::hint::black_box;

/// Candidates of the recursion of `estimator-core`.
const OF_RECURSION: usize = 4;

/// Counts what it is called with. Its name is what the emulator is told.
#[inline(never)]
fn counted<R>(kernel: impl FnOnce() -> R) -> R {
    black_box(kernel())
}

/// Every kernel's name: the engine and the recursion with the thesis's model, and a candidate of every other model.
pub fn names() -> Vec<String> {
    let others = Model::ALL.into_iter().filter(|model| !model.is_voigt()).map(|model| model.name().to_owned());
    ["engine-osp", "engine-simulation", "recursion"].map(str::to_owned).into_iter().chain(others).collect()
}

/// Runs a kernel once; returns its sample-evaluations, or `None` where none is called so.
pub fn run(name: &str) -> Option<usize> {
    // This thread as a pool of its own: another would wait meanwhile, and waiting is instructions, too.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    alone.build().expect("a process's first pool can be made of its thread").install(|| run_alone(name))
}

fn run_alone(name: &str) -> Option<usize> {
    let problem = thesis::problem(LENGTH_S);
    let candidates = match name {
        "engine-osp" => engine(&problem, Feedback::Osp),
        "engine-simulation" => engine(&problem, Feedback::Simulation),
        "recursion" => {
            let (_, published) = thesis::candidates(&problem, OF_RECURSION);
            let costs = || published.iter().map(|of| problem.cost(of, Feedback::Simulation)).sum::<f64>();
            counted(costs);
            OF_RECURSION
        }
        other => {
            candidate(&problem, Model::ALL.into_iter().find(|model| model.name() == other)?)?;
            1
        }
    };
    Some(candidates * thesis::samples(&problem))
}

/// A generation of the engine.
fn engine(problem: &Problem, feedback: Feedback) -> usize {
    let kernel = voigt::Kernel::new(problem, feedback.into());
    let (candidates, _) = thesis::candidates(problem, POPULATION);
    counted(|| kernel.costs(&candidates));
    POPULATION
}

/// A candidate in the middle of what is searched of a model beyond the Voigt family: its least squares, and its cost.
fn candidate(problem: &Problem, model: Model) -> Option<()> {
    let structures = family::of(model, problem);
    let family = structures.first()?;
    let middle: Vec<f64> = family.genes().iter().map(|gene: &Gene| gene.value(0.5)).collect();
    let cost: Cost = Feedback::Simulation.into();
    counted(|| family.costs(&[middle], problem, cost));
    Some(())
}
