//! The stages between amplifier, sensor and board, with the lines of board.toml that they make.

use bench::BoardFacts;
use divider::{FULL_SCALE, InputStage, OutputStage, REFERENCE_V, Sampling, Source, TOLERANCE};
use serde_json::{Value, json};

/// The line of board.toml, and the option that says what the source's volts stand for.
fn field(source: Source) -> (&'static str, &'static str) {
    match source {
        Source::Monitor => ("adc_span", "--amplifier V:V"),
        Source::Sensor => ("sensor_span", "--displacement µm:µm"),
    }
}

/// The lines of an input stage: its resistors, and what board.toml is to say of it.
pub fn input_stage(stage: &InputStage) -> Vec<String> {
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

/// The same as JSON.
pub fn input_stage_json(stage: &InputStage) -> Value {
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

/// The lines of an output stage: its resistors, and what board.toml is to say of it.
pub fn output_stage(stage: &OutputStage) -> Vec<String> {
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

/// The same as JSON.
pub fn output_stage_json(of: &OutputStage) -> Value {
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
