//! Where cargo puts what it builds.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;
use xshell::{Cmd, Shell, cmd};

/// Runs a `cargo build` and returns the path of the file of this name that it makes. Cargo says itself where that is:
/// settings, environment and the choice of compiler all have a part in it.
///
/// # Errors
/// The build fails, or makes no such file.
pub fn build(cargo_build: Cmd<'_>, file_name: &str) -> Result<PathBuf> {
    messages(cargo_build)?
        .iter()
        .filter_map(|message| Some(message.get("filenames")?.as_array()?.clone()))
        .flatten()
        .filter_map(|path| Some(PathBuf::from(path.as_str()?)))
        .find(|path| path.file_name() == Path::new(file_name).file_name())
        .with_context(|| format!("cargo built no {file_name}"))
}

/// Runs a `cargo test --no-run` and returns the program of the target of this name, which cargo adds a number to.
///
/// # Errors
/// The build fails, or has no such target.
pub fn executable(cargo_build: Cmd<'_>, target: &str) -> Result<PathBuf> {
    messages(cargo_build)?
        .iter()
        .filter(|message| message["target"]["name"] == target)
        .find_map(|message| Some(PathBuf::from(message["executable"].as_str()?)))
        .with_context(|| format!("cargo built no program of the target {target}"))
}

/// What cargo says of what it builds, a message a line.
fn messages(cargo: Cmd<'_>) -> Result<Vec<Value>> {
    let text = cargo.arg("--message-format=json-render-diagnostics").read()?;
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

/// Builds the host tool as the tests do, which optimises what is hot of it and is quicker built than a release;
/// returns its path.
///
/// # Errors
/// It does not build.
pub fn piezo(sh: &Shell) -> Result<PathBuf> {
    build(cmd!(sh, "cargo build --package piezo"), "piezo")
}
