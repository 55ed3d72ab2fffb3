//! Prints, as JSON, what the firmware makes of each fault of the signal with a table: the file of its record.

use emulator::signal::{FAULTS, Outcome, Recovery, Runs};
use estimator_core::Table;
use serde_json::{Value, json};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("say which table.bin")?;
    let table = Table::parse(&std::fs::read(path)?)?;
    let runs = Runs::new(&table);
    let rows: Vec<Value> = FAULTS.iter().map(|fault| row(fault.name, &runs.with(fault))).collect();
    println!("{:#}", Value::from(rows));
    Ok(())
}

fn row(name: &str, outcome: &Outcome) -> Value {
    let Outcome { flag, fault, worst_um, stated_um, silent, recovery } = *outcome;
    let back = match recovery {
        Recovery::After(ticks) => Some(ticks),
        Recovery::NeedsZero | Recovery::Faulty | Recovery::NotYet => None,
    };
    json!({
        "fault": name,
        "flag": flag.map(|(bits, tick)| raised(bits.iter_names().map(|(name, _)| name).collect(), tick)),
        "lasting": fault.map(|(bits, tick)| raised(bits.iter_names().map(|(name, _)| name).collect(), tick)),
        "worst_um": worst_um,
        "stated_um": stated_um,
        "silent_ticks": silent,
        "needs_zero": recovery == Recovery::NeedsZero,
        "stays": recovery == Recovery::Faulty,
        "back_after_ticks": back,
    })
}

fn raised(bits: Vec<&str>, tick: u32) -> Value {
    json!({ "bits": bits, "tick": tick })
}
