//! Validation errors of the Voigt family and of the generalised Prandtl–Ishlinskii model: Tables 4.8, 5.3, 5.4 and 5.5,
//! Figures 4.11 and 5.1 to 5.6. Five modelling logs, one held out, validation by simulation; µm.

use super::bench::{Attempt, Bench, cost_name};
use crate::error::ThesisError;
use comparison::Say;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::{Progress, SearchOptions, StraightLine};
use report::drawn;
use report::{Picture, Section, shown};
use serde::Serialize;

/// Tables 4.8 and 5.5 (Voigt), 5.3 (OSP) and 5.4 (simulation): MAE and MAX on the validation log, µm; of the models
/// they have.
pub fn printed(model: Model, cost: Feedback) -> Option<(f64, f64)> {
    match (cost, model) {
        (Feedback::Osp, Model::Voigt) => Some((0.3324, 0.9937)),
        (Feedback::Osp, Model::VoltageExtremum) => Some((0.299, 1.02)),
        (Feedback::Osp, Model::DisplacementExtremum) => Some((0.381, 0.778)),
        (Feedback::Osp, Model::Enhanced) => Some((0.163, 0.586)),
        (Feedback::Simulation, Model::Voigt) => Some((0.3357, 0.9313)),
        (Feedback::Simulation, Model::VoltageExtremum) => Some((0.294, 0.973)),
        (Feedback::Simulation, Model::DisplacementExtremum) => Some((0.365, 1.041)),
        (Feedback::Simulation, Model::Enhanced) => Some((0.252, 0.804)),
        _ => None,
    }
}

/// The figure of the thesis that shows a model's estimate beside the sensor.
fn figure(model: Model, cost: Feedback) -> Option<&'static str> {
    let (osp, simulation) = match model {
        Model::Voigt => ("Figure 4.11 (a)", "Figure 4.11 (b)"),
        Model::VoltageExtremum => ("Figure 5.1", "Figure 5.4"),
        Model::DisplacementExtremum => ("Figure 5.2", "Figure 5.5"),
        Model::Enhanced => ("Figure 5.3", "Figure 5.6"),
        _ => return None,
    };
    Some(if cost == Feedback::Osp { osp } else { simulation })
}

/// One model identified with one cost.
#[derive(Serialize)]
struct Row {
    model: Model,
    cost: Feedback,
    mae_um: Option<f64>,
    max_um: Option<f64>,
    thesis_mae_um: Option<f64>,
    thesis_max_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<String>,
}

/// The thesis's models, and the one that goes beyond them, which is fitted to simulation only.
const SIMULATED: [Model; 5] = [
    Model::Voigt,
    Model::VoltageExtremum,
    Model::DisplacementExtremum,
    Model::Enhanced,
    Model::GeneralisedPrandtlIshlinskii,
];

/// What is identified with each cost.
const ASKED: [(Feedback, &[Model]); 2] = [(Feedback::Osp, &Model::VOIGT_FAMILY), (Feedback::Simulation, &SIMULATED)];

/// How the baseline's row is to be read.
const STRAIGHT_LINE: &str = "Straight line: the displacement proportional to the voltage and an offset, Eq. (2.1), by least \
                             squares through the modelling logs, each weighing the same.";

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    2 * search.generations_of(&Model::VOIGT_FAMILY)
}

