//! `piezo estimate`: the displacement from a recorded voltage alone, as the device's f32 core would have it.

use super::device::look_at;
use super::print::out;
use crate::option::{LogOptions, Overwrite, PrepareAgain, finite, zero};
use crate::output;
use anyhow::{Context, Result};
use clap::Args;
use estimator_core::Range;
use identification::validate::{Estimates, Known, unmeasured};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `piezo estimate`.
#[derive(Args, Debug)]
pub struct Estimate {
    /// The table to estimate by.
    pub table: PathBuf,
    /// Logs of the voltage. A sensor's column is not looked at.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// Write the estimates to this file: time_s (since the log's first sample), voltage_V, estimate_um, half_width_um,
    /// status, log; a row a recorded instant after the first (a tick of the table's, where the log has more), the
    /// voltage as recorded, the estimate with the training sensor's zero.
    #[arg(long, value_name = "FILE", default_value = "estimates.csv")]
    pub out: PathBuf,
    /// Where the actuator is at each log's first sample, µm of the training sensor; else it is taken to have rested
    /// there for long.
    #[arg(long, value_name = "µm", value_parser = finite, allow_negative_numbers = true)]
    pub start_at: Option<f64>,
    /// Where the actuator is at a time, s since each log's first sample, in µm of the training sensor, as `piezo zero`
    /// tells a device at a known position: from then on the estimate is by that, with its ±. Best after a full swing,
    /// which wipes out how it started.
    #[arg(long, value_name = "S:µm", value_parser = zero, allow_hyphen_values = true, conflicts_with = "start_at")]
    pub zero_at: Option<(f64, f64)>,
    /// Take the voltage to go straight on over rows where it is no number, or that the time stamps leave out: a
    /// tenth at most. No estimate is written of these, and those behind are by what the memory then is; a full swing
    /// wipes that out.
    #[arg(long)]
    pub repair: bool,
    /// Print what was estimated as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// What is done to the logs otherwise than the table says.
    #[command(flatten)]
    pub prepare: PrepareAgain,
    /// What becomes of a file in the result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Estimate) -> Result<bool> {
    let path = &arguments.out;
    let inputs = arguments.logs.iter().chain([&arguments.table]);
    arguments.overwrite.of_inputs(path, Estimates::UNMEASURED_HEADING, inputs)?;
    let (file, table) = look_at(&arguments.table)?;
    let recipe = arguments.prepare.instead_of(file.recipe);
    let known = match (arguments.start_at, arguments.zero_at) {
        (Some(start), _) => Known::Start(start),
        (None, Some((at_s, um))) => Known::Zero { at_s, um },
        (None, None) => Known::Nothing,
    };
    let (mut all, mut written) = (Vec::new(), String::from(Estimates::UNMEASURED_HEADING));
    for path in &arguments.logs {
        let log = arguments.files.read_voltage(path, arguments.repair)?;
        let recipe = recipe.of(&log);
        let estimates = unmeasured(&table, log, &recipe, known).with_context(|| path.display().to_string())?;
        written.push_str(&estimates.csv());
        let Range { min, max } = table.voltage_range_v.of();
        let table_v = Range::of_values([min, max].map(|voltage| recipe.as_recorded(voltage)));
        all.push((estimates, table_v, recipe.voltage_scale));
    }
    output::write(path, written)?;
    if arguments.json {
        let logs: Vec<Value> =
            all.iter().map(|(of, table_v, scale)| findings::estimated_json(of, *table_v, *scale)).collect();
        out(&serde_json::to_string_pretty(&json!({ "logs": logs, "out": path }))?);
        return Ok(true);
    }
    findings::ends_left_out(&recipe).iter().for_each(|line| out(line));
    for (estimates, table_v, scale) in &all {
        findings::estimated(estimates, &known, *table_v, *scale).iter().for_each(|line| out(line));
    }
    out(&format!("\nWritten: {}", path.display()));
    Ok(true)
}
