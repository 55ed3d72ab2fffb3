//! The thesis's binary genetic algorithm (4.1.2) in rounds of shrinking ranges, as the identification runs it: 12 bits
//! a gene, 64 chromosomes, tournament, mutation 0.02, the best reinserted; up to 10 rounds of at least 20 generations,
//! each over 0.7 times the ranges before, around the best so far.
//!
//! A budget below 512 evaluations makes the population smaller, of 8 generations at least; an odd rest is not spent.

use super::ga::{self, Elitism, Selection, Settings};
use super::gene::{Gene, Scale};
use super::state::{Scored, Search, admissible};
use rand::RngExt;
use std::cell::Cell;

const POPULATION: usize = 64;
const GENERATIONS_A_ROUND: usize = 20;
const ROUNDS: usize = 10;
const SHRINK: f64 = 0.7;
const COORDINATE: Gene = Gene { name: "x", meaning: "", unit: "", min: 0.0, max: 1.0, scale: Scale::Linear };

/// Spends the budget of a search; `starts` are evaluated.
pub fn run(search: &mut Search<'_>, starts: &[Scored]) {
    let population = POPULATION.min(search.left() / 16 * 2).max(2);
    let whole = search.left() / population;
    let rounds = (whole / GENERATIONS_A_ROUND).clamp(1, ROUNDS);
    let mut known = starts.to_vec();
    let mut width = 1.0;
    for round in 0..rounds {
        // The first population of a round is one of its generations.
        let generations = search.left() / population / (rounds - round);
        if generations == 0 {
            return;
        }
        let genes: Vec<Gene> = search.best.at.iter().map(|&x| COORDINATE.around(x, width)).collect();
        let generations = u32::try_from(generations - 1).unwrap_or(u32::MAX);
        breed(search, &genes, population, generations, &known);
        known = vec![Scored { at: search.best.at.clone(), cost: search.best.cost }];
        width *= SHRINK;
    }
}

/// One round. What is known already is not evaluated again.
fn breed(search: &mut Search<'_>, genes: &[Gene], population: usize, generations: u32, known: &[Scored]) {
    let settings = Settings {
        bits: 12,
        population,
        generations,
        patience: 0,
        mutation: 0.02,
        selection: Selection::Tournament,
        elitism: Elitism::Reinsert,
    };
    let seed = search.random.random();
    let seeds: Vec<Vec<f64>> = known.iter().map(|point| point.at.clone()).collect();
    let (ask, asked) = (search.objective().costs, Cell::new(0));
    let cost_known = |values: &Vec<f64>| known.iter().find(|point| point.at == *values).map(|point| point.cost);
    let costs = |points: &[Vec<f64>]| {
        let unknown: Vec<Vec<f64>> = points.iter().filter(|at| cost_known(at).is_none()).map(|at| inside(at)).collect();
        asked.set(asked.get() + unknown.len());
        let mut found = ask(&unknown).into_iter();
        // As many are found as were unknown.
        let cost = |at| cost_known(at).or_else(|| found.next()).map_or(f64::INFINITY, admissible);
        points.iter().map(cost).collect()
    };
    ga::run(genes, &settings, seed, &seeds, costs, |_, best| {
        search.note(asked.take(), &[Scored { at: inside(&best.genes), cost: best.cost }]);
    });
}

/// The end of a shrunk range may round to beyond the cube.
fn inside(values: &[f64]) -> Vec<f64> {
    values.iter().map(|x| x.clamp(0.0, 1.0)).collect()
}
