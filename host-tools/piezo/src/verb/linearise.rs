//! `piezo linearise`: the device drives the amplifier to where a controller's set-point wants the displacement, and
//! goes on without a host; `--stop` brings it back to rest.

use super::device::checksum;
use super::print::out;
use crate::option::link::PortOption;
use anyhow::{Context, Result, ensure};
use bench::set_out;
use clap::Args;
use device_link::{Client, table, words};
use estimator_core::{AdcCode, SetpointCalibration, Table};
use protocol::{Faults, Health, Mode};
use serde_json::json;

/// Arguments of `piezo linearise`.
#[derive(Args, Debug)]
pub struct Linearise {
    /// Leave it: the voltage goes to rest at the drive's slew rate, and the device estimates.
    #[arg(long)]
    pub stop: bool,
    /// Print the mode, the set-point and the faults as JSON.
    #[arg(long)]
    pub json: bool,
    /// Port of the device that is to follow its set-point.
    #[command(flatten)]
    pub port: PortOption,
}

/// Runs the verb; it succeeds where the device follows the set-point, or has left it.
pub fn run(arguments: &Linearise) -> Result<bool> {
    let port = &arguments.port.port;
    let (mut client, _) = arguments.port.connect()?;
    if arguments.stop {
        let mode = client.health()?.mode;
        ensure!(mode == Mode::Linearise, "{port}: the device {}: there is nothing to leave", words::mode(mode));
        client.set_mode(Mode::Estimate)?;
        let health = client.health()?;
        tell(arguments, &health, None, "leaves the set-point; its voltage goes to rest at the drive's slew rate")?;
        return Ok(true);
    }
    let health = set_out(&mut client)?;
    let setpoint = setpoint(&mut client)?;
    let follows = !health.faults.contains(Faults::SAFE_OUTPUT);
    let what = if follows {
        "follows the set-point, until `piezo linearise --stop`, a fault or a reset"
    } else {
        "waits at rest, or is on its way there: it follows the set-point once everything has been sound there for a second"
    };
    tell(arguments, &health, Some(setpoint), what)?;
    Ok(follows)
}

/// What the set-point's codes stand for by the table in use.
fn setpoint(client: &mut Client) -> Result<SetpointCalibration> {
    let record = table::in_use(client)?.context("the device has no table")?;
    let table = Table::parse(&record).with_context(|| format!("the device's table {}", checksum(&record)))?;
    table.drive.and_then(|drive| drive.setpoint).context("the device's table says nothing of a set-point")
}

fn tell(arguments: &Linearise, health: &Health, setpoint: Option<SetpointCalibration>, what: &str) -> Result<()> {
    let wanted = health.setpoint.zip(setpoint).map(|(code, of)| of.displacement::<f64>(AdcCode(code)));
    if arguments.json {
        let faults: Vec<&str> = health.faults.iter_names().map(|(name, _)| name).collect();
        let summary = json!({ "mode": health.mode, "setpoint_um": wanted, "faults": faults });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(());
    }
    let now = wanted.map_or(String::new(), |um| format!("; it wants {um:.3} µm now"));
    out(&format!("The device {what}{now}"));
    if setpoint.is_some() {
        for meaning in remedy::faults(health.faults - Faults::SAFE_OUTPUT) {
            out(&format!("- {}\n  → {}", meaning.what, meaning.remedy));
        }
    }
    Ok(())
}
