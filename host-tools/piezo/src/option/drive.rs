//! The DAC as the amplifier's input.

use super::choice::{Choice, choice};
use super::number::span;
use ::calibration::drive::DriveOptions;
use ::calibration::span::Span;
use clap::Args;

/// The DAC as the amplifier's input.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Where the DAC drives the amplifier instead of showing the displacement")]
pub struct DriveArgs {
    /// Amplifier voltage at DAC code 0 and at full scale, V; the first larger than the second where the amplifier
    /// inverts. The DAC then drives the amplifier (piezo follow), and never shows a displacement.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", requires = "drive_slew")]
    pub drive_span: Option<Span>,
    /// Fastest change of that voltage, V/s.
    #[arg(long, value_name = "V/s", requires = "drive_span", allow_hyphen_values = true)]
    pub drive_slew: Option<f64>,
    /// Voltages that it may be driven to, V. Without it, all that the DAC can and the model was identified on.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", requires = "drive_span")]
    pub drive_range: Option<Span>,
    /// Voltage when nothing is wanted or something is wrong, V. Without it 0, or the voltage nearest to it.
    #[arg(long, allow_hyphen_values = true, value_name = "V", requires = "drive_span")]
    pub drive_rest: Option<f64>,
    /// Displacement that a controller wants by the set-point's ADC code 0 and by its full scale, µm relative to
    /// the model's zero; the first larger than the second where the input inverts. The device can then follow
    /// it (piezo linearise).
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "µm:µm")]
    pub setpoint_span: Option<Span>,
    /// When to follow the set-point. Without it as the table or board.toml says, and on request where neither does.
    #[arg(long, value_name = "WHEN", value_parser = choice(WHEN))]
    pub linearise: Option<bool>,
}

/// Whether the set-point is followed of itself after a start.
const WHEN: [Choice<bool>; 2] = [
    (true, "at-start", "After every start, without a host"),
    (false, "on-request", "When piezo linearise asks for it"),
];

impl From<&DriveArgs> for DriveOptions {
    fn from(arguments: &DriveArgs) -> Self {
        let &DriveArgs { drive_span, drive_slew, drive_range, drive_rest, setpoint_span, linearise } = arguments;
        Self { drive_span, drive_slew, drive_range, drive_within: None, drive_rest, setpoint_span, linearise }
    }
}
