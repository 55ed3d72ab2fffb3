//! Duhem in the form of Coleman and Hodgdon: its equation, its independence of the rate, its conditions.

use crate::laws;
use estimator_core::Range;
use estimator_core::model::{
    BoucWen, BoucWenParameters, Duhem, DuhemCondition, DuhemParameters, Published, Recursion, unmet_condition,
};
use proptest::prelude::*;

const PERIOD: f64 = 5e-4;

fn parameters() -> DuhemParameters {
    DuhemParameters {
        lag_s: 0.0,
        alpha_per_v: 0.03,
        saturation_v: 80.0,
        voltage_centre_v: 45.0,
        offset_um: 20.0,
        f1_um_per_v: 0.4,
        f3_um_per_v3: 4e-6,
        g0_um_per_v: 0.3,
        g2_um_per_v3: 8e-6,
    }
}

/// dw/dv of Eq. (3.12).
fn slope(p: &DuhemParameters, v: f64, w: f64, direction: f64) -> f64 {
    let [alpha, s, f1, f3, g0, g2] =
        [p.alpha_per_v, p.saturation_v, p.f1_um_per_v, p.f3_um_per_v3, p.g0_um_per_v, p.g2_um_per_v3].map(f64::from);
    let tail = f1 + 3.0 * f3 * s * s;
    let inner = v.clamp(-s, s);
    let f = f1 * inner + f3 * inner.powi(3) + tail * (v - inner);
    let g = if v.abs() < s { g0 + g2 * v * v } else { tail };
    direction * alpha * (f - w) + g
}

#[test]
fn follows_its_equation() {
    for p in [parameters(), DuhemParameters { alpha_per_v: 0.5, g2_um_per_v3: -3e-5, ..parameters() }] {
        let model = Duhem::<f64>::build(&p, 0.0);
        let offset = f64::from(p.offset_um);
        let (mut voltage, mut state) = (45.0, model.begin(45.0, Some(21.0)));
        let mut w = model.step(&mut state, voltage) - offset;
        // Small and large moves, out beyond saturation on both sides, within it and back.
        for to in [45.001, 45.4, 44.0, 60.0, 139.0, 150.0, 130.0, -20.0, -60.0, -61.0, 160.0, 161.0, 45.0] {
            let count = 100_000;
            let step = (to - voltage) / f64::from(count);
            for k in 0..count {
                let v = voltage - 45.0 + step * f64::from(k);
                let middle = w + 0.5 * step * slope(&p, v, w, step.signum());
                w += step * slope(&p, v + 0.5 * step, middle, step.signum());
            }
            voltage = to;
            let found = model.step(&mut state, voltage) - offset;
            assert!((found - w).abs() < 2e-4, "{p:?} at {to}: {found} {w}");
        }
    }
}

#[test]
fn loops_close_and_lag() {
    laws::loops_close_and_lag(&Duhem::<f64>::build(&parameters(), 0.0));
}

/// Bouc-Wen with n = 1 and γ = δ = d2 = 0 is this model with f = d1·V, g = d1 + c·A, α = β.
#[test]
fn symmetric_bouc_wen_is_a_special_case() {
    let bouc_wen = BoucWenParameters {
        lag_s: 0.0,
        a: 1.0,
        beta: 0.05,
        gamma: 0.0,
        delta: 0.0,
        n: 1.0,
        offset_um: 3.0,
        d1_um_per_v: 0.5,
        d2_um_per_v2: 0.0,
        c_um_per_v: -0.25,
    };
    let duhem = DuhemParameters {
        lag_s: 0.0,
        alpha_per_v: 0.05,
        saturation_v: 1000.0,
        voltage_centre_v: 0.0,
        offset_um: 3.0,
        f1_um_per_v: 0.5,
        f3_um_per_v3: 0.0,
        g0_um_per_v: 0.25,
        g2_um_per_v3: 0.0,
    };
    let (a, b) = (BoucWen::<f64>::build(&bouc_wen, 0.0), Duhem::<f64>::build(&duhem, 0.0));
    let (mut a_state, mut b_state) = (a.begin(0.0, None), b.begin(0.0, None));
    for k in 0..20_000 {
        let t = f64::from(k) * PERIOD;
        let voltage = 60.0 * (9.0 * t).sin() + if k % 500 == 0 { 50.0 } else { 0.0 };
        let (y, other) = (a.step(&mut a_state, voltage), b.step(&mut b_state, voltage));
        assert!((y - other).abs() < 1e-9, "{k}: {y} {other}");
    }
}

