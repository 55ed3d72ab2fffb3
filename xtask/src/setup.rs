//! What the checks need beyond cargo, and how it gets there.

use std::env;

use anyhow::{Result, bail, ensure};
use xshell::Shell;

use crate::{chromium, embedded, root};

/// Something a check needs that cargo does not bring.
#[derive(Clone, Copy)]
pub enum Tool {
    /// A compiler for the microcontroller.
    Embedded,
    /// A browser.
    Chromium,
}

impl Tool {
    fn missing(self, sh: &Shell) -> Result<()> {
        match self {
            Self::Embedded => embedded::cargo(sh).map(drop),
            Self::Chromium => chromium::find().map(drop),
        }
    }

    fn setup(self, sh: &Shell) -> Result<()> {
        match self {
            Self::Embedded => embedded::setup(sh),
            Self::Chromium => chromium::setup(sh),
        }
    }

    /// Sees to it that the tool is there before a check: installs it where nobody could be asked, on CI and as root.
    ///
    /// # Errors
    /// The tool is missing and may not or cannot be installed.
    pub fn require(self, sh: &Shell) -> Result<()> {
        let Err(missing) = self.missing(sh) else {
            return Ok(());
        };
        if root::is_root(sh) || env::var_os("CI").is_some_and(|ci| ci == "true") {
            println!("{missing}: installing");
            self.setup(sh)
        } else {
            bail!("{missing}; run `cargo xtask setup`")
        }
    }
}

/// `cargo xtask setup`: every tool is tried, whatever became of the one before.
///
/// # Errors
/// Some tool could not be installed; each has said why.
pub fn all(sh: &Shell) -> Result<()> {
    let mut ready = true;
    for tool in [Tool::Embedded, Tool::Chromium] {
        if let Err(error) = tool.setup(sh) {
            println!("{error:#}");
            ready = false;
        }
    }
    ensure!(ready, "this machine is not ready yet; see above");
    Ok(())
}
