//! `cargo xtask test`: runs the checks and says how they went.

use std::process::ExitCode;

use clap::{Args, builder::PossibleValuesParser};
use xshell::Shell;

use crate::{
    step::{STEPS, Step},
    stopwatch::{Spent, Stopwatch},
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
    Passed(Spent),
    Failed(Spent),
    Skipped,
    NotRun,
}

/// Runs the checks asked for. The end of the output says what each took, and the last line counts them; the exit code says
/// whether any failed.
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
    println!("{:9} {}", "all", outcomes.iter().filter_map(Outcome::spent).sum::<Spent>());
    println!("{}", count(&outcomes));
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn execute(sh: &Shell, step: &Step) -> Outcome {
    let stopwatch = Stopwatch::start();
    let result = tool::require(sh, step.tools).and_then(|()| (step.run)(sh));
    match result {
        Ok(()) => Outcome::Passed(stopwatch.read()),
        Err(error) => {
            println!("{error:#}");
            Outcome::Failed(stopwatch.read())
        }
    }
}

fn describe(step: &Step, outcome: &Outcome) -> String {
    let name = step.name;
    match outcome {
        Outcome::Passed(spent) => format!("{name:9} {spent}  passed"),
        Outcome::Failed(spent) => format!("{name:9} {spent}  FAILED"),
        Outcome::Skipped => format!("{name:9} SKIPPED, by --skip"),
        Outcome::NotRun => format!("{name:9} NOT RUN, after the failure above"),
    }
}

impl Outcome {
    fn spent(&self) -> Option<Spent> {
        match self {
            Self::Passed(spent) | Self::Failed(spent) => Some(*spent),
            Self::Skipped | Self::NotRun => None,
        }
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
