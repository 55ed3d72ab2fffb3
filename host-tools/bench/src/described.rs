//! A table as a person reads it: what it is for, what its converters stand for, what it drives, and how good it was.

use crate::wiring::{NO_MODEL, is_line};
use ::calibration::drive::trained_on;
use estimator_core::{AdcCode, Admitted, DacCode, DriveLimits, Range, Table};
use feedforward::{Beyond, Plan, reach};
use std::path::Path;

/// What is said of a table with which a device does not find a monitor's wire that is off: nobody said how fast the
/// amplifier is, or it is so fast that hardly any leap is more than it can.
pub fn wire_not_found(table: &Table) -> Option<String> {
    let found = "a monitor's wire that is off is not found";
    match table.least_leap_v() {
        None => Some(format!(
            "{found}: state amplifier_slew, the fastest that the amplifier can, V/s, in board.toml or as an option"
        )),
        Some(_) if table.finds_open_wire() => None,
        Some(least) => Some(format!(
            "{found}: only a leap of more than {least:.3} V in a tick is, and the table's voltages span {:.3} V. State as amplifier_slew, in \
             board.toml or as an option, the fastest that the voltage ever goes in this use, V/s: not the amplifier's own rate, where a \
             controller's or a generator's slew limit keeps it slower",
            table.voltage_range_v.span()
        )),
    }
}

/// What can be held at rest, µm, in words.
pub fn held(table: &Admitted, limits: &DriveLimits) -> String {
    let [low, high] = reach(table, limits);
    let Range { min, max } = limits.range_v;
    format!("At rest {min} … {max} V hold about {low:.2} … {high:.2} µm, relative to the model's zero")
}

/// How far a model's displacement is to be believed, by its mean error on what was held out, µm, in words.
pub fn believed(held_out_mae_um: Option<f32>) -> String {
    match held_out_mae_um {
        Some(mae) => {
            format!(
                "The model itself was {mae:.3} µm off on average on what was held out when it was identified, its sensor's zero included"
            )
        }
        None => "How far the model itself is off nobody knows: nothing was held out when it was identified".to_owned(),
    }
}

/// What is to be said of what a table's model drives; a line each.
pub fn caveats(table: &Admitted, limits: &DriveLimits) -> [String; 2] {
    [held(table, limits), believed(table.provenance.validation_mae_um)]
}

/// What is to be said of a plan whose voltage goes beyond those of the training, into the room that a table has there.
pub fn beyond_training(table: &Admitted, plan: &Plan) -> Option<String> {
    let trained = trained_on(table);
    let Beyond { ticks, from_tick, most_v } = plan.beyond(trained)?;
    Some(format!(
        "On {ticks} of {} ticks, from {:.3} s on, the voltage goes up to {most_v:.3} V beyond what the logs taught, {:.3} … {:.3} V: there the \
         model was not trained, and how far it is off nobody knows",
        plan.voltage.len(),
        from_tick as f64 * table.sample_period::<f64>(),
        trained.min,
        trained.max
    ))
}

/// What a table is called: by its model, where it has one.
pub fn title(table: &Table) -> String {
    if is_line(table) { "straight line".to_owned() } else { table.model().to_string() }
}

/// A table as a sentence names it: by its file, its model, its checksum, and that of the file's own table, which has
/// not the board's calibration.
pub fn called(file: &Path, table: &Admitted) -> String {
    let own = table_files::name(table);
    let from = table_files::read(file).ok().map(|(_, of_file)| table_files::name(&of_file)).filter(|from| *from != own);
    let from = from.map_or(String::new(), |from| format!(" as calibrated for this board; made from {from}"));
    let file = file.display();
    match is_line(table) {
        true => format!("{file} (checksum {own}{from})"),
        false => format!("{file} ({}, checksum {own}{from})", title(table)),
    }
}

/// A table in a few lines.
pub fn describe(table: &Admitted) -> Vec<String> {
    let volts = |code| table.adc.voltage::<f32>(AdcCode(code));
    let output = |code| match &table.drive {
        Some(drive) => format!("{:.3} V", drive.voltage::<f32>(DacCode(code))),
        None => format!("{:.3} µm", table.dac.displacement::<f32>(DacCode(code))),
    };
    let (adc, dac) = (table.adc.full_scale, table.dac.full_scale);
    let (voltage, limits, made) = (table.voltage_range_v, table.displacement_limits_um, &table.provenance);
    let [major, minor, patch] = made.tool_version;
    let held_out = match (made.validation_mae_um, made.validation_max_um) {
        (Some(mae), Some(max)) => format!("{mae:.3} µm on what was held out then, at most {max:.3} µm"),
        _ => "nothing was held out".to_owned(),
    };
    vec![
        format!("{}, tick {} µs", title(table), table.sample_period_us),
        format!(
            "voltages {:.3} … {:.3} V around {:.3} V, displacements {:.3} … {:.3} µm",
            voltage.min, voltage.max, table.voltage_zero_v, limits.min, limits.max
        ),
        format!(
            "ADC 0 … {adc} is {:.3} … {:.3} V, DAC 0 … {dac} is {} … {}{}",
            volts(0),
            volts(adc),
            output(0),
            output(dac),
            driven(table)
        ),
        match is_line(table) {
            true => NO_MODEL.to_owned(),
            false => format!(
                "by piezo {major}.{minor}.{patch} from logs {}, seed {}: {:.3} µm off on average in training, starts included, without each log's own offset; {held_out}",
                made.logs, made.seed, made.train_mae_um
            ),
        },
        time(table),
        wire(table),
        table.interval.map_or("no ± beside the estimate".to_owned(), |interval| {
            format!("± {:.3} µm beside the estimate at least, once its displacement was told", interval.misfit_um)
        }),
    ]
}

