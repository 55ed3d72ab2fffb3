//! `piezo train`: a board beside a sensor → the logs that a table is identified from, and one to prove it with.

use super::device::note_damage;
use super::print::{out, progress};
use crate::option::link::PortOption;
use crate::option::{BoardOption, ExcitationArgs, Overwrite};
use crate::output;
use anyhow::{Context, Result, anyhow};
use bench::{BenchError, FORMER, NO_MODEL, Trained, Training, taught, train, unoccupied};
use clap::Args;
use device_link::interrupt::Interrupt;
use emulator::TICK_US;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo train`.
#[derive(Args, Debug)]
pub struct Train {
    /// Folder for the logs and session.toml.
    #[arg(long)]
    pub out: PathBuf,
    /// Length of the whole session, minutes.
    #[arg(long, default_value_t = 2.0, value_parser = crate::option::positive, allow_negative_numbers = true)]
    pub minutes: f64,
    /// Say what would be driven and what that would tell of an emulated actuator, and drive nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Write the voltages to this file, for any generator: time_s,voltage_V.
    #[arg(long, value_name = "FILE")]
    pub drive: Option<PathBuf>,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// What comes next is typed by learn.
    #[arg(skip)]
    pub of_learn: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// The file that says what the board's wires stand for.
    #[command(flatten)]
    pub board: BoardOption,
    /// What the voltages are to be like.
    #[command(flatten)]
    pub excitation: ExcitationArgs,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` where it ended before its time. What was recorded by then is kept.
pub fn run(arguments: &Train) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    unoccupied(&arguments.out)?;
    let device = if arguments.dry_run { None } else { Some(arguments.board.connect(&arguments.port)?) };
    let wiring = match &device {
        Some((_, identity, facts)) => arguments.board.wiring(facts, identity.tick_us)?,
        None => arguments.board.wiring(&arguments.board.facts()?, TICK_US)?,
    };
    let drive = arguments.excitation.drive(&wiring, 60.0 * arguments.minutes)?;
    if let Some(file) = &arguments.drive {
        arguments.overwrite.of(file, "time_s,voltage_V\n")?;
        output::write(file, drive.to_csv())?;
    }
    let said = [drive.covers(), drive.forbidden()].concat();
    if !arguments.json {
        said.iter().for_each(|line| out(&format!("- {line}")));
    }
    let Some((mut client, ..)) = device else {
        let taught = taught(&wiring, &drive).ok().and_then(Result::ok);
        if arguments.json {
            let would = json!({ "covers": said, "seconds": drive.duration_s(), "teaches": taught });
            out(&serde_json::to_string_pretty(&would)?);
        } else if let Some(taught) = taught {
            out(&format!("- {}", remedy::TAUGHT));
            remedy::taught(&taught).iter().for_each(|(what, error)| out(&format!("    {what:<46} {error}")));
        }
        return Ok(true);
    };
    let bar = progress((drive.duration_s() / wiring.line().sample_period::<f64>()) as u64);
    let training = Training { wiring: &wiring, drive: &drive, folder: &arguments.out, interrupt: &interrupt };
    let trained = train(&mut client, &training, &mut |segment, ticks| {
        bar.set_prefix(segment.name);
        bar.set_position(ticks as u64);
    });
    bar.finish_and_clear();
    note_damage(&client);
    let stranded = || remedy::stranded(&arguments.out, &arguments.port.port);
    let trained = trained.map_err(|error| match error {
        error @ BenchError::FormerKept { .. } => error.into(),
        error if arguments.out.join(FORMER).exists() => anyhow!(error).context(stranded()),
        error => error.into(),
    })?;
    tell(arguments, &trained)?;
    // It is said before what hinders the way home, which is what the user must know last.
    let complete = trained.complete();
    trained.home.with_context(stranded)?;
    Ok(complete)
}

fn tell(arguments: &Train, trained: &Trained) -> Result<()> {
    if arguments.json {
        let summary = json!({
            "logs": trained.logs,
            "complete": trained.complete(),
            "waited_ticks": trained.starved,
            "ended": trained.ended.as_ref().map(remedy::ended),
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(());
    }
    for log in &trained.logs {
        let cut = if log.complete { "" } else { "; cut short" };
        out(&format!("{}  {} samples, {}{cut}", log.log.display(), log.rows, log.what));
    }
    if trained.starved > 0 {
        out(&format!(
            "On {} ticks the device waited for this machine and held its voltage, as the logs show.",
            trained.starved
        ));
    }
    if trained.home.is_ok() {
        out(&match trained.lent {
            true => "The voltage is at rest, and the table of before is in use again.".to_owned(),
            false => format!("The voltage is at rest; the device has, as before, {NO_MODEL}."),
        });
    }
    match &trained.ended {
        Some(why) => {
            out(&format!("FAILED: it ended before its time: {}", remedy::ended(why)));
            remedy::kept_logs(&arguments.out).iter().for_each(|kept| out(kept));
        }
        None if arguments.of_learn => {}
        None => {
            let board = remedy::quoted(&arguments.board.board.display().to_string());
            out(&format!("Next:\n\n    {} --board {board}", remedy::identify(&arguments.out)));
        }
    }
    Ok(())
}
