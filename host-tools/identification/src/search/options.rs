//! How a search runs, as `table.toml` records it.

use super::Optimiser;
use super::space::Ranges;
use estimator_core::Model;
use minimisation::ga::{Elitism, Selection, Settings};
use serde::{Deserialize, Serialize};

/// Where the first population of a model comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Random; and once more with the solutions of the simpler models among it. The better result counts.
    Family,
    /// Random only, as the thesis.
    Random,
}

/// How the search runs. The thesis's own setting is the ranges of Table 4.5, mutation 0.15, the best kept aside, one
/// round of 400 generations, and random starts.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchOptions {
    /// What is searched, and where.
    pub ranges: Ranges,
    /// Bits a gene.
    pub bits: u32,
    /// Chromosomes of a generation, an even number.
    pub population: usize,
    /// Generations a round.
    pub generations: u32,
    /// Rounds of shrinking ranges.
    pub rounds: u32,
    /// Width of a round's ranges as a fraction of the round's before, around the best so far.
    pub shrink: f64,
    /// Stop a round after so many generations without improvement; 0: never.
    pub patience: u32,
    /// Bits flipped in a generation, as a fraction of all.
    pub mutation: f64,
    /// Choice of parents.
    pub selection: Selection,
    /// What becomes of the best chromosome.
    pub elitism: Elitism,
    /// What the first population is drawn from.
    pub start: Start,
    /// Method for the models beyond the Voigt family, of which only a few numbers are searched.
    pub optimiser: Optimiser,
    /// Candidates that the method may try for each number that is searched.
    pub evaluations: u32,
    /// Seed; the same seed gives the same table on any number of threads.
    pub seed: u32,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl SearchOptions {
    /// What is searched for where nothing else is said: coordinates on the logs' own scale, 64 chromosomes of 10 bits a
    /// gene in 10 rounds of 60 generations; 250 candidates a number at most by `local` for the other models.
    pub const DEFAULT: Self = Self {
        ranges: Ranges::Data,
        bits: 10,
        population: 64,
        generations: 60,
        rounds: 10,
        shrink: 0.7,
        patience: 0,
        mutation: 0.02,
        selection: Selection::Tournament,
        elitism: Elitism::Reinsert,
        start: Start::Family,
        optimiser: Optimiser::Local,
        evaluations: 250,
        seed: 1,
    };

    /// Of one round of the genetic algorithm.
    pub(crate) fn settings(&self) -> Settings {
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
    pub(crate) fn starts(&self, earlier: usize) -> usize {
        if self.start == Start::Family && earlier > 0 { 2 } else { 1 }
    }
}
