//! Errors as a table for people.

use identification::validate::Figures;

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
        figures.mae_um,
        figures.max_um,
        figures.rmse_um,
        figures.mae_percent,
        figures.mae_without_offset_um,
        figures.rmse_without_offset_um
    )
}
