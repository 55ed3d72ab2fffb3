//! The converters of the target.

use super::drive::DriveArgs;
use super::number::{positive, span};
use ::calibration::CalibrationOptions;
use ::calibration::span::Span;
use anyhow::Result;
use bench::BoardFacts;
use clap::Args;
use std::path::PathBuf;

/// Calibration of the converters.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Calibration of the target's converters")]
pub struct CalibrationArgs {
    /// What the board's converters and wires stand for: a board.toml. The options below win over what it says; with
    /// --dac-span its drive is not meant.
    #[arg(long, value_name = "FILE")]
    pub board: Option<PathBuf>,
    /// Amplifier voltage at ADC code 0 and at full scale, V; the first larger than the second where the divider
    /// inverts. Without it a range a little wider than the logs' is assumed.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub adc_span: Option<Span>,
    /// Largest ADC code (with oversampling); 4095 where nothing else is known.
    #[arg(long, value_parser = clap::value_parser!(u16).range(3..), allow_negative_numbers = true)]
    pub adc_full_scale: Option<u16>,
    /// Fastest change of the amplifier's output, V/s: its slew rate, or its peak current over the stack's capacitance,
    /// whichever is less; or the slew limit of what drives it. A device then finds a monitor's wire that is off, and
    /// estimates from no voltage that leaps farther.
    #[arg(long, value_parser = positive, allow_hyphen_values = true, value_name = "V/s")]
    pub amplifier_slew: Option<f64>,
    /// Displacement at DAC code 0 and at full scale, µm relative to the model's zero. Without it
    /// the displacement limits.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "µm:µm")]
    pub dac_span: Option<Span>,
    /// Largest DAC code; 4095 where nothing else is known.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub dac_full_scale: Option<u16>,
    /// The DAC as the amplifier's input.
    #[command(flatten)]
    pub drive: DriveArgs,
}

impl CalibrationArgs {
    /// What is stated, here or in the board's file.
    pub fn options(&self) -> Result<CalibrationOptions> {
        let &Self { ref board, adc_span, adc_full_scale, amplifier_slew, dac_span, dac_full_scale, ref drive } = self;
        let stated = CalibrationOptions {
            adc_span,
            adc_full_scale,
            amplifier_slew,
            dac_span,
            dac_full_scale,
            drive: drive.into(),
        };
        match board {
            Some(board) => Ok(BoardFacts::read(board)?.calibration(&stated)),
            None => Ok(stated),
        }
    }
}
