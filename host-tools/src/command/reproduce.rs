//! `piezo reproduce`: the thesis's validation errors (Tables 4.8, 5.3, 5.4) beside those of the same models, identified
//! the same way on the synthetic rig: five modelling logs, the 10 Hz triangle held out, validation by simulation.

use super::limit;
use super::print::{out, progress};
use crate::calibration::CalibrationOptions;
use crate::identify::{Candidate, Conditions, Problem, SearchOptions, Setting, identify};
use crate::prepare::Recipe;
use crate::rig::{EXCITATIONS, Rig, VALIDATION};
use crate::session::Feedback;
use anyhow::{Context, Result};
use clap::Args;
use estimator_core::{Digest, Model};
use serde::Serialize;

/// Arguments of `piezo reproduce`.
#[derive(Args, Debug)]
pub struct Reproduce {
    /// Print an array of objects, one a model and cost.
    #[arg(long)]
    pub json: bool,
    /// How wide the limits may be within which the estimate is proven to stay, as a multiple of the training stroke.
    #[arg(long, default_value_t = 2.0, value_parser = limit, allow_negative_numbers = true)]
    pub limit: f64,
    /// Seed of the rig's noise.
    #[arg(long, default_value_t = 1)]
    pub rig_seed: u64,
    /// The search.
    #[command(flatten)]
    pub search: SearchOptions,
}

/// One model identified with one cost.
#[derive(Serialize)]
struct Row {
    model: Model,
    cost: Feedback,
    mae_um: f64,
    max_um: f64,
    thesis_mae_um: Option<f64>,
    thesis_max_um: Option<f64>,
}

/// Tables 4.8 (Voigt), 5.3 (OSP) and 5.4 (simulation): MAE and MAX on the validation log, µm; of the models it has.
fn thesis(model: Model, cost: Feedback) -> Option<(f64, f64)> {
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

/// Tick, µs: every fifth of the rig's 10,000 samples a second, as in the thesis.
const TICK_US: u32 = 500;

/// The thesis's models, and the one that goes beyond them, which is fitted to simulation only.
const SIMULATED: [Model; 5] =
    [Model::Voigt, Model::VoltageExtremum, Model::DisplacementExtremum, Model::Enhanced, Model::Champion];

/// Runs the verb.
pub fn run(arguments: &Reproduce) -> Result<bool> {
    let problem = problem(arguments)?;
    let setting = Setting {
        recipe: Recipe::at_tick(TICK_US),
        calibration: CalibrationOptions::default(),
        tabulated: false,
        logs: Digest::default(),
        seed: arguments.search.seed,
    };
    let bar = progress(2 * arguments.search.generations_of(&Model::VOIGT_FAMILY));
    let mut rows = Vec::new();
    for cost in [Feedback::Osp, Feedback::Simulation] {
        let models = if cost == Feedback::Osp { &Model::VOIGT_FAMILY[..] } else { &SIMULATED };
        let fits = identify(&problem, models, cost, &arguments.search, &mut |model, best| {
            bar.set_prefix(model.to_string());
            bar.set_message(format!("{cost:?} {best:.4} µm"));
            bar.inc(1);
        });
        for fit in fits {
            let model = fit.model;
            let candidate = Candidate::new(&problem, fit, &setting)?;
            let figures = candidate.held_out_figures().context("the rig's validation log is missing")?;
            let thesis = thesis(model, cost);
            rows.push(Row {
                model,
                cost,
                mae_um: figures.mae_um,
                max_um: figures.max_um,
                thesis_mae_um: thesis.map(|(mae, _)| mae),
                thesis_max_um: thesis.map(|(_, max)| max),
            });
        }
    }
    bar.finish_and_clear();
    if arguments.json {
        out(&serde_json::to_string_pretty(&rows)?);
    } else {
        print(&rows);
    }
    Ok(true)
}

fn problem(arguments: &Reproduce) -> Result<Problem> {
    let rig = Rig { seed: arguments.rig_seed, ..Rig::default() };
    let (mut training, mut held_out) = (Vec::new(), Vec::new());
    for excitation in EXCITATIONS {
        let session = Recipe::at_tick(TICK_US).session(&rig.log(excitation))?;
        if excitation.name == VALIDATION { held_out.push(session) } else { training.push(session) }
    }
    Ok(Problem::new(training, held_out, Conditions { limit: arguments.limit, ..Conditions::default() }))
}

fn print(rows: &[Row]) {
    out(
        "Validation on the 10 Hz triangle, held out, in simulation. Ours: the synthetic rig. Thesis: its own actuator.",
    );
    out(&format!(
        "{:<28} {:<11} {:>8} {:>8} {:>9} {:>11} {:>11} {:>9}",
        "model", "cost", "MAE µm", "MAX µm", "of Voigt", "thesis MAE", "thesis MAX", "of Voigt"
    ));
    for row in rows {
        let voigt = rows.iter().find(|other| other.model == Model::Voigt && other.cost == row.cost);
        let of_voigt = |value: f64, of: fn(&Row) -> f64| voigt.map_or(1.0, |voigt| value / of(voigt));
        let thesis_of_voigt = row.thesis_mae_um.zip(voigt.and_then(|voigt| voigt.thesis_mae_um)).map(|(a, b)| a / b);
        let shown = |value: Option<f64>, digits| value.map_or("–".to_owned(), |value| format!("{value:.digits$}"));
        out(&format!(
            "{:<28} {:<11} {:>8.4} {:>8.4} {:>9.2} {:>11} {:>11} {:>9}",
            row.model,
            if row.cost == Feedback::Osp { "OSP" } else { "simulation" },
            row.mae_um,
            row.max_um,
            of_voigt(row.mae_um, |row| row.mae_um),
            shown(row.thesis_mae_um, 4),
            shown(row.thesis_max_um, 4),
            shown(thesis_of_voigt, 2)
        ));
    }
}
