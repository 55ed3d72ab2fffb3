//! `cargo xtask test`: runs the checks and says how they went.

use std::{path::PathBuf, process::ExitCode};

use anyhow::Result;
use clap::{Args, Command, builder::PossibleValuesParser};
use xshell::Shell;

use crate::{
    beside::{self, Beside},
    outcome::{self, Outcome},
    step::{STEPS, Step},
    stopwatch::Stopwatch,
    tool,
};

/// Which checks to run, and how.
#[derive(Args)]
pub struct Arguments {
    /// Checks to run instead of all
    #[arg(value_name = "STEP", value_parser = names())]
    steps: Vec<String>,
    /// Print the checks, one a line, and run none
    #[arg(long)]
    list: bool,
    /// Run the rest after a failure too
    #[arg(long)]
    keep_going: bool,
    /// Leave a check out; the summary says so
    #[arg(long, value_name = "STEP", value_parser = names())]
    skip: Vec<String>,
    /// Leave how the checks went in this file, for the run that started this one
    #[arg(long, hide = true, value_name = "FILE")]
    outcomes: Option<PathBuf>,
}

fn names() -> PossibleValuesParser {
    STEPS.iter().map(|step| step.name).collect::<Vec<_>>().into()
}

/// Runs the checks asked for, some of them beside others. The end of the output says what each took, and the last line
/// counts them; the exit code says whether any failed. `xtask` is the command line of `cargo xtask`.
///
/// # Errors
/// Those beside others cannot be started, or their output cannot be read.
pub fn run(sh: &Shell, arguments: &Arguments, xtask: &Command) -> Result<ExitCode> {
    if arguments.list {
        for step in &STEPS {
            println!("{:8} {}", step.name, step.about);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let stopwatch = Stopwatch::start();
    let named = |names: &[String], step: &Step| names.iter().any(|name| name == step.name);
    let chosen: Vec<&Step> =
        STEPS.iter().filter(|step| arguments.steps.is_empty() || named(&arguments.steps, step)).collect();
    let skipped = |step: &Step| named(&arguments.skip, step);
    // Where nothing follows them, they need no process of their own.
    let others = chosen.iter().skip_while(|step| !step.beside).any(|step| !step.beside && !skipped(step));
    let apart = |step: &Step| others && step.beside && !skipped(step);
    let mut outcomes = Vec::with_capacity(chosen.len());
    let (mut failed, mut started) = (false, None);
    for (index, step) in chosen.iter().enumerate() {
        let ends = failed && !arguments.keep_going;
        if apart(step) && !ends {
            if started.is_none() {
                let steps: Vec<&Step> = chosen.iter().copied().filter(|step| apart(step)).collect();
                let names: Vec<&str> = steps.iter().map(|step| step.name).collect();
                println!("\nbeside what follows, and printed after it: {}", names.join(", "));
                started = Some(Beside::start(steps, arguments.keep_going)?);
            }
            continue;
        }
        println!("\n[{}/{}] {}: {}", index + 1, chosen.len(), step.name, step.about);
        let outcome = if skipped(step) {
            Outcome::Skipped
        } else if ends {
            Outcome::NotRun
        } else {
            execute(sh, step, xtask)
        };
        failed |= outcome.failed();
        println!("{}", outcome.describe(step));
        outcomes.push((*step, outcome));
    }
    outcomes.extend(started.map(Beside::finish).transpose()?.into_iter().flatten());
    println!();
    for (step, outcome) in &outcomes {
        println!("{}", outcome.describe(step));
    }
    let outcomes: Vec<Outcome> = outcomes.into_iter().map(|(_, outcome)| outcome).collect();
    if let Some(path) = &arguments.outcomes {
        beside::leave(path, &outcomes)?;
    }
    println!("{:9} {}", "all", stopwatch.read());
    println!("{}", outcome::count(&outcomes));
    Ok(if outcomes.iter().any(Outcome::failed) { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn execute(sh: &Shell, step: &Step, xtask: &Command) -> Outcome {
    let stopwatch = Stopwatch::start();
    let result = tool::require(sh, step.tools).and_then(|()| (step.run)(sh, xtask));
    match result {
        Ok(()) => Outcome::Passed(stopwatch.read()),
        Err(error) => {
            println!("{error:#}");
            Outcome::Failed(stopwatch.read())
        }
    }
}
