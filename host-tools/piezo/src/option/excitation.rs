//! The voltages of a session on the bench.

use super::number::span;
use ::calibration::span::Span;
use anyhow::Result;
use bench::Wiring;
use clap::Args;
use excitation::{Drive, hertz};

/// What a drive is designed for.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "The voltages")]
pub struct ExcitationArgs {
    /// Lowest and highest voltage, V; without it all that board.toml allows.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub range: Option<Span>,
    /// Highest frequency, Hz: 50, 50Hz or 0.05kHz.
    #[arg(long, default_value_t = 20.0, value_parser = hertz, value_name = "HZ", allow_negative_numbers = true)]
    pub up_to: f64,
    /// Draws the random part.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
}

impl ExcitationArgs {
    /// The drive on a board, of so many s.
    pub fn drive(&self, wiring: &Wiring, seconds: f64) -> Result<Drive> {
        let range = self.range.map(|span| (span.zero, span.full));
        Ok(Drive::design(&wiring.request(range, self.up_to, seconds, self.seed)?)?)
    }
}
