//! The thesis's whole search (64 chromosomes, 400 generations, five logs of 4,000 samples, nine parameters), in seconds,
//! and the evaluation of an admissible population on one core, in sample-evaluations a second. In the search a candidate
//! that is not admissible costs no samples, so its time times its 513 million nominal evaluations would flatter it.

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use estimator_core::Model;
use identification::cost::Feedback;
use identification::family::voigt::Kernel;
use identification::search::Optimiser;
use identification::search::ga::{Elitism, Selection};
use identification::search::space::{Ranges, Space};
use identification::{Conditions, Problem, SearchOptions, Start, identify};
use recordings::prepare::Recipe;
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};
use recordings::session::Session;
use std::hint::black_box;
use std::time::Duration;

const THESIS: SearchOptions = SearchOptions {
    ranges: Ranges::Data,
    bits: 10,
    population: 64,
    generations: 400,
    rounds: 1,
    shrink: 0.5,
    patience: 0,
    mutation: 0.15,
    selection: Selection::Tournament,
    elitism: Elitism::Aside,
    start: Start::Random,
    optimiser: Optimiser::CmaEs,
    evaluations: 1,
    seed: 1,
};

fn sessions() -> Vec<Session> {
    let modelling = EXCITATIONS.into_iter().filter(|excitation| excitation.name != VALIDATION);
    let session = |excitation| Recipe::at_tick(500).session(&Rig::default().log(excitation));
    modelling.map(|excitation| session(excitation).expect("the rig is five times as fast as the tick")).collect()
}

const POPULATION: usize = 64;

/// The optimum of the search with the simulation cost, to four digits.
const CANDIDATE: [f64; 9] = [307.2, 0.9423, 1.132, -0.073, 0.2415, 0.1027, 0.2458, 0.348, 1.027];

fn whole_search(criterion: &mut Criterion) {
    let problem = Problem::new(sessions(), Vec::new(), Conditions::default());
    let mut group = criterion.benchmark_group("whole search, enhanced model");
    group.sample_size(10).measurement_time(Duration::from_secs(10)).sampling_mode(SamplingMode::Flat);
    for cost in [Feedback::Osp, Feedback::Simulation] {
        group.bench_function(format!("{cost:?}"), |bencher| {
            bencher.iter(|| identify(&problem, &[Model::Enhanced], cost, &THESIS, &mut |_, _| ()));
        });
    }
    group.finish();
}

/// A population on one thread, at once and one candidate after the other.
fn population(criterion: &mut Criterion) {
    let problem = Problem::new(sessions(), Vec::new(), Conditions::default());
    let samples: usize = problem.training().map(|session| session.voltage.len()).sum();
    let space = Space::new(Model::Enhanced, Ranges::Data, problem.extent());
    let (candidate, published) = (space.parameters(&CANDIDATE), space.published(&CANDIDATE));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let mut group = criterion.benchmark_group("population, enhanced model");
    group.throughput(Throughput::Elements((POPULATION * samples) as u64)).sample_size(10);
    for cost in [Feedback::Osp, Feedback::Simulation] {
        let kernel = Kernel::new(&problem, cost.into());
        let candidates = [candidate; POPULATION];
        let admissible = kernel.costs(&candidates).iter().all(|cost| cost.is_finite());
        assert!(admissible, "the candidate must be admissible to be evaluated");
        group.bench_function(format!("{cost:?}, at once"), |bencher| {
            alone.install(|| bencher.iter(|| kernel.costs(black_box(&candidates))));
        });
        group.bench_function(format!("{cost:?}, one by one"), |bencher| {
            bencher.iter(|| (0..POPULATION).map(|_| problem.cost(black_box(&published), cost)).sum::<f64>());
        });
    }
    group.finish();
}

criterion_group!(benches, whole_search, population);
criterion_main!(benches);
