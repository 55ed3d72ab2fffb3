//! `cargo xtask`: the chores of this repository.
//!
//! `setup` gets a machine ready; `test` runs the one list of checks, the same for people and for CI; `emulate` starts
//! the firmware without a board; `size` says what it takes of the chip, `cycles` what its tick costs; `figures` writes
//! the documents' figures; `bench` measures what identification costs, `kernels` counts the instructions of what is hot
//! in it; `soak` has the firmware stream for an hour, `miri` looks for what Rust leaves undefined.

mod artifact;
mod bench;
mod beside;
mod book;
mod changelog;
mod check;
mod circles;
mod comments;
mod cycles;
mod embedded;
mod emulate;
mod figures;
mod image;
mod kernels;
mod miri;
mod outcome;
mod packages;
mod python;
mod qemu;
mod root;
mod rules;
mod size;
mod soak;
mod step;
mod stopwatch;
mod tool;

use std::{path::Path, process::ExitCode};

use anyhow::{Context, Result, ensure};
use clap::{CommandFactory as _, Parser, Subcommand};
use xshell::Shell;

/// The chores of this repository.
#[derive(Parser)]
#[command(bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Get this machine ready for every check; what is already there is left alone
    Setup,
    /// Run the checks, all of them or those named, in the order of the list
    Test(check::Arguments),
    /// Start the firmware in QEMU, for `piezo` to talk to as to a board
    Emulate(emulate::Arguments),
    /// Print what the firmware takes of the chip: flash, RAM, instructions per tick
    Size(size::Arguments),
    /// Print what the tick's interrupt costs on the board, in cycles, with every model
    Cycles(cycles::Arguments),
    /// Write the figures that documents state, from what the commands print, or compare them
    Figures(figures::Arguments),
    /// Measure what identification costs: sample-evaluations a second beside a plain loop
    Bench(bench::Arguments),
    /// Count the instructions of identification's hot kernels, or write the file that the check compares with
    Kernels(kernels::Arguments),
    /// Have the firmware stream for an hour of its own time, and compare every sample with the host's
    Soak(soak::Arguments),
    /// Have Miri interpret the tests of what reads flash, the wire and a C program's pointers
    Miri,
}

fn main() -> Result<ExitCode> {
    let arguments = Arguments::parse();
    let sh = Shell::new()?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask has left the repository's root folder")?;
    sh.change_dir(root);
    let one_rate = matches!(arguments.chore, Chore::Setup | Chore::Emulate(_));
    ensure!(
        one_rate || std::env::var_os(embedded::TICK_HZ).is_none(),
        "{} is set: unset it, the checks and what they measure build every rate by themselves",
        embedded::TICK_HZ
    );
    match arguments.chore {
        Chore::Setup => tool::setup(&sh, &step::tools()).map(|()| ExitCode::SUCCESS),
        Chore::Test(arguments) => check::run(&sh, &arguments, &Arguments::command()),
        Chore::Emulate(arguments) => emulate::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Size(arguments) => size::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Cycles(arguments) => cycles::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Figures(arguments) => figures::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Bench(arguments) => bench::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Kernels(arguments) => kernels::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Soak(arguments) => soak::run(&sh, &arguments).map(|()| ExitCode::SUCCESS),
        Chore::Miri => miri::run(&sh).map(|()| ExitCode::SUCCESS),
    }
}
