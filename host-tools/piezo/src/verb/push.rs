//! `piezo push`: a table into the device's parameter store.

use super::device::{self, note_damage};
use super::print::out;
use crate::option::link::{Doubted, PortOption, WriteOptions};
use ::calibration::converter_mismatches;
use anyhow::{Result, ensure};
use clap::Args;
use device_link::board;
use device_link::table::to_record;
use device_link::words;
use protocol::TableSource;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo push`.
#[derive(Args, Debug)]
pub struct Push {
    /// The table: table.toml or its folder, or the record in table.bin.
    pub table: PathBuf,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of a table that has doubts.
    #[command(flatten)]
    pub doubts: Doubted,
    /// When it may be written.
    #[command(flatten)]
    pub write: WriteOptions,
}

/// Runs the verb.
pub fn run(arguments: &Push) -> Result<bool> {
    let (table, doubts) = table_files::read_doubted(&arguments.table)?;
    let record = to_record(&table);
    let (mut client, identity) = arguments.port.connect()?;
    device::fits(&board::of(&identity)?, &table, &arguments.table)?;
    converter_mismatches(&table)
        .iter()
        .for_each(|mismatch| eprintln!("piezo: careful: {}", remedy::mismatch(mismatch)));
    let doubted = device::doubted(&arguments.table, &doubts, arguments.doubts.doubted, arguments.write.dry_run)?;
    doubted.ask(|| arguments.write.hindered(&mut client, &table))?;
    let (restarted, mut refused) =
        arguments.write.write(&mut client, Some(&table), |client, consent| client.push(record.clone(), consent))?;
    refused.extend(doubted.refused());
    if let Some(identity) = &restarted {
        ensure!(
            identity.source == TableSource::Stored,
            "the device has not taken what it stored; its table is now {}",
            words::source(&identity.source)
        );
        ensure!(
            client.pull()? == record,
            "after its restart the device runs another table than was pushed: push again"
        );
    }
    note_damage(&client);
    let called = bench::called(&arguments.table, &table);
    if arguments.json {
        out(&serde_json::to_string_pretty(&json!({
            "table": arguments.table,
            "model": table.model(),
            "checksum": device::checksum(&record),
            "written": !arguments.write.dry_run,
            "in_use": restarted.is_some(),
            "doubts": doubts,
            "refused": refused,
        }))?);
    } else if arguments.write.dry_run {
        out(&device::fits_unwritten(&arguments.table, &table, &identity, &refused));
    } else if restarted.is_some() {
        out(&format!("{called} is stored, and in use on the board ({})", identity.board));
    } else {
        out(&format!("{called} is stored on {}", identity.board));
        out(&format!("It is used from the next reset on: piezo reset --port {}", arguments.port.port));
    }
    Ok(refused.is_empty())
}
