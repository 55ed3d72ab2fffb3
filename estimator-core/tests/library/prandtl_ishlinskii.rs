//! Properties of the Prandtl-Ishlinskii model and of its inverse.

#[path = "common/prandtl_ishlinskii_inverse.rs"]
mod exact;

use crate::laws;
use estimator_core::*;
use exact::ExactInverse;
use proptest::prelude::*;

const SYMMETRIC: PrandtlIshlinskiiParameters = PrandtlIshlinskiiParameters {
    lag_s: 0.0,
    thresholds_v: List::of([0.0, 2.0, 5.0, 10.0, 20.0]),
    weights_um_per_v: List::of([0.08, 0.03, 0.02, 0.0, 0.04]),
    offset_um: 0.5,
    dead_zones_um: List::of([]),
    dead_zone_slopes: List::of([]),
    memory_v: Range { min: -20.0, max: 80.0 },
};

const ASYMMETRIC: PrandtlIshlinskiiParameters = PrandtlIshlinskiiParameters {
    dead_zones_um: List::of([-3.0, -1.0, 0.0, 2.0, 4.0]),
    dead_zone_slopes: List::of([0.3, -0.4, 1.2, 0.5, -1.1]),
    ..SYMMETRIC
};

/// Of the displacement limits.
const SPAN_UM: f64 = 15.0;
const RANGE: Range<f64> = Range { min: -20.0, max: 80.0 };

fn model<T: Real>(parameters: &PrandtlIshlinskiiParameters) -> PrandtlIshlinskii<T> {
    PrandtlIshlinskii::build(parameters)
}

fn run<T: Real>(model: &PrandtlIshlinskii<T>, voltages: &[T]) -> Vec<T> {
    let mut state = model.begin(voltages[0], None);
    voltages.iter().map(|&voltage| model.step(&mut state, voltage)).collect()
}

fn voltages() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(RANGE.min..RANGE.max, 2..60)
}

fn either() -> impl Strategy<Value = PrandtlIshlinskiiParameters> {
    prop::sample::select(vec![SYMMETRIC, ASYMMETRIC])
}

#[test]
fn first_rise_is_the_sum_of_dead_zones_of_the_voltage() {
    let model = model::<f64>(&SYMMETRIC);
    for (voltage, expected) in [(0.0, 0.5), (2.0, 0.66), (5.0, 0.5 + 0.4 + 0.09), (30.0, 0.5 + 2.4 + 0.84 + 0.5 + 0.4)]
    {
        let state = &mut model.begin(0.0, None);
        assert!((model.step(state, voltage) - expected).abs() < 1e-7, "{voltage} V");
    }
}

#[test]
fn minor_loops_between_the_same_voltages_are_congruent() {
    let model = model::<f64>(&SYMMETRIC);
    let minor = [20.0, 25.0, 30.0, 26.0, 21.0, 20.0];
    let shape = |history: &[f64]| {
        let all: Vec<f64> = history.iter().chain(&minor).copied().collect();
        let displacements = run(&model, &all)[history.len()..].to_vec();
        displacements.iter().map(|y| y - displacements[0]).collect::<Vec<_>>()
    };
    let (low, high) = (shape(&[0.0, -20.0]), shape(&[0.0, 80.0]));
    // Both begin from a reversal at 20 V once the loop has gone round.
    let close = |history: &[f64]| shape(&[history, &[20.0, 30.0]].concat());
    for (a, b) in close(&[0.0, -20.0]).iter().zip(close(&[0.0, 80.0])) {
        assert!((a - b).abs() < 1e-12);
    }
    assert!(low != high, "the first passes differ");
}

#[test]
fn asymmetric_loops_are_not_point_symmetric_and_symmetric_ones_are() {
    let asymmetry = |parameters| {
        let y = run(&model::<f64>(parameters), &[0.0, 30.0, -30.0, 0.0, 30.0, 0.0]);
        (y[3] - 0.5 + (y[5] - 0.5)).abs()
    };
    assert!(asymmetry(&SYMMETRIC) < 1e-9);
    assert!(asymmetry(&ASYMMETRIC) > 0.1);
}

