//! `piezo validate`: a table against logs, the f64 reference and the f32 core side by side.

use super::print::{heading, out, row};
use crate::option::{DECIMATIONS, LogOptions, choice, not_negative};
use anyhow::Result;
use clap::Args;
use estimator_core::Status;
use identification::table_file::TableFile;
use identification::validate::{Comparison, Figures, compare};
use identification::{LogUse, Role};
use recordings::log::Log;
use recordings::prepare::{Decimation, Recipe};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `piezo validate`.
#[derive(Args, Debug)]
pub struct Validate {
    /// The table.
    pub table: PathBuf,
    /// Logs, best such as it has not seen.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// Fail (exit code 1) when the f32 core's mean absolute error over all logs exceeds this, µm.
    #[arg(long, value_name = "µm", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_mae: Option<f64>,
    /// Fail (exit code 1) when it exceeds this percentage of the stroke.
    #[arg(long, value_name = "%", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_percent: Option<f64>,
    /// Judge by the error without a constant offset, as it is after re-zeroing.
    #[arg(long)]
    pub rezero: bool,
    /// Cut off the start of each log, s, instead of what the table's recipe says.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_start: Option<f64>,
    /// Cut off the end of each log, s, instead of what the table's recipe says.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_end: Option<f64>,
    /// What becomes of a log faster than the tick, instead of what the table's recipe says.
    #[arg(long, value_parser = choice(DECIMATIONS))]
    pub decimate: Option<Decimation>,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
}

/// Runs the verb; `false` when a threshold is exceeded.
pub fn run(arguments: &Validate) -> Result<bool> {
    let (file, table) = TableFile::load(&arguments.table)?;
    let recipe = Recipe {
        skip_start_s: arguments.skip_start.unwrap_or(file.recipe.skip_start_s),
        skip_end_s: arguments.skip_end.unwrap_or(file.recipe.skip_end_s),
        decimation: arguments.decimate.unwrap_or(file.recipe.decimation),
        ..file.recipe
    };
    let logs = arguments.files.read_all(&arguments.logs)?;
    let mut comparisons = Vec::new();
    for log in &logs {
        let recipe = recipe.of(log);
        comparisons.push(compare(&table, &recipe.session(&recipe.cut(log))?));
    }
    let trained_on: Vec<Option<(f64, f64)>> = logs.iter().map(|log| trained_on(&file.logs, log)).collect();
    let mil = Figures::all(comparisons.iter().map(|c| &c.mil));
    let sil = Figures::all(comparisons.iter().map(|c| &c.sil));
    let (Some(mil), Some(sil)) = (mil, sil) else { return Ok(false) };
    let (judged, percent) = match arguments.rezero {
        true => (sil.mae_without_offset_um, sil.mae_without_offset_percent),
        false => (sil.mae_um, sil.mae_percent),
    };
    let within = |limit: Option<f64>, value: f64| limit.is_none_or(|limit| value <= limit);
    let passed = within(arguments.max_mae, judged) && within(arguments.max_percent, percent);
    if arguments.json {
        let logs: Vec<Value> = comparisons.iter().zip(&logs).zip(&trained_on).map(to_json).collect();
        let report = json!({ "logs": logs, "all": { "mil": mil, "sil": sil }, "passed": passed });
        out(&serde_json::to_string_pretty(&report)?);
        return Ok(passed);
    }
    out(
        "Simulation from each log's first sample: the f64 reference (MIL) and the f32 core of the target (SIL), told the \
         sensor's first reading.",
    );
    out(&heading("log"));
    for ((comparison, log), trained_on) in comparisons.iter().zip(&logs).zip(&trained_on) {
        out(&row(&format!("{}  f64 (MIL)", comparison.name), &comparison.mil));
        out(&row(&format!("{}  f32 (SIL)", comparison.name), &comparison.sil));
        let cold = &comparison.cold;
        out(&row(&format!("{}  f32, cold", comparison.name), &cold.all));
        if let Some(settled) = &cold.settled {
            out(&row(&format!("{}  f32, settled", comparison.name), settled));
        }
        out(&match cold.settled_after_s {
            Some(after) => format!("    cold: started as a device is, told nothing; settled: the same after {after:.2} s"),
            None => "    cold: started as a device is, told nothing; it never counts as settled, since the voltage does not turn \
                     at either end of half the table's range"
                .to_owned(),
        });
        out(&format!("    f32 differs from f64 by at most {:.2e} µm", comparison.mil_sil_um));
        if let Some((from, to)) = trained_on {
            out(&format!(
                "    the table was trained on {from:.2} … {to:.2} s of this log: these errors prove nothing there"
            ));
        }
        if log.displacement_estimated {
            out("    its displacement is a device's estimate, no sensor's: these errors say nothing of the actuator");
        }
        let remarks = remarks(comparison.status);
        if !remarks.is_empty() {
            out(&format!("    {remarks}"));
        }
    }
    if comparisons.len() > 1 {
        out(&row("all  f64 (MIL)", &mil));
        out(&row("all  f32 (SIL)", &sil));
    }
    let limit = |limit: Option<f64>, unit: &str| limit.map_or(String::new(), |limit| format!(" {limit} {unit}"));
    if !passed {
        let (um, of_stroke) = (limit(arguments.max_mae, "µm"), limit(arguments.max_percent, "%"));
        out(&format!("FAILED: {judged:.4} µm, {percent:.2} % of the stroke; allowed:{um}{of_stroke}"));
    }
    Ok(passed)
}

/// The seconds of a log that a table was trained on.
fn trained_on(uses: &[LogUse], log: &Log) -> Option<(f64, f64)> {
    let used = uses.iter().find(|used| used.role == Role::Training && used.sha256 == log.sha256)?;
    Some((used.from_s, used.to_s))
}

/// What the status bits mean.
fn remarks(status: Status) -> String {
    let meanings = [
        (
            Status::VOLTAGE_OUT_OF_RANGE,
            "the voltage left the range the model was identified on; the nearest end was taken",
        ),
        (Status::CLAMPED, "the estimate was clamped to the table's limits"),
        (Status::DAC_SATURATED, "the displacement reached an end of the DAC's range"),
        (Status::ADC_SATURATED, "the ADC stood at an end of its range"),
    ];
    let raised = meanings.into_iter().filter(|(bit, _)| status.contains(*bit)).map(|(_, meaning)| meaning);
    raised.collect::<Vec<_>>().join("; ")
}

fn to_json(((comparison, log), trained_on_s): ((&Comparison, &Log), &Option<(f64, f64)>)) -> Value {
    let status: Vec<&str> = comparison.status.iter_names().map(|(name, _)| name).collect();
    json!({
        "log": comparison.name,
        "mil": comparison.mil,
        "sil": comparison.sil,
        "mil_sil_um": comparison.mil_sil_um,
        "cold": comparison.cold,
        "status": status,
        "trained_on_s": trained_on_s,
        "displacement_estimated": log.displacement_estimated,
    })
}
