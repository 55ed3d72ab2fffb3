use super::*;
use emulator::TABLE;
use estimator_core::{DriveLimits, Range, Table};
use recordings::log::ReadOptions;

const TICK_S: f64 = 5e-4;

fn driving() -> Admitted {
    driving_at(40.0)
}

/// A drive of so many V/s.
fn driving_at(slew_v_per_s: f32) -> Admitted {
    let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s };
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits, setpoint: None };
    Table { drive: Some(drive), ..TABLE }.admit().unwrap()
}

/// A log of so many displacements, so many milliseconds apart.
fn log(count: usize, ms: f64, um: impl Fn(usize) -> f64) -> Log {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.csv");
    let rows: String = (0..count).map(|k| format!("{:.6},{:.6}\n", k as f64 * ms * 1e-3, um(k))).collect();
    std::fs::write(&path, format!("time_s,displacement_um\n{rows}")).unwrap();
    recordings::log::read(&path, &ReadOptions { voltage_required: false, ..ReadOptions::default() }).unwrap()
}

fn round(count: usize) -> impl Fn(usize) -> f64 {
    move |k| 15.0 + 2.0 * (k as f64 / count as f64 * std::f64::consts::TAU).sin()
}

#[test]
fn points_are_a_whole_number_of_ticks_apart_or_as_many_as_is_said() {
    let every = |ms, every| Waveform::of(&log(20, ms, round(20)), TICK_S, every).map(|of| of.every.get());
    assert_eq!(every(5.0, None).unwrap(), 10);
    let error = every(5.2, None).unwrap_err().to_string();
    assert!(error.contains("5.200000 ms") && error.contains("10.400 ticks"), "{error}");
    assert_eq!(every(5.2, NonZeroU16::new(7)).unwrap(), 7);
    assert!(matches!(Waveform::of(&log(4_097, 5.0, round(99)), TICK_S, None), Err(WaveformError::Points(4_097))));
}

#[test]
fn a_line_that_comes_back_is_as_long_as_its_points_and_another_has_its_way_back() {
    let table = driving();
    let closed = Waveform::of(&log(200, 5.0, round(200)), TICK_S, None).unwrap().foreseen(&table).unwrap();
    assert_eq!((closed.line_ticks, closed.back_ticks), (2_000, None));
    assert!(closed.off_um < 0.1, "{closed:?}");
    let ramp = Waveform::of(&log(200, 5.0, |k| 10.0 + 0.05 * k as f64), TICK_S, None).unwrap();
    let open = ramp.foreseen(&table).unwrap();
    let back = Pace::of(&table).unwrap().ticks(19.95, 10.0);
    assert_eq!((open.line_ticks, open.back_ticks), (1_990 + back as usize, Some(back)));
    let said = open.said(TICK_S);
    assert!(said.contains("back to its first point") && said.starts_with("200 points of 10 ticks"), "{said}");
}

#[test]
fn what_the_drive_cannot_follow_is_refused() {
    let table = driving();
    let line = |every, um: fn(usize) -> f64| {
        Waveform::of(&log(200, 5.0, um), TICK_S, NonZeroU16::new(every)).unwrap().foreseen(&table)
    };
    let swing: fn(usize) -> f64 = |k| 15.0 + 8.0 * (k as f64 * std::f64::consts::TAU / 200.0).sin();
    assert!(line(10, swing).is_ok());
    assert!(matches!(line(1, swing), Err(WaveformError::OutOfReach { .. })), "too fast");
    assert!(matches!(line(10, |k| 15.0 + 0.3 * k as f64), Err(WaveformError::OutOfReach { .. })), "too far");
    let plain = TABLE.admit().unwrap();
    let still = Waveform::of(&log(20, 5.0, round(20)), TICK_S, None).unwrap();
    assert!(matches!(still.foreseen(&plain), Err(WaveformError::NoDrive)));
}

#[test]
fn a_first_point_that_cannot_be_held_is_refused_however_far_it_is() {
    let table = driving();
    for um in [60.0, 1e5, -1e5, 3e38] {
        let far = Waveform::of(&log(20, 5.0, |_| um), TICK_S, None).unwrap();
        let error = far.foreseen(&table).unwrap_err();
        assert!(matches!(error, WaveformError::Beyond { .. }), "{um}: {error}");
    }
}

#[test]
fn a_line_that_is_longer_than_is_looked_at_says_so() {
    let table = driving();
    let slow = Waveform::of(&log(200, 5.0, round(200)), TICK_S, NonZeroU16::new(12_000)).unwrap();
    let foreseen = slow.foreseen(&table).unwrap();
    assert!(foreseen.judged_ticks < foreseen.line_ticks && foreseen.line_ticks == 200 * 12_000, "{foreseen:?}");
    let said = foreseen.said(TICK_S);
    assert!(said.contains(&format!("off at most in the first {} of its", foreseen.judged_ticks)), "{said}");
}

#[test]
fn the_way_back_is_judged_too() {
    let table = driving();
    let ramp = Waveform::of(&log(200, 5.0, |k| 10.0 + 0.05 * k as f64), TICK_S, None).unwrap();
    let open = ramp.foreseen(&table).unwrap();
    assert!(open.back_ticks.is_some());
    assert_eq!(open.judged_ticks, open.line_ticks);
}

/// Of voltages to both sides of the model's zero, the largest of which are half as large as their span, and a drive
/// that is nearly the slowest that is admitted.
#[test]
fn a_way_that_is_too_long_to_be_looked_at_is_refused() {
    let table = driving_at(40.0);
    let drive = table.drive.unwrap();
    let limits = DriveLimits { rest_v: 0.0, slew_v_per_s: 0.007, ..drive.limits };
    let [voltage_range_v, displacement_limits_um] = [(-1.8, 1.8), (-30.0, 30.0)].map(|(min, max)| Range { min, max });
    let drive = Some(DriveCalibration { limits, ..drive });
    let slow = Table { voltage_zero_v: 1.8, voltage_range_v, displacement_limits_um, drive, ..*table }.admit().unwrap();
    let still = Waveform::of(&log(20, 5.0, |_| 15.0), TICK_S, None).unwrap();
    let found = still.foreseen(&slow);
    assert!(matches!(found, Err(WaveformError::LongWay(2_000_001..))), "{found:?}");
}
