//! `piezo feedforward`: a wanted trajectory → the voltages that bring the actuator there.

use super::LogOptions;
use super::print::out;
use crate::calibration::Span;
use crate::drive::{identified_on, limits, ordered};
use crate::feedforward::{Plan, Trajectory, delay_ticks, plan};
use crate::log::{Displacement, ReadOptions, read, write_csv};
use crate::prepare::not_negative;
use crate::table_file::TableFile;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use estimator_core::{Admitted, DriveLimits};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo feedforward`.
#[derive(Args, Debug)]
pub struct Feedforward {
    /// The table of the actuator.
    pub table: PathBuf,
    /// Where the displacement is wanted: a log with time and displacement (time_s,displacement_um), relative to the model's
    /// zero as every estimate is; straight between its samples.
    pub trajectory: PathBuf,
    /// The voltages, as a log with the displacement that the model gives for them.
    #[arg(long)]
    pub out: PathBuf,
    /// Voltages that the amplifier may be driven to, V. Without it the table's drive's, else all that the model was
    /// identified on.
    #[arg(long, allow_hyphen_values = true, value_name = "V:V")]
    pub range: Option<Span>,
    /// Fastest change of the voltage, V/s. Without it the table's drive's.
    #[arg(long, value_name = "V/s", value_parser = not_negative, allow_negative_numbers = true)]
    pub slew: Option<f64>,
    /// Voltage at which the actuator rests before, V. Without it the table's drive's, else 0 or the voltage nearest to it.
    #[arg(long, allow_hyphen_values = true, value_name = "V")]
    pub rest: Option<f64>,
    /// Exit with 1 where the model of these voltages misses the trajectory by more than this, µm, once it has been met.
    #[arg(long, value_name = "µm", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Print what was planned as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the trajectory.
    #[command(flatten)]
    pub log: LogOptions,
}

/// Runs the verb; `false` beyond `--max-error`.
pub fn run(arguments: &Feedforward) -> Result<bool> {
    let (_, table) = TableFile::load(&arguments.table)?;
    let options = ReadOptions {
        columns: arguments.log.columns.clone(),
        sample_rate: arguments.log.fs,
        displacement_required: true,
        voltage_required: false,
    };
    let trajectory = read(&arguments.trajectory, &options)?;
    let name = arguments.out.display();
    ensure!(!arguments.out.is_dir(), "{name}: is a folder, --out names a file");
    let limits = stated(arguments, &table)?;
    let tick_s: f64 = table.sample_period();
    let plan = plan(&table, &limits, &Trajectory::of(&trajectory, tick_s))
        .with_context(|| format!("{}: no voltages can be planned", arguments.table.display()))?;
    write_csv(&arguments.out, tick_s, &plan.voltage, &plan.displacement, Displacement::Estimated)
        .with_context(|| format!("{name}: cannot be written"))?;
    tell(arguments, &table, &limits, &plan)
}

fn stated(arguments: &Feedforward, table: &Admitted) -> Result<DriveLimits> {
    let drive = table.drive.map(|drive| drive.limits);
    let range = arguments.range.map(ordered).or(drive.map(|drive| drive.range_v));
    let range = range.unwrap_or_else(|| identified_on(table));
    let Some(slew) = arguments.slew.or(drive.map(|drive| f64::from(drive.slew_v_per_s))) else {
        bail!("how fast may the voltage change? --slew V/s (the table has no drive that says it)");
    };
    let rest = arguments.rest.or(drive.map(|drive| range.clamp(drive.rest_v).into()));
    Ok(limits(range, rest, slew))
}

fn tell(arguments: &Feedforward, table: &Admitted, limits: &DriveLimits, plan: &Plan) -> Result<bool> {
    let tick_s: f64 = table.sample_period();
    let near = 1e-3 * f64::from(table.displacement_limits_um.span());
    // From rest to where the trajectory begins is a way that no inverse can spare.
    let met = plan.displacement.iter().zip(&plan.wanted).position(|(y, r)| (y - r).abs() < near);
    let errors = met.and_then(|tick| plan.round_trip(tick));
    let hull = |better: fn(f64, f64) -> f64| plan.voltage.iter().copied().reduce(better).unwrap_or(0.0);
    let (low, high) = (hull(f64::min), hull(f64::max));
    let good = match (arguments.max_error, &errors) {
        (None, _) => true,
        (Some(most), Some(errors)) => errors.max_um <= most,
        (Some(_), None) => false,
    };
    if arguments.json {
        let summary = json!({
            "out": arguments.out,
            "ticks": plan.voltage.len(),
            "limits": limits,
            "voltage_v": { "min": low, "max": high },
            "fastest_v_per_s": plan.fastest() / tick_s,
            "out_of_reach": plan.out_of_reach,
            "met_after_s": met.map(|tick| tick as f64 * tick_s),
            "delay_ticks": delay_ticks(table),
            "round_trip": errors,
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(good);
    }
    out(&format!(
        "{}  {} ticks, {low:.3} … {high:.3} V, at most {:.0} V/s",
        arguments.out.display(),
        plan.voltage.len(),
        plan.fastest() / tick_s
    ));
    match (met, errors) {
        (Some(tick), Some(errors)) => out(&format!(
            "The {} model of these voltages is {:.4} µm off the trajectory on average, {:.4} µm at most ({:.3} % of its {:.2} µm), \
             once it has met it after {:.3} s",
            table.model,
            errors.mae_um,
            errors.max_um,
            100.0 * errors.max_um / errors.stroke_um.max(f64::MIN_POSITIVE),
            errors.stroke_um,
            tick as f64 * tick_s
        )),
        _ => out(
            "The model never meets the trajectory: is it relative to the model's zero, and within the voltages' reach?",
        ),
    }
    if plan.out_of_reach > 0 {
        out(&format!(
            "On {} of {} ticks the voltage or its slew rate stood at a limit ({} … {} V, {} V/s)",
            plan.out_of_reach,
            plan.voltage.len(),
            limits.range_v.min,
            limits.range_v.max,
            limits.slew_v_per_s
        ));
    }
    if let (false, Some(most)) = (good, arguments.max_error) {
        out(&format!("FAILED: more than {most} µm off"));
    }
    Ok(good)
}
