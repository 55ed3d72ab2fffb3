//! `piezo feedforward`: a wanted trajectory → the voltages that bring the actuator there.

use super::device::look_at;
use super::print::out;
use crate::option::{LogOptions, Overwrite};
use crate::option::{not_negative, span};
use crate::output::Replacement;
use ::calibration::drive::{planned, trained_on};
use ::calibration::span::Span;
use ::feedforward::{Plan, Trajectory, approach, near, plan, reach};
use anyhow::{Context, Result};
use bench::{beyond_training, caveats};
use clap::Args;
use estimator_core::{Admitted, DriveLimits};
use recordings::log::{Displacement, csv_beside};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo feedforward`.
#[derive(Args, Debug)]
pub struct Feedforward {
    /// The table of the actuator.
    pub table: PathBuf,
    /// Where the displacement is wanted: a log with time and displacement (time_s,displacement_um), relative to the
    /// model's zero as every estimate is; straight between its samples.
    pub trajectory: PathBuf,
    /// The voltages, as a log with the displacement that the model gives for them.
    #[arg(long)]
    pub out: PathBuf,
    /// Voltages that the amplifier may be driven to, V. Without it the table's drive's, else those that the
    /// training went over.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub range: Option<Span>,
    /// Fastest change of the voltage, V/s. Without it the table's drive's.
    #[arg(long, value_name = "V/s", value_parser = not_negative, allow_negative_numbers = true)]
    pub slew: Option<f64>,
    /// Voltage at which the actuator rests before, V. Without it the table's drive's, else 0 or the voltage
    /// nearest to it.
    #[arg(long, allow_hyphen_values = true, value_name = "V")]
    pub rest: Option<f64>,
    /// Exit with 1 where the model of these voltages misses the trajectory by more than this, µm, once it has been met.
    /// Without it, where it misses it because of a limit.
    #[arg(long, value_name = "µm", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Print what was planned as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the trajectory.
    #[command(flatten)]
    pub log: LogOptions,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` beyond `--max-error`, and where the trajectory is never met.
pub fn run(arguments: &Feedforward) -> Result<bool> {
    let (_, table) = look_at(&arguments.table)?;
    let trajectory = arguments.log.read_trajectory(&arguments.trajectory)?;
    let heading = "time_s,voltage_V,estimated_displacement_um\n";
    arguments.overwrite.of_inputs(&arguments.out, heading, [&arguments.table, &arguments.trajectory])?;
    let limits = stated(arguments, &table)?;
    let tick_s: f64 = table.sample_period();
    let wanted = Trajectory::of(&trajectory, tick_s);
    let mut whole = approach(&table, &limits, &wanted).with_context(|| remedy::no_plan(&table, &limits))?;
    let begins = whole.len();
    whole.extend(wanted.0);
    let plan = plan(&table, &limits, &Trajectory(whole)).with_context(|| remedy::no_plan(&table, &limits))?;
    csv_beside(&arguments.out, tick_s, &plan.voltage, &plan.displacement, Displacement::Estimated)
        .and_then(Replacement::commit)
        .with_context(|| format!("{}: cannot be written", arguments.out.display()))?;
    tell(arguments, &table, &limits, &plan, begins)
}

fn stated(arguments: &Feedforward, table: &Admitted) -> Result<DriveLimits> {
    planned(table, arguments.range, arguments.rest, arguments.slew)
        .with_context(|| remedy::no_slew(&arguments.trajectory))
}

fn tell(arguments: &Feedforward, table: &Admitted, limits: &DriveLimits, plan: &Plan, begins: usize) -> Result<bool> {
    let tick_s: f64 = table.sample_period();
    let met = plan.met(begins, near(table));
    let errors = met.and_then(|tick| plan.round_trip(tick));
    let hull = |better: fn(f64, f64) -> f64| plan.voltage.iter().copied().reduce(better).unwrap_or(0.0);
    let (low, high) = (hull(f64::min), hull(f64::max));
    // What --max-error allows is no shortfall.
    let short = met.filter(|_| arguments.max_error.is_none()).and_then(|met| plan.shortfall(met, near(table)));
    let good = short.is_none()
        && errors.as_ref().is_some_and(|errors| arguments.max_error.is_none_or(|most| errors.max_um <= most));
    if arguments.json {
        let summary = json!({
            "out": arguments.out,
            "ticks": plan.voltage.len(),
            "limits": limits,
            "voltage_v": { "min": low, "max": high },
            "fastest_v_per_s": plan.fastest() / tick_s,
            "out_of_reach": plan.out_of_reach,
            "reach_um": reach(table, limits),
            "approach_s": begins as f64 * tick_s,
            "short_um": short.map(|short| short.most_um),
            "short_from_s": short.map(|short| short.tick as f64 * tick_s),
            "met_after_s": met.map(|tick| tick as f64 * tick_s),
            "beyond_training": plan.beyond(trained_on(table)),
            "delay_ticks": table.parameters.delay_ticks(),
            "round_trip": errors,
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(good);
    }
    out(&format!(
        "{}  {} ticks, the first {begins} of them from rest to where the trajectory begins, {low:.3} … {high:.3} V, at most {:.0} V/s, \
         from {} V; it ends where the trajectory does",
        arguments.out.display(),
        plan.voltage.len(),
        plan.fastest() / tick_s,
        limits.rest_v
    ));
    match (met, errors) {
        (Some(tick), Some(errors)) => out(&format!(
            "The {} model of these voltages is {:.4} µm off the trajectory on average, {:.4} µm at most ({:.3} % of its {:.2} µm), \
             once it has met it after {:.3} s",
            table.model(),
            errors.mae_um,
            errors.max_um,
            100.0 * errors.max_um / errors.stroke_um.max(f64::MIN_POSITIVE),
            errors.stroke_um,
            tick as f64 * tick_s
        )),
        _ => out(
            "FAILED: the model never meets the trajectory: is it relative to the model's zero, and within the voltages' reach?",
        ),
    }
    caveats(table, limits).iter().chain(&beyond_training(table, plan)).for_each(|line| out(line));
    if plan.out_of_reach > 0 {
        out(&remedy::at_a_limit(plan.out_of_reach, plan.voltage.len(), limits));
    }
    if let Some(short) = short {
        out(&remedy::falls_short(short.tick as f64 * tick_s, short.most_um));
    }
    if let (false, Some(most), Some(_)) = (good, arguments.max_error, met) {
        out(&format!("FAILED: more than {most} µm off"));
    }
    Ok(good)
}
