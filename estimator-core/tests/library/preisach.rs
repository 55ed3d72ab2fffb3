//! Properties of the Preisach model: its Everett function, its memory, and densities from reversal curves.

mod relays;

use crate::laws;
use estimator_core::model::{
    CELLS, Linear, Preisach, PreisachParameters, Published, REVERSALS, Recursion, SIDE, densities_from_reversal_curves,
};
use estimator_core::{List, Range, Real};
use proptest::prelude::*;
use relays::Unlimited;

const UNIFORM: PreisachParameters = PreisachParameters {
    lag_s: 0.0,
    lower_v: -20.0,
    upper_v: 80.0,
    densities_um: List::of([1.0; 10]),
    offset_um: -1.5,
};

/// Six cells along an edge, some of them empty.
const UNEVEN: PreisachParameters = PreisachParameters {
    densities_um: List::of([
        0.5, 0.1, 0.8, 0.0, 0.3, 1.0, 0.2, 0.0, 0.7, 0.0, 0.05, 0.6, 0.1, 0.4, 1.2, 0.3, 0.2, 0.0, 0.1, 0.9, 0.6,
    ]),
    ..UNIFORM
};

/// What rounds where a place is an `f32`, as it is in every number type, µm.
const ROUNDED: f64 = 1e-5;

const RANGE: Range<f64> = Range { min: -20.0, max: 80.0 };

fn model<T: Real>(parameters: &PreisachParameters) -> Preisach<T> {
    Preisach::build(parameters)
}

/// From negative saturation.
fn run<T: Real>(parameters: &PreisachParameters, voltages: &[T]) -> Vec<T> {
    let model = model(parameters);
    let mut state = model.begin(T::of(parameters.lower_v), None);
    voltages.iter().map(|&voltage| model.step(&mut state, voltage)).collect()
}

fn last(parameters: &PreisachParameters, voltages: &[f64]) -> f64 {
    *run(parameters, voltages).last().unwrap()
}

fn voltages(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(RANGE.min - 5.0..RANGE.max + 5.0, 2..count)
}

fn either() -> impl Strategy<Value = PreisachParameters> {
    prop::sample::select(vec![UNIFORM, UNEVEN])
}

/// Reversals about 30 V that shrink by this factor each.
fn spiral(reversals: usize, factor: f64) -> Vec<f64> {
    (0..reversals).map(|i| 30.0 + if i % 2 == 0 { 50.0 } else { -50.0 } * factor.powi(i as i32)).collect()
}

/// A uniform density of 1 µm a cell of 25 V × 25 V: the mass of a triangle is half the square of its side.
#[test]
fn a_uniform_density_has_a_quadratic_everett_function() {
    let model = model::<f64>(&UNIFORM);
    for (high, low) in
        [(80.0, -20.0), (60.0, 60.0), (31.0, 30.0), (31.0, 29.0), (80.0, 10.0), (54.0, -19.0), (5.0, -20.0)]
    {
        let side: f64 = (high - low) / 25.0;
        assert!((model.everett(high, low) - side * side / 2.0).abs() < ROUNDED, "{high} V, {low} V");
    }
    assert_eq!(model.everett(10.0, 20.0), 0.0);
    // Virgin rise and the fall from its top: parabolas.
    let y = run(&UNIFORM, &[30.0, 80.0, 30.0, -20.0]);
    for (found, expected) in y.iter().zip([2.0f64, 8.0, 6.0, 0.0]) {
        assert!((found + 1.5 - expected).abs() < ROUNDED);
    }
}

#[test]
fn the_everett_function_is_the_mass_of_the_triangle() {
    // Against a sum over a fine grid of relays.
    let model = model::<f64>(&UNEVEN);
    let fine = 600;
    let volt = |i: usize| -20.0 + (i as f64) / 6.0;
    for (high, low) in [(600, 0), (437, 13), (437, 337), (480, 401), (333, 320), (250, 50), (199, 101)] {
        let mut mass = 0.0;
        for alpha in 0..fine {
            for beta in 0..=alpha {
                let density = f64::from(UNEVEN.densities_um[(alpha / 100) * (alpha / 100 + 1) / 2 + beta / 100]) / 1e4;
                if alpha < high && beta >= low {
                    mass += if alpha == beta { density / 2.0 } else { density };
                }
            }
        }
        let found = model.everett(volt(high), volt(low));
        assert!((found - mass).abs() < ROUNDED, "{found} for {mass}");
    }
}

