//! The genetic algorithm finds minima, the same on any number of threads, and stops when it is told to.

use identification::search::ga::{Elitism, Selection, Settings, run};
use identification::search::{Gene, Scale, each};

const THESIS: Settings = Settings {
    bits: 10,
    population: 64,
    generations: 400,
    patience: 0,
    mutation: 0.15,
    selection: Selection::Tournament,
    elitism: Elitism::Aside,
};

fn genes(count: usize) -> Vec<Gene> {
    (0..count).map(|_| Gene { name: "x", meaning: "", unit: "", min: -1.0, max: 3.0, scale: Scale::Linear }).collect()
}

fn sphere(genes: &[f64]) -> f64 {
    genes.iter().map(|x| (x - 0.7).abs()).sum::<f64>()
}

#[test]
fn finds_a_minimum_with_either_selection_and_reports_a_falling_cost() {
    for selection in [Selection::Tournament, Selection::Roulette] {
        let settings = Settings { selection, mutation: 0.02, elitism: Elitism::Reinsert, ..THESIS };
        let mut costs = Vec::new();
        let best = run(&genes(5), &settings, 1, &[], each(sphere), |_, best| costs.push(best.cost));
        assert!(best.cost < 0.05, "{selection:?}: {best:?}");
        assert_eq!(best.cost, sphere(&best.genes));
        assert_eq!(costs.len(), 401);
        assert!(costs.is_sorted_by(|a, b| a >= b));
    }
}

#[test]
fn the_same_seed_gives_the_same_result_on_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&genes(4), &THESIS, 9, &[], each(sphere), |_, _| ()))
    };
    assert_eq!(on(1), on(4));
    assert_ne!(on(1), run(&genes(4), &THESIS, 10, &[], each(sphere), |_, _| ()));
}

#[test]
fn an_infinite_cost_never_wins_and_a_seed_is_never_lost() {
    let forbidden = |x: &[f64]| if x[0] < 2.0 { f64::INFINITY } else { sphere(x) };
    let best = run(&genes(3), &THESIS, 1, &[], each(forbidden), |_, _| ());
    assert!(best.genes[0] >= 2.0);
    let seed = vec![0.7, 0.7, 0.7];
    let best = run(&genes(3), &THESIS, 1, std::slice::from_ref(&seed), each(sphere), |_, _| ());
    assert_eq!(best.genes, seed);
}

#[test]
fn patience_stops_the_run() {
    let mut generations = 0;
    let settings = Settings { patience: 7, ..THESIS };
    run(&genes(2), &settings, 1, &[], each(|_| 1.0), |_, _| generations += 1);
    assert_eq!(generations, 8);
}
