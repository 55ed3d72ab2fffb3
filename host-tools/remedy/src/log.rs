//! What is wrong with a log or with how it is prepared.

use super::paste::{self, verb};
use recordings::log::{Fault, LogError, Quantity, Unit};
use recordings::prepare::PrepareError;
use result_files::Replacement;
use std::error::Error;
use std::io;
use std::path::Path;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(LogError { path, place, fault: found }) = error.downcast_ref() {
        return Some(format!("{}{place}: {}", path.display(), fault(found, path)));
    }
    error.downcast_ref().map(prepare)
}

/// The option of the sample rate, with a place for the number that only the user knows.
const FS: &str = "--fs";
const SENSOR: (&str, &str) = ("--sensor", "<N>um/V");

fn fault(fault: &Fault, path: &Path) -> String {
    let with = |options: &[(&str, &str)]| paste::with(path, options);
    // What was stated already is not asked for again.
    let stated = paste::value(FS);
    let rate: (&str, &str) = (FS, stated.as_deref().unwrap_or("<HZ>"));
    let line = |example: &str, rate_needed: bool| match rate_needed {
        true => with(&[("--columns", example), rate]),
        false => with(&[("--columns", example)]),
    };
    let columns = |example: &str| with(&[("--columns", example)]);
    // Nobody has recorded what is wanted.
    let planned = ["waveform", "follow", "feedforward"].into_iter().any(verb);
    let repairs = ["identify", "compare", "validate", "estimate", "look"].into_iter().any(verb);
    let repaired = || match verb("look") {
        true => " (identify --repair)".to_owned(),
        false => paste::with_flag("--repair"),
    };
    let of = match (verb("validate"), verb("estimate")) {
        (true, _) => "errors",
        (_, true) => "estimates",
        _ => "learning",
    };
    match fault {
        Fault::SampleRate(rate) => {
            format!("{rate} Hz is not a sample rate: state what the recorder was set to, in Hz, by --fs <HZ>")
        }
        Fault::NoHeader { example, rate_needed, .. } => {
            format!(
                "{fault}: say which is which; if the first ones are meant in these units{}",
                line(example, *rate_needed)
            )
        }
        Fault::NoTime { .. } => format!(
            "{fault}: state the sample rate that the recorder was set to, in Hz, or add time=N:s to --columns{}",
            with(&[rate])
        ),
        Fault::NoColumn { quantity, example, with_sensor, rate_needed, .. } => {
            let alone = match *quantity == Quantity::Displacement && !planned {
                true => format!(
                    "\nof a voltage without a sensor nothing can be learnt; by a table that was learnt, its displacement is estimated\n    \
                     piezo estimate '<TABLE>' {}{}",
                    paste::log(&path.to_string_lossy()),
                    ["--columns", FS, "--voltage-scale"].map(paste::typed).concat()
                ),
                false => String::new(),
            };
            let in_volts = with_sensor.as_ref().map(|example| {
                line(example, *rate_needed)
            });
            let line = line(example, *rate_needed);
            let open = if example.contains('<') { ", with its number and its unit in the brackets' place" } else { "" };
            if let Some(in_volts) = in_volts {
                return format!("{fault}: name it; if it is a sensor's output in volts, with its scale for <N>{in_volts}\nor, if these are meant{open}{line}{alone}");
            }
            format!("{fault}: name it; if these are meant{open}{line}{alone}")
        }
        Fault::Ambiguous { example, .. } => {
            let scale =
                if example.contains('<') { " (for <N> the sensor's scale: how many µm a volt is)" } else { "" };
            format!("{fault}: say which is which; if these are meant{scale}{}", columns(example))
        }
        Fault::NoSensitivity { .. } => {
            format!("{fault}: state it, with the sensor's number for <N>{}", with(&[SENSOR]))
        }
        Fault::SensitivityOfLength { .. } => format!("{fault}: leave the scale out, of --sensor or --columns"),
        Fault::RateContradicted { .. } => format!("{fault}: leave --fs out; if the file is wrong, correct it there"),
        Fault::TwoClaims { example, .. } => format!("{fault}: choose one, as in{}", columns(example)),
        Fault::MissingUnit { example, with_sensor: Some(in_volts), .. } => format!(
            "{fault}: state it; if the displacement is a sensor's output in volts, with its scale for <N>{}\nor, if these units are right{}",
            columns(in_volts),
            columns(example)
        ),
        Fault::MissingUnit { example, .. } => {
            format!("{fault}: state it; if these units are right{}", columns(example))
        }
        Fault::UnknownUnit { example, .. } => format!("{fault}; or state the unit, as in{}", columns(example)),
        Fault::WrongDimension { quantity: Quantity::Displacement, unit: Unit::Volt | Unit::Millivolt, .. } => {
            format!("{fault}: if it is a displacement sensor's output, state its scale{}", with(&[SENSOR]))
        }
        Fault::WrongDimension { example, .. } => {
            format!(
                "{fault}: where the header has the columns exchanged, or a wrong unit, correct it in the file; where it is right, the columns are{}",
                columns(example)
            )
        }
        Fault::NoSuchColumn { wanted, columns } => {
            format!("--columns asks for column {wanted} and the columns are {columns}: choose among these")
        }
        Fault::NotANumber { quantity, .. } | Fault::NotFinite { quantity, .. } | Fault::MissingField { quantity }
            if repairs && *quantity != Quantity::Time =>
        {
            let what = fault.to_string();
            let what = what.split_once(": ").map_or(&*what, |(what, _)| what);
            format!("{what}: correct it, or leave what is no number out of the {of}{}", repaired())
        }
        Fault::IrregularTime { example, value, percent, period } if planned => format!(
            "irregular time (t = {value} s is {percent} % of a sample period of {period} s off its place): resample it to points equally far \
             apart; if they are in truth, leave the time column out and state their rate{}",
            line(example, true)
        ),
        Fault::Gap { missing, after, gaps, .. } if planned => format!(
            "{missing} points are missing after t = {after} s (gaps in all: {gaps}): resample it to points equally far apart"
        ),
        Fault::Gap { missing, after, gaps, few: true } if repairs => format!(
            "{missing} samples are missing after t = {after} s (gaps in all: {gaps}): record again, keep the part before or after, or take \
             the voltage to go straight on over them and leave them out of the {of}{}",
            repaired()
        ),
        Fault::IrregularTime { example, .. } => format!("{fault}{}", line(example, true)),
        Fault::ImplausiblePeriod { example, .. } => {
            format!("{fault}: if it is another, state it, as in{}", columns(example))
        }
        Fault::RateDisagrees { stated, found, unit, .. } => format!(
            "--fs {stated} disagrees with the time column ({found} Hz, taken to be in {unit}): leave --fs out, or state the \
             column's unit in --columns as well{}",
            with(&[("--fs", "")])
        ),
        Fault::Constant { example, .. } => {
            format!("{fault}: choose another column than in{}\nor record a moving actuator", columns(example))
        }
        Fault::ImplausibleSpan { example, .. } => {
            format!("{fault}: if that is wrong, state its unit, as in{}", columns(example))
        }
        Fault::FewRows { rows: 0, .. } => {
            "holds no rows of numbers: it must be a table of a row a line, with comma, semicolon, tab or spaces between its \
             fields"
                .to_owned()
        }
        fault => fault.to_string(),
    }
}

