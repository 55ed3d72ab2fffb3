//! The thesis's extremum terms tried on every model, as its Section 6.2 asks: the voltage V_ext and the displacement
//! y_ext at the last reversal. Errors are mean absolute errors in simulation, µm.
//!
//! ```text
//! y(n) = y_model(n) + Σ w·(x(n − 1) − mean of x over the modelling logs)     x: V_ext, y_ext or both, each behind a lag
//! ```
//!
//! The weights follow by least squares from what the identified model leaves of the modelling logs, each weighing the
//! same, and the lag, from none to 0.1 s, is the one that leaves least of them; the exponents are 1. y_ext is of the
//! model's own displacement, as in the recursion. That is less than identifying anew with the term: where the catalogue
//! has a model with it as a structure, that one stands beside it, refitted.

use super::added_term::{LAGS, Observed, Term, mean_error};
use super::bench::{Attempt, Bench};
use crate::error::ThesisError;
use estimator_core::{Admitted, Model, Parameters};
use identification::cost::{Cost, Feedback};
use identification::family;
use identification::{Character, Problem, Progress, SearchOptions, StructureSearch};
use recordings::session::Session;
use report::{Section, shown};
use serde::Serialize;

/// A term gains where it leaves less than this of the error: what a richer structure must in an identification.
const GAINS: f64 = 0.97;

/// Where the terms are tried: V_ext, y_ext.
const TERMS: [&[usize]; 3] = [&[0], &[1], &[0, 1]];

/// Errors without a term, with V_ext, with y_ext, with both, µm; `None` where there is no such model.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize)]
struct Errors {
    without_um: Option<f64>,
    voltage_extremum_um: Option<f64>,
    displacement_extremum_um: Option<f64>,
    both_um: Option<f64>,
}

/// How a term comes to a model.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
enum How {
    /// Added to the identified model.
    Added,
    /// Identified together with it.
    Refitted,
}

#[derive(Serialize)]
struct Row {
    model: Model,
    how: How,
    modelled: Errors,
    held_out: Errors,
    /// Lags of the added terms, s: V_ext alone, y_ext alone, both.
    lags_s: Option<[f64; 3]>,
}

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    search.generations_of(&Model::VOIGT_FAMILY) + 550
}

/// Identifies every model and tries the terms.
///
/// # Errors
/// The figures cannot be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    bench.identify(Feedback::Simulation, &Model::ALL, progress);
    let (mut rows, mut failed) = (Vec::new(), Vec::new());
    for model in Model::ALL {
        let Some(attempt) = bench.attempt(Feedback::Simulation, model) else { continue };
        match &attempt.result {
            Ok(candidate) => rows.extend(added(bench.problem(), &candidate.table)),
            Err(why) => failed.push(format!("{model}: {}", (bench.say)(why))),
        }
        match model {
            Model::Voigt => rows.push(voigt(bench)),
            Model::VoigtChain => rows.push(chain(bench, progress)),
            _ => (),
        }
    }
    let caption = format!("Extremum terms on every model: MAE on {}, held out.", bench.held_out());
    let mut grid = bench
        .grid(&caption)
        .words("model", 28)
        .words("terms", 8)
        .numbers("without µm", 8)
        .numbers("V_ext", 8)
        .numbers("y_ext", 8)
        .numbers("both", 8)
        .numbers("best of without", 8);
    for row in &rows {
        let Errors { without_um, voltage_extremum_um, displacement_extremum_um, both_um } = row.held_out;
        let words = if row.how == How::Added { "added" } else { "refitted" };
        let errors = [without_um, voltage_extremum_um, displacement_extremum_um, both_um];
        let cells = [row.model.to_string(), words.to_owned()].into_iter();
        let best = row.held_out.best().map(|(_, of_without)| of_without);
        grid.row(cells.chain(errors.map(|um| shown(um, 4))).chain([shown(best, 3)]));
    }
    bench.baseline(&mut grid, 2);
    let mut notes = vec![
        "Added: to the identified model, by least squares on what it leaves of the modelling logs, behind the lag that leaves \
         least. Refitted: identified together with the term, which Voigt's extremum models (5.4), (5.5), (5.3) and the chain's \
         second structure are; what Table 5.1's black box gains is the item black-box."
            .to_owned(),
    ];
    notes.extend(conclusion(&rows));
    if Character::of(bench.problem().training(), bench.problem().deadband).single_amplitude() {
        notes.push(
            "The modelling logs have a single amplitude: V_ext takes two values there and y_ext is nearly proportional to \
             it, so that what both together gain, and what any term does at another amplitude, was taught by little."
                .to_owned(),
        );
    }
    notes.extend(failed);
    Ok(Section {
        title: "Extremum terms on every model: Section 6.2",
        tables: vec![grid],
        notes,
        figures: Vec::new(),
        json: bench.json(&rows)?,
    })
}

