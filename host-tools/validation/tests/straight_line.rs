//! The straight line: found, and judged as models are.

use recordings::session::Session;
use validation::StraightLine;

/// `y(n) = 0.2·V(n − 1) − 0.5` µm with an error, measured every `every` ticks.
fn session(ticks: u32, every: usize, error: impl Fn(u32) -> f64) -> Session {
    let voltage: Vec<f64> = (0..ticks).map(|k| 20.0 * (f64::from(k) * 0.01).sin()).collect();
    let instants: Vec<u32> = (0..ticks).step_by(every).collect();
    let at = |k: &u32| 0.2 * voltage[k.saturating_sub(1) as usize] - 0.5 + error(*k);
    let displacement = instants.iter().map(at).collect();
    Session::new("made".to_owned(), voltage, instants, displacement, 5e-4)
}

#[test]
fn a_line_is_found_from_the_voltage_before_each_instant_and_has_no_error() {
    for every in [1, 7] {
        let session = session(2000, every, |_| 0.0);
        let line = StraightLine::fit(std::iter::once(&session)).unwrap();
        assert!((line.gain_um_per_v - 0.2).abs() < 1e-12 && (line.offset_um() + 0.5).abs() < 1e-12, "{line:?}");
        assert!(line.errors(&session).max_um < 1e-12);
        assert!((line.voltage(line.displacement(3.0)) - 3.0).abs() < 1e-12);
    }
}

#[test]
fn errors_of_a_known_ripple_are_its_own() {
    let ripple = session(2001, 1, |k| if k % 2 == 0 { 0.03 } else { -0.03 });
    let line = StraightLine::fit(std::iter::once(&session(2001, 1, |_| 0.0))).unwrap();
    let errors = line.errors(&ripple);
    for error in [errors.mae_um, errors.rmse_um, errors.max_um] {
        assert!((error - 0.03).abs() < 1e-12, "{errors:?}");
    }
}

#[test]
fn what_is_only_run_through_is_not_judged() {
    let line = StraightLine::fit(std::iter::once(&session(2001, 1, |_| 0.0))).unwrap();
    let mut halves = session(2001, 1, |k| if k < 1000 { 5.0 } else { 0.03 });
    halves.lead_in = 1000;
    let errors = line.errors(&halves);
    assert!((errors.mae_um - 0.03).abs() < 1e-12 && (errors.max_um - 0.03).abs() < 1e-12, "{errors:?}");
}

/// Two logs with other offsets: the mean of them, although one is ten times as long.
#[test]
fn each_session_weighs_the_same() {
    let (short, long) = (session(629, 1, |_| 0.1), session(6284, 1, |_| -0.1));
    let line = StraightLine::fit([&short, &long].into_iter()).unwrap();
    assert!((line.offset_um() + 0.5).abs() < 1e-3, "{line:?}");
}

#[test]
fn a_voltage_that_rests_has_no_line() {
    let mut session = session(100, 1, |_| 0.0);
    session.voltage.fill(3.0);
    assert_eq!(StraightLine::fit(std::iter::once(&session)), None);
}