#[test]
fn minor_loops_between_the_same_voltages_are_congruent() {
    let shape = |history: &[f64]| {
        let all = [history, &[25.0, 37.0, 25.0, 30.0, 37.0, 31.0, 25.0]].concat();
        let y = run(&UNEVEN, &all)[history.len()..].to_vec();
        // From the second voltage on the loop is closed, whatever came before.
        y.iter().skip(2).map(|displacement| displacement - y[2]).collect::<Vec<_>>()
    };
    let reference = shape(&[0.0]);
    assert!(reference.iter().any(|y| *y > 0.05));
    for history in [&[80.0, 0.0][..], &[-20.0, 60.0], &[50.0, 10.0, 40.0, 20.0]] {
        for (a, b) in shape(history).iter().zip(&reference) {
            assert!((a - b).abs() < ROUNDED);
        }
    }
    assert!((last(&UNEVEN, &[80.0, 25.0]) - last(&UNEVEN, &[25.0])).abs() > 0.5, "though they lie elsewhere");
}

#[test]
fn reversal_curves_give_the_densities_back() {
    for parameters in [UNIFORM, UNEVEN] {
        let side = (1..=SIDE).find(|n| n * (n + 1) / 2 == parameters.densities_um.len()).unwrap();
        let node = |i: usize| -20.0 + 100.0 * i as f64 / side as f64;
        let curve = |a, b| last(&parameters, &[node(a), node(b)]);
        let found = densities_from_reversal_curves(side, curve).unwrap();
        assert_eq!(found.len(), parameters.densities_um.len());
        for (found, &expected) in found.iter().zip(parameters.densities_um.iter()) {
            assert!((found - f64::from(expected)).abs() < ROUNDED, "{found} for {expected}");
        }
    }
    assert_eq!(densities_from_reversal_curves(0, |_, _| 0.0f32), None);
    assert_eq!(densities_from_reversal_curves(SIDE + 1, |_, _| 0.0f32), None);
    assert_eq!(densities_from_reversal_curves(SIDE, |_, _| 0.0f32).map(|list| list.len()), Some(CELLS));
}

#[test]
fn a_known_displacement_is_begun_with_and_one_out_of_reach_comes_nearest() {
    let model = model::<f64>(&UNEVEN);
    for voltage in [-20.0, 10.0, 33.0, 79.0, 80.0, 95.0] {
        let at = |displacement| model.step(&mut model.begin(voltage, displacement), voltage);
        let (least, most) = (at(Some(-1e6)), at(Some(1e6)));
        assert!((least - last(&UNEVEN, &[voltage])).abs() < 1e-6);
        assert!((most - last(&UNEVEN, &[80.0, voltage])).abs() < 1e-6);
        for part in [0.0, 0.2, 0.7, 1.0] {
            let wanted = least + part * (most - least);
            assert!((at(Some(wanted)) - wanted).abs() < 1e-6, "{wanted} µm at {voltage} V");
        }
        assert!((at(None) - (least + most) / 2.0).abs() < 1e-6);
        assert!(at(Some(f64::NAN)).is_finite());
    }
}

