//! Made logs whose contents are known.

use std::fmt::Write;

use recordings::log::{ReadOptions, open};

use super::*;

/// Surveys a log of `time,voltage,displacement` rows.
fn surveyed(rows: impl Iterator<Item = (f64, f64, f64)>) -> Survey {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let mut text = "time_s,voltage_V,displacement_um\n".to_owned();
    for (time, voltage, displacement) in rows {
        writeln!(text, "{time},{voltage},{displacement}").unwrap();
    }
    std::fs::write(&path, text).unwrap();
    survey(open(&path, &ReadOptions { holes: true, ..ReadOptions::default() }).unwrap()).unwrap()
}

/// A sine of `volts` at `hz` for `seconds`, at 1 kHz.
fn sine(volts: f64, hz: f64, seconds: f64) -> impl Iterator<Item = f64> {
    let rows = (seconds * 1000.0) as u32;
    (0..rows).map(move |k| volts * (std::f64::consts::TAU * hz * f64::from(k) / 1000.0).sin())
}

#[test]
fn amplitudes_and_frequencies_are_found() {
    let voltage: Vec<f64> = sine(10.0, 2.0, 5.0).chain(sine(50.0, 20.0, 2.0)).collect();
    let rows = voltage.iter().enumerate().map(|(k, v)| (k as f64 / 1000.0, *v, v / 10.0));
    let survey = surveyed(rows);
    assert_eq!((survey.rows, survey.clock.hz, survey.clock.long_steps), (7000, 1000.0, 0));
    // Two reversals a cycle.
    assert!(survey.swings.reversals.abs_diff(20 + 80) <= 2, "{:?}", survey.swings);
    let of = |low: f64, hz: f64| {
        let fits = |cell: &&Cell| (cell.amplitude_v.0 - low).abs() < 0.5 && cell.frequency_hz.0 == hz;
        survey.swings.cells.iter().find(fits).map_or(0, |cell| cell.half_cycles)
    };
    assert!(of(7.5, 1.4).abs_diff(20) <= 2, "{:?}", survey.swings);
    assert!(of(43.5, 14.0).abs_diff(80) <= 2, "{:?}", survey.swings);
}

#[test]
fn long_logs_are_kept_in_blocks_and_show_the_same() {
    let cycles = 700;
    let voltage = sine(10.0, 1.0, f64::from(cycles));
    let survey = surveyed(voltage.enumerate().map(|(k, v)| (k as f64 / 1000.0, v, v)));
    assert_eq!(survey.rows_a_block, 4);
    assert!(survey.blocks.len() <= 1 << 18);
    assert!(survey.swings.reversals.abs_diff(2 * cycles as usize) <= 1, "{}", survey.swings.reversals);
    let voltage = survey.voltage.unwrap();
    assert!((voltage.high - 10.0).abs() < 1e-3 && (voltage.low + 10.0).abs() < 1e-3);
}

#[test]
fn noise_clipping_and_a_frozen_sensor_are_seen() {
    // A multiplicative generator's numbers, even from -1 to 1.
    let mut state = 1_u64;
    let mut scatter = move || {
        state = state * 48_271 % 2_147_483_647;
        state as f64 / 1_073_741_823.5 - 1.0
    };
    let deviation = 1.0 / 3.0_f64.sqrt();
    let voltage: Vec<f64> = sine(50.0, 1.0, 10.0).collect();
    let noisy = voltage.iter().enumerate().map(|(k, v)| (k as f64 / 1000.0, *v, v + scatter()));
    let noise = surveyed(noisy).displacement.unwrap().noise;
    assert!((noise / deviation - 1.0).abs() < 0.1, "{noise} {deviation}");

    let clipped = voltage.iter().enumerate().map(|(k, v)| (k as f64 / 1000.0, *v, v.min(40.0)));
    let displacement = surveyed(clipped).displacement.unwrap();
    assert!(displacement.longest_at_high > 100 && displacement.longest_at_low < 8, "{displacement:?}");

    let frozen = voltage.iter().enumerate().map(|(k, v)| (k as f64 / 1000.0, *v, if k < 3000 { *v } else { 7.0 }));
    let frozen = surveyed(frozen).frozen.unwrap();
    assert_eq!((frozen.first_row, frozen.rows, frozen.displacement_um), (3000, 7000, 7.0));
    assert!(surveyed(voltage.iter().enumerate().map(|(k, v)| (k as f64 / 1000.0, *v, *v))).frozen.is_none());
}

