//! Converters by what is stated of them, and by what is assumed.

use ::calibration::drive::{planned, trained_on};
use ::calibration::span::Span;
use ::calibration::{Assumed, CalibrationOptions, converter_mismatches};
use estimator_core::{AdcCode, Admitted, DacCode, Range, Table};
use std::path::Path;

/// The table in a folder of `tests/data/table`.
fn table(folder: &str) -> Admitted {
    let record = std::fs::read(Path::new("../../tests/data/table").join(folder).join("table.bin")).unwrap();
    Table::parse(&record).unwrap()
}

#[test]
fn a_span_may_be_inverted() {
    let options = CalibrationOptions {
        adc_span: Some(Span { zero: 22.0, full: -22.0 }),
        adc_full_scale: Some(65535),
        dac_span: Some(Span { zero: 5.0, full: -5.0 }),
        ..CalibrationOptions::default()
    };
    let unit = Range { min: -1.0, max: 1.0 };
    let (adc, dac) = options.calibration(unit, 0.0, unit);
    assert!((adc.voltage::<f64>(AdcCode(0)) - 22.0).abs() < 1e-5);
    assert!((adc.voltage::<f64>(AdcCode(65535)) + 22.0).abs() < 1e-4);
    assert_eq!(dac.code(5.0f64), DacCode(0));
    assert_eq!(dac.code(-5.0f64), DacCode(4095));
    assert_eq!((options.assumed(), CalibrationOptions::default().assumed()), (None, Some(Assumed::Both)));
}

#[test]
fn what_is_assumed_covers_the_table() {
    let (voltage, limits) = (Range { min: -20.0, max: 20.0 }, Range { min: -6.0, max: 7.0 });
    let (adc, dac) = CalibrationOptions::default().calibration(voltage, 50.0, limits);
    assert!(adc.voltage::<f64>(AdcCode(1)) < 30.0 && adc.voltage::<f64>(AdcCode(4094)) > 70.0);
    assert_eq!((dac.code(-6.0f64), dac.code(7.0f64)), (DacCode(0), DacCode(4095)));
}

#[test]
fn converters_that_do_not_fit_are_told() {
    let fits = |adc: (f64, f64), dac: (f64, f64)| {
        let mut table = *table("");
        let span = |(zero, full)| Some(Span { zero, full });
        let options = CalibrationOptions { adc_span: span(adc), dac_span: span(dac), ..Default::default() };
        options.apply(&mut table);
        converter_mismatches(&table).len()
    };
    assert_eq!(fits((-1.0, 4.0), (-8.0, 52.0)), 0);
    assert_eq!(fits((4.0, -1.0), (52.0, -8.0)), 0, "inverting ones fit as well");
    // The margin beyond what was recorded need not be seen.
    let trained = trained_on(&table(""));
    let (zero, full) = (f64::from(trained.min), f64::from(trained.max));
    assert_eq!(fits((zero, full), (-8.0, 52.0)), 0);
    assert_eq!(fits((zero + 0.01, full), (-8.0, 52.0)), 1);
    assert_eq!(fits((0.0, 2.0), (-8.0, 52.0)), 1);
    assert_eq!(fits((-1.0, 4.0), (-1.0, 40.0)), 1);
    assert_eq!(fits((-1.0, 4.0), (10.0, 52.0)), 2, "no safe value, and not all of the limits");
}

#[test]
fn a_plan_keeps_what_is_stated_else_what_the_table_s_drive_may() {
    let plain = table("");
    assert_eq!(planned(&plain, None, None, None), None, "nobody says how fast");
    let limits = planned(&plain, None, None, Some(100.0)).unwrap();
    assert_eq!((limits.range_v, limits.rest_v, limits.slew_v_per_s), (trained_on(&plain), 0.0, 100.0));
    let (trained, margin) = (trained_on(&plain), 0.01);
    let beside = planned(&plain, None, Some(f64::from(trained.min - margin)), Some(100.0)).unwrap();
    assert_eq!((beside.range_v, beside.rest_v), (trained.include(trained.min - margin), trained.min - margin));
    let drives = table("generalised-prandtl-ishlinskii");
    assert_eq!(planned(&drives, None, None, None), drives.drive.map(|drive| drive.limits));
    let narrow = planned(&drives, Some(Span { zero: 2.0, full: 1.0 }), None, Some(7.0)).unwrap();
    assert_eq!((narrow.range_v, narrow.rest_v, narrow.slew_v_per_s), (Range { min: 1.0, max: 2.0 }, 1.0, 7.0));
}
