//! Bouc-Wen: its bound, its independence of the rate, its loops, and its equation.

use crate::laws;
use estimator_core::Range;
use estimator_core::model::{BoucWen, BoucWenParameters, Published, Recursion};
use proptest::prelude::*;

fn parameters(n: f32) -> BoucWenParameters {
    BoucWenParameters {
        lag_s: 0.0,
        a: 1.0,
        beta: 0.08,
        gamma: 0.03,
        delta: 0.02,
        n,
        offset_um: 2.0,
        d1_um_per_v: 0.4,
        d2_um_per_v2: 4e-4,
        c_um_per_v: -0.15,
    }
}

/// dh/du as the module states it.
fn slope(p: &BoucWenParameters, h: f64, direction: f64) -> f64 {
    let [a, beta, gamma, delta, n] = [p.a, p.beta, p.gamma, p.delta, p.n].map(f64::from);
    let sign = if h == 0.0 { 0.0 } else { h.signum() };
    a - h.abs().powf(n) * (beta * sign * direction + gamma + delta * direction)
}

/// The same, in steps far shorter than any tick's.
fn integrate(p: &BoucWenParameters, mut h: f64, change: f64) -> f64 {
    let count = 10_000;
    let step = change / f64::from(count);
    for _ in 0..count {
        let middle = h + 0.5 * step * slope(p, h, change.signum());
        h += step * slope(p, middle, change.signum());
    }
    h
}