#[test]
fn what_is_no_measurement_is_found_as_an_identification_finds_it() {
    let voltage: Vec<f64> = sine(50.0, 1.0, 10.0).collect();
    let of = |displacement: &dyn Fn(usize, f64) -> f64| {
        surveyed(voltage.iter().enumerate().map(|(k, &v)| (k as f64 / 1000.0, v, displacement(k, v / 10.0))))
    };
    assert_eq!(of(&|_, y| y).flaws, Some(Vec::new()));
    let spikes = of(&|row, y| if row == 2_500 || row == 7_000 { y + row as f64 / 1e3 } else { y }).flaws.unwrap();
    let [Found { worst: Flaw::Spike { at, back: true, .. }, first_row: 7_000, count: 2 }] = spikes[..] else {
        panic!("{spikes:?}")
    };
    assert!((at.from_s - 7.0).abs() < 1e-9, "{at:?}");
    let cut = of(&|row, y| if row == 9_999 { y - 3.0 } else { y }).flaws.unwrap();
    assert!(
        matches!(cut[..], [Found { worst: Flaw::Spike { back: false, .. }, first_row: 9_999, count: 1 }]),
        "{cut:?}"
    );
}

#[test]
fn gaps_and_a_still_voltage_are_told() {
    let survey = surveyed((0..1000).map(|k| (f64::from(k + 50 * (k / 500)) / 1000.0, 5.0, f64::from(k))));
    assert_eq!((survey.clock.long_steps, survey.clock.hz), (1, 1000.0));
    // Two of three stamps with three decimals at 3 kHz are the one before.
    let rounded = surveyed((0..999).map(|k| ((f64::from(k) / 3.0).round() / 1000.0, 5.0, f64::from(k))));
    assert!(rounded.clock.long_steps > 300 && (rounded.clock.hz - 3000.0).abs() < 10.0, "{:?}", rounded.clock);
    assert_eq!(survey.swings.reversals, 0);
    assert!(survey.swings.cells.is_empty());
}

#[test]
fn rows_without_a_number_are_a_flaw_and_count_for_nothing_else() {
    let voltage: Vec<f64> = sine(10.0, 2.0, 5.0).collect();
    let of =
        |none: fn(usize) -> bool| {
            let rows = voltage.iter().enumerate();
            surveyed(rows.map(|(k, &v)| {
                (k as f64 / 1000.0, if none(k) { f64::NAN } else { v }, if k == 9 { f64::NAN } else { v })
            }))
        };
    let (whole, holed) = (of(|_| false), of(|k| k < 3 || (1_200..1_205).contains(&k)));
    let holes = |survey: &Survey| {
        let of =
            survey.flaws.iter().flatten().map(|of| (matches!(of.worst, Flaw::Hole { .. }), of.first_row, of.count));
        of.collect::<Vec<_>>()
    };
    assert_eq!((holes(&whole), holes(&holed)), (vec![(true, 9, 1)], vec![(true, 1_200, 3)]));
    let range = |survey: &Survey| survey.voltage.map(|series| (series.low, series.high, series.resolution));
    assert_eq!((range(&holed), &holed.swings, holed.frozen), (range(&whole), &whole.swings, None));
    assert!(holed.voltage.is_some_and(|series| series.noise < 1e-6));
    assert!(of(|_| true).voltage.is_none());
}

#[test]
fn samples_that_are_missing_are_no_secret_where_the_time_leaps() {
    let rows = || sine(10.0, 2.0, 5.0).enumerate().filter(|(k, _)| !(1_240..1_262).contains(k));
    let of = |rows: Vec<(f64, f64, f64)>| surveyed(rows.into_iter()).flaws.unwrap_or_default();
    let hidden = of(rows().zip(0..).map(|((_, v), row)| (f64::from(row) / 1000.0, v, 0.1 * v)).collect());
    assert!(matches!(hidden[..], [Found { worst: Flaw::Missing { .. }, .. }]), "{hidden:?}");
    let told = of(rows().map(|(k, v)| (k as f64 / 1000.0, v, 0.1 * v)).collect());
    assert!(matches!(told[..], [Found { worst: Flaw::Hole { .. }, .. }]), "{told:?}");
}