#[test]
fn every_rule_has_its_fault() {
    assert_eq!([UNIFORM.check(), UNEVEN.check()], [Ok(()), Ok(())]);
    let broken = [
        (PreisachParameters { lag_s: f32::NAN, ..UNIFORM }, "lag_s"),
        (PreisachParameters { upper_v: f32::NAN, ..UNIFORM }, "finite"),
        (PreisachParameters { upper_v: -20.0, ..UNIFORM }, "above"),
        (PreisachParameters { lower_v: f32::MIN, upper_v: f32::MAX, ..UNIFORM }, "above"),
        (PreisachParameters { densities_um: List::of([1.0; 4]), ..UNIFORM }, "n(n+1)/2"),
        (PreisachParameters { densities_um: List::of([]), ..UNIFORM }, "n(n+1)/2"),
        (PreisachParameters { densities_um: List::of([1.0, -1.0, 1.0]), ..UNIFORM }, "at least 0"),
        (PreisachParameters { densities_um: List::of([f32::INFINITY]), ..UNIFORM }, "finite"),
        (PreisachParameters { densities_um: List::of([f32::MAX; 3]), ..UNIFORM }, "sum"),
        (PreisachParameters { densities_um: List::of([0.0; 3]), ..UNIFORM }, "not all be 0"),
    ];
    for (parameters, part) in broken {
        assert!(parameters.check().is_err_and(|rule| rule.contains(part)), "{part}: {:?}", parameters.check());
        run::<f32>(&parameters, &[0.0, 30.0, f32::NAN, -10.0, 90.0]);
    }
}

#[test]
fn survives_the_wire() {
    laws::survives_the_wire(UNEVEN);
}

/// Up to its capacity the memory is complete; beyond it a spiral of 300 reversals stays within 1 % of the stroke of
/// where it should be, and where it should be with a uniform density.
#[test]
fn a_full_memory_forgets_little() {
    for parameters in [UNIFORM, UNEVEN] {
        let model = model::<f64>(&parameters);
        let stroke = model.everett(80.0, -20.0);
        let largest = parameters.densities_um.iter().fold(0.0, |most: f64, &density| most.max(density.into()));
        let side = if parameters == UNIFORM { 4.0 } else { 6.0 };
        let allowed = if parameters == UNIFORM { ROUNDED } else { 0.01 * stroke };
        let bound = side * side / 88.0 * largest;
        for factor in [0.8, 0.9, 0.95, 0.98, 0.99, 0.995] {
            let mut state = model.begin(-20.0, None);
            let mut unlimited = Unlimited::new();
            let mut before = 0.0;
            for (index, voltage) in spiral(300, factor).into_iter().enumerate() {
                let found = model.step(&mut state, voltage);
                let error = (found - unlimited.displacement(&model, voltage, parameters.offset_um.into())).abs();
                // The last extreme is the present voltage, which is no entry yet.
                if index <= REVERSALS {
                    assert!(error < 1e-12, "{error} µm at reversal {index}");
                }
                assert!(error < allowed, "{error} µm of {allowed} at reversal {index} of {factor}");
                assert!((error - before).abs() <= bound, "{error} µm after {before}");
                before = error;
                assert!(state.reversals() <= REVERSALS);
            }
        }
    }
}

/// Before a full memory forgets, in the tick in which it does, and afterwards; of voltages that turn, go on, and wipe
/// older loops out.
#[test]
fn to_try_a_voltage_gives_what_a_step_gives_when_the_memory_is_full() {
    let model = model::<f64>(&UNEVEN);
    let mut state = model.begin(-20.0, None);
    let mut fullest = 0;
    for voltage in spiral(60, 0.97) {
        let (now, swing) = (voltage, 30.0 - voltage);
        for tried in [now, now + 0.01 * swing, now - 0.01 * swing, now + 1.9 * swing, now + 3.0 * swing, 85.0, -25.0] {
            let before = state.clone();
            let found = model.peek(&state, tried);
            assert_eq!(state, before);
            assert_eq!(found, model.step(&mut state.clone(), tried), "{tried} V");
        }
        model.step(&mut state, voltage);
        fullest = fullest.max(state.reversals());
    }
    assert_eq!(fullest, REVERSALS);
}

