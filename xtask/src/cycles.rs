//! `cargo xtask cycles`: what the tick's interrupt costs on the board, in cycles of its core.
//!
//! The board's unmodified image runs in the CPU emulator, whose tests count the cycles of every handler by a model of
//! the core and the flash, at three levels; they fail where the core states fewer than must be stated.

use std::fmt::Write as _;

use anyhow::{Context, Result, ensure};
use clap::Args;
use estimator_core::{Model, table::ALLOWED_PERCENT};
use serde_json::{Value, json};
use xshell::{Shell, cmd};

use crate::{
    embedded::{self, Board},
    packages::BOARD,
    tool::{self, CMAKE, EMBEDDED, LIBCLANG, MAKE, PKG_CONFIG},
};

/// How to print it.
#[derive(Args)]
pub struct Arguments {
    /// Print JSON for machines
    #[arg(long)]
    json: bool,
}

/// Cycles a second.
const CORE_HZ: u64 = 170_000_000;
/// Ticks a second of the images that there are.
pub const RATES_HZ: [u64; 4] = [1_000, 2_000, 5_000, 10_000];
/// How the documented costs are read where they leave room, as the tests order them.
pub const LEVELS: [&str; 3] = ["optimistic", "typical", "pessimistic"];

/// Runs the tests and prints what they found.
///
/// # Errors
/// Something does not build, or a tick takes more than is stated.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    tool::require(sh, &[&EMBEDDED, &CMAKE, &MAKE, &PKG_CONFIG, &LIBCLANG])?;
    let rows = measure(sh)?;
    if arguments.json {
        println!("{rows:#}");
    } else {
        print!("{}", text(&rows)?);
    }
    Ok(())
}

/// For each model, once to estimate and once to drive: instructions and cycles of the most expensive tick of all
/// tables, the mean of the table that was identified on the measured log, what the core states, and whether the
/// board refuses it.
///
/// # Errors
/// See [`run`].
pub fn measure(sh: &Shell) -> Result<Value> {
    let image = embedded::image(sh, Board::NucleoG474re)?;
    let printed = cmd!(sh, "cargo test --quiet {BOARD...} --test=image cycles:: -- --nocapture")
        .env("FIRMWARE_IMAGE", image)
        .read()?;
    // The tests' own lines may stand before it.
    let lines = printed.lines().filter_map(|line| Some(serde_json::from_str(line.split_once("cycles: ")?.1)));
    let lines = lines.collect::<Result<Vec<Value>, _>>()?;
    let mut rows = Vec::new();
    for (model, drives) in Model::ALL.into_iter().flat_map(|model| [(model, false), (model, true)]) {
        let of = |line: &&Value| line["model"] == model.name() && line["drives"] == drives;
        let tables: Vec<&Value> = lines.iter().filter(of).collect();
        if !tables.is_empty() {
            rows.push(row(model, drives, &tables)?);
        }
    }
    ensure!(rows.len() == 2 * Model::ALL.len() - 1, "of some models nothing was printed:\n{printed}");
    Ok(Value::Array(rows))
}

/// The most of all tables, of those that make the model's own figure: the Bouc-Wen model has others
/// for other exponents.
fn row(model: Model, drives: bool, tables: &[&Value]) -> Result<Value> {
    let stated = &tables.first().context("no table")?["stated"];
    let most = |pointer: &str| {
        let tables = tables.iter().filter(|table| table["stated"] == *stated);
        tables.filter_map(|table| table.pointer(pointer)?.as_u64()).max()
    };
    let levels = |pointer: &str| [0, 1, 2].map(|at| (LEVELS[at], format!("{pointer}/{at}")));
    let cycles: Value = object(levels("/most_cycles").map(|(level, place)| (level, json!(most(&place)))));
    let mean =
        levels("/mean_cycles").map(|(level, place)| (level, tables[0].pointer(&place).cloned().unwrap_or_default()));
    let stated = stated.as_u64().context("nothing is stated")?;
    Ok(json!({
        "model": model.name(),
        "drives": drives,
        "most_instructions": most("/most_instructions"),
        "most_cycles": cycles,
        "mean_cycles": object(mean),
        "stated": stated,
        "percent": object(RATES_HZ.map(|hz| (hz.to_string(), json!(100.0 * (stated * hz) as f64 / CORE_HZ as f64)))),
        "refused": tables.iter().any(|table| table["refused"] == true && table["stated"] == stated),
        "tables": tables,
    }))
}

/// Figures by their level or their rate, as an object of JSON.
fn object<const N: usize>(figures: [(impl Into<String>, Value); N]) -> Value {
    figures.into_iter().map(|(of, figure)| (of.into(), figure)).collect()
}

fn text(rows: &Value) -> Result<String> {
    let mut text = String::new();
    let shares = RATES_HZ.map(|hz| format!("{:>7}", format!("{} kHz", hz / 1_000))).concat();
    writeln!(
        text,
        "{:32}{:>10}{:>14}{:>33}{:>9}  % of a tick at",
        "", "", "instructions", "cycles, at most", "stated"
    )?;
    writeln!(
        text,
        "{:32}{:>10}{:>14}{:>11}{:>11}{:>11}{:>9}{shares}",
        "model", "", "at most", LEVELS[0], LEVELS[1], LEVELS[2], ""
    )?;
    for row in rows.as_array().context("no rows")? {
        let what = if row["drives"] == true { "drive" } else { "estimate" };
        let figure =
            |pointer: &str| row.pointer(pointer).and_then(Value::as_u64).map_or("–".to_owned(), |n| n.to_string());
        let levels = LEVELS.map(|level| figure(&format!("/most_cycles/{level}")));
        let name = row["model"].as_str().context("no name")?;
        let shares = RATES_HZ
            .map(|hz| row["percent"][hz.to_string()].as_f64().map_or("–".to_owned(), |of| format!("{of:.1}")));
        writeln!(
            text,
            "{name:32}{what:>10}{:>14}{:>11}{:>11}{:>11}{:>9}{}",
            figure("/most_instructions"),
            levels[0],
            levels[1],
            levels[2],
            figure("/stated"),
            shares.map(|share| format!("{share:>7}")).concat()
        )?;
    }
    writeln!(
        text,
        "Stated is 10 % more than was observed at 2 kHz, which is no proof; above {ALLOWED_PERCENT} % a table is refused."
    )?;
    Ok(text)
}
