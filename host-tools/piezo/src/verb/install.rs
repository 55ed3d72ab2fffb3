//! `piezo install`: a table with the board's calibration into the device, in use, and compared with the host bit for bit.

use super::device::{self, note_damage};
use super::print::{out, progress};
use crate::option::BoardOption;
use crate::option::link::{Interrupting, PortOption};
use ::calibration::{CalibrationOptions, converter_mismatches};
use anyhow::Result;
use bench::{BoardFacts, NO_MODEL, OtherRange, for_board, install, may_take, rehearsal, wire_not_found};
use clap::Args;
use device_link::board;
use device_link::interrupt::Interrupt;
use device_link::table::to_record;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo install`.
#[derive(Args, Debug)]
pub struct Install {
    /// The table: table.toml, or the folder that `piezo identify` wrote.
    #[arg(required_unless_present = "line")]
    pub table: Option<PathBuf>,
    /// Install no actuator's table but a straight line, by which a board can be driven that knows no model yet (piezo train).
    #[arg(long, conflicts_with = "table")]
    pub line: bool,
    /// The DAC is unplugged, or plugged where it belongs by the new table: by the one it drives the amplifier, by the other it
    /// shows the displacement; or it drives it from another rest, to which it jumps.
    #[arg(long)]
    pub rewired: bool,
    /// Check everything and write nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// The table's doubts were just said, by the part of learn before.
    #[arg(skip)]
    pub of_learn: bool,
    /// The file that says what the board's wires stand for.
    #[command(flatten)]
    pub board: BoardOption,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

/// Runs the verb; `false` when host and device differ in any bit.
pub fn run(arguments: &Install) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let stated = arguments.table.as_deref().map(|path| for_board(path, &arguments.board.board)).transpose()?;
    let (mut client, identity) = arguments.port.connect()?;
    let facts = BoardFacts::read(&arguments.board.board)?;
    arguments.board.of_board(&facts, &identity)?;
    let (name, table, mut doubts) = match stated {
        Some(stated) => stated,
        None => {
            ("a straight line".into(), *arguments.board.wiring(identity.tick_us)?.line(), vec![NO_MODEL.to_owned()])
        }
    };
    remedy::calibrated(&mut doubts, &facts.calibration(&CalibrationOptions::default()));
    doubts.extend(wire_not_found(&table));
    device::fits(&board::of(&identity)?, &table, &name)?;
    converter_mismatches(&table)
        .iter()
        .for_each(|mismatch| eprintln!("piezo: careful: {}", remedy::mismatch(mismatch)));
    let other = facts.range_v().filter(|_| !arguments.line).and_then(|board| OtherRange::of(&table, board));
    let other = other.as_ref().map(remedy::other_range);
    remedy::narrow(&table).iter().chain(&other).for_each(|careful| eprintln!("piezo: careful: {careful}"));
    arguments.interrupting.consent(&mut client, arguments.dry_run)?;
    let checksum = device::checksum(&to_record(&table));
    if arguments.dry_run {
        may_take(&mut client, &table, arguments.rewired)?;
        let written = json!({ "table": name, "checksum": checksum, "written": false, "doubts": doubts });
        out(&match arguments.json {
            true => serde_json::to_string_pretty(&written)?,
            false => device::fits_unwritten(&name, &table, &identity),
        });
        careful(&doubts, arguments);
        return Ok(true);
    }
    let codes = rehearsal(&table)?;
    let bar = progress(codes.len() as u64);
    let compared = install(&mut client, &table, arguments.rewired, &codes, &interrupt, &mut |ticks| {
        bar.set_position(ticks as u64);
    });
    bar.finish_and_clear();
    note_damage(&client);
    let compared = compared?;
    if arguments.json {
        out(&serde_json::to_string_pretty(&json!({
            "table": name, "checksum": checksum, "bit_exact": compared.bit_exact(), "compared": compared, "doubts": doubts,
        }))?);
        return Ok(compared.bit_exact());
    }
    out(&format!("{} is stored, and in use on the board ({})", device::called(&name, &table), identity.board));
    if table.drive.and_then(|drive| drive.setpoint).is_some_and(|setpoint| setpoint.at_start) {
        out("it follows its set-point from its next start on; at once: piezo linearise");
    }
    careful(&doubts, arguments);
    out(&match compared.bit_exact() {
        true => {
            format!("bit-exact: over {} ticks of a random voltage the device's every bit is the host's", compared.ticks)
        }
        false => format!(
            "FAILED: {} of {} ticks differ, by at most {:e} µm: are the firmware and this program built from the same sources?",
            compared.ticks - compared.identical,
            compared.ticks,
            compared.max_difference_um
        ),
    });
    Ok(compared.bit_exact())
}

/// What to be careful about, for people.
fn careful(doubts: &[String], arguments: &Install) {
    let said = !arguments.json && !arguments.of_learn;
    doubts.iter().filter(|_| said).for_each(|doubt| out(&format!("- careful: {doubt}")));
}
