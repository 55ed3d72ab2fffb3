//! A table as a person reads it: what it is for, what its converters stand for, what it drives, and how good it was.

use crate::wiring::{NO_MODEL, is_line};
use estimator_core::{AdcCode, Admitted, DacCode, DriveLimits, Table};

/// What is said of a table that does not state how fast the amplifier is.
pub const WIRE_NOT_FOUND: &str = "a monitor's wire that is off is not found: state amplifier_slew, the fastest that the amplifier can, \
                                  V/s, in board.toml or as an option";

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
        (Some(mae), Some(max)) => format!("{mae:.3} µm on what was held out, at most {max:.3} µm"),
        _ => "nothing was held out".to_owned(),
    };
    vec![
        format!("{}, tick {} µs", table.model(), table.sample_period_us),
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
                "by piezo {major}.{minor}.{patch} from logs {}, seed {}: {:.3} µm off on average in training; {held_out}",
                made.logs, made.seed, made.train_mae_um
            ),
        },
        time(table),
        table.amplifier_slew_v_per_s.map_or(WIRE_NOT_FOUND.to_owned(), |slew| {
            format!("the amplifier goes {slew} V/s at most: a voltage that leaps farther is held, and a fault where it lasts")
        }),
        table.interval.map_or("no ± beside the estimate".to_owned(), |interval| {
            format!("± {:.3} µm beside the estimate at least, once its displacement was told", interval.misfit_um)
        }),
    ]
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
    fn how_fast_the_amplifier_is_is_said_or_that_nobody_did() {
        let stated = describe(Wiring::new(&FACTS, 500).unwrap().line()).join("\n");
        assert!(stated.contains("goes 20000 V/s at most") && !stated.contains(WIRE_NOT_FOUND), "{stated}");
        assert!(describe(&emulator::TABLE.admit().unwrap()).iter().any(|line| line == WIRE_NOT_FOUND));
    }

    #[test]
    fn a_straight_line_is_not_described_as_a_model() {
        let line = describe(Wiring::new(&FACTS, 500).unwrap().line()).join("\n");
        assert!(line.contains(NO_MODEL) && !line.contains("in training"), "{line}");
        let model = describe(&emulator::TABLE.admit().unwrap()).join("\n");
        assert!(!model.contains(NO_MODEL) && model.contains("off on average in training"), "{model}");
    }
}
