//! `soak TICKS`: prints what came of it; fails where a tick is not accounted for, or a sample is not the host's.

use soak::Soak;
use std::error::Error;
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let ticks = std::env::args().nth(1).ok_or("say how many ticks")?.parse()?;
    let soak = Soak::of(ticks)?;
    println!("{soak}");
    Ok(if soak.sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
