//! The list of checks.

use std::{num::NonZero, path::PathBuf, thread};

use anyhow::{Result, ensure};
use clap::Command;
use xshell::{Cmd, Shell, cmd};

use crate::{
    artifact, book,
    embedded::{self, Board, TARGET, TICK_HZ},
    figures,
    image::Image,
    kernels,
    packages::{BOARD, HOST, MICROMATH},
    python, rules,
    tool::{self, ARM_GCC, CHROMIUM, CMAKE, EMBEDDED, LIBCLANG, MAKE, PKG_CONFIG, PYTHON, QEMU, Tool, VALGRIND},
};

/// One check of the list.
pub struct Step {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it proves, in a line.
    pub about: &'static str,
    /// What it needs beyond cargo.
    pub tools: &'static [&'static Tool],
    /// Whether it may run beside those that follow: it uses one core for most of its time, and none of its
    /// tests measures time.
    pub beside: bool,
    /// Runs it, with the command line that it was named on, for what documents say of that; an error is
    /// the check's failure.
    pub run: fn(&Shell, &Command) -> Result<()>,
}

/// Every check, the quick ones first, and those that run beside others before these. `board` is the first of them: its
/// tests compile while others run.
pub const STEPS: [Step; 16] = [
    Step { name: "fmt", about: "the sources are formatted", tools: &[], beside: false, run: |sh, _| fmt(sh) },
    Step {
        name: "rules",
        about: "libraries name no flags or verbs, the identification needs no terminal, no host crate is too long, no modules make a circle, no example is untested, no documentation is of two words, no comment is wider than 120 columns, each change says whether a format changed",
        tools: &[],
        beside: false,
        run: |sh, _| rules::check(sh),
    },
    Step {
        name: "book",
        about: "every chapter, link, path, test and chore that a document names is there",
        tools: &[],
        beside: false,
        run: book::check,
    },
    Step { name: "clippy", about: "no lint fires", tools: &[], beside: false, run: |sh, _| clippy(sh) },
    Step {
        name: "doc",
        about: "the documentation builds without a warning",
        tools: &[],
        beside: false,
        run: |sh, _| doc(sh),
    },
    Step { name: "build", about: "the tests on the host compile", tools: &[], beside: false, run: |sh, _| build(sh) },
    Step {
        name: "board",
        about: "the board's own image does its work in a CPU emulator",
        tools: &[&EMBEDDED, &CMAKE, &MAKE, &PKG_CONFIG, &LIBCLANG],
        beside: true,
        run: |sh, _| board(sh),
    },
    Step {
        name: "firmware",
        about: "the firmware builds for both boards without software f64, and no lint fires at any rate",
        tools: &[&EMBEDDED],
        beside: true,
        run: |sh, _| firmware(sh),
    },
    Step {
        name: "c",
        about: "a program in C, linked with the static library, gives the host's bits on a Cortex-M4F in QEMU",
        tools: &[&EMBEDDED, &QEMU, &ARM_GCC],
        beside: true,
        run: |sh, _| c(sh),
    },
    Step {
        name: "python",
        about: "the wheel, installed where nothing else is, gives the program's numbers to Python and to a notebook",
        tools: &[&PYTHON],
        beside: true,
        run: |sh, _| python::check(sh, &built_piezo(sh)?),
    },
    Step {
        name: "html",
        about: "mdBook makes HTML of the book without a warning",
        tools: &[],
        beside: true,
        run: |sh, _| html(sh),
    },
    Step {
        name: "test",
        about: "unit, property and command tests on the host",
        tools: &[],
        beside: false,
        run: |sh, _| test(sh),
    },
    Step {
        name: "kernels",
        about: "the hot kernels of the identification take the instructions that are stated, within 3 %",
        tools: &[&VALGRIND],
        beside: false,
        run: |sh, _| kernels::check(sh),
    },
    Step {
        name: "emulated",
        about: "the host tool and the firmware in QEMU understand each other",
        tools: &[&EMBEDDED, &QEMU],
        beside: false,
        run: |sh, _| emulated(sh),
    },
    Step {
        name: "browser",
        about: "the HTML report, and the live scope of a device at 2 kHz, are sound in a browser on a phone's width and a desktop's",
        tools: &[&CHROMIUM, &EMBEDDED, &QEMU],
        beside: false,
        run: |sh, _| browser(sh),
    },
    Step {
        name: "figures",
        about: "documents state the figures that commands print; a tick takes no more than it should",
        tools: figures::TOOLS,
        beside: false,
        run: |sh, _| figures::check(sh, built_piezo(sh)?),
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

fn clippy(sh: &Shell) -> Result<()> {
    cmd!(sh, "cargo clippy {HOST...} --all-targets -- -D warnings").run()?;
    Ok(cmd!(sh, "cargo clippy {MICROMATH...} --lib --test=library --profile=test -- -D warnings").run()?)
}

/// With the examples, cargo chooses the features that the tests have, too, and finds what clippy has checked.
fn doc(sh: &Shell) -> Result<()> {
    Ok(cmd!(sh, "cargo doc {HOST...} --no-deps --lib --bins --examples").env("RUSTDOCFLAGS", "-D warnings").run()?)
}

/// The tests on the host. What needs more than cargo brings is run by name only.
fn tests(sh: &Shell) -> Cmd<'_> {
    cmd!(sh, "cargo test {HOST...}")
}

/// The host tool that the tests on the host are built with.
fn built_piezo(sh: &Shell) -> Result<PathBuf> {
    artifact::build(tests(sh).arg("--no-run"), "piezo")
}

/// By itself, so that what runs beside the tests does not wait for cargo's lock.
fn build(sh: &Shell) -> Result<()> {
    tests(sh).arg("--no-run").run()?;
    Ok(cmd!(sh, "cargo test {MICROMATH...} --lib --test=library --no-run").run()?)
}

fn test(sh: &Shell) -> Result<()> {
    // Twice as many at a time as there are cores: many wait for an emulated device, and others compute meanwhile.
    let at_a_time = 2 * thread::available_parallelism().map_or(1, NonZero::get);
    tests(sh).env("RUST_TEST_THREADS", at_a_time.to_string()).run()?;
    cmd!(sh, "cargo test {MICROMATH...} --lib --test=library").run()?;
    Ok(cmd!(sh, "cargo test {MICROMATH...} --doc").run()?)
}

/// Rates of the firmware that no check builds an image of.
const OTHER_RATES: [&str; 2] = ["1000", "5000"];

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
    for hz in OTHER_RATES {
        embedded::cargo(sh)?
            .args(["clippy", "--release", "--package", "firmware", "--target", TARGET, "--lib"])
            .args(Board::NucleoG474re.arguments())
            .args(["--", "-D", "warnings"])
            .env(TICK_HZ, hz)
            .run()?;
    }
    // Beside a board, whose foreign crates are built already.
    let micromath = ["--no-default-features", "--features", "mps2-an386,micromath", "--lib"];
    Ok(embedded::cargo(sh)?.arg("fw").args(micromath).run()?)
}

