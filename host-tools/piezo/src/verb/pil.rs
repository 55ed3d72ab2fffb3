//! `piezo pil`: processor in the loop. Logs go through the device's tick, and every bit of what comes back is compared
//! with what the host's f32 core gives.

use super::device::{self, note_damage};
use super::print::{out, progress};
use crate::option::link::{Interrupting, PortOption};
use crate::option::{LogOptions, count};
use anyhow::{Result, ensure};
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::pil::{Comparison, Difference, TickResult, compare, feed};
use device_link::table::{self, to_record};
use device_link::{Client, words};
use estimator_core::{AdcCode, Admitted};
use protocol::{Health, Mode};
use recordings::log::Log;
use recordings::prepare::Recipe;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Arguments of `piezo pil`.
#[derive(Args, Debug)]
pub struct Pil {
    /// Logs. A table.toml, or its folder, may stand first: they are then prepared by its recipe, as `validate` does,
    /// and the device must run this very table. Without it they are taken as they are, every n-th sample at the tick.
    #[arg(required = true, value_name = "[TABLE] LOG")]
    pub files: Vec<PathBuf>,
    /// Feed no more than so many ticks of each log.
    #[arg(long, value_parser = |text: &str| count::<u64>(text, "; leave it out for all of them"), allow_negative_numbers = true)]
    pub limit: Option<u64>,
    /// Print the comparison as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
    /// Reading of the logs.
    #[command(flatten)]
    pub logs: LogOptions,
}

/// Runs the verb; `false` when host and device differ in any bit.
pub fn run(arguments: &Pil) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let is_table = |path: &Path| table_files::in_folder(path).extension().is_some_and(|extension| extension == "toml");
    let (table, logs) = match &arguments.files[..] {
        [table, logs @ ..] if is_table(table) => (Some(table), logs),
        logs => (None, logs),
    };
    ensure!(!logs.is_empty(), "name a log to feed, too: piezo pil table.toml log.csv --port …");
    let stated = table.map(|path| device::look_at(path)).transpose()?;
    let logs = arguments.logs.read_all(logs, false)?;

    let (mut client, identity) = arguments.port.connect()?;
    arguments.interrupting.consent(&mut client, false)?;
    let zeroed = client.health()?.bias_age_ticks.is_some();
    let running = table::running(&mut client)?;
    if let (Some(path), Some((_, table))) = (table, &stated) {
        let (wanted, found) = (to_record(table), to_record(&running));
        ensure!(
            wanted == found,
            "{}: the device runs another table (checksum {}, this one is {}): piezo push {} --reset --port {}",
            path.display(),
            device::checksum(&found),
            device::checksum(&wanted),
            path.display(),
            arguments.port.port
        );
    }
    let recipe = stated.map_or_else(|| Recipe::at_tick(identity.tick_us), |(file, _)| file.recipe);
    let codes: Vec<Vec<AdcCode>> =
        logs.iter().map(|log| codes(log, &recipe, &running, arguments.limit)).collect::<Result<_>>()?;

    let compared = compare_all(&mut client, &running, &logs, &codes, &interrupt);
    // Whatever happened, the device estimates again, and no longer streams.
    let restored = client.set_mode(Mode::Estimate);
    zeroed.then(|| eprintln!("piezo: careful: {}", remedy::zero_lost()));
    let comparisons = compared?;
    restored?;
    let health = client.health()?;
    note_damage(&client);
    let identical = comparisons.iter().all(Comparison::bit_exact);
    if arguments.json {
        out(&serde_json::to_string_pretty(&to_json(&logs, &comparisons, &health)?)?);
    } else {
        tell(&logs, &comparisons, &health, identical);
    }
    Ok(identical)
}

/// The ADC codes that a log's voltages give on this device, a tick each.
fn codes(log: &Log, recipe: &Recipe, table: &Admitted, limit: Option<u64>) -> Result<Vec<AdcCode>> {
    let recipe = recipe.of(log);
    let session = recipe.session(&recipe.cut(log))?;
    let limit = limit.map_or(usize::MAX, |limit| usize::try_from(limit).unwrap_or(usize::MAX));
    let amplifier = session.voltage.iter().map(|v| v + recipe.voltage_zero_v);
    Ok(amplifier.take(limit).map(|v| table.adc.code(v)).collect())
}

fn compare_all(
    client: &mut Client,
    table: &Admitted,
    logs: &[Log],
    codes: &[Vec<AdcCode>],
    interrupt: &Interrupt,
) -> Result<Vec<Comparison>> {
    let bar = progress(codes.iter().map(|codes| codes.len() as u64).sum());
    let mut comparisons = Vec::new();
    for (log, codes) in logs.iter().zip(codes) {
        let before = bar.position();
        bar.set_prefix(log.name.clone());
        let samples = feed(client, table, codes, interrupt, &mut |ticks| bar.set_position(before + ticks as u64))?;
        comparisons.push(compare(table, codes, &samples));
    }
    bar.finish_and_clear();
    Ok(comparisons)
}

fn tell(logs: &[Log], comparisons: &[Comparison], health: &Health, identical: bool) {
    for (log, comparison) in logs.iter().zip(comparisons) {
        let ticks = comparison.ticks;
        out(&match &comparison.first_difference {
            None => format!("{}: {ticks} ticks, the device's every bit is the host's", log.name),
            Some(_) => format!(
                "{}: {} of {ticks} ticks differ, by at most {:e} µm",
                log.name,
                ticks - comparison.identical,
                comparison.max_difference_um
            ),
        });
        if let Some(Difference { tick, code, host, device }) = &comparison.first_difference {
            out(&format!(
                "    the first is tick {tick}, code {code}: host {}, device {}",
                tick_result(host),
                tick_result(device)
            ));
        }
        if !comparison.status.is_empty() {
            out(&format!("    on the way: {}", words::list(words::status(comparison.status).map(|(_, what)| what))));
        }
    }
    out(&format!(
        "A tick takes at most {} of {} cycles so far; {} ticks late or missed",
        health.cycles_max, health.cycles_period, health.missed
    ));
    if !identical {
        out(
            "FAILED: are the firmware and this program built from the same sources, both with or both without micromath?",
        );
    }
}

fn tick_result(gave: &TickResult) -> String {
    let status: Vec<&str> = gave.status.iter_names().map(|(name, _)| name).collect();
    format!("{} µm (0x{:08x}) {}", gave.displacement_um, gave.bits, status.join(" ")).trim_end().to_owned()
}

fn to_json(logs: &[Log], comparisons: &[Comparison], health: &Health) -> Result<Value> {
    let one = |(log, comparison): (&Log, &Comparison)| -> Result<Value> {
        let mut value = serde_json::to_value(comparison)?;
        value["log"] = json!(log.name);
        Ok(value)
    };
    let all = |of: fn(&Comparison) -> usize| comparisons.iter().map(of).sum::<usize>();
    Ok(json!({
        "ticks": all(|comparison| comparison.ticks),
        "identical": all(|comparison| comparison.identical),
        "logs": logs.iter().zip(comparisons).map(one).collect::<Result<Vec<_>>>()?,
        "cycles_max": health.cycles_max,
        "cycles_period": health.cycles_period,
        "missed": health.missed,
    }))
}
