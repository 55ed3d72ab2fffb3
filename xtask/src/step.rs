//! The list of checks.

use anyhow::Result;
use xshell::{Shell, cmd};

use crate::{chromium, embedded, setup::Tool};

/// One check.
pub struct Step {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it proves, in a line.
    pub about: &'static str,
    /// What it needs beyond cargo.
    pub tool: Option<Tool>,
    /// Runs it; an error is the check's failure.
    pub run: fn(&Shell) -> Result<()>,
}

/// Every check, the quick ones first.
pub const STEPS: [Step; 6] = [
    Step { name: "fmt", about: "the sources are formatted", tool: None, run: fmt },
    Step { name: "clippy", about: "no lint fires", tool: None, run: clippy },
    Step { name: "doc", about: "the documentation builds without a warning", tool: None, run: doc },
    Step { name: "test", about: "unit, property and command tests on the host", tool: None, run: test },
    Step {
        name: "no-std",
        about: "estimator-core builds for the microcontroller",
        tool: Some(Tool::Embedded),
        run: no_std,
    },
    Step {
        name: "browser",
        about: "the HTML report is sound in a browser, on a phone's width and a desktop's",
        tool: Some(Tool::Chromium),
        run: browser,
    },
];

fn fmt(sh: &Shell) -> Result<()> {
    Ok(cmd!(sh, "cargo fmt --all --check").run()?)
}

fn clippy(sh: &Shell) -> Result<()> {
    cmd!(sh, "cargo clippy --workspace --all-targets -- -D warnings").run()?;
    // The host tool's feature is the core's too.
    Ok(cmd!(sh, "cargo clippy -p estimator-core -p host-tools --features host-tools/micromath,estimator-core/micromath --all-targets -- -D warnings").run()?)
}

fn doc(sh: &Shell) -> Result<()> {
    Ok(cmd!(sh, "cargo doc --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings").run()?)
}

fn test(sh: &Shell) -> Result<()> {
    cmd!(sh, "cargo test --workspace --exclude report-browser-test").run()?;
    Ok(cmd!(sh, "cargo test -p estimator-core --features micromath").run()?)
}

fn no_std(sh: &Shell) -> Result<()> {
    let target = embedded::TARGET;
    for features in [&[][..], &["--features", "micromath"]] {
        embedded::cargo(sh)?
            .args(["build", "-p", "estimator-core", "--release", "--target", target])
            .args(features)
            .run()?;
    }
    Ok(())
}

fn browser(sh: &Shell) -> Result<()> {
    let chrome = chromium::find()?;
    Ok(cmd!(sh, "cargo test -p report-browser-test -- --nocapture").env("CHROME", chrome).run()?)
}
