//! How a search runs, as the command line and `table.toml` have it.

use super::Optimiser;
use super::ga::{Elitism, Selection, Settings};
use super::space::Ranges;
use clap::{Args, Command, FromArgMatches};
use estimator_core::Model;
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

/// What the command line has where nothing is said.
impl Default for SearchOptions {
    fn default() -> Self {
        let matches = Self::augment_args(Command::new("search")).get_matches_from(["search"]);
        Self::from_arg_matches(&matches).expect("every option has a default")
    }
}

impl SearchOptions {
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