impl Errors {
    /// The best of the terms, and its error as a fraction of that without.
    fn best(&self) -> Option<(&'static str, f64)> {
        let without = self.without_um?;
        let with =
            [("V_ext", self.voltage_extremum_um), ("y_ext", self.displacement_extremum_um), ("both", self.both_um)];
        let known = with.into_iter().filter_map(|(name, um)| Some((name, um? / without)));
        known.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Which models gain by a term, added and refitted, on what decided nothing.
fn conclusion(rows: &[Row]) -> [String; 2] {
    [(How::Added, "added"), (How::Refitted, "refitted")].map(|(how, words)| {
        let of_how = || rows.iter().filter(|row| row.how == how);
        let gains: Vec<String> = of_how()
            .filter_map(|row| {
                let (name, of_without) = row.held_out.best().filter(|(_, of_without)| *of_without < GAINS)?;
                Some(format!("{} ({name}, {:.1} %)", row.model, 100.0 * (1.0 - of_without)))
            })
            .collect();
        let least = 100.0 * (1.0 - GAINS);
        if gains.is_empty() {
            format!("With a term {words} none of {} gains more than {least:.0} % held out.", of_how().count())
        } else {
            format!(
                "With a term {words} {} of {} gain more than {least:.0} % held out, each by its best: {}.",
                gains.len(),
                of_how().count(),
                gains.join(", ")
            )
        }
    })
}

/// The terms added to an identified model.
fn added(problem: &Problem, table: &Admitted) -> Option<Row> {
    let observed = |session: &Session| Observed::new(table, session);
    let training: Vec<Observed> = problem.training().map(observed).collect();
    let held_out: Vec<Observed> = problem.validation().map(observed).collect();
    let fits: Vec<Term<'_>> = TERMS.iter().map(|which| Term::fit(which, &training)).collect::<Option<_>>()?;
    let [voltage, displacement, both] = &fits[..] else { return None };
    let errors = |sessions: &[Observed]| Errors {
        without_um: Some(mean_error(sessions, |_, _| 0.0)),
        voltage_extremum_um: Some(voltage.error(sessions)),
        displacement_extremum_um: Some(displacement.error(sessions)),
        both_um: Some(both.error(sessions)),
    };
    Some(Row {
        model: table.model(),
        how: How::Added,
        modelled: errors(&training),
        held_out: errors(&held_out),
        lags_s: Some([voltage, displacement, both].map(|term| LAGS[term.lag])),
    })
}

/// Voigt's model identified with its terms: the extremum models of the catalogue.
fn voigt(bench: &Bench) -> Row {
    let errors = |held_out: bool| {
        let of = |model| {
            let candidate = bench.attempt(Feedback::Simulation, model).and_then(Attempt::candidate)?;
            let figures = if held_out { candidate.held_out_figures() } else { candidate.training_figures() };
            figures.map(|figures| figures.mae_um)
        };
        Errors {
            without_um: of(Model::Voigt),
            voltage_extremum_um: of(Model::VoltageExtremum),
            displacement_extremum_um: of(Model::DisplacementExtremum),
            both_um: of(Model::Enhanced),
        }
    };
    Row { model: Model::Voigt, how: How::Refitted, modelled: errors(false), held_out: errors(true), lags_s: None }
}

/// The chain identified without and with its voltage term.
fn chain(bench: &Bench, progress: Progress<'_>) -> Row {
    let (problem, search) = (bench.problem(), bench.search());
    let cost = Cost::from(Feedback::Simulation);
    let structures = family::of(Model::VoigtChain, problem);
    let (mut modelled, mut held_out) = (Errors::default(), Errors::default());
    let mut known = Vec::new();
    for family in &structures {
        let searched = StructureSearch {
            problem,
            cost,
            method: search.optimiser,
            evaluations: search.evaluations as usize * family.genes().len(),
            seed: search.seed,
        };
        let mut progress = |_, least| progress(Model::VoigtChain, least);
        let found = searched.run(family.as_ref(), &known, Some(&mut progress));
        let Some(parameters) = found.parameters else { continue };
        let with = matches!(parameters, Parameters::VoigtChain(of) if of.voltage_extremum_um_per_v != 0.0);
        for (errors, um) in [(&mut modelled, Some(found.cost)), (&mut held_out, problem.held_out(&parameters, cost))] {
            *(if with { &mut errors.voltage_extremum_um } else { &mut errors.without_um }) = um;
        }
        known = found.genes;
    }
    Row { model: Model::VoigtChain, how: How::Refitted, modelled, held_out, lags_s: None }
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn without_a_term_each_model_has_the_error_that_its_table_has() {
        let mut bench = small();
        let section = section(&mut bench, &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        assert_eq!(rows.len(), Model::ALL.len() + 2);
        for row in rows {
            let model = Model::ALL.into_iter().find(|model| row["model"] == model.name()).unwrap();
            let figures = bench.candidate(Feedback::Simulation, model).unwrap().held_out_figures().unwrap();
            let without = row["held_out"]["without_um"].as_f64().unwrap();
            // The chain's own is with its term where that was worth it.
            if row["how"] == "added" || model == Model::Voigt {
                assert!((without / figures.mae_um - 1.0).abs() < 1e-9, "{row} {}", figures.mae_um);
            }
        }
        let chain = rows.iter().find(|row| row["how"] == "refitted" && row["model"] == "voigt-chain").unwrap();
        assert!(
            chain["held_out"]["voltage_extremum_um"].as_f64() > Some(0.0) && chain["held_out"]["both_um"].is_null()
        );
        let single = section.notes.iter().filter(|note| note.contains("single amplitude")).count();
        assert_eq!((section.notes.len(), single), (4, 1), "the rig has one amplitude: {:?}", section.notes);
    }

    #[test]
    fn the_conclusion_names_who_gains_by_more_than_three_percent() {
        let row = |model, with: f64| Row {
            model,
            how: How::Added,
            modelled: Errors::default(),
            held_out: Errors {
                without_um: Some(1.0),
                voltage_extremum_um: Some(with),
                both_um: Some(1.2),
                ..Errors::default()
            },
            lags_s: None,
        };
        let [added, refitted] = conclusion(&[row(Model::Duhem, 0.5), row(Model::BoucWen, 0.98)]);
        assert!(added.contains("1 of 2") && added.contains("Duhem (3.11) (V_ext, 50.0 %)"), "{added}");
        assert!(!added.contains("Bouc") && refitted.contains("none of 0"), "{added} {refitted}");
    }
}
