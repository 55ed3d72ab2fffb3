//! The browser that opens the HTML report.

use std::{env, path::PathBuf};

use anyhow::{Context, Result, bail};
use xshell::Shell;

use crate::root;

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// The browser's path: `$CHROME`, or the first of the usual names on `PATH`.
///
/// # Errors
/// No browser found, or `$CHROME` names none.
pub fn find() -> Result<PathBuf> {
    if let Some(chrome) = env::var_os("CHROME") {
        return which::which(&chrome)
            .with_context(|| format!("$CHROME is {}: not a program; correct or unset it", chrome.display()));
    }
    NAMES
        .iter()
        .find_map(|name| which::which(name).ok())
        .with_context(|| format!("none of {} on PATH, and $CHROME is not set", NAMES.join(", ")))
}

/// Installs Chromium unless a browser is there.
///
/// # Errors
/// No package manager this program knows, no right to use it, or its own failure.
pub fn setup(sh: &Shell) -> Result<()> {
    if env::var_os("CHROME").is_none() && find().is_err() {
        if which::which("apt-get").is_err() {
            bail!("install Chromium or Chrome, or set $CHROME to the path of one");
        }
        root::apt_install(sh, &["chromium"])?;
    }
    println!("chromium: {}", find()?.display());
    Ok(())
}
