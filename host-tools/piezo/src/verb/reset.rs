//! `piezo reset`: restarts the device.

use super::device;
use super::print::out;
use crate::option::link::{Interrupting, PortOption};
use anyhow::Result;
use clap::Args;
use device_link::{table, words};
use serde_json::json;

/// Arguments of `piezo reset`.
#[derive(Args, Debug)]
pub struct Reset {
    /// Say what is in the way, and restart nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print the table that it now runs as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

/// Runs the verb.
pub fn run(arguments: &Reset) -> Result<bool> {
    let (mut client, found) = arguments.port.connect()?;
    let refused: Vec<String> = arguments.interrupting.consent(&mut client, arguments.dry_run)?.into_iter().collect();
    let identity = if arguments.dry_run { found } else { client.restart()? };
    let checksum = table::in_use(&mut client)?.map(|record| device::checksum(&record));
    if arguments.json {
        let (source, model) = (&identity.source, &identity.model);
        out(&serde_json::to_string_pretty(&json!({
            "restarted": !arguments.dry_run, "source": source, "model": model, "checksum": checksum, "refused": refused,
        }))?);
    } else {
        let which = checksum.map_or(String::new(), |checksum| format!(" (checksum {checksum})"));
        let is = match arguments.dry_run {
            true if !refused.is_empty() => "was not restarted, and would not be",
            true => "was not restarted",
            false => "is back",
        };
        out(&format!("{} {is}; its table{which} is {}", identity.board, words::source(&identity.source)));
    }
    Ok(refused.is_empty())
}
