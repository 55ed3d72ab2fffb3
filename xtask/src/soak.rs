//! `cargo xtask soak`: the firmware streams for an hour of its own time, and every sample is what the host computes.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::{
    artifact,
    embedded::{self, Board},
    packages::HOST,
    qemu::{self, Qemu},
    tool::{self, EMBEDDED, QEMU},
};

/// How long it streams, and where it runs.
#[derive(Args)]
pub struct Arguments {
    /// Ticks of the device; 2,000 of them are a second of its time
    #[arg(long, default_value_t = 7_200_000)]
    ticks: u32,
    /// The image for the MPS2 in QEMU, in real time, instead of the firmware's library on the host, which is quicker
    #[arg(long)]
    emulated: bool,
}

/// Builds it and runs it.
///
/// # Errors
/// It does not build, QEMU does not start, a tick is not accounted for, or a sample is not the host's.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    let soak = artifact::build(cmd!(sh, "cargo build {HOST...} --bin soak"), "soak")?;
    let ticks = arguments.ticks.to_string();
    if !arguments.emulated {
        return Ok(cmd!(sh, "{soak} {ticks}").run()?);
    }
    tool::require(sh, &[&EMBEDDED, &QEMU])?;
    let image = embedded::image(sh, Board::Mps2An386)?;
    let port = qemu::free_port(0)?;
    let _qemu = Qemu::start(&mut qemu::command(&image, &qemu::socket(port)))?;
    let address = format!("tcp:127.0.0.1:{port}");
    Ok(cmd!(sh, "{soak} {ticks} {address}").run()?)
}
