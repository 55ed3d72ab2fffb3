//! `cargo xtask bench`: what identification costs, in sample-evaluations a second, beside a plain loop.
//!
//! Times are this machine's, of this minute: no check compares them, and no figure of a document is made of them.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

/// How much to measure, and how to print it.
#[derive(Args)]
pub struct Arguments {
    /// A share of the thesis's workload, for a few seconds instead of some minutes
    #[arg(long)]
    quick: bool,
    /// Print JSON for machines
    #[arg(long)]
    json: bool,
}

/// Builds the bench as a release is built, and runs it.
///
/// # Errors
/// It does not build, or two kernels that should compute the same do not.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    let options = [("--quick", arguments.quick), ("--json", arguments.json)];
    let options = options.into_iter().filter_map(|(option, given)| given.then_some(option));
    Ok(cmd!(sh, "cargo bench --quiet --package identification --bench workload -- {options...}").quiet().run()?)
}
