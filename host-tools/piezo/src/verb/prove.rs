//! `piezo prove`: the board's own estimate beside the sensor on a random drive: pass or fail.

use super::device::note_damage;
use super::print::{heading, out, progress, row};
use crate::option::link::PortOption;
use crate::option::{BoardOption, not_negative, positive};
use crate::{output, remedy};
use anyhow::{Result, bail, ensure};
use bench::{Proof, Proven, prove};
use clap::Args;
use device_link::interrupt::Interrupt;
use serde_json::json;
use std::path::PathBuf;

/// How often the table's ± says that it holds the sensor, %.
const STATED: f64 = 95.0;

/// Arguments of `piezo prove`.
#[derive(Args, Debug)]
pub struct Prove {
    /// Folder for the log, proven.csv.
    #[arg(long)]
    pub out: PathBuf,
    /// Length, s.
    #[arg(long, default_value_t = 30.0, value_parser = positive)]
    pub seconds: f64,
    /// Highest frequency, Hz.
    #[arg(long, default_value_t = 20.0, value_parser = positive, value_name = "HZ")]
    pub up_to: f64,
    /// Draws the voltages; another than the training's.
    #[arg(long, default_value_t = 2)]
    pub seed: u64,
    /// Pass where the mean absolute error is at most this, % of the stroke, instead of where the table's ± holds the sensor
    /// for 95 % of the time.
    #[arg(long, value_name = "%", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_percent: Option<f64>,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
    /// The board.
    #[command(flatten)]
    pub board: BoardOption,
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
}

/// Runs the verb; `false` on FAIL.
pub fn run(arguments: &Prove) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    output::folder(&arguments.out)?;
    let (mut client, identity) = arguments.port.connect()?;
    let wiring = arguments.board.wiring(identity.tick_us)?;
    let log = arguments.out.join("proven.csv");
    let (up_to_hz, duration_s, seed) = (arguments.up_to, arguments.seconds, arguments.seed);
    let proof = Proof { wiring: &wiring, up_to_hz, duration_s, seed, log: &log, interrupt: &interrupt };
    let bar = progress((duration_s / wiring.line().sample_period::<f64>()) as u64);
    let proven = prove(&mut client, &proof, &mut |ticks| bar.set_position(ticks as u64));
    bar.finish_and_clear();
    note_damage(&client);
    let proven = proven?;
    if let Some(complaint) = &proven.complaint {
        bail!("{}; what was measured before is in {}", remedy::complaint(complaint), log.display());
    }
    judge(arguments, &proven)
}

fn judge(arguments: &Prove, proven: &Proven) -> Result<bool> {
    let Proven { figures, coverage, log, .. } = proven;
    ensure!(
        coverage.is_some() || arguments.max_percent.is_some(),
        "the table states no ±, so nothing says what would be good enough: say it with --max-percent; {} is written",
        log.display()
    );
    let held = coverage.map_or(0.0, |coverage| coverage.covered_percent);
    let (passed, by) = match arguments.max_percent {
        Some(most) => (
            figures.mae_percent <= most,
            format!("the mean absolute error is {:.2} % of the stroke, {most} % are allowed", figures.mae_percent),
        ),
        None => {
            (held >= STATED, format!("the table's ± holds the sensor {held:.1} % of the time; it promises {STATED} %"))
        }
    };
    if arguments.json {
        let summary = json!({ "passed": passed, "figures": figures, "interval": coverage, "log": log });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(passed);
    }
    out(&heading("the board's estimate, zeroed at rest"));
    out(&row("random voltage", figures));
    if let Some(coverage) = coverage {
        out(&format!("± {:.3} µm on average holds the sensor {held:.1} % of the time", coverage.half_width_um));
    }
    out(&log.display().to_string());
    out(&match passed {
        true => format!("PASS: {by}"),
        false => format!("FAIL: {by}: train again, longer (--minutes), --up-to {} at least", arguments.up_to),
    });
    Ok(passed)
}
