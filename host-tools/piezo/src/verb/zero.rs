//! `piezo zero`: calls the displacement of now 0, as at rest.

use super::device::{note_damage, require_estimating};
use super::print::out;
use crate::option::link::PortOption;
use anyhow::{Result, anyhow};
use clap::Args;
use device_link::table;
use device_link::{Client, LinkError};
use serde_json::json;
use std::time::Duration;

/// Arguments of `piezo zero`.
#[derive(Args, Debug)]
pub struct Zero {
    /// Print the displacement before and after as JSON.
    #[arg(long)]
    pub json: bool,
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
}

/// How long to wait for the samples that show it.
const PATIENCE: Duration = Duration::from_secs(1);

/// Runs the verb.
pub fn run(arguments: &Zero) -> Result<bool> {
    let port = &arguments.port.port;
    let (mut client, _) = arguments.port.connect()?;
    require_estimating(&client.health()?, port)?;
    table::running(&mut client)?;
    let before = displacement(&mut client)?;
    client.set_zero().map_err(|error| match error {
        LinkError::Unknown { .. } => {
            anyhow!("{error}: look with `piezo monitor --port {port}`, and zero again if need be")
        }
        error => error.into(),
    })?;
    let after = displacement(&mut client)?;
    note_damage(&client);
    if arguments.json {
        out(&serde_json::to_string_pretty(&json!({ "before_um": before, "after_um": after }))?);
    } else {
        let number = |um: Option<f32>| um.map_or("unknown".to_owned(), |um| format!("{um:.4} µm"));
        out(&format!("The displacement was {}; it was called 0, and now reads {}", number(before), number(after)));
        out("The zero lasts until the device is restarted or paused, runs pil, or has had a fault.");
    }
    Ok(true)
}

/// The displacement of now, µm.
fn displacement(client: &mut Client) -> Result<Option<f32>, LinkError> {
    client.stream(true)?;
    let samples = client.samples(PATIENCE)?;
    client.stream(false)?;
    Ok(samples.and_then(|samples| samples.samples.last().map(|sample| sample.displacement)))
}
