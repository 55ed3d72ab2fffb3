//! The list of checks.

use anyhow::{Result, ensure};
use xshell::{Cmd, Shell, cmd};

use crate::{
    artifact,
    embedded::{self, Board, TARGET},
    image::Image,
    size,
    tool::{self, CHROMIUM, CMAKE, EMBEDDED, LIBCLANG, MAKE, PKG_CONFIG, QEMU, Tool},
};

/// One check.
pub struct Step {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it proves, in a line.
    pub about: &'static str,
    /// What it needs beyond cargo.
    pub tools: &'static [&'static Tool],
    /// Runs it; an error is the check's failure.
    pub run: fn(&Shell) -> Result<()>,
}

/// Every check, the quick ones first.
pub const STEPS: [Step; 8] = [
    Step { name: "fmt", about: "the sources are formatted", tools: &[], run: fmt },
    Step { name: "clippy", about: "no lint fires", tools: &[], run: clippy },
    Step { name: "doc", about: "the documentation builds without a warning", tools: &[], run: doc },
    Step { name: "test", about: "unit, property and command tests on the host", tools: &[], run: test },
    Step {
        name: "firmware",
        about: "the firmware builds for both boards, without a lint and without software f64",
        tools: &[&EMBEDDED],
        run: firmware,
    },
    Step {
        name: "emulated",
        about: "the host tool and the firmware in QEMU understand each other; a tick takes no more than it should",
        tools: &[&EMBEDDED, &QEMU],
        run: emulated,
    },
    Step {
        name: "board",
        about: "the board's own image does its work in a CPU emulator",
        tools: &[&EMBEDDED, &CMAKE, &MAKE, &PKG_CONFIG, &LIBCLANG],
        run: board,
    },
    Step {
        name: "browser",
        about: "the HTML report is sound in a browser, on a phone's width and a desktop's",
        tools: &[&CHROMIUM],
        run: browser,
    },
];

/// Every tool that a check needs, once.
pub fn tools() -> Vec<&'static Tool> {
    let mut tools: Vec<&Tool> = STEPS.iter().flat_map(|step| step.tools).copied().collect();
    tools.sort_by_key(|tool| tool.name);
    tools.dedup_by_key(|tool| tool.name);
    tools
}

fn fmt(sh: &Shell) -> Result<()> {
    Ok(cmd!(sh, "cargo fmt --all --check").run()?)
}

/// Packages with a step of their own: they need a target or a compiler that not everybody has.
const APART: [&str; 4] = ["--exclude", "firmware", "--exclude", "board-emulator-test"];
/// What of the firmware is no board's.
const PORTABLE: [&str; 4] = ["--package", "firmware", "--lib", "--no-default-features"];

fn clippy(sh: &Shell) -> Result<()> {
    cmd!(sh, "cargo clippy --workspace {APART...} --all-targets -- -D warnings").run()?;
    cmd!(sh, "cargo clippy {PORTABLE...} --tests -- -D warnings").run()?;
    // The host tool's feature is the core's too.
    Ok(cmd!(sh, "cargo clippy --workspace {APART...} --features piezo/micromath,estimator-core/micromath --all-targets -- -D warnings").run()?)
}

fn doc(sh: &Shell) -> Result<()> {
    let _deny = sh.push_env("RUSTDOCFLAGS", "-D warnings");
    cmd!(sh, "cargo doc --workspace {APART...} --no-deps").run()?;
    Ok(cmd!(sh, "cargo doc {PORTABLE...} --no-deps").run()?)
}

/// The workspace's tests, all built with the same features, so that each package is compiled once. What needs more than
/// cargo brings is run by name only.
fn tests(sh: &Shell) -> Cmd<'_> {
    cmd!(sh, "cargo test --workspace {APART...}")
}

fn test(sh: &Shell) -> Result<()> {
    tests(sh).run()?;
    cmd!(sh, "cargo test {PORTABLE...} --tests").run()?;
    Ok(cmd!(sh, "cargo test -p estimator-core --features micromath").run()?)
}

fn firmware(sh: &Shell) -> Result<()> {
    for board in Board::ALL {
        embedded::cargo(sh)?
            .args(["clippy", "--release", "--package", "firmware", "--target", TARGET, "--lib"])
            .args(board.arguments())
            .args(["--", "-D", "warnings"])
            .run()?;
        let image = Image::read(&embedded::image(sh, board)?)?;
        let found = image.soft_doubles();
        ensure!(
            found.is_empty(),
            "something computes in f64, which takes hundreds of instructions: {}",
            found.join(" ")
        );
    }
    let micromath =
        ["build", "--release", "--package", "estimator-core", "--features", "micromath", "--target", TARGET];
    Ok(embedded::cargo(sh)?.args(micromath).run()?)
}

fn emulated(sh: &Shell) -> Result<()> {
    let image = embedded::image(sh, Board::Mps2An386)?;
    // Built for the tests on the host already.
    let piezo = artifact::build(tests(sh).arg("--no-run"), "piezo")?;
    tests(sh)
        .args(["exact", "follow", "link", "models", "pil", "store", "stream"].map(|test| format!("--test={test}")))
        .env("FIRMWARE_IMAGE_MPS2", image)
        .env("PIEZO", &piezo)
        .run()?;
    size::check(sh, &piezo)
}

fn board(sh: &Shell) -> Result<()> {
    let image = embedded::image(sh, Board::NucleoG474re)?;
    cmd!(sh, "cargo clippy --package board-emulator-test --all-targets -- -D warnings").run()?;
    Ok(cmd!(sh, "cargo test --package board-emulator-test -- --nocapture").env("FIRMWARE_IMAGE", image).run()?)
}

fn browser(sh: &Shell) -> Result<()> {
    let chrome = tool::chromium()?;
    let by_name = ["checks", "report"].map(|test| format!("--test={test}"));
    Ok(tests(sh).args(by_name).args(["--", "--nocapture"]).env("CHROME", chrome).run()?)
}
