//! The browser, as this test wants it: headless, alone, and cut off from any network.

use std::{env, ffi::OsStr, path::PathBuf, process::Command};

use anyhow::{Context, Result, anyhow};
pub use headless_chrome::Browser;
use headless_chrome::{LaunchOptions, browser::default_executable};

/// Starts the browser `$CHROME` names, or else the Chromium or Chrome that is installed, with a fresh profile. It ends with
/// the value returned.
///
/// # Errors
/// No browser, or one that does not start.
pub fn launch() -> Result<Browser> {
    let path = match env::var_os("CHROME") {
        Some(chrome) => PathBuf::from(chrome),
        None => default_executable().map_err(|none| anyhow!("{none}: run `cargo xtask setup`"))?,
    };
    let options = LaunchOptions::default_builder()
        .path(Some(path.clone()))
        // Chromium's sandbox refuses to run as root, as tests in containers do.
        .sandbox(!is_root())
        // The library would say `--headless`, which older browsers take for their former, different mode.
        .headless(false)
        .args(
            [
                "--headless=new",
                "--disable-gpu",
                "--disable-component-update",
                "--hide-scrollbars",
                "--host-resolver-rules=MAP * ~NOTFOUND",
            ]
            .map(OsStr::new)
            .to_vec(),
        )
        .build()?;
    Browser::new(options)
        .with_context(|| format!("{} does not start; run `cargo xtask setup` or set $CHROME", path.display()))
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n")
}