#[test]
fn a_known_displacement_is_begun_with_and_one_out_of_reach_comes_nearest() {
    for parameters in [SYMMETRIC, ASYMMETRIC] {
        let model = model::<f64>(&parameters);
        let at = |displacement| model.step(&mut model.begin(30.0, Some(displacement)), 30.0);
        let (least, most) = (at(-1e6), at(1e6));
        assert!(most - least > 1.0);
        for part in [0.0, 0.3, 0.9, 1.0] {
            let wanted = least + part * (most - least);
            assert!((at(wanted) - wanted).abs() < 1e-7, "{wanted}");
        }
        assert!(at(f64::NAN).is_finite());
    }
}

#[test]
fn every_rule_has_its_fault() {
    assert_eq!([SYMMETRIC.check(), ASYMMETRIC.check()], [Ok(()), Ok(())]);
    let broken = [
        (PrandtlIshlinskiiParameters { lag_s: f32::INFINITY, ..SYMMETRIC }, "lag_s"),
        (PrandtlIshlinskiiParameters { weights_um_per_v: List::of([1.0]), ..SYMMETRIC }, "as many"),
        (PrandtlIshlinskiiParameters { memory_v: Range { min: 0.0, max: 39.0 }, ..SYMMETRIC }, "half of memory_v"),
        (PrandtlIshlinskiiParameters { memory_v: Range { min: 1.0, max: f32::NAN }, ..SYMMETRIC }, "ordered"),
        (PrandtlIshlinskiiParameters { offset_um: f32::NAN, ..SYMMETRIC }, "finite"),
        (PrandtlIshlinskiiParameters { thresholds_v: List::of([0.0, 2.0, 2.0, 3.0, 4.0]), ..SYMMETRIC }, "increase"),
        (PrandtlIshlinskiiParameters { thresholds_v: List::of([1.0, 2.0, 3.0, 4.0, 5.0]), ..SYMMETRIC }, "from 0"),
        (
            PrandtlIshlinskiiParameters { weights_um_per_v: List::of([1.0, -0.1, 0.0, 0.0, 0.0]), ..SYMMETRIC },
            "at least 0",
        ),
        (PrandtlIshlinskiiParameters { weights_um_per_v: List::of([0.0; 5]), ..SYMMETRIC }, "not all 0"),
        (
            PrandtlIshlinskiiParameters { thresholds_v: List::of([]), weights_um_per_v: List::of([]), ..SYMMETRIC },
            "from 0",
        ),
        (PrandtlIshlinskiiParameters { dead_zones_um: List::of([0.0]), ..SYMMETRIC }, "as many"),
        (PrandtlIshlinskiiParameters { dead_zone_slopes: List::of([0.3, -1.4, 1.2, 0.5, -1.0]), ..ASYMMETRIC }, "sum"),
        (PrandtlIshlinskiiParameters { dead_zone_slopes: List::of([0.3, -0.4, 1.2, 0.5, -1.8]), ..ASYMMETRIC }, "sum"),
        (
            PrandtlIshlinskiiParameters { dead_zones_um: List::of([-3.0, -1.0, 0.1, 2.0, 4.0]), ..ASYMMETRIC },
            "contain 0",
        ),
        (
            PrandtlIshlinskiiParameters { dead_zones_um: List::of([-1.0, -3.0, 0.0, 2.0, 4.0]), ..ASYMMETRIC },
            "increase",
        ),
    ];
    for (parameters, part) in broken {
        assert!(parameters.check().is_err_and(|rule| rule.contains(part)), "{part}: {:?}", parameters.check());
        run(&model::<f32>(&parameters), &[0.0, 10.0, -10.0]);
    }
}

#[test]
fn survives_the_wire() {
    laws::survives_the_wire(ASYMMETRIC);
}

