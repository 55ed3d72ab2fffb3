//! `cargo xtask size`: what the firmware takes of the chip.
//!
//! Flash and RAM are those of the board's image. Instructions are those of the emulated board's tick, from the function's
//! first to its last, while it estimates a measured log; they are not cycles, but they are the same on every run.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Deserialize;
use serde_json::{Value, json};
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
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Instead, what the tick of every model takes, identified on the measured log: JSON for `piezo compare --instructions`
    #[arg(long)]
    models: bool,
}

/// The function that is counted, and the one with which the tick starts anew in another mode.
const TICK: &str = "tick_sample";
const RESTART: &str = "tick_restart";
/// The table and the log it is counted with.
const TABLE: &str = "tests/data/table/table.toml";
const LOG: &str = "tests/data/picma-p885-1hz.csv";

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
    if arguments.models {
        return models(sh);
    }
    let board = Image::read(&embedded::image(sh, Board::NucleoG474re)?)?;
    let [direct, tabulated] = instructions_per_tick(sh, &artifact::piezo(sh)?, &[])?;
    let soft_doubles = board.soft_doubles();
    if arguments.json {
        let figures = json!({
            "flash_bytes": board.flash_bytes,
            "ram_bytes": board.ram_bytes,
            "soft_double_symbols": soft_doubles.len(),
            "instructions_per_tick": {
                "direct": direct.max,
                "direct_mean": direct.mean(),
                "tabulated": tabulated.max,
                "tabulated_mean": tabulated.mean(),
            },
        });
        println!("{figures:#}");
    } else {
        println!("flash                              {:>8} bytes", board.flash_bytes);
        println!("RAM without stack                  {:>8} bytes", board.ram_bytes);
        println!("instructions per tick, direct      {:>8} at most, {:.1} on average", direct.max, direct.mean());
        println!("instructions per tick, tabulated   {:>8} at most, {:.1} on average", tabulated.max, tabulated.mean());
        println!("symbols of software f64            {:>8} {}", soft_doubles.len(), soft_doubles.join(" "));
    }
    Ok(())
}

/// What a tick may take; a little more than it takes.
const MOST_DIRECT: u64 = 450;
const MOST_TABULATED: u64 = 160;

/// Counts over the first four seconds of the log, and sees that neither form takes more than it should.
///
/// # Errors
/// One does, or it cannot be measured.
pub fn check(sh: &Shell, piezo: &Path) -> Result<()> {
    let [direct, tabulated] = instructions_per_tick(sh, piezo, &["--limit", "8000"])?;
    println!("instructions per tick: direct {} at most, tabulated {}", direct.max, tabulated.max);
    ensure!(direct.max <= MOST_DIRECT, "the direct form takes {} instructions, more than {MOST_DIRECT}", direct.max);
    ensure!(tabulated.max <= MOST_TABULATED, "the tabulated form takes {}, more than {MOST_TABULATED}", tabulated.max);
    Ok(())
}

impl Counts {
    fn mean(&self) -> f64 {
        self.sum as f64 / self.calls as f64
    }
}

/// The names of the models on the command line.
const MODELS: [&str; 12] = [
    "voigt",
    "voltage-extremum",
    "displacement-extremum",
    "enhanced",
    "voigt-chain",
    "prandtl-ishlinskii",
    "maxwell-slip",
    "duhem",
    "bouc-wen",
    "preisach",
    "narx",
    "champion",
];

/// Prints what the tick of every model takes, over the first four seconds of the log.
fn models(sh: &Shell) -> Result<()> {
    let piezo = artifact::piezo(sh)?;
    let mut figures = serde_json::Map::new();
    for model in MODELS {
        let folder = TempDir::new()?;
        let out = folder.path();
        cmd!(sh, "{piezo} identify {LOG} --model {model} --adc-full-scale 65520 --out {out}")
            .quiet()
            .ignore_stdout()
            .run()?;
        let counts = instructions(sh, &piezo, &out.join("table.toml"), &["--limit", "8000"])?;
        figures.insert(model.to_owned(), json!({ "max": counts.max, "mean": counts.mean() }));
    }
    println!("{:#}", Value::Object(figures));
    Ok(())
}

/// The tick's instructions with the direct and with the tabulated form of one table.
fn instructions_per_tick(sh: &Shell, piezo: &Path, log: &[&str]) -> Result<[Counts; 2]> {
    let count = |form: &str| -> Result<Counts> {
        let folder = TempDir::new()?;
        let tables = folder.path();
        cmd!(sh, "{piezo} emit {TABLE} --form {form} --adc-full-scale 65520 --out {tables}").read()?;
        instructions(sh, piezo, &tables.join("table.toml"), log)
    };
    Ok([count("direct")?, count("tabulated")?])
}

/// The instructions of the tick while a table runs on the measured log.
fn instructions(sh: &Shell, piezo: &Path, table: &Path, log: &[&str]) -> Result<Counts> {
    let path = embedded::image(sh, Board::Mps2An386)?;
    let image = Image::read(&path)?;
    let functions = format!("function={:#x},mark={:#x}", image.function(TICK)?, image.function(RESTART)?);
    let plugin = artifact::build(cmd!(sh, "cargo build --package instruction-count"), "libinstruction_count.so")?;
    let folder = TempDir::new()?;
    let counts = folder.path().join("counts.json");
    let plugin = format!("{},{functions},out={}", plugin.display(), counts.display());
    let port = qemu::free_port(0)?;
    let link = format!("tcp:127.0.0.1:{port}");
    let qemu = Qemu::start(qemu::command(&path, &qemu::socket(port)).args(["-plugin", &plugin]))?;
    cmd!(sh, "{piezo} push {table} --reset --port {link}").read()?;
    let report: Value =
        serde_json::from_str(&cmd!(sh, "{piezo} pil {table} {LOG} {log...} --json --port {link}").read()?)?;
    qemu.quit()?;
    let stretches: Vec<Counts> =
        fs::read_to_string(counts)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    // Before and after the log, the tick estimates what the emulated converter gives.
    let of_log = |stretch: &Counts| report["ticks"] == stretch.calls && stretch.jumps == 0;
    let log = stretches.into_iter().find(of_log);
    log.with_context(|| format!("{TICK} was not called once for each tick of the log, or it was jumped to"))
}
