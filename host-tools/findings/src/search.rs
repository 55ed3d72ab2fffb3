//! How a model was searched, in words.

use estimator_core::Model;
use identification::SearchOptions;

/// How a model was searched: the Voigt family by the genetic algorithm, every other by the method that was chosen.
pub fn search(model: Model, of: &SearchOptions) -> String {
    if model.is_voigt() {
        format!(
            "genetic algorithm, seed {}, {} rounds of {} generations, {} chromosomes of {} bits a gene, mutation {}",
            of.seed, of.rounds, of.generations, of.population, of.bits, of.mutation
        )
    } else {
        format!(
            "{}, seed {}, at most {} candidates for each number that is searched",
            of.optimiser, of.seed, of.evaluations
        )
    }
}

/// How models of either kind are searched.
pub fn searches(of: &SearchOptions) -> String {
    format!(
        "seed {}; Voigt family {} rounds of {} generations of {} chromosomes of {} bits a gene, the others {} \
         candidates a searched number by {}",
        of.seed, of.rounds, of.generations, of.population, of.bits, of.evaluations, of.optimiser
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generations_are_those_of_the_voigt_family_alone() {
        let of = |model| search(model, &SearchOptions::DEFAULT);
        assert!(of(Model::Enhanced).contains("10 rounds of 60 generations, 64 chromosomes"), "{}", of(Model::Enhanced));
        let local = of(Model::GeneralisedPrandtlIshlinskii);
        assert_eq!(local, "local, seed 1, at most 250 candidates for each number that is searched");
    }
}
