//! `piezo info`: who the device is, which table it runs, how it is, and what to do about it.

use super::device::checksum;
use super::print::out;
use crate::option::link::PortOption;
use anyhow::Result;
use clap::Args;
use device_link::table;
use estimator_core::Table;
use protocol::{Faults, VERSION};
use remedy::Known;
use serde_json::{Value, json};

/// Arguments of `piezo info`.
#[derive(Args, Debug)]
pub struct Info {
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
    /// Afterwards have the device forget its counts, the faults seen, and the last words.
    #[arg(long)]
    pub forget: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
}

/// Runs the verb.
pub fn run(arguments: &Info) -> Result<bool> {
    let (mut client, identity) = arguments.port.connect()?;
    let table = table::in_use(&mut client)?.map(|record| (Table::parse(&record), checksum(&record)));
    let health = client.health()?;
    if arguments.forget {
        client.forget()?;
    }
    let found = Known { identity, health, table, damaged: client.damaged() };
    if arguments.json {
        out(&serde_json::to_string_pretty(&to_json(&found)?)?);
    } else {
        remedy::state(&found).iter().for_each(|line| out(line));
    }
    Ok(true)
}

fn to_json(found: &Known) -> Result<Value> {
    let Known { identity, health, table, damaged } = found;
    let names = |faults: Faults| faults.iter_names().map(|(name, _)| name).collect::<Vec<_>>();
    let mut state = serde_json::to_value(health)?;
    state["faults"] = json!(names(health.faults));
    state["faults_seen"] = json!(names(health.faults_seen));
    state["reset"] = json!(health.reset.iter_names().map(|(name, _)| name).collect::<Vec<_>>());
    Ok(json!({
        "protocol": VERSION,
        "identity": identity,
        "checksum": table.as_ref().map(|(_, checksum)| checksum),
        "table": table.as_ref().and_then(|(table, _)| table.as_ref().ok()).map(|table| **table),
        "health": state,
        "damaged_frames": damaged,
    }))
}