fn emulated(sh: &Shell) -> Result<()> {
    let image = embedded::image(sh, Board::Mps2An386)?;
    Ok(tests(sh)
        .args(["--test=exact", "--test=emulated"])
        .env("FIRMWARE_IMAGE_MPS2", image)
        .env("PIEZO", built_piezo(sh)?)
        .run()?)
}

fn c(sh: &Shell) -> Result<()> {
    let build = embedded::cargo(sh)?.args(["build", "--release", "--package", "estimator-c", "--target", TARGET]);
    let library = artifact::build(build, "libpiezo_estimator.a")?;
    Ok(tests(sh).args(["--test=cortex_m", "--", "--nocapture"]).env("STATIC_LIBRARY", library).run()?)
}

fn board(sh: &Shell) -> Result<()> {
    let fast = embedded::image_at(sh, 10_000)?;
    // The last one built is the one that stands where the book says.
    let image = embedded::image(sh, Board::NucleoG474re)?;
    cmd!(sh, "cargo clippy {BOARD...} --lib --test=image --profile=test -- -D warnings").run()?;
    // The cycles are counted, and held to what the core states, where the documents' figures are made of them.
    let tests = cmd!(sh, "cargo test {BOARD...} --lib --test=image -- --nocapture --skip cycles::no_");
    let tests = tests.env("FIRMWARE_IMAGE", image).env("FIRMWARE_IMAGE_10KHZ", fast);
    Ok(tests.env("PIEZO", built_piezo(sh)?).run()?)
}

/// With a lock and crates of its own, which nothing else here is built with. Clippy compiles it, by the lints of its
/// manifest: to check it first would take mdBook's crates twice.
fn html(sh: &Shell) -> Result<()> {
    let own = ["--manifest-path", "book/html/Cargo.toml"];
    cmd!(sh, "cargo fmt {own...} --check").run()?;
    let run = cmd!(sh, "cargo run --quiet --locked {own...} --target-dir target/html");
    Ok(run.env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver").run()?)
}

fn browser(sh: &Shell) -> Result<()> {
    let by_name = ["checks", "report", "scope"].map(|test| format!("--test={test}"));
    let tests = tests(sh).args(by_name).args(["--", "--nocapture"]);
    let tests =
        tests.env("CHROME", tool::chromium()?).env("FIRMWARE_IMAGE_MPS2", embedded::image(sh, Board::Mps2An386)?);
    Ok(tests.env("PIEZO", built_piezo(sh)?).run()?)
}
