//! Errors as a table for people.

use crate::micrometres::Micrometres;
use identification::validate::Figures;
use identification::{Candidate, Outcome, StraightLine};

/// Heading of [`row`].
pub fn heading(first: &str) -> String {
    format!(
        "{first:<34} {:>8} {:>8} {:>8} {:>8} {:>14} {:>14}",
        "MAE µm", "MAX µm", "RMSE µm", "% stroke", "MAE, no offset", "RMS, no offset"
    )
}

/// One line of errors: MAE, MAX, RMSE, MAE in % of the stroke, MAE and RMS without a constant offset.
pub fn row(first: &str, figures: &Figures) -> String {
    format!(
        "{first:<34} {:>8.4} {:>8.4} {:>8.4} {:>8.2} {:>14.4} {:>14.4}",
        Micrometres(figures.mae_um),
        Micrometres(figures.max_um),
        Micrometres(figures.rmse_um),
        figures.mae_percent,
        Micrometres(figures.mae_without_offset_um),
        Micrometres(figures.rmse_without_offset_um)
    )
}

/// The errors of every candidate, the chosen one marked, and of a straight line: held out where something was,
/// else in training.
pub fn of_outcome(outcome: &Outcome) -> Vec<String> {
    let figures = |candidate: &Candidate| candidate.held_out_figures().or(candidate.training_figures());
    let held_out = outcome.judged().held_out_figures().is_some();
    let mut lines = vec![heading(if held_out { "held out, in simulation" } else { "training, in simulation" })];
    lines.extend(outcome.candidates.iter().enumerate().filter_map(|(index, candidate)| {
        let mark = if index == outcome.chosen { "→ " } else { "  " };
        Some(row(&format!("{mark}{}", candidate.table.model()), &figures(candidate)?))
    }));
    if let Some(line) = &outcome.straight_line {
        lines.push(row(&format!("  {}", StraightLine::NAME), &line.held_out.unwrap_or(line.training)));
    }
    lines.extend(outcome.failed.iter().map(|(model, _)| format!("  {model}: no admissible candidate was found")));
    lines
}
