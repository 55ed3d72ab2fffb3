//! The running estimator: finite and within its limits for any codes and any admitted table, and the same recursion as
//! the model's.

use crate::common::{VOIGT, any_table, table};
use estimator_core::*;
use proptest::prelude::*;

fn running(table: Table) -> Estimator<f32> {
    Estimator::new(&table.admit().unwrap())
}

fn admitted_table() -> impl Strategy<Value = Admitted> {
    any_table().prop_filter_map("not admissible", |table| table.admit().ok())
}

/// Reversals of every size, holds, glitches, saturation and noise, repeated.
fn any_codes() -> impl Strategy<Value = Vec<(u16, u16)>> {
    let level = prop_oneof![Just(0u16), Just(u16::MAX), any::<u16>(), 0u16..4096];
    let dwell = prop_oneof![Just(1u16), 1u16..4, 1u16..300];
    prop::collection::vec((level, dwell), 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Some four million ticks over 3,000 tables.
    #[test]
    fn finite_and_within_limits_for_any_codes(admitted in admitted_table(), codes in any_codes()) {
        let limits = admitted.displacement_limits_um;
        let mut estimator = Estimator::<f32>::new(&admitted);
        for (level, dwell) in codes {
            for k in 0..dwell {
                let estimate = estimator.tick(AdcCode(level.wrapping_add(k & 1)));
                prop_assert!(limits.contains(estimate.displacement), "{estimate:?}");
                prop_assert!(estimate.dac.0 <= admitted.dac.full_scale);
            }
        }
    }

    /// The admissibility proof holds: from a start within the limits, no codes ever reach the clamp.
    #[test]
    fn an_admitted_table_is_never_clamped(admitted in admitted_table(), codes in any_codes()) {
        // The proof is exact; the arithmetic rounds. Where the reach touches the limits, rounding may cross them.
        let narrower = Range { min: -29.9, max: 29.9 };
        prop_assume!(Table { displacement_limits_um: narrower, ..*admitted }.admit().is_ok());
        let mut estimator = Estimator::<f32>::new(&admitted);
        for (level, dwell) in codes {
            for _ in 0..dwell {
                prop_assert!(!estimator.tick(AdcCode(level)).status.contains(Status::CLAMPED));
            }
        }
    }
}

#[test]
fn the_tick_is_the_recursion_of_eq_4_8() {
    let admitted = table().admit().unwrap();
    let mut estimator = Estimator::<f64>::new(&admitted);
    assert!(estimator.start_at(0.5));
    let p = VOIGT.map(f64::from);
    let mut y = 0.5f64;
    for k in 0..4000 {
        let v = 19.0 * (0.01 * f64::from(k)).sin();
        let x = (-p.lambda_per_v * (v - p.beta_v)).exp();
        let d = 1e-6 * p.alpha_um * p.lambda_per_v * x / (1.0 + x).powi(2);
        let metres = y * 1e-6;
        y += 1e6 * 5e-4 * (v.signum() * (v.abs() / p.b_ohm).powf(p.p) - metres / (d * p.b_ohm));
        let estimate = estimator.tick_volts(v);
        assert!((estimate.displacement - y).abs() < 1e-10, "tick {k}: {estimate:?} against {y}");
        assert!((Status::NOT_SETTLED).contains(estimate.status));
    }
}

#[test]
fn euler_tends_to_the_exact_step_as_the_tick_shrinks() {
    let run = |period: f64, scheme| {
        let discretisation = Discretisation { sample_period: period, scheme, deadband: 0.0 };
        let model = Voigt::build(&VOIGT.map(f64::from), &discretisation);
        let mut state = model.begin(0.0, Some(0.0));
        let ticks = (0.006 / period).round() as u32;
        (0..ticks).map(|_| model.step(&mut state, 10.0)).last().unwrap()
    };
    let discretisation = Discretisation { sample_period: 1.0, scheme: Scheme::ForwardEuler, deadband: 0.0 };
    let model = Voigt::build(&VOIGT.map(f64::from), &discretisation);
    let (rate, drive) = (model.rate(10.0), model.drive(10.0));
    let exact = drive / rate * (1.0 - (-0.006 * rate).exp());
    assert!((run(5e-4, Scheme::ZeroOrderHold) - exact).abs() < 1e-12);
    assert!((run(2e-3, Scheme::ZeroOrderHold) - exact).abs() < 1e-12);
    let errors = [5e-4, 2.5e-4, 1.25e-4].map(|period| (run(period, Scheme::ForwardEuler) - exact).abs());
    assert!(errors[0] > 1.9 * errors[1] && errors[1] > 1.9 * errors[2], "{errors:?}");
}

#[test]
fn starts_at_rest_and_stays_there() {
    let mut estimator = running(table());
    let code = table().adc.code(12.0f32);
    let first = estimator.tick(code).displacement;
    assert!(first > 1.0);
    for _ in 0..1000 {
        assert!((estimator.tick(code).displacement - first).abs() < 1e-5);
    }
    assert_eq!(estimator.tick(code).status, Status::NOT_SETTLED, "no reversal has been seen");
}

#[test]
fn what_is_wrong_is_said() {
    let narrow = Table { dac: DacCalibration { gain_codes_per_um: 1000.0, ..table().dac }, ..table() };
    let mut estimator = running(narrow);
    // Reversals half of the 40 V apart settle it, seen when the voltage has left them: 2, 1, 3 and −8 V do not; 3 and
    // −17.5 V do, whatever ripple lies between.
    let swing = [1.0f32, 2.0, 1.0, 3.0, -8.0, -7.0, -17.5];
    let voltages = swing.map(|voltage| (voltage, false)).into_iter().chain([(4.0, true), (3.0, true)]);
    for (voltage, settled) in voltages {
        let status = estimator.tick(narrow.adc.code(voltage)).status;
        assert_eq!(status, if settled { Status::empty() } else { Status::NOT_SETTLED });
    }
    for _ in 0..100 {
        estimator.tick(narrow.adc.code(19.0f32));
    }
    assert_eq!(estimator.tick(narrow.adc.code(19.0f32)).status, Status::DAC_SATURATED);
    let beyond = estimator.tick(narrow.adc.code(21.0f32)).status;
    assert!(beyond.contains(Status::VOLTAGE_OUT_OF_RANGE) && !beyond.contains(Status::ADC_SATURATED));
    assert!(estimator.tick(AdcCode(4095)).status.contains(Status::ADC_SATURATED | Status::VOLTAGE_OUT_OF_RANGE));
    let mut estimator = running(table());
    assert!(!estimator.start_at(1e9) && estimator.start_at(1.0) && !estimator.start_at(f32::NAN));
    estimator.start_at(1e9);
    assert!(estimator.tick_volts(0.0).displacement <= 6.0);
}

#[test]
fn the_bias_can_be_told_and_a_restart_forgets_it() {
    let mut estimator = running(table());
    let codes = [3.0f32, 7.0, 12.0, 4.0].map(|v| table().adc.code(v));
    let first = codes.map(|code| estimator.tick(code));
    let mut twin = estimator.clone();
    assert!(estimator.set_zero(0.0));
    let zero = twin.tick(codes[3]).displacement;
    let rest = estimator.tick(codes[3]);
    let after = twin.tick(codes[3]).displacement - estimator.tick(codes[3]).displacement;
    assert!(rest.displacement.abs() < 0.1 && (zero - rest.displacement - after).abs() < 1e-6);
    assert_eq!(rest.dac, table().dac.code(rest.displacement));
    estimator.restart();
    assert!(!estimator.set_zero(0.0), "before the first tick there is nothing to call 0");
    assert_eq!(estimator.bias(), 0.0);
    assert_eq!(codes.map(|code| estimator.tick(code)), first);
}

#[test]
fn the_displacement_of_now_can_be_called_anything_and_shifted() {
    let mut estimator = running(table());
    let code = table().adc.code(7.0f32);
    // At rest the displacement of now is that of the next tick.
    let model = estimator.tick(code).displacement;
    assert!(estimator.set_zero(2.5));
    assert!((estimator.bias() - (2.5 - model)).abs() < 1e-6, "what is added to the model's displacement");
    assert!((estimator.tick(code).displacement - 2.5).abs() < 1e-5);
    assert!(estimator.shift(-0.75));
    let shifted = estimator.tick(code);
    assert!((shifted.displacement - 1.75).abs() < 1e-5);
    assert_eq!(shifted.dac, table().dac.code(shifted.displacement));
    let bias = estimator.bias();
    assert!(!estimator.set_zero(f32::NAN) && !estimator.shift(f32::INFINITY));
    assert_eq!(estimator.bias(), bias, "what is not finite changes nothing");
    estimator.restart();
    assert!(!estimator.set_zero(0.5) && !estimator.shift(0.5), "there is no displacement before the first tick");
    assert!((estimator.tick(code).displacement - model).abs() < 1e-5);
}
