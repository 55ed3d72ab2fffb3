//! `piezo emulate`: the firmware on this machine behind a socket, with an amplifier, an actuator and a sensor
//! on its converters.
//!
//! Wired otherwise than the board's file says, it is what `piezo calibrate` is for; instruments then show what is.

use super::print::out;
use crate::option::{choice, finite, not_negative, positive};
use crate::output;
use anyhow::{Context, Result};
use bench::{BoardFacts, EMULATED, Wiring, emulated};
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::pages;
use device_link::table::to_record;
use emulator::{Emulator, FileFlash, PAGES, Readings, TICK_US, numbered};
use parameter_store::RamFlash;
use plants::{Change, Density, Kind};
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `piezo emulate`.
#[derive(Args, Debug)]
pub struct Emulate {
    /// What the actuator's hysteresis is made of; none is a model's own.
    #[arg(long, value_name = "KIND", value_parser = choice(KINDS), default_value = "relays")]
    pub device: Kind,
    /// Which actuator of that kind, with the errors of its converters and its sensor.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Port of this machine at which the device listens; 0 is any that is free.
    #[arg(long, default_value_t = 4740, allow_negative_numbers = true)]
    pub tcp_port: u16,
    /// Seconds of the device in a second, one where it waits for the host's voltages. Beyond some twenty the link
    /// cannot carry every sample away.
    #[arg(long, default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    pub speed: f64,
    /// A spring that the actuator pushes against, in the actuator's own stiffness: 1 halves the stroke. What a load
    /// does to a table: let it be learnt without, keep it with --flash, start again with --load, and prove it
    #[arg(long, value_name = "RATIO", value_parser = not_negative, allow_negative_numbers = true)]
    pub load: Option<f64>,
    /// Kelvin a minute by which the actuator warms up. Each lengthens it by about 1 % of its stroke, and takes 0.3 %
    /// of its strain
    #[arg(long, value_name = "K/MIN", value_parser = finite, allow_negative_numbers = true)]
    pub warming: Option<f64>,
    /// How it is wired. Where there is no such file, one is written.
    #[arg(long, value_name = "FILE", default_value = "board.toml")]
    pub board: PathBuf,
    /// How it is wired in truth, where --board is not to say that: what calibrate is to find. The readings of a
    /// multimeter and of the sensor's display are then printed whenever the voltage stands still.
    #[arg(long, value_name = "FILE")]
    pub wired: Option<PathBuf>,
    /// Keep its flash in this file, and with it its tables, from one run to the next.
    #[arg(long, value_name = "FILE")]
    pub flash: Option<PathBuf>,
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
    let truth = match &arguments.wired {
        Some(wired) => Wiring::new(&BoardFacts::read(wired)?, TICK_US).with_context(|| wired.display().to_string())?,
        None => wiring.clone(),
    };
    let change = Change {
        kelvin_per_s: arguments.warming.unwrap_or(0.0) / 60.0,
        ..Change::load(arguments.load.unwrap_or(0.0), 0.0)
    };
    let bench = emulated(&truth, arguments.device, arguments.seed).after(change);
    // The sensor's display counts from where its scale does.
    let display_um = truth.sensor.zero_um - bench.sensor_um.map_or(0.0, |(zero, _)| zero);
    let (plant, meters) = bench.metered();
    let erased = pages::with(&to_record(wiring.line()), PAGES)?;
    let emulator = Emulator::new()
        .plant(plant)
        .uid(numbered(arguments.seed as u32))
        .speed(arguments.speed)
        .port(arguments.tcp_port);
    let device = match &arguments.flash {
        Some(path) => emulator.flash(FileFlash::open(path, &erased)?).start()?,
        None => emulator.flash(RamFlash::new(erased)).start()?,
    };
    // Once nothing is in the board's way any more.
    if written {
        output::write(&arguments.board, facts.to_toml())?;
    }
    let port = device.address();
    let kept = match &arguments.flash {
        Some(path) => format!("Its tables are kept in {}.", path.display()),
        None => "Its tables are gone when it ends.".to_owned(),
    };
    let wired = match (&arguments.wired, written) {
        (Some(wired), _) => format!("is what is believed; it is wired as {} says", wired.display()),
        (None, true) => "was written, and says how it is wired".to_owned(),
        (None, false) => "was there, and says how it is wired".to_owned(),
    };
    let (described, next) =
        remedy::introduced(&bench, &wiring, arguments.wired.is_none(), &format!("--port tcp:{port} --board {board}"));
    out(&format!(
        "An emulated board, its firmware as on a real one; {} s of it pass in a second. {kept} Ctrl-C ends it.\n\
         {described} ({}; seed {}).\n{board} {wired}.\nIn another terminal, {next}",
        arguments.speed,
        arguments.device.name(),
        arguments.seed
    ));
    let mut readings = Readings::default();
    while !interrupt.wanted() {
        std::thread::sleep(LOOK);
        if arguments.wired.is_some() && readings.still_anew(meters.voltage(), meters.displacement()) {
            let (volts, um) = (meters.voltage(), display_um + meters.displacement());
            out(&format!("multimeter at the amplifier's output: {volts:.4} V; the sensor's display: {um:.4} µm"));
        }
    }
    device.shutdown();
    Ok(true)
}

/// How often the instruments are looked at.
const LOOK: Duration = Duration::from_millis(50);
