//! `cargo xtask test`: runs the checks and says how they went.

use std::{
    process::ExitCode,
    time::{Duration, Instant},
};

use clap::{Args, builder::PossibleValuesParser};
use xshell::Shell;

use crate::{
    step::{STEPS, Step},
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
}

fn names() -> PossibleValuesParser {
    STEPS.iter().map(|step| step.name).collect::<Vec<_>>().into()
}

enum Outcome {
    Passed(Duration),
    Failed(Duration),
    Skipped,
    NotRun,
}

/// Runs the checks asked for. The last line of output counts them; the exit code says whether any failed.
pub fn run(sh: &Shell, arguments: &Arguments) -> ExitCode {
    if arguments.list {
        for step in &STEPS {
            println!("{:8} {}", step.name, step.about);
        }
        return ExitCode::SUCCESS;
    }
    let named = |names: &[String], step: &Step| names.iter().any(|name| name == step.name);
    let chosen: Vec<&Step> =
        STEPS.iter().filter(|step| arguments.steps.is_empty() || named(&arguments.steps, step)).collect();
    let mut outcomes = Vec::with_capacity(chosen.len());
    let mut failed = false;
    for (index, step) in chosen.iter().enumerate() {
        println!("\n[{}/{}] {}: {}", index + 1, chosen.len(), step.name, step.about);
        let outcome = if named(&arguments.skip, step) {
            Outcome::Skipped
        } else if failed && !arguments.keep_going {
            Outcome::NotRun
        } else {
            execute(sh, step)
        };
        failed |= matches!(outcome, Outcome::Failed(_));
        println!("{}", describe(step, &outcome));
        outcomes.push(outcome);
    }
    println!();
    for (step, outcome) in chosen.iter().zip(&outcomes) {
        println!("{}", describe(step, outcome));
    }
    println!("{}", count(&outcomes));
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn execute(sh: &Shell, step: &Step) -> Outcome {
    let start = Instant::now();
    let result = tool::require(sh, step.tools).and_then(|()| (step.run)(sh));
    match result {
        Ok(()) => Outcome::Passed(start.elapsed()),
        Err(error) => {
            println!("{error:#}");
            Outcome::Failed(start.elapsed())
        }
    }
}

fn describe(step: &Step, outcome: &Outcome) -> String {
    let name = step.name;
    match outcome {
        Outcome::Passed(time) => format!("{name} passed in {:.1} s", time.as_secs_f64()),
        Outcome::Failed(time) => format!("{name} FAILED after {:.1} s", time.as_secs_f64()),
        Outcome::Skipped => format!("{name} SKIPPED, by --skip"),
        Outcome::NotRun => format!("{name} NOT RUN, after the failure above"),
    }
}

/// `N passed, N failed`, and how many were skipped if any were; those a failure kept from running count as skipped.
fn count(outcomes: &[Outcome]) -> String {
    let passed = outcomes.iter().filter(|outcome| matches!(outcome, Outcome::Passed(_))).count();
    let failed = outcomes.iter().filter(|outcome| matches!(outcome, Outcome::Failed(_))).count();
    let skipped = outcomes.len() - passed - failed;
    let mut line = format!("{passed} passed, {failed} failed");
    if skipped > 0 {
        line += &format!(", {skipped} skipped");
    }
    line
}
