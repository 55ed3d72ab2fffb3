//! Convergence of the Voigt model's search: Table 4.7, Figures 4.9 and 4.10. After each generation the best candidate's
//! modelling error (its cost, µm) and validation error (held out, in simulation, µm), and when each was least.

use super::bench::{Bench, cost_name};
use crate::error::ThesisError;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::{Convergence, Progress, SearchOptions};
use report::drawn;
use report::{Picture, Section, shown};
use serde::Serialize;
use serde_json::json;

/// A least error, µm, and the generation in which it was first reached, counted from 1.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Least {
    mae_um: f64,
    generation: usize,
}

/// Table 4.7: least modelling and validation error of each cost, and the figure of its course.
pub const PRINTED: [(Feedback, &str, [Least; 2]); 2] = [
    (
        Feedback::Osp,
        "Figure 4.9",
        [Least { mae_um: 0.3258, generation: 88 }, Least { mae_um: 0.3324, generation: 185 }],
    ),
    (
        Feedback::Simulation,
        "Figure 4.10",
        [Least { mae_um: 0.4993, generation: 356 }, Least { mae_um: 0.3357, generation: 360 }],
    ),
];

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    2 * search.generations_of(&[Model::Voigt])
}

/// Identifies with both costs and compares.
///
/// # Errors
/// The figures cannot be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    let mut grid = bench
        .grid("Table 4.7: least errors of Voigt's search, and when they came.")
        .words("cost", 10)
        .words("error", 10)
        .numbers("least µm", 8)
        .numbers("generation", 10)
        .numbers("thesis µm", 9)
        .numbers("iteration", 9);
    let (mut rows, mut figures, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for (cost, figure, printed) in PRINTED {
        bench.identify(cost, &[Model::Voigt], progress);
        let Some(attempt) = bench.attempt(cost, Model::Voigt) else { continue };
        let course = match &attempt.result {
            Ok(candidate) => &candidate.fit.convergence[..],
            Err(why) => {
                notes.push(format!("{}: {why}", cost_name(cost)));
                &[]
            }
        };
        let ours = [
            least(course.iter().map(|after| Some(after.training))),
            least(course.iter().map(|after| after.validation)),
        ];
        for ((error, ours), thesis) in ["modelling", "validation"].into_iter().zip(ours).zip(printed) {
            grid.row([
                cost_name(cost).to_owned(),
                error.to_owned(),
                shown(ours.map(|least| least.mae_um), 4),
                ours.map_or("–".to_owned(), |least| least.generation.to_string()),
                shown(Some(thesis.mae_um), 4),
                thesis.generation.to_string(),
            ]);
            rows.push(json!({ "cost": cost, "error": error, "ours": ours, "thesis": thesis }));
        }
        if let Some(words) = over_fitting(course) {
            notes.push(format!("{}: {words}", cost_name(cost)));
        }
        figures.extend(picture(cost, figure, course));
    }
    bench.baseline(&mut grid, 2);
    let search = bench.search();
    notes.insert(
        0,
        format!(
            "Generations are counted over {} rounds of {}, with each round's first population. The modelling error is \
             the cost itself, one step ahead in the OSP rows; the validation error is always in simulation, on {}.",
            search.rounds,
            search.generations + 1,
            bench.held_out()
        ),
    );
    Ok(Section {
        title: "Convergence: Table 4.7, Figures 4.9 and 4.10",
        tables: vec![grid],
        notes,
        figures,
        json: bench.json(&rows)?,
    })
}

/// The least of some errors, and the first generation that had it.
fn least(errors: impl Iterator<Item = Option<f64>>) -> Option<Least> {
    let known =
        errors.enumerate().filter_map(|(index, error)| Some((index + 1, error.filter(|error| error.is_finite())?)));
    known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(generation, mae_um)| Least { mae_um, generation })
}

/// Whether a search over-fits by the thesis's criterion (4.1.3): the validation error was least sooner than the
/// modelling error; and what became of the validation error since.
fn over_fitting(course: &[Convergence]) -> Option<String> {
    let modelling = least(course.iter().map(|after| Some(after.training)))?;
    let validation = least(course.iter().map(|after| after.validation))?;
    let last = course.last()?.validation?;
    let generations = format!("{} (modelling: {})", validation.generation, modelling.generation);
    let judged = if validation.generation < modelling.generation {
        format!("the validation error was least already in generation {generations}, so that the search over-fits")
    } else {
        format!(
            "the validation error was least no sooner than in generation {generations}, so that the search does not over-fit"
        )
    };
    Some(format!(
        "{judged} by the thesis's criterion (4.1.3); at the end of {} generations the validation error stands {:.1} % above \
         its least. Training alone decides, so the end counts.",
        course.len(),
        100.0 * (last / validation.mae_um - 1.0)
    ))
}

fn picture(cost: Feedback, figure: &str, course: &[Convergence]) -> Option<Picture> {
    let name = format!("Voigt by {}, as {figure}", cost_name(cost));
    let caption = "Error of the best candidate after each generation: modelling (dashed) and validation.".to_owned();
    let svg = drawn::convergence(course, &format!("{name}. {caption}"))?;
    Some(Picture { svg, name, role: "", caption })
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn least_is_the_first_of_the_smallest() {
        let found = least([Some(3.0), None, Some(1.0), Some(1.0), Some(f64::NAN), Some(2.0)].into_iter());
        assert_eq!(found, Some(Least { mae_um: 1.0, generation: 3 }));
        assert_eq!(least([None, Some(f64::INFINITY)].into_iter()), None);
    }

    #[test]
    fn over_fitting_is_a_validation_error_that_is_least_sooner_than_the_modelling_error() {
        let course = |errors: [(f64, f64); 3]| {
            errors.map(|(training, validation)| Convergence { training, validation: Some(validation) })
        };
        let over_fitted = over_fitting(&course([(3.0, 2.0), (2.0, 1.0), (1.0, 1.5)])).unwrap();
        assert!(over_fitted.contains("already in generation 2 (modelling: 3)"), "{over_fitted}");
        assert!(over_fitted.contains("search over-fits by") && over_fitted.contains("50.0 % above"), "{over_fitted}");
        for sound in [[(3.0, 2.0), (2.0, 1.5), (1.0, 1.0)], [(3.0, 2.0), (1.0, 1.5), (1.0, 1.0)]] {
            let words = over_fitting(&course(sound)).unwrap();
            assert!(words.contains("does not over-fit") && words.contains("0.0 % above"), "{words}");
        }
        assert_eq!(over_fitting(&[Convergence { training: 1.0, validation: None }]), None);
    }

    #[test]
    fn four_least_errors_and_two_figures() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        assert_eq!(rows.len(), 4);
        for row in rows {
            let generation = row["ours"]["generation"].as_u64().unwrap();
            assert!((1..=21).contains(&generation), "three rounds of seven: {row}");
        }
        assert_eq!(rows[2]["thesis"], json!({ "mae_um": 0.4993, "generation": 356 }));
        assert_eq!(section.figures.len(), 2);
        let line = section.tables[0].named().last().unwrap();
        let mae = rows[0]["straight_line_mae_um"].as_f64().unwrap();
        assert_eq!((line.0.as_str(), line.1[1].as_str()), ("straight line (2.1)", &*format!("{mae:.4}")));
    }
}
