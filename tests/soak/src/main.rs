//! `soak TICKS [ADDRESS]`: prints what came of it; fails where a tick is not accounted for, or a sample is
//! not the host's.
//!
//! Without an address, of the firmware's library on the host; with one (`tcp:HOST:PORT`), of the image for the
//! MPS2, in QEMU.

use soak::{Soak, signal};
use std::error::Error;
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let ticks = arguments.next().ok_or("say how many ticks")?.parse()?;
    let soak = match arguments.next() {
        None => Soak::of(ticks)?,
        Some(address) => Soak::at(&address.parse()?, signal::triangle, ticks)?,
    };
    println!("{soak}");
    Ok(if soak.sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