/// A log that cannot be brought to the tick.
pub fn prepare(error: &PrepareError) -> String {
    match error {
        PrepareError::TooShort { log, left, need } => format!(
            "{log}: only {left} measured samples are left at the tick, after what --skip-start, --skip-end, --hold-out, \
             decimation and --delay take; at least {need} are needed (is the sample rate right?)"
        ),
        PrepareError::NotAMultiple { log, log_hz, tick_hz } => format!(
            "{log}: {log_hz} Hz is no multiple of the tick rate, {tick_hz} Hz: use --decimate every, or another --tick-us"
        ),
        PrepareError::TooLong { log, ticks, tick_us, most } => format!(
            "{log}: {ticks:.0} ticks of {tick_us} µs, more than {most:.0}: is the sample rate right? Else use a longer \
             --tick-us"
        ),
        PrepareError::NoDisplacement { .. } => error.to_string(),
    }
}

/// A log that can be written no further, for this error: the lines that are whole are kept, and it is said where.
pub fn cut_short(path: &Path, file: Replacement, error: &io::Error) -> String {
    let kept = match file.keep_lines() {
        Ok(kept) => kept.map_or(String::new(), |kept| format!("; {} holds the samples before", kept.display())),
        Err(uncut) => format!("; {uncut}"),
    };
    format!("{}: cannot be written: {error}{kept}", path.display())
}

/// What is said of a recording in a result's place.
pub fn kept(path: &Path) -> String {
    format!(
        "{}: is there already, and no measurement is written over: name another with --out, or lose it with --force",
        path.display()
    )
}

/// What is to be said of a trajectory whose displacement nobody wanted, but some device has estimated.
pub fn of_an_estimate(path: &Path) -> String {
    format!(
        "{}: its displacement is what a device has estimated, errors and all, and not what was wanted: of a log of `piezo follow`, \
         --columns displacement=wanted_um takes that; of any \
         other log, --columns displacement=<NAME> the column that is meant",
        path.display()
    )
}
