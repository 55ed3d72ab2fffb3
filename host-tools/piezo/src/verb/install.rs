//! `piezo install`: a table with the board's calibration into the device, in use, and compared with the host bit for bit.

use super::device::{self, note_damage};
use super::print::{out, progress};
use crate::option::BoardOption;
use crate::option::link::PortOption;
use ::calibration::converter_mismatches;
use anyhow::Result;
use bench::{BoardFacts, NO_MODEL, for_board, install, rehearsal, wire_not_found};
use clap::Args;
use device_link::board;
use device_link::interrupt::Interrupt;
use device_link::table::to_record;
use estimator_core::{Range, Table};
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
}

/// A table that knows less of the ADC's range is remarked on.
const NARROW: f32 = 0.1;

/// Runs the verb; `false` when host and device differ in any bit.
pub fn run(arguments: &Install) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let stated = arguments.table.as_deref().map(|path| for_board(path, &arguments.board.board)).transpose()?;
    let (mut client, identity) = arguments.port.connect()?;
    arguments.board.of_board(&BoardFacts::read(&arguments.board.board)?, &identity)?;
    let (name, table, mut doubts) = match stated {
        Some(stated) => stated,
        None => {
            ("a straight line".into(), *arguments.board.wiring(identity.tick_us)?.line(), vec![NO_MODEL.to_owned()])
        }
    };
    doubts.extend(wire_not_found(&table));
    device::fits(&board::of(&identity)?, &table, &name)?;
    converter_mismatches(&table)
        .iter()
        .for_each(|mismatch| eprintln!("piezo: careful: {}", remedy::mismatch(mismatch)));
    narrow(&table).iter().for_each(|careful| eprintln!("piezo: careful: {careful}"));
    let codes = rehearsal(&table)?;
    let bar = progress(codes.len() as u64);
    let compared = install(&mut client, &table, arguments.rewired, &codes, &interrupt, &mut |ticks| {
        bar.set_position(ticks as u64);
    });
    bar.finish_and_clear();
    note_damage(&client);
    let (checksum, compared) = (device::checksum(&to_record(&table)), compared?);
    if arguments.json {
        out(&serde_json::to_string_pretty(&json!({
            "table": name, "checksum": checksum, "bit_exact": compared.bit_exact(), "compared": compared, "doubts": doubts,
        }))?);
        return Ok(compared.bit_exact());
    }
    out(&format!(
        "{} ({}, checksum {checksum}) is stored, and in use on the board ({})",
        name.display(),
        table.model(),
        identity.board
    ));
    if table.drive.and_then(|drive| drive.setpoint).is_some_and(|setpoint| setpoint.at_start) {
        out("it follows its set-point from its next start on; at once: piezo linearise");
    }
    doubts.iter().filter(|_| !arguments.of_learn).for_each(|doubt| out(&format!("- careful: {doubt}")));
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

/// What is to be said of a table that knows hardly any of what the board's ADC reads: one that was learnt from an amplifier's input
/// knows volts that are its output's many times over.
fn narrow(table: &Table) -> Option<String> {
    let reads = table.adc.gain_v_per_code * f32::from(table.adc.full_scale);
    let Range { min, max } = table.voltage_range_v;
    let zero = table.voltage_zero_v;
    ((max - min) < NARROW * reads).then(|| {
        format!(
            "the table knows {:.3} … {:.3} V, {:.1} % of what the board's ADC reads: was it learnt from the amplifier's input? Then identify \
             with --voltage-scale, the amplifier's gain",
            min + zero,
            max + zero,
            100.0 * (max - min) / reads
        )
    })
}
