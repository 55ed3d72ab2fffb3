//! `piezo look`: what was understood of a log, before anything is fitted to it.

use super::print::out;
use crate::option::{LogOptions, Overwrite};
use crate::output::{self, PICTURE};
use anyhow::{Result, ensure};
use clap::Args;
use log_survey::{Cell, Clock, ColumnRead, RateSource, Series, Survey, survey};
use recordings::log::{Fault, LogError, Quantity, ReadOptions, Reading, open};
use remedy::sentence;
use std::path::{Path, PathBuf};

/// Fewest rows at an end of the range that look like a rest or saturation.
const REST: u64 = 8;
/// Smallest part of a mean half cycle that does: a sine's crest, rounded, is one number for less.
const PART_OF_A_HALF_CYCLE: u64 = 20;

/// Arguments of `piezo look`.
#[derive(Args, Debug)]
pub struct Look {
    /// Logs. They are streamed, however long they are; of a .mat or .tdms file all is held at once.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// Draw the log to this file (SVG; an .html name gets a page with the pictures of all logs).
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print what was understood as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Look) -> Result<bool> {
    if let Some(path) = &arguments.out {
        ensure!(!path.is_dir(), "{}: is a folder, --out names a file", path.display());
        output::not_over(path, &arguments.logs.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
        arguments.overwrite.of(path, PICTURE)?;
        let page = path.extension().is_some_and(|extension| extension == "html");
        ensure!(
            page || arguments.logs.len() == 1,
            "{}: holds the picture of one log: name an .html file",
            path.display()
        );
    }
    let (mut pictures, mut surveys, mut learnable) = (Vec::new(), Vec::new(), true);
    for path in &arguments.logs {
        let (reading, refusal) = opened(path, arguments)?;
        let found = survey(reading)?;
        learnable &= refusal.is_none() && found.voltage.is_some() && found.displacement.is_some();
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        pictures.push(report::survey(&found, &name));
        if arguments.json {
            surveys.push(serde_json::json!({ "log": path, "survey": found, "refusal": refusal }));
        } else {
            out(&path.display().to_string());
            print(&found, refusal.as_deref());
        }
    }
    if arguments.json {
        out(&serde_json::to_string_pretty(&surveys)?);
    }
    if let Some(path) = &arguments.out {
        let page = path.extension().is_some_and(|extension| extension == "html");
        let contents = if page {
            format!("<!doctype html>\n<meta charset=\"utf-8\">\n{}", pictures.join("\n"))
        } else {
            pictures.concat()
        };
        output::write(path, contents)?;
        if !arguments.json {
            out(&format!("\nWritten: {}", path.display()));
        }
    }
    if learnable && !arguments.json {
        out("\nNext: piezo identify, with the same files and options, and --out FOLDER for what it writes");
    }
    Ok(true)
}

/// The log, with a displacement if it has one that can be read; else with the sentence that says why not.
fn opened(path: &Path, arguments: &Look) -> Result<(Reading<'static>, Option<String>)> {
    let options = arguments.files.options();
    match open(path, &options) {
        Err(error @ LogError { fault: Fault::NoColumn { quantity: Quantity::Displacement, .. }, .. }) => {
            let without = open(path, &ReadOptions { displacement_required: false, ..options })?;
            Ok((without, Some(sentence(&error))))
        }
        opened => Ok((opened?, None)),
    }
}

/// Prints what was understood, and why there is no displacement.
fn print(survey: &Survey, refusal: Option<&str>) {
    let line = |name: &str, words: &str| out(&format!("  {name:<13} {words}"));
    for ColumnRead { quantity, number, name, unit } in &survey.columns {
        let name = if name.is_empty() { String::new() } else { format!(" {name:?}") };
        line(quantity, &format!("column {number}{name}, in {unit}"));
    }
    line("rate", &rate(survey));
    for (name, unit, small, series) in
        [("voltage", "V", "mV", &survey.voltage), ("displacement", "µm", "nm", &survey.displacement)]
    {
        match series {
            Some(series) => {
                ranges(&line, name, (unit, small), series);
                rests(&line, unit, series, survey);
            }
            None => line(name, refusal.unwrap_or("no column holds it")),
        }
    }
    if let Some(frozen) = survey.frozen {
        let words = format!(
            "{} µm in {} rows from row {} on, while the voltage moves by {:.4} V: was the sensor off, or out of its range?",
            frozen.displacement_um,
            frozen.rows,
            frozen.first_row + 1,
            frozen.voltage_v
        );
        line("frozen", &words);
    }
    swings(&line, survey);
}

fn rate(survey: &Survey) -> String {
    let Clock { hz, source, steps_s, long_steps, duration_s } = &survey.clock;
    let source = match source {
        RateSource::Column => "by the time column".to_owned(),
        RateSource::File(name) => format!("by the file's {name:?}"),
        RateSource::Stated => "as stated by --fs".to_owned(),
    };
    let steps = match steps_s {
        Some((low, high)) if high - low > 0.01 / hz => {
            format!("; steps of {} to {} ms", short(low * 1e3), short(high * 1e3))
        }
        _ => String::new(),
    };
    let gaps = match long_steps {
        0 => String::new(),
        1 => "; 1 gap, where identify will refuse it".to_owned(),
        gaps => format!("; {gaps} gaps, where identify will refuse it"),
    };
    if survey.rows < 2 {
        return format!("{} row, of which there must be two to have a rate", survey.rows);
    }
    if !hz.is_finite() {
        let first_to_last = short(*duration_s);
        return format!(
            "none {source}: from the first of {} rows to the last it goes on by {first_to_last} s",
            survey.rows
        );
    }
    format!("{} Hz, {source}; {} rows, {} s{steps}{gaps}", short(*hz), survey.rows, short(*duration_s))
}

fn ranges(line: &dyn Fn(&str, &str), name: &str, (unit, small): (&str, &str), series: &Series) {
    let Series { low, high, noise, resolution, .. } = *series;
    let words = format!(
        "{} … {} {unit}; noise {} {small} (1 σ), smallest step {} {small}",
        short(low),
        short(high),
        short(noise * 1e3),
        short(resolution * 1e3)
    );
    line(name, &words);
}

/// How long a series stands at its ends.
fn rests(line: &dyn Fn(&str, &str), unit: &str, series: &Series, survey: &Survey) {
    let Series { low, high, longest_at_low, longest_at_high, .. } = *series;
    let half_cycle = survey.rows / (survey.swings.reversals as u64 + 1);
    let least = REST.max(half_cycle / PART_OF_A_HALF_CYCLE);
    for (end, value, rows) in [("lowest", low, longest_at_low), ("highest", high, longest_at_high)] {
        if rows >= least && low < high {
            let value = short(value);
            line(
                "",
                &format!("stands at its {end}, {value} {unit}, for {rows} rows: a rest, or the end of the range?"),
            );
        }
    }
}

fn swings(line: &dyn Fn(&str, &str), survey: &Survey) {
    let swings = &survey.swings;
    let Some(voltage) = &survey.voltage else { return };
    line("reversals", &format!("{} of the voltage, by {} V at least", swings.reversals, short(swings.threshold_v)));
    if survey.rows_a_block > 1 {
        let hz = survey.clock.hz / (2 * survey.rows_a_block) as f64;
        line("", &format!("a long log: oscillations above {} Hz count as one", short(hz)));
    }
    if voltage.low >= voltage.high {
        line("", "the voltage is constant: nothing can be learnt from it");
        return;
    }
    line("half cycles", "amplitude, V × frequency, Hz: how many");
    for Cell { amplitude_v, frequency_hz, half_cycles } in &swings.cells {
        let from_to = |(from, to): (f64, f64)| format!("{} … {}", short(from), short(to));
        line("", &format!("{:>17} × {:<15} {half_cycles:>8}", from_to(*amplitude_v), from_to(*frequency_hz)));
    }
}

/// A number of four significant digits.
fn short(x: f64) -> String {
    let text = format!("{x:.3e}");
    match text.parse::<f64>() {
        Ok(x) if x == 0.0 || (1e-4..1e6).contains(&x.abs()) => format!("{x}"),
        _ => text,
    }
}