#[test]
fn known_sets_meet_the_conditions_or_not() {
    let good = DuhemParameters { g0_um_per_v: 0.39, g2_um_per_v3: 1e-6, ..parameters() };
    assert_eq!((good.check(), good.unmet_condition()), (Ok(()), None));
    // Steps of f and g at saturation: the memory of reversals is 0.1·(1 − exp(−80·0.03)) µm/V, less than g.
    assert_eq!(parameters().unmet_condition(), None);
    let unmet = |p: DuhemParameters| p.unmet_condition().unwrap();
    assert_eq!(unmet(DuhemParameters { g0_um_per_v: 0.45, ..parameters() }), DuhemCondition::Lagging);
    assert_eq!(unmet(DuhemParameters { g0_um_per_v: 0.15, ..parameters() }), DuhemCondition::Rising);
    assert_eq!(unmet(DuhemParameters { f3_um_per_v3: -4e-5, ..parameters() }), DuhemCondition::Increasing);

    // Bouc-Wen over ±80 V: c·A from 0 to somewhat beyond −d1/2 while the whole memory cannot build up.
    let bouc_wen = |c: f64, alpha: f64| {
        let g = move |v: f64| if v.abs() < 80.0 { 0.4 + c } else { 0.4 };
        unmet_condition(alpha, 80.0, |_| 0.4, g)
    };
    assert_eq!(bouc_wen(0.1, 0.05), Some(DuhemCondition::Lagging));
    assert_eq!(bouc_wen(-0.1, 0.05), None);
    assert_eq!(bouc_wen(-0.22, 0.05), Some(DuhemCondition::Rising));
    assert_eq!(bouc_wen(-0.22, 0.005), None);
    assert_eq!(unmet_condition(0.05, 80.0, |_| 0.4, |_| 0.3), Some(DuhemCondition::Even));
    assert_eq!(unmet_condition(0.05, 80.0, |_| 0.4, |v: f64| 0.4 - 1e-3 * (80.0 - v)), Some(DuhemCondition::Even));
    assert_eq!(unmet_condition(0.05, 80.0, |_| f64::INFINITY, |_| 0.3), Some(DuhemCondition::Increasing));
}

/// Condition (c) is strict to the last digit: g = k·(1 − exp(−α·S)) for a constant difference k from 0 to S.
#[test]
fn the_integral_is_exact_for_a_constant_difference() {
    let memory = 0.1 * (1.0 - (-0.05f64 * 80.0).exp());
    let at = |g: f64| unmet_condition(0.05, 80.0, |v: f64| if v.abs() < 80.0 { g + 0.1 } else { g }, |_| g);
    assert_eq!(at(memory * 0.999), Some(DuhemCondition::Rising));
    assert_eq!(at(memory * 1.001), None);
}

#[test]
fn begins_at_the_known_displacement_or_nearest() {
    let model = Duhem::<f64>::build(&parameters(), 0.0);
    let on_f = model.step(&mut model.begin(60.0, None), 60.0);
    for off in [-1.0, 0.5] {
        let mut state = model.begin(60.0, Some(on_f + off));
        assert!((model.step(&mut state, 60.0) - on_f - off).abs() < 1e-9);
    }
    let y = model.step(&mut model.begin(60.0, Some(1e6)), 60.0);
    assert!(y > on_f + 1.0 && y <= on_f + model.largest_memory() + 1e-9);
}

#[test]
fn what_breaks_a_rule_is_refused_and_still_builds() {
    let good = parameters();
    assert_eq!(good.check(), Ok(()));
    let bad = [
        DuhemParameters { g2_um_per_v3: f32::NAN, ..good },
        DuhemParameters { lag_s: -1.1, ..good },
        DuhemParameters { lag_s: f32::NAN, ..good },
        DuhemParameters { alpha_per_v: 0.0, ..good },
        DuhemParameters { saturation_v: 0.0, ..good },
        DuhemParameters { f1_um_per_v: -0.1, ..good },
        DuhemParameters { f3_um_per_v3: -1e-3, ..good },
        DuhemParameters { g2_um_per_v3: 1e38, ..good },
    ];
    for bad in bad {
        assert!(bad.check().is_err(), "{bad:?}");
        let model = Duhem::<f32>::build(&bad, 0.0);
        let mut state = model.begin(1.0, Some(2.0));
        model.step(&mut state, 200.0);
        model.step(&mut state, -200.0);
    }
}

