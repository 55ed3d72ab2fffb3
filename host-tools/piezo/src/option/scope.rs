//! Which part of a log is scored, and what the estimator is told.

use super::choice::Choice;
use super::number::not_negative;
use clap::Args;
use identification::validate::{Scope, Told};

/// Which part of each log is scored.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "What is scored (the estimator always runs from the log's beginning)")]
pub struct ScopeArgs {
    /// Score from this time on, s from the log's first sample.
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Score up to this time, s from the log's first sample.
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Zero the estimate at this time, s from the log's first sample, as `piezo zero` does: its mean error over the 50
    /// ms up to there is taken off, and only what follows is scored. Before, the device is told nothing.
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub zero_at: Option<f64>,
}

impl From<&ScopeArgs> for Scope {
    fn from(arguments: &ScopeArgs) -> Self {
        Self { from_s: arguments.from, to_s: arguments.to, zero_at_s: arguments.zero_at }
    }
}

/// What the estimator is told.
pub const TOLD: [Choice<Told>; 4] = [
    (Told::Nothing, Told::Nothing.name(), "Nothing, as a device that is switched on"),
    (Told::FirstReading, Told::FirstReading.name(), "The sensor's first reading"),
    (
        Told::OneCycle,
        Told::OneCycle.name(),
        "The mean error over a full cycle, the second where enough follows it, taken off from then on; what follows is scored",
    ),
    (Told::Offset, Told::Offset.name(), "The mean error of what is scored, taken off: a bound on what zeroing can do"),
];
