//! Who a device is, which table it runs and how it is, as lines for people: faults and status bits come
//! with their remedies.

use crate::bench::FORMER_OF_KILLED;
use crate::bits::{self, Meaning};
use crate::identification::refused;
use crate::{played, supply};
use bench::{describe, is_line};
use device_link::words;
use estimator_core::{AdcCode, Admitted, SetpointCalibration, Status, TableError};
use findings::counted;
use protocol::{Faults, Health, Identity, Mode, VERSION};

/// All that is known of a device.
#[derive(Debug)]
pub struct Known {
    /// What the device says of itself: board, firmware, tick.
    pub identity: Identity,
    /// Its counters, faults, mode and cycles.
    pub health: Health,
    /// The table in use and its checksum.
    pub table: Option<(Result<Admitted, TableError>, String)>,
    /// Frames that came damaged here.
    pub damaged: u32,
}

/// The lines that say all of it to people.
#[must_use]
pub fn state(known: &Known) -> Vec<String> {
    let Known { identity, health, table, damaged } = known;
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
        lines.push(format!("Waveform {}", played(health, rests)));
    }
    lines.extend(supply(health).map(|supply| format!("Supply   {supply}")));
    let faults = if rests { Faults::empty() } else { health.faults };
    lines.push(if faults.is_empty() { "Faults   none".to_owned() } else { "Faults".to_owned() });
    lines.extend(bits::faults(faults).map(|meaning| bullet("now", meaning)));
    lines.extend(bits::faults(health.faults_seen - faults).map(|meaning| bullet("earlier", meaning)));
    for (status, ticks) in counts(health) {
        lines.extend(bits::status(status).map(|meaning| bullet(&counted(ticks, "tick"), meaning)));
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
                Err(error) => vec![format!("it cannot be shown here: {}", refused(error))],
            };
            let line = table.as_ref().is_ok_and(|table| is_line(table));
            let former = line.then(|| FORMER_OF_KILLED.to_owned());
            lines.extend(described.into_iter().chain(former).map(|line| format!("         {line}")));
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