/// What is held, and whether that finds a wire that is off.
fn wire(table: &Table) -> String {
    let held = table.amplifier_slew_v_per_s.zip(table.least_leap_v()).map(|(slew, least)| {
        format!(
            "the amplifier goes {slew} V/s at most: a voltage that leaps by more than {least:.3} V in a tick is held"
        )
    });
    match (held, wire_not_found(table)) {
        (Some(held), Some(not_found)) => format!("{held}, but {not_found}"),
        (Some(held), None) => format!("{held}, and a fault where it lasts"),
        (None, not_found) => not_found.unwrap_or_default(),
    }
}

/// What its tick takes on the board.
pub fn time(table: &Table) -> String {
    let cycles = table.cycles();
    format!(
        "a tick takes at most {} cycles, {:.0} % of the board's {}; observed in an emulator, not proven",
        cycles.most,
        cycles.percent(),
        cycles.period
    )
}

/// What the DAC drives, if anything.
fn driven(table: &Admitted) -> String {
    table.drive.map_or(String::new(), |drive| {
        let DriveLimits { range_v, rest_v, slew_v_per_s } = drive.limits;
        let wanted = drive.setpoint.map_or(String::new(), |setpoint| {
            let um = |code| setpoint.displacement::<f32>(AdcCode(code));
            let (zero, full) = (um(0), um(table.adc.full_scale));
            let start = if setpoint.at_start { ", followed after every start" } else { "" };
            format!("; a set-point of 0 … {} wants {zero:.3} … {full:.3} µm{start}", table.adc.full_scale)
        });
        format!(
            ": it drives the amplifier, to {:.3} … {:.3} V at {slew_v_per_s} V/s, rests at {rest_v} V{wanted}",
            range_v.min, range_v.max
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::FACTS;
    use crate::wiring::Wiring;
    use estimator_core::{DriveCalibration, SetpointCalibration, Table};

    #[test]
    fn a_set_point_is_described_where_there_is_one() {
        let mut table = *Wiring::new(&FACTS, 500).unwrap().line().to_owned();
        let said = |table: Table| describe(&table.admit().unwrap()).join("\n");
        assert!(!said(table).contains("set-point"), "{}", said(table));
        let setpoint = SetpointCalibration { gain_um_per_code: 20.0 / 65_520.0, offset_um: -1.0, at_start: true };
        table.drive = table.drive.map(|drive| DriveCalibration { setpoint: Some(setpoint), ..drive });
        assert!(said(table).contains("-1.000 … 19.000 µm, followed after every start"), "{}", said(table));
    }

    #[test]
    fn what_is_held_is_said_and_that_a_wire_is_not_found_where_it_is_not() {
        let line = *Wiring::new(&FACTS, 500).unwrap().line().to_owned();
        let said = |slew| {
            let table = Table { drive: None, amplifier_slew_v_per_s: slew, ..line };
            (describe(&table.admit().unwrap()).join("\n"), wire_not_found(&table))
        };
        let (described, not_found) = said(Some(20_000.0));
        // In a tick of 500 µs 10 V and a code, and a 96th of the codes.
        assert!(described.contains("goes 20000 V/s at most: a voltage that leaps by more than 11.7"), "{described}");
        assert!(described.contains("and a fault where it lasts") && not_found.is_none(), "{not_found:?}");
        for slew in [Some(1e6), None] {
            let (described, not_found) = said(slew);
            let not_found = not_found.expect("nothing is held");
            assert!(described.contains(&not_found) && !described.contains("a fault where"), "{described}");
            assert_eq!(not_found.contains("that the voltage ever goes in this use"), slew.is_some(), "{not_found}");
            assert!(not_found.starts_with("a monitor's wire that is off is not found: "), "{not_found}");
        }
    }

    #[test]
    fn a_straight_line_is_not_described_as_a_model() {
        let line = describe(Wiring::new(&FACTS, 500).unwrap().line()).join("\n");
        assert!(line.contains(NO_MODEL) && !line.contains("in training"), "{line}");
        let model = describe(&emulator::TABLE.admit().unwrap()).join("\n");
        assert!(!model.contains(NO_MODEL) && model.contains("off on average in training"), "{model}");
    }
}