/// Identifies the models and compares.
///
/// # Errors
/// No model has an admissible candidate.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    for (cost, models) in ASKED {
        bench.identify(cost, models, progress);
    }
    let attempts = || ASKED.into_iter().flat_map(|(cost, models)| models.iter().map(move |model| (cost, *model)));
    let attempts: Vec<&Attempt> = attempts().filter_map(|(cost, model)| bench.attempt(cost, model)).collect();
    let line = bench.straight_line();
    let rows: Vec<Row> = attempts.iter().map(|attempt| row(attempt, bench.say)).collect();
    let none = rows.iter().all(|row| row.mae_um.is_none());
    if let Some(failed) = attempts.first().and_then(|attempt| attempt.failed()).filter(|_| none) {
        return Err(failed.clone().into());
    }
    let caption = format!("Validation on {}, held out, in simulation.", bench.held_out());
    let mut grid = bench
        .grid(&caption)
        .words("model", 28)
        .words("cost", 11)
        .numbers("MAE µm", 8)
        .numbers("MAX µm", 8)
        .numbers("of Voigt", 9)
        .numbers("thesis MAE", 11)
        .numbers("thesis MAX", 11)
        .numbers("of Voigt", 9);
    for row in &rows {
        let voigt = rows.iter().find(|other| other.model == Model::Voigt && other.cost == row.cost);
        let of_voigt = |of: fn(&Row) -> Option<f64>| of(row).zip(voigt.and_then(of)).map(|(a, b)| a / b);
        grid.row([
            row.model.to_string(),
            cost_name(row.cost).to_owned(),
            shown(row.mae_um, 4),
            shown(row.max_um, 4),
            shown(of_voigt(|row| row.mae_um), 2),
            shown(row.thesis_mae_um, 4),
            shown(row.thesis_max_um, 4),
            shown(of_voigt(|row| row.thesis_mae_um), 2),
        ]);
    }
    if let Some(figures) = line {
        let [mae, max] = [figures.mae_um, figures.max_um].map(|um| shown(Some(um), 4));
        grid.sparse_row(StraightLine::NAME, [(2, mae), (3, max)]);
    }
    let failed = rows
        .iter()
        .filter_map(|row| Some(format!("{} by {}: {}", row.model, cost_name(row.cost), row.failed.as_ref()?)));
    Ok(Section {
        title: "Validation errors: Tables 4.8, 5.3, 5.4 and 5.5",
        notes: line.map(|_| STRAIGHT_LINE.to_owned()).into_iter().chain(failed).collect(),
        figures: attempts.iter().flat_map(|attempt| pictures(attempt)).collect(),
        json: bench.json(&rows)?,
        tables: vec![grid],
    })
}

fn row(attempt: &Attempt, say: Say) -> Row {
    let figures = attempt.candidate().and_then(|candidate| candidate.held_out_figures());
    let printed = printed(attempt.model, attempt.cost);
    Row {
        model: attempt.model,
        cost: attempt.cost,
        mae_um: figures.map(|figures| figures.mae_um),
        max_um: figures.map(|figures| figures.max_um),
        thesis_mae_um: printed.map(|(mae, _)| mae),
        thesis_max_um: printed.map(|(_, max)| max),
        failed: attempt.failed().map(|error| say(error)),
    }
}

/// Sensor, estimate and error on the first held-out log.
fn pictures(attempt: &Attempt) -> Option<Picture> {
    let log = attempt.candidate()?.held_out.first()?;
    let (model, cost) = (attempt.model, cost_name(attempt.cost));
    let of_the_thesis = figure(model, attempt.cost).map_or(String::new(), |figure| format!(", as {figure}"));
    let name = format!("{model}, {cost}{of_the_thesis}");
    let (svg, caption) = drawn::over_time(log, &name)?;
    Some(Picture { svg, name, role: "held out", caption })
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn each_model_stands_beside_what_the_thesis_prints_of_it() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        assert_eq!(rows.len(), 9);
        for row in rows {
            let (ours, thesis) = (row["mae_um"].as_f64(), row["thesis_mae_um"].as_f64());
            assert!(ours.is_some_and(|mae| mae > 0.0), "{row}");
            assert_eq!(thesis.is_none(), row["model"] == "generalised-prandtl-ishlinskii", "{row}");
            assert!(row["straight_line_mae_um"].as_f64() > ours, "{row}");
        }
        assert_eq!(rows[3]["thesis_mae_um"], 0.163);
        let text = section.text();
        let line = text.lines().find(|line| line.starts_with("straight line (2.1)")).expect("the baseline has a row");
        let mae = format!("{:.4}", rows[0]["straight_line_mae_um"].as_f64().unwrap());
        assert!(line.contains(&mae), "{line} {mae}");
        assert_eq!(section.figures.len(), 9);
        assert!(section.figures[3].name.contains("Figure 5.3"), "{}", section.figures[3].name);
        assert!(
            section
                .text()
                .starts_with("Validation on the 10 Hz triangle, held out, in simulation. Ours: the synthetic")
        );
    }
}
