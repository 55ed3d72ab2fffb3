//! `piezo prove`: the board's own estimate beside the sensor on a random drive: pass or fail.

use super::device::note_damage;
use super::print::{out, progress};
use crate::option::link::{Interrupting, PortOption};
use crate::option::{BoardOption, not_negative, positive, span};
use crate::output;
use ::calibration::span::Span;
use anyhow::Result;
use bench::{BenchError, Proof, Proven, foresee, prove};
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::play::PlayError;
use excitation::hertz;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo prove`.
#[derive(Args, Debug)]
pub struct Prove {
    /// Folder for the log, proven.csv, which is never written over.
    #[arg(long, default_value = "proof")]
    pub out: PathBuf,
    /// Length of the random voltage, s.
    #[arg(long, default_value_t = 30.0, value_parser = positive, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Its length in minutes.
    #[arg(long, value_parser = positive, conflicts_with = "seconds", allow_negative_numbers = true)]
    pub minutes: Option<f64>,
    /// Highest frequency, Hz: 50, 50Hz or 0.05kHz.
    #[arg(long, default_value_t = 20.0, value_parser = hertz, value_name = "HZ", allow_negative_numbers = true)]
    pub up_to: f64,
    /// Lowest and highest voltage, V; without it all that the table and board.toml allow.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub range: Option<Span>,
    /// Draws the voltages; another than the training's.
    #[arg(long, default_value_t = 2, allow_negative_numbers = true)]
    pub seed: u64,
    /// Pass where the mean absolute error is at most this, % of the stroke; 2 where the table states a ±, which must
    /// hold the sensor for 80 % of the time besides: it says 95 % over many recordings.
    #[arg(long, value_name = "%", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_percent: Option<f64>,
    /// Check everything, say what would be driven, and drive nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
    /// The file that says what the board's wires stand for.
    #[command(flatten)]
    pub board: BoardOption,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

/// Runs the verb; `false` on FAIL, and where it is interrupted.
pub fn run(arguments: &Prove) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let _held = output::to_folder(&arguments.out)?;
    let (mut client, identity, facts) = arguments.board.connect(&arguments.port)?;
    let wiring = arguments.board.wiring(&facts, identity.tick_us)?;
    let busy = arguments.interrupting.consent(&mut client, arguments.dry_run)?;
    let log = arguments.out.join("proven.csv");
    let duration_s = arguments.minutes.map_or(arguments.seconds, |minutes| 60.0 * minutes);
    let (up_to_hz, seed) = (arguments.up_to, arguments.seed);
    let (range, max_percent) = (arguments.range.map(|span| (span.zero, span.full)), arguments.max_percent);
    let proof =
        Proof { wiring: &wiring, range, up_to_hz, duration_s, seed, max_percent, log: &log, interrupt: &interrupt };
    if arguments.dry_run {
        let (said, refused) = (foresee(&mut client, &proof)?, Vec::from_iter(busy));
        match arguments.json {
            true => out(&serde_json::to_string_pretty(&json!({ "would": said, "refused": refused }))?),
            false => said.iter().for_each(|line| out(&format!("- {line}"))),
        }
        return Ok(refused.is_empty());
    }
    let free = !log.exists();
    let bar = progress((duration_s / wiring.line().sample_period::<f64>()) as u64);
    let proven = prove(&mut client, &proof, &mut |ticks| bar.set_position(ticks as u64));
    bar.finish_and_clear();
    note_damage(&client);
    let proven = match proven {
        Err(BenchError::Play(why @ PlayError::Interrupted { .. })) => {
            let kept = log.exists().then_some(&log);
            if arguments.json {
                out(&serde_json::to_string_pretty(&json!({ "passed": false, "complete": false, "log": kept }))?);
            }
            eprintln!("piezo: {}", remedy::proof_interrupted(&why, kept.map(PathBuf::as_path)));
            return Ok(false);
        }
        Err(error) => {
            let kept = Some(&log).filter(|log| free && log.exists());
            kept.iter().for_each(|log| eprintln!("piezo: {}", remedy::proof_kept(log)));
            return Err(error.into());
        }
        Ok(proven) => proven,
    };
    tell(arguments, &proven)?;
    // What the proof says stands, and is said before what the user must know last.
    proven.home?;
    Ok(proven.verdict.passed)
}

fn tell(arguments: &Prove, proven: &Proven) -> Result<()> {
    if arguments.json {
        let Proven { figures, shares, verdict, log, .. } = proven;
        let summary =
            json!({ "passed": verdict.passed, "complete": true, "figures": figures, "shares": shares, "log": log });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(());
    }
    remedy::proof(proven, arguments.up_to).iter().for_each(|line| out(line));
    Ok(())
}
