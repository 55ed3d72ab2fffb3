//! `cargo xtask size`: what the firmware takes of the chip.
//!
//! Flash and RAM are those of the board's image. Instructions are those of the emulated board's tick, from the
//! function's first to its last, while it estimates a measured log; they are not cycles, but they are the same
//! on every run.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use clap::Args;
use estimator_core::Model;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use tempfile::TempDir;
use xshell::{Shell, cmd};

use crate::{
    artifact,
    embedded::{self, Board},
    image::Image,
    qemu::{self, Qemu},
    tool::{self, EMBEDDED, QEMU},
};

/// How to print it.
#[derive(Args)]
pub struct Arguments {
    /// Print JSON for machines
    #[arg(long)]
    json: bool,
    /// Instead, what the tick of every model takes: JSON for `piezo compare --instructions`
    #[arg(long)]
    models: bool,
}

/// The function that is counted, and the one with which the tick starts anew in another mode.
const TICK: &str = "tick_sample";
const RESTART: &str = "tick_restart";
/// The measured log.
pub const LOG: &str = "tests/data/picma-p885-1hz.csv";
/// The table it is counted with, on the measured log.
const TABLE: &str = "tests/data/table/table.toml";
/// Ticks of it that are counted.
const TICKS: &str = "8000";
/// A table of every model, by its name.
const TABLES: &str = "tests/data/table/models";

/// What the plugin in `tests/instruction-count` writes.
#[derive(Deserialize)]
struct Counts {
    calls: u64,
    jumps: u64,
    max: u64,
    sum: u64,
}

/// Builds, measures, prints.
///
/// # Errors
/// Something does not build or run, or the tick cannot be measured.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    tool::require(sh, &[&EMBEDDED, &QEMU])?;
    let piezo = artifact::piezo(sh)?;
    if arguments.models {
        println!("{:#}", models(sh, &piezo)?);
        return Ok(());
    }
    let size = figures(sh, &piezo)?;
    if arguments.json {
        println!("{size:#}");
    } else {
        let ticks = &size["instructions_per_tick"];
        println!("flash                              {:>8} bytes", size["flash_bytes"]);
        println!("RAM without stack                  {:>8} bytes", size["ram_bytes"]);
        let (most, mean) = (&ticks["max"], ticks["mean"].as_f64().unwrap_or(f64::NAN));
        println!("instructions per tick              {most:>8} at most, {mean:.1} on average");
        println!("symbols of software f64            {:>8}", size["soft_double_symbols"]);
    }
    Ok(())
}

/// Flash, RAM, and the tick's instructions with the thesis's model.
///
/// # Errors
/// See [`run`].
pub fn figures(sh: &Shell, piezo: &Path) -> Result<Value> {
    let board = Image::read(&embedded::image(sh, Board::NucleoG474re)?)?;
    let bench = Bench::new(sh, piezo)?;
    let folder = TempDir::new()?;
    let out = folder.path();
    cmd!(sh, "{piezo} emit {TABLE} --adc-full-scale 65520 --out {out}").read()?;
    let counts = bench.instructions(&out.join("table.toml"))?;
    Ok(json!({
        "flash_bytes": board.flash_bytes,
        "ram_bytes": board.ram_bytes,
        "soft_double_symbols": board.soft_doubles().len(),
        "instructions_per_tick": { "max": counts.max, "mean": counts.mean() },
    }))
}

impl Counts {
    fn mean(&self) -> f64 {
        self.sum as f64 / self.calls as f64
    }
}

/// What the tick of every model takes, with the tables that were identified on the log.
///
/// # Errors
/// See [`run`].
pub fn models(sh: &Shell, piezo: &Path) -> Result<Value> {
    let bench = Bench::new(sh, piezo)?;
    let mut figures = Map::new();
    for model in Model::ALL {
        let name = model.name();
        let counts = bench.instructions(Path::new(&format!("{TABLES}/{name}.toml")))?;
        figures.insert(name.to_owned(), json!({ "max": counts.max, "mean": counts.mean() }));
    }
    Ok(Value::Object(figures))
}

/// The emulated board, the plugin that counts, and the host tool.
struct Bench<'a> {
    sh: &'a Shell,
    piezo: &'a Path,
    image: PathBuf,
    /// What the plugin is told, but for where to write.
    plugin: String,
}

impl<'a> Bench<'a> {
    fn new(sh: &'a Shell, piezo: &'a Path) -> Result<Self> {
        let image = embedded::image(sh, Board::Mps2An386)?;
        let symbols = Image::read(&image)?;
        let plugin = artifact::build(cmd!(sh, "cargo build --package instruction-count"), "libinstruction_count.so")?;
        let (function, mark) = (symbols.function(TICK)?, symbols.function(RESTART)?);
        let plugin = format!("{},function={function:#x},mark={mark:#x}", plugin.display());
        Ok(Self { sh, piezo, image, plugin })
    }

    /// The instructions of the tick while a table runs on the first four seconds of the measured log: four periods.
    fn instructions(&self, table: &Path) -> Result<Counts> {
        let (sh, piezo) = (self.sh, self.piezo);
        let folder = TempDir::new()?;
        let counts = folder.path().join("counts.json");
        let plugin = format!("{},out={}", self.plugin, counts.display());
        let port = qemu::free_port(0)?;
        let link = format!("tcp:127.0.0.1:{port}");
        let qemu = Qemu::start(qemu::command(&self.image, &qemu::socket(port)).args(["-plugin", &plugin]))?;
        cmd!(sh, "{piezo} push {table} --reset --doubted --port {link}").read()?;
        let report: Value =
            serde_json::from_str(&cmd!(sh, "{piezo} pil {table} {LOG} --limit {TICKS} --json --port {link}").read()?)?;
        qemu.quit()?;
        let stretches: Vec<Counts> =
            fs::read_to_string(counts)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
        // Before and after the log, the tick estimates what the emulated converter gives.
        let of_log = |stretch: &Counts| report["ticks"] == stretch.calls && stretch.jumps == 0;
        let log = stretches.into_iter().find(of_log);
        log.with_context(|| format!("{TICK} was not called once for each tick of the log, or it was jumped to"))
    }
}