prop_compose! {
    fn any_set()(
        alpha_per_v in 2e-3f32..0.5,
        saturation_v in 20f32..200.0,
        voltage_centre_v in -50f32..50.0,
        offset_um in -10f32..10.0,
        f1_um_per_v in 0f32..1.0,
        cubic in -0.3f32..1.0,
        g0_um_per_v in -1f32..1.0,
        square in -1f32..1.0,
    ) -> DuhemParameters {
        let per_square = 1.0 / (saturation_v * saturation_v);
        DuhemParameters {
            lag_s: 0.0, alpha_per_v, saturation_v, voltage_centre_v, offset_um, f1_um_per_v,
            f3_um_per_v3: cubic * f1_um_per_v * per_square, g0_um_per_v, g2_um_per_v3: square * per_square,
        }
    }
}

fn any_voltages() -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(prop_oneof![-300f32..300.0, -1f32..1.0, 50f32..52.0], 1..200)
}

proptest! {
    #[test]
    fn bounded_for_any_jumps(p in any_set(), start in prop::option::of(-200f32..200.0), voltages in any_voltages()) {
        prop_assert_eq!(p.check(), Ok(()));
        let model = Duhem::<f32>::build(&p, 0.0);
        let reach = model.reach(Range { min: -300.0, max: 300.0 }).unwrap();
        let slack = 1e-5 * (1.0 + reach.min.abs() + reach.max.abs());
        laws::stays_within(reach, slack, &model, voltages, start)?;
    }

    #[test]
    fn rate_independent(
        p in any_set(),
        cuts in prop::collection::vec(0f64..1.0, 0..60),
        ends in (-200f64..200.0, -200f64..200.0),
    ) {
        let model = Duhem::<f64>::build(&p, 0.0);
        let start = model.begin(ends.0, Some(1.0));
        let mut cuts = cuts;
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        let (mut cut, mut whole) = (start, start);
        let mut last = 0.0;
        for part in cuts {
            let to = if part == 1.0 { ends.1 } else { ends.0 + part * (ends.1 - ends.0) };
            last = model.step(&mut cut, to);
        }
        let error = (last - model.step(&mut whole, ends.1)).abs();
        prop_assert!(error < 1e-8 * (1.0 + model.largest_memory()), "{}", error);
    }

    #[test]
    fn the_columns_weigh_to_the_displacement(p in any_set(), voltages in any_voltages()) {
        let model = Duhem::<f64>::build(&p, 0.0);
        let weights = [p.f1_um_per_v, p.f3_um_per_v3, p.g0_um_per_v, p.g2_um_per_v3, p.offset_um].map(f64::from);
        laws::columns_weigh_to_the_displacement(&model, &weights, 0.0, voltages.into_iter().map(f64::from), 1e-8)?;
    }

    /// Within 0 and saturation, a set with constant f' and g that meets the conditions moves the way the voltage moves.
    #[test]
    fn a_set_that_meets_the_conditions_rises_with_the_voltage(
        g0 in 0.21f32..0.399, alpha in 2e-3f32..0.2, voltages in prop::collection::vec(0f64..79.0, 2..100),
    ) {
        let p = DuhemParameters {
            alpha_per_v: alpha, voltage_centre_v: 0.0, f3_um_per_v3: 0.0, g0_um_per_v: g0, g2_um_per_v3: 0.0,
            ..parameters()
        };
        prop_assert_eq!(p.unmet_condition(), None);
        let model = Duhem::<f64>::build(&p, 0.0);
        let mut state = model.begin(0.0, None);
        let (mut last, mut y) = (0.0, model.step(&mut state.clone(), 0.0));
        for voltage in voltages {
            let next = model.step(&mut state, voltage);
            prop_assert!((next - y) * (voltage - last) >= 0.0);
            (last, y) = (voltage, next);
        }
    }

    #[test]
    fn single_precision_follows(p in any_set(), steps in prop::collection::vec(-1f32..1.0, 1..400)) {
        let (single, double) = (Duhem::<f32>::build(&p, 0.0), Duhem::<f64>::build(&p, 0.0));
        let (mut a, mut b, mut voltage) = (single.begin(0.0, None), double.begin(0.0, None), 0.0f32);
        for step in steps {
            voltage += step;
            let error = (f64::from(single.step(&mut a, voltage)) - double.step(&mut b, voltage.into())).abs();
            prop_assert!(error < 2e-4, "{}", error);
        }
    }
}
