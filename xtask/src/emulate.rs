//! `cargo xtask emulate`: the firmware in QEMU, for the host tool to talk to as to a board.

use std::{path::PathBuf, process::Command};

use anyhow::{Context, Result};
use clap::Args;
use xshell::Shell;

use crate::{
    embedded::{self, Board},
    qemu::{self, NO_QEMU},
    tool::{self, EMBEDDED, QEMU},
};

/// Where the emulated board is found.
#[derive(Args)]
pub struct Arguments {
    /// Port of this machine on which the board's UART listens
    #[arg(long, default_value_t = 4740)]
    port: u16,
    /// Make the UART a pseudo-terminal instead, which is opened like a serial port
    #[arg(long, conflicts_with = "port")]
    pty: bool,
    /// Run this image instead of building one
    #[arg(long, value_name = "ELF")]
    image: Option<PathBuf>,
}

/// Builds the image and runs it until Ctrl-C or a signal.
///
/// # Errors
/// The image does not build, the port is taken, or QEMU does not start.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    tool::require(sh, &[&EMBEDDED, &QEMU])?;
    let image = match &arguments.image {
        Some(image) => image.clone(),
        None => embedded::image_as_chosen(sh, Board::Mps2An386)?,
    };
    let (serial, port) = if arguments.pty {
        println!("QEMU names the pseudo-terminal below, as `char device redirected to /dev/pts/N`.");
        ("pty".to_owned(), "/dev/pts/N".to_owned())
    } else {
        let port = qemu::free_port(arguments.port)?;
        (qemu::socket(port), format!("tcp:127.0.0.1:{port}"))
    };
    println!(
        "The firmware runs in QEMU until you press Ctrl-C. In another terminal, type\n\n    \
         cargo run --release -- info --port {port}\n"
    );
    hand_over(qemu::command(&image, &serial).args(["-monitor", "none"]))
}

/// Goes on as QEMU: whoever ends this process ends the emulator, with nothing left behind.
#[cfg(unix)]
fn hand_over(qemu: &mut Command) -> Result<()> {
    use std::os::unix::process::CommandExt;
    Err(qemu.exec()).context(NO_QEMU)
}

/// Waits for QEMU, which gets Ctrl-C from the same terminal.
#[cfg(not(unix))]
fn hand_over(qemu: &mut Command) -> Result<()> {
    let status = qemu.status().context(NO_QEMU)?;
    anyhow::ensure!(status.success(), "QEMU: {status}");
    Ok(())
}
