//! `piezo emulate`: the firmware on this machine behind a socket, with an amplifier, an actuator and a sensor on its converters.

use super::print::out;
use crate::option::{choice, positive};
use crate::output;
use anyhow::{Context, Result};
use bench::{BoardFacts, EMULATED, Wiring, emulated};
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::pages;
use device_link::table::to_record;
use emulator::{Emulator, PAGES, TICK_US};
use parameter_store::RamFlash;
use plants::{Density, Kind};
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `piezo emulate`.
#[derive(Args, Debug)]
pub struct Emulate {
    /// What the actuator's hysteresis is made of; none is a model's own.
    #[arg(long, value_name = "KIND", value_parser = choice(KINDS), default_value = "relays")]
    pub device: Kind,
    /// Which actuator of that kind, and its noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Port of this machine at which the device listens; 0 is any that is free.
    #[arg(long, default_value_t = 4740)]
    pub tcp_port: u16,
    /// Seconds of the device in a second. Beyond some twenty the link cannot carry every sample away.
    #[arg(long, default_value_t = 1.0, value_parser = positive)]
    pub speed: f64,
    /// How it is wired. Where there is no such file, one is written.
    #[arg(long, value_name = "FILE", default_value = "board.toml")]
    pub board: PathBuf,
}

const KINDS: [(Kind, &str, &str); 6] = [
    (Kind::Relays(Density::Gaussian), "relays", "Preisach's relays, Gaussian density"),
    (Kind::Relays(Density::Lorentzian), "relays-lorentzian", "Preisach's relays, Lorentzian density"),
    (Kind::RateDependent, "rate-dependent", "Plays whose thresholds grow with the rate"),
    (Kind::JilesAtherton, "jiles-atherton", "Jiles and Atherton's equations"),
    (Kind::BoucWen, "bouc-wen", "Bouc and Wen's equation, exponent 1"),
    (Kind::BoucWenSharp, "bouc-wen-sharp", "Bouc and Wen's equation, exponent 2"),
];

/// Runs the verb, until Ctrl-C.
pub fn run(arguments: &Emulate) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let (board, written) = (arguments.board.display(), !arguments.board.exists());
    let facts = if written { EMULATED } else { BoardFacts::read(&arguments.board)? };
    let wiring = Wiring::new(&facts, TICK_US).with_context(|| board.to_string())?;
    if written {
        output::write(&arguments.board, facts.to_toml())?;
    }
    let (sensor, drive) = (wiring.sensor, wiring.drive());
    let bench = emulated(&wiring, arguments.device, arguments.seed);
    let device = Emulator::new()
        .flash(RamFlash::new(pages::with(&to_record(wiring.line()), PAGES)?))
        .plant(bench.connected())
        .speed(arguments.speed)
        .port(arguments.tcp_port)
        .start()?;
    let (port, range) = (device.address(), drive.limits.range_v);
    out(&format!(
        "An emulated board, its firmware as on a real one; {} s of it pass in a second. Its tables are gone when it ends. Ctrl-C ends it.\n\
         Its DAC drives an amplifier of {} … {} V ({} V/s, rest at {} V), its ADC reads that voltage and a sensor of {} … {} µm \
         beside an actuator with a stroke of {:.1} µm ({}; seed {}).\n\
         {board} {}.\n\
         In another terminal, from board and sensor to a proven table:\n\n    piezo learn --port tcp:{port} --board {board} --out p885",
        arguments.speed,
        range.min,
        range.max,
        drive.limits.slew_v_per_s,
        drive.limits.rest_v,
        sensor.zero_um,
        sensor.full_um,
        bench.stroke_um,
        arguments.device.name(),
        arguments.seed,
        if written { "was written, and says how it is wired" } else { "was there, and says how it is wired" }
    ));
    while !interrupt.wanted() {
        std::thread::sleep(Duration::from_millis(50));
    }
    device.shutdown();
    Ok(true)
}