proptest! {
    /// The search finds the voltages of the closed form, from whatever memory.
    #[test]
    fn the_inverse_is_the_exact_one(parameters in either(), voltages in voltages()) {
        let model = model::<f64>(&parameters);
        let discretisation = Discretisation { sample_period: 5e-4, scheme: Scheme::ForwardEuler, deadband: 0.0 };
        let engine = Parameters::PrandtlIshlinskii(parameters).build(&discretisation);
        let context = InverseContext { voltage_zero: 0.0, sample_period: 5e-4, displacement_span: SPAN_UM };
        let range_v = Range { min: RANGE.min as f32, max: RANGE.max as f32 };
        let limits = DriveLimits { range_v, rest_v: 0.0, slew_v_per_s: 1e6 };
        let mut inverse = Inverse::build(&engine, &context, &limits).unwrap();
        let mut state = model.begin(0.0, None);
        let mut displacement = model.step(&mut state, 0.0);
        let mut exact = ExactInverse::new(&parameters, &laws::columns(&model, &state));
        for &voltage in &voltages {
            displacement = model.step(&mut state, voltage);
            let expected = exact.step(displacement);
            prop_assert!((expected - voltage).abs() < 1e-9, "{expected} V in closed form, {voltage} applied");
            let found = inverse.tick(displacement).voltage;
            // What counts as reached, at the least slope (that of the play without width by the flattest part of S),
            // and what the search's last step leaves of the whole range, which these limits allow in a tick.
            let reached = f64::from(inverse::REACHED) * SPAN_UM / (0.08 * 0.4);
            let tolerance = reached + RANGE.span() / 2048.0;
            prop_assert!((found - voltage).abs() < tolerance, "{found} V found, {voltage} applied");
        }
        prop_assert!(displacement.is_finite());
    }

    #[test]
    fn the_superposition_is_inverted_exactly(x in -20.0f64..20.0) {
        let curve = *model::<f64>(&ASYMMETRIC).superposition();
        prop_assert!((curve.inverse().apply(curve.apply(x)) - x).abs() < 1e-13);
        prop_assert!(curve.apply(x + 1e-3) > curve.apply(x));
    }

    /// Voltages on the way, at whatever rate, change nothing.
    #[test]
    fn rate_independent(parameters in either(), voltages in voltages(), between in 1u32..9) {
        let model = model::<f64>(&parameters);
        let (fast, slow) = laws::at_two_rates(|voltages| run(&model, voltages), &voltages, between);
        prop_assert_eq!(fast, slow);
    }

    /// What happened between two voltages is forgotten once both have been passed.
    #[test]
    fn wiping_out(parameters in either(), voltages in voltages()) {
        let model = model::<f64>(&parameters);
        let outer = [RANGE.max, RANGE.min, RANGE.max];
        let with: Vec<f64> = [&[0.0][..], &outer[..2], &voltages, &outer[2..]].concat();
        let without: Vec<f64> = [&[0.0][..], &outer].concat();
        prop_assert_eq!(run(&model, &with).last().copied(), run(&model, &without).last().copied());
    }

    #[test]
    fn stays_within_reach(parameters in either(), voltages in voltages(), known in prop::option::of(-30.0f64..40.0)) {
        let single = model::<f32>(&parameters);
        let reach = single.reach(Range { min: RANGE.min as f32, max: RANGE.max as f32 });
        let (voltages, known) = (voltages.into_iter().map(|v| v as f32), known.map(|known| known as f32));
        laws::stays_within(reach, 0.0, &single, voltages, known)?;
    }

    #[test]
    fn the_columns_weigh_to_the_displacement(voltages in voltages()) {
        let model = model::<f64>(&SYMMETRIC);
        let weights = SYMMETRIC.weights_um_per_v.iter().chain([&SYMMETRIC.offset_um]);
        let weights: Vec<f64> = weights.map(|&weight| weight.into()).collect();
        prop_assert_eq!(weights.len(), 6);
        laws::columns_weigh_to_the_displacement(&model, &weights, 0.0, voltages, 1e-12)?;
    }
}