/// A clock that writes whole periods, and now and then one of them late.
#[test]
fn a_stamp_that_comes_late_alone_is_no_gap_and_does_not_change_the_rate() {
    let rows = sine(10.0, 2.0, 5.0).enumerate().map(|(k, v)| (if k % 97 == 50 { k + 1 } else { k }, v));
    let survey = surveyed(rows.map(|(k, v)| (k as f64 / 1000.0, v, 0.1 * v)));
    assert!((survey.clock.hz - 1000.0).abs() < 0.5, "{:?}", survey.clock);
    assert_eq!(survey.flaws, Some(Vec::new()));
    // Stamps of whole milliseconds of a clock that is about twice as fast come in pairs all the time.
    for hz in [1920.0, 1953.125, 1999.0] {
        let rows = sine(10.0, 2.0, 5.0).enumerate().map(|(k, v)| ((1e3 * k as f64 / hz).round() / 1e3, v, 0.1 * v));
        let survey = surveyed(rows);
        assert!((survey.clock.hz / hz - 1.0).abs() < 1e-3 && survey.flaws == Some(Vec::new()), "{hz}: {survey:?}");
    }
}

#[test]
fn time_stamps_that_do_not_advance_have_no_rate() {
    let survey = surveyed([(1.0, 0.0, 0.0), (1.0, 1.0, 0.1), (1.0, 0.5, 0.05)].into_iter());
    assert!(survey.clock.hz.is_nan() && survey.clock.duration_s == 0.0, "{:?}", survey.clock);
}

#[test]
fn a_flaw_behind_a_gap_is_dated_by_the_time_stamps() {
    let rows = || sine(10.0, 2.0, 5.0).enumerate().filter(|(k, _)| !(1_240..1_262).contains(k));
    let at = |(k, v): (usize, f64), none: usize| {
        (k as f64 / 1000.0, if k == none { f64::NAN } else { v }, if k == 3_000 { 5.0 } else { 0.1 * v })
    };
    let holed = surveyed(rows().map(|row| at(row, 2_000))).flaws.unwrap_or_default();
    assert!(matches!(holed[..], [Found { worst: Flaw::Hole { .. }, count: 2, .. }, _]), "{holed:?}");
    let found = surveyed(rows().map(|row| at(row, usize::MAX))).flaws.unwrap_or_default();
    let [missing, Found { worst: spike @ Flaw::Spike { .. }, first_row: 2_978, .. }] = found[..] else {
        panic!("{found:?}")
    };
    assert!((spike.at().from_s - 3.0).abs() < 1e-6, "{spike:?}");
    let Found { worst: hole @ Flaw::Hole { at }, first_row: 1_240, count: 1 } = missing else { panic!("{missing:?}") };
    assert!((at.from_s - 1.24).abs() < 1e-6 && (at.to_s - 1.261).abs() < 1e-6, "{hole:?}");
}

#[test]
fn how_long_the_voltage_stands_at_first_and_the_hum_of_the_sensor_are_found() {
    let of = |rest_s: f64, hum_um: f64| {
        let rest = std::iter::repeat_n(0.0, (rest_s * 1000.0) as usize);
        let hum = sine(hum_um, 50.0, 10.0 + rest_s);
        let rows = rest.chain(sine(50.0, 1.0, 10.0)).zip(hum).enumerate();
        surveyed(rows.map(|(k, (volt, hum))| (k as f64 / 1000.0, volt, volt / 10.0 + hum)))
    };
    let survey = of(2.0, 0.05);
    assert!((survey.stands_at_first_s.unwrap() - 2.0).abs() < 0.01, "{:?}", survey.stands_at_first_s);
    let hum = survey.hum.unwrap();
    assert!(hum.hertz == 50 && (hum.amplitude_um - 0.05).abs() < 0.005, "{hum:?}");
    let survey = of(0.0, 0.0);
    assert!(survey.stands_at_first_s.unwrap() < 0.01 && survey.hum.is_none(), "{:?}", survey.hum);
}

/// Stamps whose span is beyond any number.
#[test]
fn a_clock_without_a_rate_is_no_reason_to_fail() {
    let survey = surveyed([(-1e308, 0.0, 0.0), (0.0, 1.0, 0.1), (1e308, 2.0, 0.2)].into_iter());
    assert_eq!(survey.hum, None);
}
