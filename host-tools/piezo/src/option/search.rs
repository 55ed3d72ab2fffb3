//! How a search runs.

use super::choice::{Choice, choice};
use super::number::{even, fraction};
use clap::Args;
use identification::search::Optimiser;
use identification::search::ga::{Elitism, Selection};
use identification::search::space::Ranges;
use identification::{SearchOptions, Start};

const DEFAULT: SearchOptions = SearchOptions::DEFAULT;
const OTHERS: &str = "Search of the other models";

/// How the search runs. The thesis's own setting is `--ranges table-4.5 --mutation 0.15 --elitism aside --generations
/// 400 --rounds 1 --start random`.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Genetic algorithm, which searches the Voigt family")]
pub struct SearchArgs {
    /// What is searched, and where.
    #[arg(long, hide_short_help = true, value_parser = choice(RANGES), default_value = "data")]
    pub ranges: Ranges,
    /// Bits a gene.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.bits, value_parser = clap::value_parser!(u32).range(2..=30), allow_negative_numbers = true)]
    pub bits: u32,
    /// Chromosomes of a generation, an even number.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.population, value_parser = even, allow_negative_numbers = true)]
    pub population: usize,
    /// Generations a round.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.generations, value_parser = clap::value_parser!(u32).range(0..=1_000_000), allow_negative_numbers = true)]
    pub generations: u32,
    /// Rounds of shrinking ranges.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.rounds, value_parser = clap::value_parser!(u32).range(1..=50), allow_negative_numbers = true)]
    pub rounds: u32,
    /// Width of a round's ranges as a fraction of the round's before, around the best so far.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.shrink, value_parser = fraction, allow_negative_numbers = true)]
    pub shrink: f64,
    /// Stop a round after so many generations without improvement; 0: never.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.patience, allow_negative_numbers = true)]
    pub patience: u32,
    /// Bits flipped in a generation, as a fraction of all.
    #[arg(long, hide_short_help = true, default_value_t = DEFAULT.mutation, value_parser = fraction, allow_negative_numbers = true)]
    pub mutation: f64,
    /// Choice of parents.
    #[arg(long, hide_short_help = true, value_parser = choice(SELECTIONS), default_value = "tournament")]
    pub selection: Selection,
    /// What becomes of the best chromosome.
    #[arg(long, hide_short_help = true, value_parser = choice(ELITISMS), default_value = "reinsert")]
    pub elitism: Elitism,
    /// What the first population is drawn from.
    #[arg(long, hide_short_help = true, value_parser = choice(STARTS), default_value = "family")]
    pub start: Start,
    /// Method for the models beyond the Voigt family, of which only a few numbers are searched.
    #[arg(long, hide_short_help = true, help_heading = OTHERS, value_parser = choice(OPTIMISERS), default_value = "local")]
    pub optimiser: Optimiser,
    /// Candidates that the method may try for each number that is searched.
    #[arg(
        long,
        hide_short_help = true,
        help_heading = OTHERS,
        default_value_t = DEFAULT.evaluations,
        value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true
    )]
    pub evaluations: u32,
    /// Seed; the same seed gives the same table on any number of threads.
    #[arg(long, hide_short_help = true, help_heading = "Any search", default_value_t = DEFAULT.seed, allow_negative_numbers = true)]
    pub seed: u32,
}

const RANGES: [Choice<Ranges>; 2] = [
    (Ranges::Data, "data", "Coordinates and ranges from the training logs' own scale"),
    (
        Ranges::Table45,
        "table-4.5",
        "The published parameters within Table 4.5; g, h, e and f within the magnitudes of Table 5.2, of either sign",
    ),
];

const SELECTIONS: [Choice<Selection>; 2] = [
    (Selection::Tournament, "tournament", "The better of two drawn at random (Appendix D)"),
    (Selection::Roulette, "roulette", "With a probability inversely proportional to the cost (Appendix C)"),
];

const ELITISMS: [Choice<Elitism>; 2] = [
    (Elitism::Aside, "aside", "It is remembered and does not breed on (Appendix D)"),
    (Elitism::Reinsert, "reinsert", "It replaces the worst of each generation"),
];

/// Where the first population of a model comes from.
pub const STARTS: [Choice<Start>; 2] = [
    (
        Start::Family,
        "family",
        "Random; and once more with the solutions of the simpler models among it. The better result counts",
    ),
    (Start::Random, "random", "Random only, as the thesis"),
];

/// Every method of a search, as it is typed.
pub const OPTIMISERS: [Choice<Optimiser>; 5] = [
    (Optimiser::Genetic, "genetic", "The thesis's binary genetic algorithm in rounds of shrinking ranges"),
    (Optimiser::DifferentialEvolution, "differential-evolution", "Differential evolution"),
    (Optimiser::ParticleSwarm, "particle-swarm", "Particle swarm"),
    (Optimiser::CmaEs, "cma-es", "Covariance matrix adaptation"),
    (
        Optimiser::Local,
        "local",
        "Downhill, by Gauss–Newton or Nelder–Mead, with restarts until they find nothing better",
    ),
];

options!(SearchArgs => SearchOptions {
    ranges, bits, population, generations, rounds, shrink, patience, mutation, selection, elitism, start, optimiser,
    evaluations, seed,
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_has_one_name() {
        assert_eq!(OPTIMISERS.map(|(method, ..)| method), Optimiser::ALL);
        assert_eq!(OPTIMISERS.map(|(_, name, _)| name.to_owned()), Optimiser::ALL.map(|method| method.to_string()));
    }
}
