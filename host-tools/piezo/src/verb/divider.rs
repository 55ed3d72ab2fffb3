//! `piezo divider`: the resistors between an amplifier's monitor, or a sensor, and the board's pin, and what they cost;
//! and those between the board's output and the amplifier's input.

use super::print::out;
use crate::option::{choice, span};
use ::calibration::span::Span;
use anyhow::{Result, bail, ensure};
use clap::Args;
use divider::{InputStage, OutputStage, Series, Source};

/// Arguments of `piezo divider`.
#[derive(Args, Debug)]
pub struct DividerArgs {
    /// Lowest and highest voltage of the amplifier's monitor, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", required_unless_present_any = ["sensor", "input"])]
    pub monitor: Option<Span>,
    /// Amplifier's output at these two voltages of its monitor, or of its input, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", conflicts_with = "sensor")]
    pub amplifier: Option<Span>,
    /// Lowest and highest voltage of a displacement sensor's output, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", conflicts_with = "monitor")]
    pub sensor: Option<Span>,
    /// Displacement at these two voltages of the sensor, µm.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "µm:µm", conflicts_with_all = ["monitor", "input"])]
    pub displacement: Option<Span>,
    /// Lowest and highest voltage that the amplifier's input is to be given, V: the stage between A2 and there.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", conflicts_with_all = ["monitor", "sensor"])]
    pub input: Option<Span>,
    /// Values that the resistors are sold in.
    #[arg(long, value_parser = choice(SERIES), default_value = "e96")]
    pub series: Series,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
}

const SERIES: [(Series, &str, &str); 2] =
    [(Series::E24, "e24", "24 values a decade"), (Series::E96, "e96", "96 values a decade")];

/// Runs the verb.
pub fn run(arguments: &DividerArgs) -> Result<bool> {
    let DividerArgs { monitor, amplifier, sensor, displacement, input, series, .. } = *arguments;
    let ends = |volts: Span| {
        ensure!(volts.zero < volts.full, "{}:{}: name the lowest voltage first", volts.zero, volts.full);
        Ok((volts.zero, volts.full))
    };
    let pair = |span: Option<Span>| span.map(|Span { zero, full }| (zero, full));
    let (lines, json) = if let Some(input) = input {
        let stage = OutputStage::choose(ends(input)?, pair(amplifier), series)?;
        (remedy::output_stage(&stage), remedy::output_stage_json(&stage))
    } else {
        let (source, volts, stands_for) = match (monitor, sensor) {
            (Some(monitor), _) => (Source::Monitor, monitor, amplifier),
            (None, Some(sensor)) => (Source::Sensor, sensor, displacement),
            (None, None) => bail!("nothing is named: --monitor, --sensor or --input"),
        };
        let stage = InputStage::choose(source, ends(volts)?, pair(stands_for), series)?;
        (remedy::input_stage(&stage), remedy::input_stage_json(&stage))
    };
    match arguments.json {
        true => out(&serde_json::to_string_pretty(&json)?),
        false => lines.iter().for_each(|line| out(line)),
    }
    Ok(true)
}
