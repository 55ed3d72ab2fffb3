//! Differential evolution, current-to-pbest/1/bin (Zhang and Sanderson, JADE, 2009, without its adaptation):
//!
//! v = x + F·(p − x) + F·(a − b), p one of the best tenth, a and b any two others, F uniform on 0.4 … 0.9 for each
//!
//! Of x a coordinate stays with a probability of 0.1. What leaves the cube is mirrored back. A trial replaces x when it
//! costs no more. A collapsed population keeps its best and is drawn anew.

use super::state::{COLLAPSED, Scored, Search, extent, reflect, sort};
use rand::{Rng, RngExt};

const CROSSOVER: f64 = 0.9;

/// Spends the budget of a search; `population` is evaluated and grows to 8 a dimension, 20 … 100.
pub fn run(search: &mut Search<'_>, mut population: Vec<Scored>) {
    let size = (8 * search.dimension).clamp(20, 100).min((search.left() / 4).max(4));
    search.fill(&mut population, size);
    while search.left() > 0 {
        sort(&mut population);
        if extent(population.iter().map(|x| x.at.as_slice()), search.dimension) < COLLAPSED {
            population.truncate(1);
            search.fill(&mut population, size);
            continue;
        }
        let trials = (0..population.len()).map(|i| trial(&population, i, &mut search.random)).collect();
        for (point, trial) in population.iter_mut().zip(search.evaluate(trials)) {
            if trial.cost <= point.cost {
                *point = trial;
            }
        }
    }
}

/// A trial against one of a population of at least four, the cheapest first.
fn trial(population: &[Scored], i: usize, random: &mut impl Rng) -> Vec<f64> {
    let count = population.len();
    let pbest = random.random_range(0..(count / 10).max(2));
    let a = (i + random.random_range(1..count)) % count;
    let b = loop {
        let b = random.random_range(0..count);
        if b != a && b != i {
            break b;
        }
    };
    let factor = random.random_range(0.4..0.9);
    let [x, pbest, a, b] = [i, pbest, a, b].map(|i| &population[i].at);
    let always = random.random_range(0..x.len());
    (0..x.len())
        .map(|k| {
            // Drawn for each, so that the numbers drawn do not depend on `always`.
            let crossed = random.random_bool(CROSSOVER) || k == always;
            if crossed { reflect(x[k] + factor * (pbest[k] - x[k] + a[k] - b[k])) } else { x[k] }
        })
        .collect()
}
