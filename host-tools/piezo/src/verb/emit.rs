//! `piezo emit`: the faces of a table, with another calibration where asked.

use super::device::look_at;
use super::print::out;
use crate::option::{CalibrationArgs, Overwrite};
use crate::output::{self, FACES};
use ::calibration::converter_mismatches;
use anyhow::{Result, anyhow};
use bench::describe;
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::PathBuf;
use table_files::{TableFile, in_folder, record, rust_source};

/// One face of a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Face {
    /// table.toml, for people, or its folder.
    Toml,
    /// table.rs, a `const` for the firmware.
    Rust,
    /// table.bin, the record for a flash page.
    Binary,
}

/// Arguments of `piezo emit`.
#[derive(Args, Debug)]
pub struct Emit {
    /// The table to start from.
    pub table: PathBuf,
    /// Folder for table.toml, table.rs and table.bin.
    #[arg(long, required_unless_present = "face", conflicts_with = "face")]
    pub out: Option<PathBuf>,
    /// Print one face to standard output instead.
    #[arg(long, value_enum)]
    pub face: Option<Face>,
    /// Bring the table to this tick, µs, without another search: that of a board whose image was built
    /// for another rate.
    #[arg(long, value_parser = clap::value_parser!(u32).range(10..=1_000_000), allow_negative_numbers = true)]
    pub tick_us: Option<u32>,
    /// Print what was written as JSON.
    #[arg(long, conflicts_with = "face")]
    pub json: bool,
    /// What the board's converters stand for.
    #[command(flatten)]
    pub calibration: CalibrationArgs,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Emit) -> Result<bool> {
    // With its own folder for --out the faces are being made again.
    let again = arguments.out.as_ref().is_some_and(|out| in_folder(&arguments.table) == out.join("table.toml"));
    let (mut file, _) = if again { TableFile::load(&arguments.table)? } else { look_at(&arguments.table)? };
    if let Some(tick_us) = arguments.tick_us {
        let name = arguments.table.display();
        remedy::bring_to(&mut file, tick_us)
            .map_err(|bound| anyhow!("{name}: {bound}: identify with --tick-us {tick_us}"))?;
    }
    let calibration = arguments.calibration.options()?;
    calibration.apply(&mut file.table);
    let drive = file.table.drive;
    calibration.drive.require(drive.is_some(), drive.is_some_and(|drive| drive.setpoint.is_some()))?;
    remedy::calibrated(&mut file.doubts, &calibration);
    let admitted = match arguments.tick_us {
        Some(tick_us) => file.admit().map_err(|refused| {
            anyhow!("{}: at {tick_us} µs {refused}: identify with --tick-us {tick_us}", arguments.table.display())
        })?,
        None => file.admit()?,
    };
    admitted.in_time().map_err(|misfit| anyhow!("{}", remedy::board(&misfit, &admitted, &arguments.table)))?;
    converter_mismatches(&admitted)
        .iter()
        .for_each(|mismatch| eprintln!("piezo: careful: {}", remedy::mismatch(mismatch)));
    if let Some(folder) = &arguments.out {
        let held = output::to_folder(folder)?;
        FACES.iter().try_for_each(|(name, known_by)| arguments.overwrite.of(&folder.join(name), known_by))?;
        held.write_all(file.faces()?)?;
        let faces = ["table.toml", "table.rs", "table.bin"].map(|name| folder.join(name));
        if arguments.json {
            out(&serde_json::to_string_pretty(&json!({ "written": faces }))?);
        } else {
            faces.iter().for_each(|path| out(&path.display().to_string()));
            let noise = file.noise.map(|noise| noise.told(admitted.deadband_v));
            describe(&admitted).iter().chain(&noise).for_each(|line| out(&format!("    {line}")));
        }
    }
    match arguments.face {
        Some(Face::Toml) => drop(output::standard(file.to_toml()?.as_bytes())?),
        Some(Face::Rust) => drop(output::standard(rust_source(&admitted).as_bytes())?),
        Some(Face::Binary) => drop(output::standard(&record(&admitted))?),
        None => {}
    }
    Ok(true)
}
