//! `piezo`: parses arguments, runs a verb, turns what comes of it into an exit code.

use clap::{Parser, Subcommand};
use host_tools::command::{emit, identify, reproduce, simulate, validate};
use std::process::ExitCode;

/// Sensorless displacement of piezo actuators: learn the model from one recorded session with a real sensor, prove it on
/// data it has not seen, and put it on a microcontroller.
#[derive(Parser)]
#[command(name = "piezo", version, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a threshold of `validate` was exceeded; 2 the arguments or a file are \
                          wrong: no file is left half-written.";

#[derive(Subcommand)]
enum Verb {
    /// Recorded logs → parameter table (table.toml, table.rs, table.bin) and report.html.
    #[command(after_help = "Example: piezo identify tests/data/picma-p885-1hz.csv --out out/demo")]
    Identify(Box<identify::Identify>),
    /// Table + logs → errors, f64 reference and f32 core side by side.
    #[command(after_help = "Example: piezo validate out/demo/table.toml other.csv --max-percent 2")]
    Validate(validate::Validate),
    /// The synthetic rig → the thesis's six logs as CSV.
    #[command(after_help = "Example: piezo simulate --out out/rig --noise-nm 20 --adc-bits 12")]
    Simulate(simulate::Simulate),
    /// A table → its faces, in another form or with the calibration of your board.
    #[command(
        after_help = "Example: piezo emit out/demo/table.toml --adc-span -22:22 --form tabulated --out out/board"
    )]
    Emit(emit::Emit),
    /// The thesis's validation errors beside ours on the synthetic rig.
    #[command(after_help = "Example: piezo reproduce --json")]
    Reproduce(reproduce::Reproduce),
}

fn main() -> ExitCode {
    let result = match Cli::parse().verb {
        Verb::Identify(arguments) => identify::run(&arguments),
        Verb::Validate(arguments) => validate::run(&arguments),
        Verb::Simulate(arguments) => simulate::run(&arguments),
        Verb::Emit(arguments) => emit::run(&arguments),
        Verb::Reproduce(arguments) => reproduce::run(&arguments),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("piezo: {error:#}");
            ExitCode::from(2)
        }
    }
}
