//! `piezo install`: a table with the board's calibration into the device, in use, and compared with the host
//! bit for bit.

use super::device::{self, note_damage};
use super::print::{out, progress};
use crate::option::BoardOption;
use crate::option::link::{Doubted, Interrupting, PortOption, careful};
use ::calibration::drive::ordered;
use ::calibration::span::Span;
use ::calibration::{CalibrationOptions, converter_mismatches};
use anyhow::{Result, bail};
use bench::{NO_MODEL, OtherRange, converters_fit, for_board, install, refusals, rehearsal, wire_not_found};
use clap::Args;
use device_link::board;
use device_link::busy::idle_as_started;
use device_link::interrupt::Interrupt;
use device_link::pil::Comparison;
use device_link::table::to_record;
use estimator_core::Admitted;
use protocol::Identity;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo install`.
#[derive(Args, Debug)]
pub struct Install {
    /// The table: table.toml, or the folder that `piezo identify` wrote.
    #[arg(required_unless_present = "line")]
    pub table: Option<PathBuf>,
    /// Install no actuator's table but a straight line, by which a board can be driven that knows no model
    /// yet (piezo train).
    #[arg(long, conflicts_with = "table")]
    pub line: bool,
    /// The DAC is unplugged, or plugged where it belongs by the new table: by the one it drives the amplifier, by the
    /// other it shows the displacement; or it drives it from another rest, to which it jumps.
    #[arg(long)]
    pub rewired: bool,
    /// Install a table, too, that was learnt on less than a tenth of what the board's ADC reads.
    #[arg(long)]
    pub narrow: bool,
    /// Check everything and write nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// The table's doubts were just said, by the part of learn before.
    #[arg(skip)]
    pub of_learn: bool,
    /// The voltages that learn was told, V: they count instead of board.toml's.
    #[arg(skip)]
    pub range: Option<Span>,
    /// The file that says what the board's wires stand for.
    #[command(flatten)]
    pub board: BoardOption,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of a table that has doubts.
    #[command(flatten)]
    pub doubts: Doubted,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

/// Runs the verb; `false` when host and device differ in any bit.
pub fn run(arguments: &Install) -> Result<bool> {
    let stated = arguments.table.as_deref().map(|path| for_board(path, &arguments.board.board)).transpose()?;
    let (mut client, identity, facts) = arguments.board.connect(&arguments.port)?;
    let (name, table, mut doubts) = match stated {
        Some(stated) => stated,
        None => {
            let wiring = arguments.board.wiring(&facts, identity.tick_us)?;
            ("a straight line".into(), *wiring.line(), vec![NO_MODEL.to_owned()])
        }
    };
    remedy::calibrated(&mut doubts, &facts.calibration(&CalibrationOptions::default()));
    converters_fit(&table, &identity)?;
    device::fits(&board::of(&identity)?, &table, &name)?;
    converter_mismatches(&table)
        .iter()
        .for_each(|mismatch| eprintln!("piezo: careful: {}", remedy::mismatch(mismatch)));
    let driven = arguments.range.map(ordered).or(facts.range_v()).filter(|_| !arguments.line);
    let other = driven.and_then(|driven| OtherRange::of(&table, driven));
    doubts.extend(other.as_ref().filter(|of| of.common().is_none()).map(remedy::other_range));
    let other = other.as_ref().filter(|of| of.common().is_some()).map(remedy::other_range);
    let narrow = remedy::narrow(&table).filter(|_| !arguments.line);
    let may = arguments.narrow || arguments.of_learn;
    if let Some(narrow) = narrow.as_ref().filter(|_| !may && !arguments.dry_run) {
        bail!("{}: {narrow}", name.display());
    }
    let of_wire = wire_not_found(&table).filter(|_| !arguments.of_learn);
    narrow.iter().chain(&other).chain(&of_wire).for_each(|careful| eprintln!("piezo: careful: {careful}"));
    // The straight line was asked for by name, and what learn's part before has just said is not said again.
    let may_doubt = arguments.doubts.doubted || arguments.line;
    let doubted = device::doubted(&name, if arguments.of_learn { &[] } else { &doubts }, may_doubt, arguments.dry_run)?;
    doubts.extend(of_wire);
    let busy = match arguments.of_learn {
        // Its session found the device idle, and left it as it starts.
        true => idle_as_started(&mut client).map(|()| None)?,
        false => arguments.interrupting.consent(&mut client, arguments.dry_run)?,
    };
    if arguments.dry_run {
        let refusals = refusals(&mut client, &table, arguments.rewired)?;
        let refusals = refusals.iter().map(|refusal| careful(refusal));
        let refused: Vec<String> =
            narrow.filter(|_| !may).into_iter().chain(busy).chain(refusals).chain(doubted.refused()).collect();
        tell(arguments, &(&name, &table, &doubts), &identity, Err(&refused))?;
        return Ok(refused.is_empty());
    }
    // A jump, which the last of them may be, is what is said of a table that the device would take.
    doubted.ask(|| {
        refusals(&mut client, &table, arguments.rewired)?.pop().map_or(Ok(()), |refusal| Err(refusal.into()))
    })?;
    // Not before that question, which Ctrl-C ends.
    let interrupt = Interrupt::watch()?;
    let codes = rehearsal(&table)?;
    let bar = progress(codes.len() as u64);
    let compared = install(&mut client, &table, arguments.rewired, &codes, &interrupt, &mut |ticks| {
        bar.set_position(ticks as u64);
    });
    bar.finish_and_clear();
    note_damage(&client);
    let compared = compared?;
    tell(arguments, &(&name, &table, &doubts), &identity, Ok(&compared))?;
    Ok(compared.bit_exact())
}

/// What was installed, or only looked at with what would be refused: its file, the table, and what to be careful about.
fn tell(
    arguments: &Install,
    (name, table, doubts): &(&PathBuf, &Admitted, &Vec<String>),
    identity: &Identity,
    done: Result<&Comparison, &[String]>,
) -> Result<()> {
    let compared = done.ok();
    if arguments.json {
        out(&serde_json::to_string_pretty(&json!({
            "table": name, "checksum": device::checksum(&to_record(table)), "written": compared.is_some(),
            "bit_exact": compared.map(Comparison::bit_exact), "compared": compared, "doubts": doubts,
            "refused": done.err().unwrap_or_default(),
        }))?);
        return Ok(());
    }
    out(&match done {
        Ok(_) => format!("{} is stored, and in use on the board ({})", bench::called(name, table), identity.board),
        Err(refused) => device::fits_unwritten(name, table, identity, refused),
    });
    let at_start = table.drive.and_then(|drive| drive.setpoint).is_some_and(|setpoint| setpoint.at_start);
    if at_start && compared.is_some() {
        out("it follows its set-point from its next start on; at once: piezo linearise");
    }
    compared.iter().for_each(|compared| out(&remedy::rehearsed(compared)));
    Ok(())
}