proptest! {
    /// The same as a memory without limit and without increments.
    #[test]
    fn follows_every_history(parameters in either(), voltages in voltages(20)) {
        let model = model::<f64>(&parameters);
        let mut state = model.begin(-20.0, None);
        let mut unlimited = Unlimited::new();
        for &voltage in &voltages {
            let expected = unlimited.displacement(&model, voltage, parameters.offset_um.into());
            prop_assert!((model.step(&mut state, voltage) - expected).abs() < 1e-12);
        }
    }

    /// Whatever the memory holds.
    #[test]
    fn to_try_a_voltage_gives_what_a_step_gives(
        parameters in either(), voltages in voltages(200), calm in 0.0f64..1.0, tried in -25.0f64..85.0,
    ) {
        let model = model::<f64>(&parameters);
        let mut state = model.begin(-20.0, None);
        for (index, voltage) in voltages.into_iter().enumerate() {
            // Swings that shrink in the end fill the memory.
            let voltage = 30.0 + (voltage - 30.0) * (-calm * index as f64 / 20.0).exp();
            let before = state.clone();
            let tried = 30.0 + (tried - 30.0) * (-calm * index as f64 / 20.0).exp();
            let found = model.peek(&state, tried);
            prop_assert_eq!(&state, &before);
            prop_assert_eq!(found, model.step(&mut state.clone(), tried));
            model.step(&mut state, voltage);
        }
    }

    #[test]
    fn wiping_out(parameters in either(), voltages in voltages(60)) {
        let inner: Vec<f64> = voltages.iter().map(|&voltage| voltage.clamp(5.0, 60.0)).collect();
        let outer = [65.0, 1.0];
        for tail in [&[65.0][..], &[65.0, 20.0], &[62.0, 1.0], &[65.0, 1.0, 30.0]] {
            let with = last(&parameters, &[&outer[..], &inner, tail].concat());
            let without = last(&parameters, &[&outer[..], tail].concat());
            prop_assert!((with - without).abs() < 1e-12, "{} against {}", with, without);
        }
    }

    #[test]
    fn rate_independent(parameters in either(), voltages in voltages(60), between in 1u32..9) {
        let (fast, slow) = laws::at_two_rates(|voltages| run(&parameters, voltages), &voltages, between);
        prop_assert_eq!(fast, slow);
    }

    #[test]
    fn stays_within_reach(parameters in either(), voltages in voltages(200), known in prop::option::of(-5.0f32..20.0)) {
        let model = model::<f32>(&parameters);
        let range = Range { min: 0.0, max: 50.0 };
        let reach = model.reach(range);
        laws::stays_within(reach, 0.0, &model, voltages.into_iter().map(|v| range.clamp(v as f32)), known)?;
    }

    /// A memory that is always full stays within reach, and in f32 near f64.
    #[test]
    fn a_full_memory_stays_bounded(parameters in either(), factors in prop::collection::vec(0.97f32..1.0, 100..400)) {
        let single = model::<f32>(&parameters);
        let range = Range { min: -20.0, max: 80.0 };
        let reach = single.reach(range);
        let mut state = single.begin(-20.0, None);
        let mut swing = 50.0;
        for factor in factors {
            swing *= -factor;
            let displacement = single.step(&mut state, 30.0 + swing);
            prop_assert!(reach.contains(displacement), "{} not in {:?}", displacement, reach);
            // Once it has forgotten what was too much.
            let displacement = single.step(&mut state, 30.0 + swing);
            prop_assert!(reach.contains(displacement), "{} not in {:?}", displacement, reach);
            let columns = laws::columns(&single, &state);
            let weights = parameters.densities_um.iter().chain([&parameters.offset_um]);
            let sum: f32 = columns.iter().zip(weights).map(|(column, weight)| column * weight).sum();
            prop_assert!((sum - displacement).abs() < 2e-4, "{} against {}", sum, displacement);
        }
    }

    #[test]
    fn the_columns_weigh_to_the_displacement(parameters in either(), voltages in voltages(60)) {
        let model = model::<f64>(&parameters);
        let weights = parameters.densities_um.iter().chain([&parameters.offset_um]);
        let weights: Vec<f64> = weights.map(|&weight| weight.into()).collect();
        laws::columns_weigh_to_the_displacement(&model, &weights, 0.0, voltages.iter().copied(), 1e-9)?;
        let mut state = model.begin(0.0, None);
        for voltage in voltages {
            model.advance(&mut state, voltage);
            let columns = laws::columns(&model, &state);
            prop_assert!(columns.iter().all(|column| (-1e-12..=1.0 + 1e-12).contains(column)));
        }
    }
}
