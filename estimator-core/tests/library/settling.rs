//! When an estimate counts as settled, of every model: what a start was not told, and what a clamped voltage left.

use crate::common::converter::table_read_by_12_bits;
use estimator_core::*;

/// A deadband of three codes.
fn table(model: Model) -> Admitted {
    table_read_by_12_bits(model, 3.0).admit().unwrap_or_else(|error| panic!("{model}: {error}"))
}

/// Statuses of an estimator at these parts of the table's range, below 0 and above 1 beyond it.
fn statuses(estimator: &mut Estimator<f32>, table: &Table, parts: impl IntoIterator<Item = f32>) -> Vec<Status> {
    let Range { min, max } = table.voltage_range_v;
    parts.into_iter().map(|part| estimator.tick(table.adc.code(min + (max - min) * part)).status).collect()
}

/// From one part of the range to another, without the former.
fn leg(from: f32, to: f32) -> impl Iterator<Item = f32> {
    (1..=50).map(move |k| from + (to - from) * k as f32 / 50.0)
}

/// Small swings, then one of nearly all of the range.
fn swings() -> impl Iterator<Item = f32> {
    let turns = [0.9, 0.6, 0.8, 0.5, 0.7, 0.1, 0.3];
    turns.windows(2).flat_map(|turn| leg(turn[0], turn[1])).collect::<Vec<f32>>().into_iter()
}

#[test]
fn a_voltage_that_was_not_the_model_s_unsettles_every_model_as_a_start_does() {
    let unsettled = |statuses: &[Status]| -> Vec<bool> {
        statuses.iter().map(|status| status.contains(Status::NOT_SETTLED)).collect()
    };
    for model in Model::ALL {
        let table = table(model);
        let code = table.adc.gain_v_per_code / table.voltage_range_v.span();
        // Ten codes beyond the range, at the end of the converter, and the like below.
        for beyond in [1.0 + 10.0 * code, 1.5, -10.0 * code, -0.5] {
            let mut estimator = Estimator::<f32>::new(&table);
            let settled = statuses(&mut estimator, &table, leg(0.5, 0.1).chain(leg(0.1, 0.9)).chain(leg(0.9, 0.5)));
            assert!(!settled.last().unwrap().contains(Status::NOT_SETTLED), "{model}: it turned at 0.1 and at 0.9");
            // A tick of it is enough, and a fresh estimator, told nothing, has the same to wipe out.
            let mut fresh = Estimator::<f32>::new(&table);
            let [found, expected] = [&mut estimator, &mut fresh]
                .map(|of| unsettled(&statuses(of, &table, [beyond, 0.9].into_iter().chain(swings()))));
            assert_eq!(found, expected, "{model} beyond at {beyond}");
            assert!(found[0] && found[1], "{model} beyond at {beyond}");
            assert_eq!(found.iter().position(|not| !not), Some(found.len() - 50), "{model}: from the turn at 0.1 on");
        }
    }
}

#[test]
fn an_end_of_the_converter_unsettles_though_it_lies_within_the_range() {
    for model in Model::ALL {
        let table = table(model);
        let Range { min, max } = table.voltage_range_v;
        let narrow = AdcCalibration { gain_v_per_code: 0.9 * (max - min) / 4095.0, offset_v: min, ..table.adc };
        let table = Table { adc: narrow, ..*table }.admit().unwrap_or_else(|error| panic!("{model}: {error}"));
        let mut estimator = Estimator::<f32>::new(&table);
        let settled = statuses(&mut estimator, &table, leg(0.5, 0.1).chain(leg(0.1, 0.8)).chain(leg(0.8, 0.5)));
        assert!(!settled.last().unwrap().contains(Status::NOT_SETTLED), "{model}");
        let [end, after] = statuses(&mut estimator, &table, [1.0, 0.5])[..] else { unreachable!("two ticks") };
        assert!(end.contains(Status::ADC_SATURATED | Status::NOT_SETTLED), "{model}: {end:?}");
        assert!(
            !end.contains(Status::VOLTAGE_OUT_OF_RANGE) && after.contains(Status::NOT_SETTLED),
            "{model}: {after:?}"
        );
    }
}

#[test]
fn a_voltage_beyond_the_range_by_no_more_than_the_deadband_is_noise() {
    for model in Model::ALL {
        let table = table(model);
        let code = table.adc.gain_v_per_code / table.voltage_range_v.span();
        let mut estimator = Estimator::<f32>::new(&table);
        let path = leg(0.5, 0.1).chain(leg(0.1, 0.9)).chain(leg(0.9, 0.5)).chain(leg(0.5, 1.0 + 2.0 * code));
        let last = *statuses(&mut estimator, &table, path).last().unwrap();
        assert!(
            last.contains(Status::VOLTAGE_OUT_OF_RANGE) && !last.contains(Status::NOT_SETTLED),
            "{model}: {last:?}"
        );
    }
}
