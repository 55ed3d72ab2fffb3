//! `piezo collect`: the units of a fleet side by side, from what each one's identification left.

use super::print::out;
use crate::option::Overwrite;
use crate::output;
use anyhow::{Result, ensure};
use clap::Args;
use fleet::{CSV, Fleet, UNIT};
use std::path::PathBuf;

/// Arguments of `piezo collect`.
#[derive(Args, Debug)]
pub struct Collect {
    /// Folders of units, where `piezo identify --unit` has written, or folders that hold such folders. One that is
    /// named and not there is a unit that is missing.
    #[arg(required = true, value_name = "FOLDER")]
    pub folders: Vec<PathBuf>,
    /// Write a row for each unit to this file.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print the units as JSON.
    #[arg(long)]
    pub json: bool,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` where a unit has no table.
pub fn run(arguments: &Collect) -> Result<bool> {
    if let Some(path) = &arguments.csv {
        ensure!(!path.is_dir(), "{}: is a folder, --csv names a file", path.display());
        ensure!(path.file_name().is_none_or(|name| name != UNIT.0), "{}: is a unit's: name another", path.display());
        arguments.overwrite.of(path, CSV)?;
    }
    let fleet = Fleet::read(&arguments.folders, |error| remedy::sentence(error));
    if let Some(path) = &arguments.csv {
        output::write(path, fleet::csv(&fleet.units)?)?;
    }
    if arguments.json {
        out(&serde_json::to_string_pretty(&fleet)?);
    } else {
        fleet::said(&fleet).iter().for_each(|line| out(line));
        if let Some(path) = &arguments.csv {
            out(&format!("\nWritten: {}", path.display()));
        }
    }
    Ok(fleet.complete())
}
