//! `piezo pull`: the table that the device runs, as a binary record.

use super::device::{self, note_damage};
use super::print::out;
use crate::option::Overwrite;
use crate::option::link::PortOption;
use crate::output::{self, RECORD};
use anyhow::{Context, Result, ensure};
use bench::describe;
use clap::Args;
use estimator_core::Table;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `piezo pull`.
#[derive(Args, Debug)]
pub struct Pull {
    /// File for the record (table.bin), or - for standard output.
    #[arg(long)]
    pub out: PathBuf,
    /// Print the table as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Pull) -> Result<bool> {
    let to_standard_output = arguments.out == Path::new("-");
    ensure!(!(to_standard_output && arguments.json), "--out - and --json would both be printed: choose one");
    if !to_standard_output {
        arguments.overwrite.of(&arguments.out, RECORD.1)?;
    }
    let (mut client, identity) = arguments.port.connect()?;
    let record = client.pull()?;
    note_damage(&client);
    let table = Table::parse(&record).context("the device's table is refused here")?;
    if to_standard_output {
        output::standard(&record)?;
        return Ok(true);
    }
    output::write(&arguments.out, &record)?;
    let checksum = device::checksum(&record);
    if arguments.json {
        let summary =
            json!({ "written": arguments.out, "source": identity.source, "checksum": checksum, "table": *table });
        out(&serde_json::to_string_pretty(&summary)?);
    } else {
        out(&format!("{}  binary record of {} bytes, checksum {checksum}", arguments.out.display(), record.len()));
        describe(&table).iter().for_each(|line| out(line));
    }
    Ok(true)
}
