//! The converters of the target.

use super::drive::DriveArgs;
use super::number::span;
use clap::Args;
use identification::calibration::CalibrationOptions;
use identification::span::Span;

/// Calibration of the converters.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Calibration of the target's converters")]
pub struct CalibrationArgs {
    /// Amplifier voltage at ADC code 0 and at full scale, V; the first larger than the second where the divider inverts.
    /// Without it a range a little wider than the logs' is assumed.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub adc_span: Option<Span>,
    /// Largest ADC code (with oversampling); 4095 where nothing else is known.
    #[arg(long, value_parser = clap::value_parser!(u16).range(3..))]
    pub adc_full_scale: Option<u16>,
    /// Displacement at DAC code 0 and at full scale, µm relative to the model's zero. Without it the displacement limits.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "µm:µm")]
    pub dac_span: Option<Span>,
    /// Largest DAC code; 4095 where nothing else is known.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub dac_full_scale: Option<u16>,
    /// The DAC as the amplifier's input.
    #[command(flatten)]
    pub drive: DriveArgs,
}

impl From<&CalibrationArgs> for CalibrationOptions {
    fn from(arguments: &CalibrationArgs) -> Self {
        let &CalibrationArgs { adc_span, adc_full_scale, dac_span, dac_full_scale, ref drive } = arguments;
        Self { adc_span, adc_full_scale, dac_span, dac_full_scale, drive: drive.into() }
    }
}
