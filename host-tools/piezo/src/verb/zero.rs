//! `piezo zero`: calls the displacement of now, or the mean over one cycle of the voltage, 0 or what it is known to be.

use super::device::{note_damage, require_estimating};
use super::print::out;
use crate::option::link::PortOption;
use crate::option::{finite, not_negative};
use anyhow::{Context, Result};
use clap::Args;
use device_link::cycle::{Cycle, CycleRequest, over_cycle};
use device_link::interrupt::Interrupt;
use device_link::motion::{Motion, displacement, look};
use device_link::table;
use device_link::{Client, told, words};
use estimator_core::{Admitted, Status};
use indicatif::ProgressBar;
use serde_json::json;

/// Arguments of `piezo zero`.
#[derive(Args, Debug)]
pub struct Zero {
    /// What the displacement of now is called, µm: a stop that is known, a gauge's reading. With --over-cycle what its
    /// mean is called: the mean of a sensor beside it, or the middle of two stops.
    #[arg(long, value_name = "UM", value_parser = finite, default_value_t = 0.0, allow_negative_numbers = true)]
    pub at: f64,
    /// Tell the mean over the voltage's first full cycle, three reversals and what comes between, instead of the
    /// displacement of now. The voltage must move meanwhile.
    #[arg(long)]
    pub over_cycle: bool,
    /// Wait so long for the cycle, s.
    #[arg(
        long,
        value_parser = not_negative,
        default_value_t = 60.0,
        requires = "over_cycle",
        allow_negative_numbers = true
    )]
    pub seconds: f64,
    /// Print the displacement before and after, the bias and the cycle as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
}

/// Runs the verb.
pub fn run(arguments: &Zero) -> Result<bool> {
    let port = &arguments.port.port;
    let interrupt = Interrupt::watch()?;
    let (mut client, identity) = arguments.port.connect()?;
    require_estimating(&client.health()?, port)?;
    let table = table::running(&mut client)?;
    bench::require_model(&table)?;
    let before = match arguments.over_cycle {
        true => Motion { displacement_um: displacement(&mut client)?, ..Motion::default() },
        false => look(&mut client, &table)?,
    };
    remedy::moving(&before, arguments.at).iter().for_each(|moving| eprintln!("piezo: careful: {moving}"));
    let cycle = if arguments.over_cycle { Some(cycle(arguments, &mut client, &table, &interrupt)?) } else { None };
    let health = match cycle {
        Some(cycle) => told::shift(&mut client, (arguments.at - cycle.mean_um) as f32)?,
        None => told::zero(&mut client, arguments.at as f32)?,
    };
    let after = displacement(&mut client)?;
    note_damage(&client);
    if arguments.json {
        let cycle = cycle.map(|cycle| {
            json!({
                "mean_um": cycle.mean_um,
                "seconds": seconds(cycle.ticks, &table),
                "voltage_min_V": cycle.voltage_v.min,
                "voltage_max_V": cycle.voltage_v.max,
                "status": cycle.status.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            })
        });
        out(&serde_json::to_string_pretty(&json!({
            "at_um": arguments.at,
            "before_um": before.displacement_um,
            "after_um": after,
            "bias_um": health.bias_um,
            "moved_V": before.moved_v,
            "cycle": cycle,
        }))?);
        return Ok(true);
    }
    let number = |um: Option<f32>| um.map_or("unknown".to_owned(), |um| format!("{um:.4} µm"));
    match cycle {
        Some(cycle) => tell(&cycle, arguments.at, &table),
        None => out(&format!(
            "The displacement was {}; it was called {} µm, and now reads {}",
            number(before.displacement_um),
            arguments.at,
            number(after)
        )),
    }
    out(&format!("The device: {}", words::bias(&health, identity.tick_us)));
    out(
        "The bias lasts until the device is zeroed again (prove does), restarted (reset, train, install), paused or fed codes (push --pause, pil), or has had a fault.",
    );
    Ok(true)
}

/// The voltage's first full cycle. An error says that nothing is changed.
fn cycle(arguments: &Zero, client: &mut Client, table: &Admitted, interrupt: &Interrupt) -> Result<Cycle> {
    let bar = ProgressBar::new_spinner();
    let found = over_cycle(client, &CycleRequest::new(table, arguments.seconds), interrupt, &mut |ticks| {
        bar.set_message(format!("waits for a full cycle of the voltage, {:.1} s", seconds(ticks, table)));
    });
    bar.finish_and_clear();
    found.context("nothing was changed on the device")
}

fn tell(cycle: &Cycle, at: f64, table: &Admitted) {
    out(&format!(
        "Over one cycle of the voltage, {:.3} s between {:.4} and {:.4} V, the mean was {:.4} µm; it was called {at} µm",
        seconds(cycle.ticks, table),
        cycle.voltage_v.min,
        cycle.voltage_v.max,
        cycle.mean_um
    ));
    if cycle.status.contains(Status::NOT_SETTLED) {
        out("The estimate was not settled all through the cycle: a larger swing may move it. Zero again after one.");
    }
}

fn seconds(ticks: usize, table: &Admitted) -> f64 {
    ticks as f64 * f64::from(table.sample_period_us) * 1e-6
}
