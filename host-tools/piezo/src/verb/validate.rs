//! `piezo validate`: a table against logs, the f64 reference and the f32 core side by side; which part is scored, what
//! the estimator is told, and the estimates as a file.

use super::device::look_at;
use super::print::out;
use crate::option::{LogOptions, Overwrite, PrepareAgain, ScopeArgs, TOLD, choice, delay, factor, not_negative};
use crate::output;
use anyhow::{Context, Result};
use clap::Args;
use findings::figures::heading;
use findings::validated_log::{Repair, log_json, of_log, rows, suspected, trained_on};
use identification::validate::{Estimates, Figures, Scope, Suspicion, Told, ToldFigures, compare_within, estimates};
use log_survey::{flaws, measured};
use recordings::prepare::Recipe;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `piezo validate`.
#[derive(Args, Debug)]
pub struct Validate {
    /// The table to be judged.
    pub table: PathBuf,
    /// Logs, best such as it has not seen.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// What the estimator is told, where a threshold judges and in what --out writes; before a --zero-at, nothing.
    #[arg(long, value_parser = choice(TOLD), default_value = Told::FirstReading.name())]
    pub told: Told,
    /// Write the f32 core's estimates to this file: time_s, voltage_V, displacement_um, estimate_um, half_width_um,
    /// status, scored, log; a row a measured instant after the first, voltage and displacement as recorded, the
    /// estimate with the sensor's zero.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Fail (exit code 1) when the f32 core's mean absolute error over all logs exceeds this, µm.
    #[arg(long, value_name = "µm", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_mae: Option<f64>,
    /// Fail (exit code 1) when it exceeds this percentage of the stroke.
    #[arg(long, value_name = "%", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_percent: Option<f64>,
    /// Judge by the error without a constant offset, as it is after re-zeroing.
    #[arg(long)]
    pub rezero: bool,
    /// Factor on the recorded displacement, instead of the table's: -1 of a sensor that is mounted the other way than
    /// in the training.
    #[arg(long, value_parser = factor, allow_negative_numbers = true)]
    pub displacement_scale: Option<f64>,
    /// How much later the sensor shows a displacement than it happens, ms, instead of the table's: of another sensor
    /// than in the training.
    #[arg(long, value_parser = delay, allow_negative_numbers = true, value_name = "MS")]
    pub delay: Option<f64>,
    /// Score nothing that is no measurement, by the rule of `identify --repair`: a value that is no number, a row that
    /// the time stamps leave out, or where the sensor leaps away and back or stands still. The voltage is run through
    /// all the same, straight past its own leaps; behind a step of the sensor alone the displacement is taken back.
    #[arg(long)]
    pub repair: bool,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
    /// What is scored.
    #[command(flatten)]
    pub scope: ScopeArgs,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// What is done to the logs otherwise than the table says.
    #[command(flatten)]
    pub prepare: PrepareAgain,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` when a threshold is exceeded.
pub fn run(arguments: &Validate) -> Result<bool> {
    if let Some(path) = &arguments.out {
        let inputs = arguments.logs.iter().chain([&arguments.table]);
        arguments.overwrite.of_inputs(path, Estimates::HEADING, inputs)?;
    }
    let (file, table) = look_at(&arguments.table)?;
    let displacement_scale = arguments.displacement_scale.unwrap_or(file.recipe.displacement_scale);
    let delay_ticks = arguments.delay.map_or(file.recipe.delay_ticks, |ms| file.recipe.ticks_of(ms));
    let recipe = Recipe { displacement_scale, delay_ticks, ..arguments.prepare.instead_of(file.recipe) };
    recipe.check()?;
    let scope: Scope = (&arguments.scope).into();
    let told = arguments.told.before(scope.zero_at_s.is_some());
    let logs = arguments.files.read_all(&arguments.logs, arguments.repair)?;
    let (mut comparisons, mut repairs) = (Vec::new(), Vec::new());
    let mut written = String::from(Estimates::HEADING);
    for log in &logs {
        let named = || log.path.display().to_string();
        let recipe = recipe.of(log);
        let cut = recipe.cut(log);
        let found = if arguments.repair { flaws(&cut) } else { Vec::new() };
        let (session, left_out) = measured(&recipe, &cut, &found)?;
        repairs.push(arguments.repair.then(|| Repair::of(left_out)));
        let comparison = compare_within(&table, &session, &scope).with_context(named)?;
        // Judged and written is what was told: of one cycle there must be one.
        let estimates = estimates(&table, &session, &recipe, &scope, told).with_context(named)?;
        comparisons.push(comparison);
        if arguments.out.is_some() {
            written.push_str(&estimates.csv());
        }
    }
    let trained_on: Vec<_> = logs.iter().map(|log| trained_on(&file.logs, log)).collect();
    let suspicion_of = |of| Suspicion::of(of, &table, &scope, told, arguments.rezero);
    let suspicions: Vec<_> = comparisons.iter().map(suspicion_of).collect();
    let mil = Figures::all(comparisons.iter().map(|c| &c.mil));
    let figures = ToldFigures::all(comparisons.iter().map(|c| &c.told));
    let (Some(mil), Some(all)) = (mil, figures) else { return Ok(false) };
    let Some(figures) = all.get(told) else { return Ok(false) };
    let (judged, percent) = match arguments.rezero {
        true => (figures.mae_without_offset_um, figures.mae_without_offset_percent),
        false => (figures.mae_um, figures.mae_percent),
    };
    let within = |limit: Option<f64>, value: f64| limit.is_none_or(|limit| value <= limit);
    let passed = within(arguments.max_mae, judged) && within(arguments.max_percent, percent);
    if let Some(path) = &arguments.out {
        output::write(path, written)?;
    }
    if arguments.json {
        let logs = comparisons.iter().zip(&logs).zip(&trained_on).zip(&suspicions).zip(&repairs);
        let logs: Vec<Value> = logs
            .map(|((((of, log), trained_on), found), repair)| {
                log_json(of, log, trained_on.as_ref(), found.as_ref(), *repair)
            })
            .collect();
        let all = json!({ "mil": mil, "sil": all.first_reading, "told": all });
        let judged = json!({ "told": told, "rezeroed": arguments.rezero, "mae_um": judged, "percent": percent });
        let report = json!({ "logs": logs, "all": all, "judged": judged, "out": arguments.out, "passed": passed });
        out(&serde_json::to_string_pretty(&report)?);
        return Ok(passed);
    }
    let explained = findings::explained(scope.zero_at_s, told);
    explained.into_iter().chain(findings::ends_left_out(&recipe)).for_each(|line| out(&line));
    out("");
    out(&heading("log"));
    for (((comparison, log), trained_on), repair) in comparisons.iter().zip(&logs).zip(&trained_on).zip(&repairs) {
        of_log(comparison, log, trained_on.as_ref(), &scope, *repair).iter().for_each(|line| out(line));
    }
    if comparisons.len() > 1 {
        rows("all", &mil, &all, None, scope.zero_at_s.is_some()).iter().for_each(|line| out(line));
    }
    if let Some(path) = &arguments.out {
        out(&format!("\nWritten: {} (f32, {})", path.display(), told));
    }
    for (((of, log), found), repair) in comparisons.iter().zip(&logs).zip(&suspicions).zip(&repairs) {
        found.iter().for_each(|found| out(&format!("\n{}: {}", of.name, suspected(of, log, found, *repair))));
    }
    if !passed {
        out(&findings::failed((judged, percent), (arguments.max_mae, arguments.max_percent)));
    }
    Ok(passed)
}
