//! `piezo reset`: restarts the device.

use super::device;
use super::print::out;
use crate::option::link::PortOption;
use anyhow::Result;
use clap::Args;
use device_link::{table, words};
use serde_json::json;

/// Arguments of `piezo reset`.
#[derive(Args, Debug)]
pub struct Reset {
    /// Print the table that it now runs as JSON.
    #[arg(long)]
    pub json: bool,
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
}

/// Runs the verb.
pub fn run(arguments: &Reset) -> Result<bool> {
    let (mut client, _) = arguments.port.connect()?;
    let identity = client.restart()?;
    let checksum = table::in_use(&mut client)?.map(|record| device::checksum(&record));
    if arguments.json {
        let summary = json!({ "source": identity.source, "model": identity.model, "checksum": checksum });
        out(&serde_json::to_string_pretty(&summary)?);
    } else {
        let which = checksum.map_or(String::new(), |checksum| format!(" (checksum {checksum})"));
        out(&format!("{} is back; its table{which} is {}", identity.board, words::source(&identity.source)));
    }
    Ok(true)
}
