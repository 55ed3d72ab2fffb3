//! `piezo waveform`: a line of wanted displacements into the device's memory, from which it plays it again and
//! again by itself.

use super::print::out;
use crate::option::link::PortOption;
use crate::option::{LogOptions, count};
use anyhow::Result;
use bench::waveform::{Waveform as Line, leave};
use bench::{held, require_model};
use clap::Args;
use device_link::table;
use remedy::plays;
use std::num::{NonZeroU16, NonZeroU32};
use std::path::PathBuf;

/// Arguments of `piezo waveform`.
#[derive(Args, Debug)]
pub struct Waveform {
    /// The line: a log with time and displacement (time_s,displacement_um), or displacement alone and --fs, relative to
    /// the model's zero; up to 4096 points, straight between them.
    #[arg(required_unless_present = "stop")]
    pub line: Option<PathBuf>,
    /// Ticks from each point to the next; without it as many as its time takes.
    #[arg(long, value_name = "TICKS", value_parser = |text: &str| count::<NonZeroU16>(text, "; leave it out for as many as its time takes"), allow_negative_numbers = true)]
    pub every: Option<NonZeroU16>,
    /// Go to rest after so many lines; without it, at --stop, a fault or a reset.
    #[arg(long, value_name = "LINES", value_parser = |text: &str| count::<NonZeroU32>(text, "; leave it out for lines without an end"), allow_negative_numbers = true)]
    pub repeat: Option<NonZeroU32>,
    /// Begin each line at a rising edge of the trigger input.
    #[arg(long)]
    pub on_trigger: bool,
    /// Leave it: the voltage goes to rest at the drive's slew rate, and the device estimates.
    #[arg(long, conflicts_with_all = ["line", "every", "repeat", "on_trigger", "dry_run"])]
    pub stop: bool,
    /// Look at it by the device's table, say what would come of it, and send nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print what comes of it as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// Reading of the line.
    #[command(flatten)]
    pub log: LogOptions,
}

/// Runs the verb.
pub fn run(arguments: &Waveform) -> Result<bool> {
    let Some(path) = &arguments.line else { return stop(arguments) };
    let log = arguments.log.read_trajectory(path)?;
    let (mut client, _) = arguments.port.connect()?;
    let table = table::running(&mut client)?;
    require_model(&table)?;
    let line = Line::of(&log, table.sample_period(), arguments.every)?;
    let foreseen = line.foreseen(&table)?;
    let lines = arguments.repeat.map_or(0, NonZeroU32::get);
    if !arguments.dry_run {
        line.play(&mut client, lines, arguments.on_trigger)?;
    }
    if arguments.json {
        out(&serde_json::to_string_pretty(&foreseen)?);
        return Ok(true);
    }
    let what = if arguments.dry_run { "Nothing was sent".to_owned() } else { plays(lines, arguments.on_trigger) };
    out(&format!("{}. {what}", foreseen.said(table.sample_period())));
    table.drive.iter().for_each(|drive| out(&held(&table, &drive.limits)));
    Ok(true)
}

fn stop(arguments: &Waveform) -> Result<bool> {
    let (mut client, _) = arguments.port.connect()?;
    let left = leave(&mut client)?;
    out(&match arguments.json {
        true => serde_json::to_string_pretty(&left)?,
        false => left.to_string(),
    });
    Ok(true)
}
