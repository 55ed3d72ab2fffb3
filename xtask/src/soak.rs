//! `cargo xtask soak`: the firmware on the host streams for an hour of its own time, and every sample is what the host computes.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::{artifact, step::HOST};

/// How long it streams.
#[derive(Args)]
pub struct Arguments {
    /// Ticks of the device; 2,000 of them are a second of its time
    #[arg(long, default_value_t = 7_200_000)]
    ticks: u32,
}

/// Builds it and runs it.
///
/// # Errors
/// It does not build, a tick is not accounted for, or a sample is not the host's.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    let soak = artifact::build(cmd!(sh, "cargo build {HOST...} --bin soak"), "soak")?;
    let ticks = arguments.ticks.to_string();
    Ok(cmd!(sh, "{soak} {ticks}").run()?)
}
