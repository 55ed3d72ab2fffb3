//! Numbers and tables for people.

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

/// A progress bar on a terminal, nothing in a pipe.
pub fn progress(length: u64) -> indicatif::ProgressBar {
    let style = indicatif::ProgressStyle::with_template("{prefix:28} {wide_bar} {percent:>3} %  {msg}  {eta} left")
        .unwrap_or_else(|_| indicatif::ProgressStyle::default_bar());
    indicatif::ProgressBar::new(length).with_style(style)
}

/// Prints a line to standard output. A reader who has closed the pipe has seen enough; anything else that keeps the line
/// from being written (a full disk) ends the program with exit code 2.
pub fn out(line: &str) {
    if let Err(error) = crate::output::standard(format!("{line}\n").as_bytes()) {
        eprintln!("piezo: {error:#}");
        std::process::exit(2);
    }
}
