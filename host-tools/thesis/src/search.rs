//! Population and bits of the genetic algorithm: Tables C.1 and C.2. The Voigt model (4.8) identified in simulation
//! with 32 × 6, 64 × 6 and 64 × 10 chromosomes × bits, once in a single round within fixed ranges, as the thesis's
//! search is, once with the ranges of each round shrunk around the best.

use super::bench::Bench;
use super::parameters::short;
use crate::error::ThesisError;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::{Candidate, Progress, SearchOptions, identify};
use report::{Section, shown};
use serde_json::{Value, json};

/// Table C.1, chromosomes and bits a gene, with Table C.2: α µm, β V, λ 1/V, b Ω, P, MAE µm.
const TABLES_C_1_2: [(usize, u32, [f64; 6]); 3] = [
    (32, 6, [1969.8, 547.619, 0.00586, 8761.90, 1.095, 0.4008]),
    (64, 6, [308.0, 553.275, 0.00606, 13_571.8, 0.799, 0.4004]),
    (64, 10, [1392.7, 753.666, 0.00584, 11_648.1, 0.865, 0.3561]),
];

/// What a search came to: α, β, λ, b, P; modelling and held-out MAE, µm.
type Found = ([f64; 5], f64, f64);

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    (2 * TABLES_C_1_2.len()) as u64 * search.generations_of(&[Model::Voigt])
}

/// Identifies with each arrangement and compares.
///
/// # Errors
/// The figures cannot be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    let caption =
        format!("Voigt (4.8) by simulation: parameters, MAE of the modelling logs and on {}.", bench.held_out());
    let mut grid = bench.grid(&caption).words("population × bits", 10).words("search", 10);
    for heading in ["α µm", "β V", "λ 1/V", "b Ω", "P", "modelling µm", "held out µm"] {
        grid = grid.numbers(heading, 8);
    }
    let (mut rows, mut notes) = (Vec::new(), Vec::new());
    for (population, bits, printed) in TABLES_C_1_2 {
        let name = format!("{population} × {bits}");
        let options = bench.search();
        let rounds = SearchOptions { population, bits, ..options.clone() };
        // As many generations as the rounds have together.
        let one = SearchOptions { generations: options.generations * options.rounds, rounds: 1, ..rounds.clone() };
        let mut searched: Vec<Value> = Vec::new();
        for (words, options) in [("one round".to_owned(), one), (format!("{} rounds", rounds.rounds), rounds.clone())] {
            let found = found(bench, &options, progress);
            let (values, modelling, held_out) = match &found {
                Ok((values, modelling, held_out)) => (Some(values), Some(*modelling), Some(*held_out)),
                Err(error) => {
                    notes.push(format!("{name}, {words}: {error:#}"));
                    (None, None, None)
                }
            };
            let value =
                |index: usize| values.and_then(|values| values.get(index)).map_or("–".to_owned(), |x| short(*x));
            let cells = [name.clone(), words].into_iter().chain((0..5).map(value));
            grid.row(cells.chain([shown(modelling, 4), shown(held_out, 4)]));
            searched.push(json!({
                "rounds": options.rounds, "parameters": values,
                "modelling_mae_um": modelling, "held_out_mae_um": held_out,
            }));
        }
        let [alpha, beta, lambda, b, p, mae] = printed;
        let cells = [name, "thesis".to_owned()].into_iter().chain([alpha, beta, lambda, b, p].map(short));
        grid.row(cells.chain(["–".to_owned(), shown(Some(mae), 4)]));
        rows.push(json!({
            "population": population, "bits": bits, "ours": searched,
            "thesis": { "parameters": [alpha, beta, lambda, b, p], "mae_um": mae },
        }));
    }
    notes.insert(
        0,
        "With one round six bits are 64 values a parameter; with ranges that shrink around the best the last round's \
         steps are far finer. The thesis does not say on which logs its MAE is; it stands in the last column."
            .to_owned(),
    );
    Ok(Section {
        title: "Population and bits: Tables C.1 and C.2",
        tables: vec![grid],
        notes,
        figures: Vec::new(),
        json: serde_json::to_string_pretty(&rows)?,
    })
}

fn found(bench: &Bench, options: &SearchOptions, progress: Progress<'_>) -> Result<Found, ThesisError> {
    let problem = bench.problem();
    let fits = identify(problem, &[Model::Voigt], Feedback::Simulation, options, progress);
    let fit = fits.into_iter().next().ok_or(ThesisError::NotSearched(Model::Voigt))?;
    let candidate = Candidate::new(problem, fit, &bench.prepared.context)?;
    let of = candidate.table.parameters.voigt().ok_or(ThesisError::NotVoigt)?;
    let of = of.map(f64::from);
    let values = [of.alpha_um, of.beta_v, of.lambda_per_v, of.b_ohm, of.p];
    let modelling = candidate.training_figures().ok_or(ThesisError::NoFigures("modelled"))?.mae_um;
    let held_out = candidate.held_out_figures().ok_or(ThesisError::NoFigures("held out"))?.mae_um;
    Ok((values, modelling, held_out))
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn three_arrangements_each_searched_twice_beside_the_printed_one() {
        let mut calls = 0;
        let mut bench = small();
        let section = section(&mut bench, &mut |_, _| calls += 1).unwrap();
        // One round of 18 generations and three of 6, each with its first population.
        assert_eq!(calls, 3 * (19 + 21));
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        let arrangement: Vec<(u64, u64)> =
            rows.iter().map(|row| (row["population"].as_u64().unwrap(), row["bits"].as_u64().unwrap())).collect();
        assert_eq!(arrangement, [(32, 6), (64, 6), (64, 10)]);
        assert_eq!(rows[2]["thesis"]["mae_um"], 0.3561);
        assert!(
            rows.iter().all(|row| row["ours"][1]["held_out_mae_um"].as_f64().is_some_and(|mae| mae < 3.0)),
            "{rows:?}"
        );
    }
}
