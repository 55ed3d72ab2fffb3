//! `piezo divider`: the resistors between an amplifier's monitor, or a sensor, and the board's pin, and what they cost; and those
//! between the board's output and the amplifier's input.

use super::print::out;
use crate::option::{choice, span};
use ::calibration::span::Span;
use anyhow::{Result, bail, ensure};
use bench::BoardFacts;
use clap::Args;
use divider::{FULL_SCALE, InputStage, OutputStage, REFERENCE_V, Sampling, Series, Source, TOLERANCE};
use serde_json::{Value, json};

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
        (stage_lines(&stage), stage_json(&stage))
    } else {
        let (source, volts, stands_for) = match (monitor, sensor) {
            (Some(monitor), _) => (Source::Monitor, monitor, amplifier),
            (None, Some(sensor)) => (Source::Sensor, sensor, displacement),
            (None, None) => bail!("nothing is named: --monitor, --sensor or --input"),
        };
        let stage = InputStage::choose(source, ends(volts)?, pair(stands_for), series)?;
        (divider_lines(&stage), divider_json(&stage))
    };
    match arguments.json {
        true => out(&serde_json::to_string_pretty(&json)?),
        false => lines.iter().for_each(|line| out(line)),
    }
    Ok(true)
}

/// The line of board.toml, and the option that says what the source's volts stand for.
fn field(source: Source) -> (&'static str, &'static str) {
    match source {
        Source::Monitor => ("adc_span", "--amplifier V:V"),
        Source::Sensor => ("sensor_span", "--displacement µm:µm"),
    }
}

fn divider_lines(stage: &InputStage) -> Vec<String> {
    let ((field, option), (_, unit)) = (field(stage.source), stage.source.stands_for());
    let mut lines = stage.lines();
    lines.push(String::new());
    match stage.span() {
        Some((zero, full)) => {
            lines.push("For board.toml, until `piezo calibrate` has measured it:".to_owned());
            lines.push(format!("\n    {field} = [{zero:.3}, {full:.3}]   # {unit} at code 0 and at full scale"));
            if stage.source == Source::Monitor {
                lines.push(format!("    adc_full_scale = {FULL_SCALE}"));
                lines.push(format!("    # amplifier_slew = <V/s>   # {}", BoardFacts::what("amplifier_slew")));
                lines.push(format!("\nor, as options: --adc-span {zero:.3}:{full:.3} --adc-full-scale {FULL_SCALE}"));
            }
        }
        None => lines.push(format!(
            "What the {}'s volts stand for was not said: with {option} this prints the line {field} of board.toml.",
            stage.source.name()
        )),
    }
    lines
}

fn divider_json(stage: &InputStage) -> Value {
    let InputStage { divider, ends_v: (low, high), .. } = stage;
    json!({
        "resistors_ohm": divider,
        "reference_v": REFERENCE_V,
        "source_v": stage.ends_v,
        "pin_v": [divider.pin(*low), divider.pin(*high)],
        "codes_v": divider.span(),
        "open_v": divider.open(),
        "adc_full_scale": FULL_SCALE,
        "volts_a_code": divider.volts_a_code(),
        "unit": stage.source.stands_for().1,
        "a_code": stage.a_volt().map(|scale| scale.abs() * divider.volts_a_code()),
        field(stage.source).0: stage.span(),
        "used": divider.used(stage.ends_v),
        "off_by_a_hundredth_of_supply_v": stage.off_by_a_hundredth_of_supply_v(),
        "tolerances": stage.costs(),
        "impedance_ohm": divider.impedance(),
        "sampling": Sampling::of(divider),
    })
}

fn stage_lines(stage: &OutputStage) -> Vec<String> {
    let mut lines = stage.lines();
    lines.push(String::new());
    lines.push(match stage.drive_span() {
        Some((at_zero, at_full)) => format!(
            "For board.toml, until `piezo calibrate` has measured it:\n\n    drive_span = [{at_zero:.3}, {at_full:.3}]   # V of the \
             amplifier at 0 V and at 3.3 V of A2\n\nor, as an option of `piezo emit`: --drive-span {at_zero:.3}:{at_full:.3}"
        ),
        None => {
            let (zero, full) = stage.stage.span();
            format!(
                "A2 at 0 V and at 3.3 V would be {zero:.3} and {full:.3} V of the input. What the amplifier makes of that was not said: with \
                 --amplifier V:V this prints the line drive_span of board.toml."
            )
        }
    });
    lines
}

fn stage_json(of: &OutputStage) -> Value {
    let (OutputStage { stage, ends_v: (low, high), .. }, (rest, holding)) = (of, of.holding());
    json!({
        "resistors_ohm": stage,
        "reference_v": REFERENCE_V,
        "input_v": [low, high],
        "pin_v": [stage.pin(*low), stage.pin(*high)],
        "output_v": stage.span(),
        "output_within_v": of.output_within_v(),
        "tolerance": TOLERANCE,
        "floating_input_v": rest,
        "up_and_down_kohm": holding,
        "drive_span": of.drive_span(),
    })
}
