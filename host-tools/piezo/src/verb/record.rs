//! `piezo record`: the device's samples as a log.

use super::device::{note_damage, require_estimating};
use super::print::out;
use crate::option::link::PortOption;
use crate::option::{Overwrite, count, not_negative};
use anyhow::{Result, bail, ensure};
use bench::BoardFacts;
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::recording::{End, Recording, RecordingRequest, record};
use device_link::sensor::Sensor;
use device_link::{table, words};
use indicatif::ProgressBar;
use protocol::Faults;
use serde_json::json;
use std::io::BufWriter;
use std::path::PathBuf;

/// Arguments of `piezo record`.
#[derive(Args, Debug)]
pub struct Record {
    /// The log, as CSV.
    #[arg(long)]
    pub out: PathBuf,
    /// Length, s; without it and --samples until Ctrl-C.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true, conflicts_with = "samples")]
    pub seconds: Option<f64>,
    /// Length of the recording, ticks.
    #[arg(long, value_parser = |text: &str| count::<u64>(text, "; leave it out to go on until Ctrl-C"), allow_negative_numbers = true)]
    pub samples: Option<u64>,
    /// Go on when samples are lost. The time column then leaps; of such a log identify leaves out what is
    /// missing with --repair.
    #[arg(long)]
    pub allow_gaps: bool,
    /// Print what was recorded as JSON.
    #[arg(long)]
    pub json: bool,
    /// What the board's wires stand for: a board.toml. Where it says a sensor_span, the sensor is recorded, too.
    #[arg(long, value_name = "FILE")]
    pub board: Option<PathBuf>,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` when the recording ended before its time. What was recorded by then is kept.
pub fn run(arguments: &Record) -> Result<bool> {
    let mut file = arguments.overwrite.growing(&arguments.out, &[])?;
    let interrupt = Interrupt::watch()?;
    let facts = arguments.board.as_deref().map(BoardFacts::read).transpose()?;
    let (mut client, identity) = arguments.port.connect()?;
    let health = client.health()?;
    require_estimating(&health, &arguments.port.port)?;
    let tick_us = identity.tick_us;
    let ticks = arguments.samples.or(arguments.seconds.map(|s| (s * 1e6 / f64::from(tick_us)).round() as u64));
    ensure!(ticks != Some(0), "--seconds is less than one tick of {tick_us} µs");
    if let (Some(path), Some(Err(other))) = (&arguments.board, facts.map(|facts| facts.of_board(&identity))) {
        eprintln!("piezo: careful: {}: {other}: the sensor's µm are by its span", path.display());
    }
    let span = facts.and_then(|facts| facts.sensor_span);
    let sensor = span.map(|(zero_um, full_um)| Sensor { zero_um, full_um, full_scale: identity.adc_full_scale });
    let table = table::running(&mut client)?;
    let request = RecordingRequest { calibration: table.adc, sensor, tick_us, ticks, allow_gaps: arguments.allow_gaps };
    client.stream(true)?;
    let bar = ticks.map_or_else(ProgressBar::new_spinner, super::print::progress);
    let recorded = record(&mut client, &request, &mut BufWriter::new(&mut file), |recording| {
        bar.set_message(format!("{:.1} s", seconds(recording, tick_us)));
        bar.set_position(recording.ticks);
        interrupt.wanted()
    });
    bar.finish_and_clear();
    // A device that no longer answers must not cost what it has already given.
    let stopped = match &recorded {
        Ok((_, End::Link(_))) => Ok(()),
        _ => client.stream(false),
    };
    note_damage(&client);
    let (recording, end) = match recorded {
        Ok(recorded) => recorded,
        Err(error) => bail!("{}", remedy::cut_short(&arguments.out, file, &error)),
    };
    if recording.rows > 0 {
        arguments.overwrite.grown(&arguments.out, file)?;
    }
    let rests = table.drive.is_some() && words::rests(health.mode, recording.faults);
    tell(arguments, &recording, &end, (tick_us, request.sensor.is_some(), rests, ticks))?;
    let complete = conclude(arguments, &recording, end, ticks)?;
    if complete {
        stopped?;
    }
    Ok(complete)
}

fn seconds(recording: &Recording, tick_us: u32) -> f64 {
    recording.ticks as f64 * f64::from(tick_us) * 1e-6
}

fn tell(
    arguments: &Record,
    recording: &Recording,
    end: &End,
    (tick_us, sensor, rests, ticks): (u32, bool, bool, Option<u64>),
) -> Result<()> {
    if arguments.json {
        let summary = json!({
            "out": (recording.rows > 0).then_some(&arguments.out),
            "samples": recording.rows,
            "seconds": seconds(recording, tick_us),
            "every": recording.every,
            "lost": recording.lost,
            "late": recording.late,
            "status": recording.status.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "faults": recording.faults.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "complete": matches!(end, End::Complete) && recording.lasted(ticks),
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(());
    }
    if recording.rows == 0 {
        return Ok(());
    }
    let every = recording.every.map_or(1, |every| every.get().into());
    out(&format!(
        "{}  {} samples, {:.3} s at {} Hz{}; the displacement is the {}",
        arguments.out.display(),
        recording.rows,
        seconds(recording, tick_us),
        1_000_000 / (tick_us * every).max(1),
        if every == 1 { String::new() } else { format!(", one of {every} ticks") },
        if sensor { "sensor's" } else { "device's estimate, no sensor's" }
    ));
    if recording.lost > 0 {
        out(&format!(
            "{} samples are missing: time leaps there; with --repair, identify, compare and validate leave them out where they are no more than a tenth",
            recording.lost
        ));
    }
    if recording.late > 0 {
        out(&format!("on {} ticks the device was late", recording.late));
    }
    if rests {
        out(words::AT_REST);
    }
    let faults = if rests { Faults::empty() } else { recording.faults };
    let meanings = remedy::status(recording.status).chain(remedy::faults(faults));
    meanings.for_each(|meaning| out(&format!("- {}\n  → {}", meaning.what, meaning.remedy)));
    Ok(())
}

/// Success, or what ended the recording before its time, that of so many ticks.
fn conclude(arguments: &Record, recording: &Recording, end: End, ticks: Option<u64>) -> Result<bool> {
    let before = match recording.rows {
        0 => "nothing was recorded before".to_owned(),
        rows => format!("{} holds the {rows} samples before", arguments.out.display()),
    };
    let why = match end {
        End::Complete if recording.rows > 0 && recording.lasted(ticks) => return Ok(true),
        End::Complete if recording.rows > 0 => format!("interrupted: {before}"),
        End::Complete => bail!("ended before the first sample: {} is not written", arguments.out.display()),
        End::Gap { samples } => format!(
            "{samples} samples were lost: {before}. Is the cable sound, and this machine not too busy? --allow-gaps goes \
             on; of such a log, identify, compare and validate leave out what is missing, a tenth at most (--repair)"
        ),
        End::Restarted => format!("the device was restarted, or its mode set: {before}"),
        End::NoSensor => bail!("the device reads no sensor: leave --board out to record its estimate alone"),
        End::Silence => format!("the device sends no samples any more: {before}. Look at it with `piezo info`"),
        End::Link(error) => return Err(anyhow::Error::from(error).context(before)),
    };
    eprintln!("piezo: {why}");
    Ok(false)
}
