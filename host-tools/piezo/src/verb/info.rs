//! `piezo info`: who the device is, which table it runs, how it is, and what to do about it.

use super::device::checksum;
use super::print::out;
use crate::option::link::PortOption;
use anyhow::Result;
use bench::describe;
use clap::Args;
use device_link::table;
use device_link::words;
use estimator_core::{AdcCode, Admitted, SetpointCalibration, Status, Table, TableError};
use protocol::{Faults, Health, Identity, Mode, VERSION};
use remedy::Meaning;
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
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
}

/// All there is to know.
struct Found {
    identity: Identity,
    health: Health,
    /// The table in use and its checksum.
    table: Option<(Result<Admitted, TableError>, String)>,
    damaged: u32,
}

/// Runs the verb.
pub fn run(arguments: &Info) -> Result<bool> {
    let (mut client, identity) = arguments.port.connect()?;
    let table = table::in_use(&mut client)?.map(|record| (Table::parse(&record), checksum(&record)));
    let health = client.health()?;
    if arguments.forget {
        client.forget()?;
    }
    let found = Found { identity, health, table, damaged: client.damaged() };
    if arguments.json {
        out(&serde_json::to_string_pretty(&to_json(&found)?)?);
    } else {
        lines(&found).iter().for_each(|line| out(line));
    }
    Ok(true)
}

fn lines(found: &Found) -> Vec<String> {
    let Found { identity, health, table, damaged } = found;
    let mut lines = vec![
        format!(
            "Board    {}{}, firmware {} ({}), protocol {VERSION}",
            identity.board,
            identity.uid.map_or(String::new(), |uid| format!(" {uid}")),
            identity.firmware,
            identity.git
        ),
        format!(
            "Needs    tables of format {} for a tick of {} µs, an ADC up to {}, a DAC up to {}",
            identity.record_version, identity.tick_us, identity.adc_full_scale, identity.dac_full_scale
        ),
    ];
    lines.extend(table_lines(identity, table.as_ref()));
    let [seconds, turn] =
        [f64::from(health.ticks), f64::from(u32::MAX)].map(|ticks| ticks * f64::from(identity.tick_us) * 1e-6);
    lines.push(format!(
        "State    {}; started {} ticks ({seconds:.1} s, modulo {:.1} days) ago: {}",
        words::state(health),
        health.ticks,
        turn / 86_400.0,
        words::reset(health.reset, health.last_words.is_some())
    ));
    lines.push(format!("Zero     {}", words::bias(health, identity.tick_us)));
    lines.push(format!("Tick     {}; {} late or missed", took(health), health.missed));
    lines.push(format!(
        "Link     {} samples dropped and {} frames refused by the device, {} line errors there, {damaged} frames damaged \
         here; {} flash words not correctable",
        health.samples_dropped, health.frames_refused, health.line_errors, health.flash_errors
    ));
    let of_table = table.as_ref().and_then(|(table, _)| table.as_ref().ok()?.drive?.setpoint);
    if let Some(code) = health.setpoint {
        let wanted = |of: SetpointCalibration| format!("{:.3} µm wanted", of.displacement::<f32>(AdcCode(code)));
        let wanted = of_table.map_or("not calibrated".to_owned(), wanted);
        lines.push(format!("Setpoint {wanted}, code {code}"));
    }
    let drives = matches!(table, Some((Ok(table), _)) if table.drive.is_some());
    let rests = drives && words::rests(health.mode, health.faults);
    if health.mode == Mode::Waveform {
        lines.push(format!("Waveform {}", remedy::played(health, rests)));
    }
    lines.extend(remedy::supply(health).map(|supply| format!("Supply   {supply}")));
    let faults = if rests { Faults::empty() } else { health.faults };
    lines.push(if faults.is_empty() { "Faults   none".to_owned() } else { "Faults".to_owned() });
    lines.extend(remedy::faults(faults).map(|meaning| bullet("now", meaning)));
    lines.extend(remedy::faults(health.faults_seen - faults).map(|meaning| bullet("earlier", meaning)));
    for (status, ticks) in counts(health) {
        lines.extend(remedy::status(status).map(|meaning| bullet(&format!("{ticks} ticks"), meaning)));
    }
    if let Some(words) = &health.last_words {
        lines.push(format!("Last words of an earlier run: {words}"));
        lines.push("  → report them, please; piezo info --forget clears them".to_owned());
    }
    lines
}

fn table_lines(identity: &Identity, table: Option<&(Result<Admitted, TableError>, String)>) -> Vec<String> {
    let source = words::source(&identity.source);
    match table {
        None => vec![format!("Table    {source}")],
        Some((table, checksum)) => {
            let mut lines = vec![format!("Table    checksum {checksum}, {source}")];
            let described = match table {
                Ok(table) => describe(table),
                // A firmware of another record format runs tables that this program cannot read.
                Err(error) => vec![format!("it cannot be shown here: {error}")],
            };
            lines.extend(described.into_iter().map(|line| format!("         {line}")));
            lines
        }
    }
}

/// How long a tick takes. A device that does not measure it, since its time is another machine's, says none.
fn took(health: &Health) -> String {
    let percent = |cycles: u32| 100.0 * f64::from(cycles) / f64::from(health.cycles_period.max(1));
    match health.cycles_max {
        0 => "its duration is not measured here".to_owned(),
        most => format!(
            "takes {:.1} % of its time, at most {:.1} % so far ({most} of {} cycles)",
            percent(health.cycles_last),
            percent(most),
            health.cycles_period,
        ),
    }
}

fn bullet(when: &str, Meaning { what, remedy }: Meaning) -> String {
    format!("- {when}: {what}\n  → {remedy}")
}

/// Status bits that were raised, and on how many ticks.
fn counts(health: &Health) -> impl Iterator<Item = (Status, u32)> {
    let counts = [
        (Status::ADC_SATURATED, health.adc_saturated),
        (Status::VOLTAGE_OUT_OF_RANGE, health.voltage_out_of_range),
        (Status::CLAMPED, health.clamped),
        (Status::DAC_SATURATED, health.dac_saturated),
        (Status::OUT_OF_REACH, health.out_of_reach),
    ];
    counts.into_iter().filter(|(_, ticks)| *ticks > 0)
}

fn to_json(found: &Found) -> Result<Value> {
    let Found { identity, health, table, damaged } = found;
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
