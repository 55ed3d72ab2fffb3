//! The thesis's whole search (64 chromosomes, 400 generations, five logs of 4,000 samples, nine parameters),
//! in seconds. In the search a candidate that is not admissible costs no samples: what a sample costs, the
//! bench `workload` says.

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use estimator_core::Model;
use identification::cost::Feedback;
use identification::search::Optimiser;
use identification::search::ga::{Elitism, Selection};
use identification::search::space::Ranges;
use identification::{Conditions, Problem, SearchOptions, Start, identify};
use recordings::prepare::Recipe;
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};
use recordings::session::Session;
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

criterion_group!(benches, whole_search);
criterion_main!(benches);
