//! `cargo xtask miri`: nothing that reads flash, the wire or a C program's pointers does what Rust leaves undefined.
//!
//! Miri interprets the tests, an instruction at a time, and stops at a pointer beyond its object, a value that is none
//! of its type, or a place that two own. It does so for a machine of 32 bits, as the chip is; a desktop's has assembly
//! in its arithmetic, which it cannot interpret. That takes hundreds of times as long as to run them, so tests of
//! thousands of cases have few or are left out, by name.

use anyhow::{Context, Result};
use xshell::{Shell, cmd};

/// 32 bits, and a standard library for the tests to run with.
const TARGET: &str = "armv7-unknown-linux-gnueabihf";
/// Of a test over random inputs.
const CASES: &str = "2";

/// Tests that Miri runs.
struct Run {
    /// What cargo is asked for.
    tests: &'static [&'static str],
    /// What of these takes more than minutes, or starts another program.
    left_out: &'static [&'static str],
}

const RUNS: [Run; 4] = [
    Run { tests: &["--package=piezo-estimator-protocol"], left_out: &[] },
    Run {
        tests: &["--package=parameter-store"],
        left_out: &[
            "a_cut_at_any_operation",
            "a_cut_erase_leaves",
            "a_flipped_bit_costs",
            "a_mark_that_fails",
            "a_torn_word_costs",
            "an_erase_that_takes_the_mark",
            "whatever_decays_in_both_pages",
        ],
    },
    // A NARX table is admitted once its feedback is proven to contract.
    Run { tests: &["--package=estimator-c", "--test=refusals"], left_out: &["an_inverse_needs_limits"] },
    Run {
        tests: &["--package=estimator-core", "--lib"],
        left_out: &[
            "accuracy_is_as_stated",
            "decades_are_counted",
            "noise_within_the_deadband",
            "relaxation",
            "resonance",
        ],
    },
];

/// Runs them, one package after the other.
///
/// # Errors
/// There is no nightly compiler and none can be had, a test fails, or Miri finds what is undefined.
pub fn run(sh: &Shell) -> Result<()> {
    if cmd!(sh, "rustup run nightly cargo miri --version").quiet().ignore_stderr().run().is_err() {
        cmd!(sh, "rustup toolchain install nightly --profile minimal --component miri --component rust-src")
            .run()
            .context("Miri is a part of nightly compilers")?;
    }
    let _cases = sh.push_env("PROPTEST_CASES", CASES);
    // What fails of random inputs is kept in a file.
    let _files = sh.push_env("MIRIFLAGS", "-Zmiri-disable-isolation");
    for Run { tests, left_out } in RUNS {
        let skips = left_out.iter().flat_map(|name| ["--skip", name]);
        cmd!(
            sh,
            "rustup run nightly cargo miri test --target {TARGET} --target-dir target/miri {tests...} -- {skips...}"
        )
        .run()?;
        left_out.iter().for_each(|name| println!("left out: {name}…"));
    }
    Ok(())
}