#[test]
fn follows_its_equation() {
    for (n, tolerance) in [(1.0, 1e-6), (2.0, 2e-4), (1.5, 2e-4), (3.0, 2e-4)] {
        for delta in [0.0, 0.02, -0.07] {
            for (beta, gamma) in [(0.08, 0.03), (0.08, 0.08), (0.08, -0.005), (0.09, 0.25)] {
                let p = BoucWenParameters { beta, gamma, delta, ..parameters(n) };
                if p.check().is_err() {
                    continue;
                }
                let model = BoucWen::<f64>::build(&p, 0.0);
                let limits = model.limits();
                for part in [-1.0, -0.6, -0.01, 0.0, 0.3, 1.0] {
                    let start = if part < 0.0 { -part * limits.min } else { part * limits.max };
                    for change in [1e-4, -1e-4, 0.7, -0.7, 6.0, -6.0, 45.0, -45.0] {
                        let (found, expected) = (model.follow(start, change), integrate(&p, start, change));
                        let error = (found - expected).abs() / limits.span();
                        assert!(error < tolerance, "{p:?} from {start} by {change}: {found} {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn branches_saturate_where_it_says() {
    for n in [1.0, 1.5, 2.0] {
        let model = BoucWen::<f64>::build(&parameters(n), 0.0);
        let expected = |sum: f64| (1.0 / sum).powf(1.0 / f64::from(n));
        let limits = model.limits();
        assert!((limits.max - expected(0.13)).abs() < 1e-5 && (limits.min + expected(0.09)).abs() < 1e-5, "{limits:?}");
        assert!((model.follow(0.0, 1000.0) - limits.max).abs() < 1e-6);
        assert!((model.follow(limits.max, -1000.0) - limits.min).abs() < 1e-6);
    }
}

#[test]
fn loops_close_and_lag() {
    for n in [1.0, 1.5, 2.0] {
        laws::loops_close_and_lag(&BoucWen::<f64>::build(&parameters(n), 0.0));
    }
}

#[test]
fn begins_at_the_known_displacement_or_nearest() {
    let model = BoucWen::<f64>::build(&parameters(1.0), 0.0);
    let free = 2.0 + 0.4 * 30.0 + 4e-4 * 900.0;
    let mut state = model.begin(30.0, Some(free - 0.3));
    assert!((model.step(&mut state, 30.0) - (free - 0.3)).abs() < 1e-5);
    assert!((state.hysteresis - 2.0).abs() < 1e-4);
    assert_eq!(model.begin(30.0, Some(1e6)).hysteresis, model.limits().min);
    let limits = model.limits();
    assert_eq!(model.begin(30.0, None).hysteresis, 0.5 * (limits.min + limits.max));
}

#[test]
fn what_breaks_a_rule_is_refused_and_still_builds() {
    let good = parameters(1.0);
    assert_eq!(good.check(), Ok(()));
    let bad = [
        BoucWenParameters { c_um_per_v: f32::NAN, ..good },
        BoucWenParameters { lag_s: -1.1, ..good },
        BoucWenParameters { lag_s: f32::NAN, ..good },
        BoucWenParameters { a: 0.0, ..good },
        BoucWenParameters { n: 0.5, ..good },
        BoucWenParameters { delta: 0.09, ..good },
        BoucWenParameters { gamma: -0.08, delta: 0.0, ..good },
        BoucWenParameters { beta: 0.0, delta: 0.0, gamma: 0.0, ..good },
        BoucWenParameters { beta: -0.1, delta: 0.0, gamma: 0.3, ..good },
        BoucWenParameters { beta: 1e-38, gamma: 1e-38, delta: 0.0, a: 1e30, ..good },
    ];
    for bad in bad {
        assert!(bad.check().is_err(), "{bad:?}");
        let model = BoucWen::<f32>::build(&bad, 0.0);
        let mut state = model.begin(1.0, Some(2.0));
        model.step(&mut state, 30.0);
        model.step(&mut state, -30.0);
    }
}

prop_compose! {
    fn any_set()(
        a in 0.2f32..3.0,
        beta in 1e-3f32..2.0,
        gamma in -0.999f32..3.0,
        delta in -0.999f32..0.999,
        n in prop_oneof![Just(1.0f32), Just(2.0), 1.0f32..4.0],
        weights in (-10f32..10.0, -1f32..1.0, -0.01f32..0.01, -1f32..1.0),
    ) -> BoucWenParameters {
        let gamma = beta * gamma;
        let smaller = beta.min(beta + gamma);
        BoucWenParameters {
            lag_s: 0.0, a, beta, gamma, delta: smaller * delta, n,
            offset_um: weights.0, d1_um_per_v: weights.1, d2_um_per_v2: weights.2, c_um_per_v: weights.3,
        }
    }
}

fn any_voltages() -> impl Strategy<Value = Vec<f32>> {
    let glitch = prop_oneof![Just(-1000f32), Just(1000.0)];
    prop::collection::vec(prop_oneof![8 => -1000f32..1000.0, 8 => -1f32..1.0, 1 => glitch], 1..200)
}

proptest! {
    #[test]
    fn bounded_for_any_jumps(p in any_set(), start in prop::option::of(-50f32..50.0), voltages in any_voltages()) {
        prop_assume!(p.check().is_ok());
        let model = BoucWen::<f32>::build(&p, 0.0);
        let limits = model.limits();
        let reach = model.reach(Range { min: -1000.0, max: 1000.0 }).unwrap();
        let slack = 1e-5 * (1.0 + reach.min.abs() + reach.max.abs());
        let mut state = model.begin(voltages[0], start);
        for voltage in voltages {
            let y = model.step(&mut state, voltage);
            prop_assert!(limits.contains(state.hysteresis), "{:?} {:?}", state, limits);
            prop_assert!(reach.min - slack <= y && y <= reach.max + slack, "{} {:?}", y, reach);
        }
    }

    /// h after a monotone move does not depend on how it is cut into ticks.
    #[test]
    fn rate_independent(
        p in any_set(), start in -1f64..1.0, cuts in prop::collection::vec(0f64..1.0, 0..60), change in -60f64..60.0,
    ) {
        prop_assume!(p.check().is_ok());
        let model = BoucWen::<f64>::build(&p, 0.0);
        let limits = model.limits();
        let start = if start < 0.0 { -start * limits.min } else { start * limits.max };
        let mut cuts = cuts;
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        let (mut cut, mut last) = (start, 0.0);
        for part in cuts {
            cut = model.follow(cut, (part - last) * change);
            last = part;
        }
        let error = (cut - model.follow(start, change)).abs() / limits.span();
        prop_assert!(error < if p.n == 1.0 { 1e-9 } else { 2e-3 }, "{}", error);
    }

    #[test]
    fn the_columns_weigh_to_the_displacement(p in any_set(), voltages in any_voltages()) {
        prop_assume!(p.check().is_ok());
        let model = BoucWen::<f64>::build(&p, 0.0);
        let weights = [p.d1_um_per_v, p.d2_um_per_v2, p.c_um_per_v, p.offset_um].map(f64::from);
        laws::columns_weigh_to_the_displacement(&model, &weights, 0.0, voltages.into_iter().map(f64::from), 1e-7)?;
    }

    /// f32 beside f64 over the same small ticks.
    #[test]
    fn single_precision_follows(
        p in any_set().prop_map(|p| BoucWenParameters { n: 1.0, ..p }),
        steps in prop::collection::vec(-1f32..1.0, 1..400),
    ) {
        prop_assume!(p.check().is_ok());
        let (single, double) = (BoucWen::<f32>::build(&p, 0.0), BoucWen::<f64>::build(&p, 0.0));
        let (mut a, mut b, mut voltage) = (single.begin(0.0, None), double.begin(0.0, None), 0.0f32);
        for step in steps {
            voltage += step;
            single.step(&mut a, voltage);
            double.step(&mut b, voltage.into());
            let error = (f64::from(a.hysteresis) - b.hysteresis).abs();
            prop_assert!(error < 1e-4 * (1.0 + double.limits().span()), "{}", error);
        }
    }
}
