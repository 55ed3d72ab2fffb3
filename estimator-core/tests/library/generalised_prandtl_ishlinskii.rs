//! Properties of the champion: bounded, monotone, linear in its weights, begun where it is told.

use estimator_core::{
    GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiParameters, Linear, List, Published, Range, Real,
    Recursion, solve,
};
use proptest::prelude::*;

const TICK: f64 = 5e-4;

const PLAIN: GeneralisedPrandtlIshlinskiiParameters = GeneralisedPrandtlIshlinskiiParameters {
    span_v: Range { min: 0.0, max: 100.0 },
    delay_ticks: 0.0,
    slew_v_per_s: 0.0,
    lag_s: 0.0,
    half_widths_v: List::of([0.0, 10.0, 20.0, 40.0]),
    resonance_hz: 0.0,
    damping: 0.0,
    weights_um: List::of([3.0, 5.0, 0.5, 1.0, 0.0, 1.5, 0.2, 0.1]),
    creep_times_s: List::of([0.01, 0.1, 1.0, 10.0]),
    creep_um_per_v: List::of([0.002, 0.002, 0.002, 0.002]),
    curvature_per_um: -0.01,
    offset_um: -2.0,
};

const MOVING: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 2.4, slew_v_per_s: 40_000.0, lag_s: 0.002, ..PLAIN };
const AHEAD: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { delay_ticks: -0.8, lag_s: 0.002, ..PLAIN };
const CUBIC: GeneralisedPrandtlIshlinskiiParameters = GeneralisedPrandtlIshlinskiiParameters {
    half_widths_v: List::of([0.0, 15.0]),
    weights_um: List::of([1.0, 4.0, 2.0, 0.5, 0.0, 1.0]),
    ..PLAIN
};
const RINGING: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { resonance_hz: 300.0, damping: 0.05, ..PLAIN };

fn any() -> impl Strategy<Value = GeneralisedPrandtlIshlinskiiParameters> {
    prop::sample::select(vec![PLAIN, MOVING, AHEAD, CUBIC])
}

fn voltages() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((-5.0f64..105.0, 1usize..20), 1..40)
        .prop_map(|steps| steps.into_iter().flat_map(|(v, dwell)| std::iter::repeat_n(v, dwell)).collect())
}

fn run<T: Real>(parameters: &GeneralisedPrandtlIshlinskiiParameters, voltages: &[T], known: Option<T>) -> Vec<T> {
    let model = GeneralisedPrandtlIshlinskii::<T>::build(parameters, T::of(TICK as f32));
    let mut state = model.begin(voltages[0], known);
    voltages.iter().map(|&v| model.step(&mut state, v)).collect()
}

proptest! {
    #[test]
    fn stays_within_reach(parameters in any(), voltages in voltages(), known in prop::option::of(-30.0f64..30.0)) {
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&parameters, TICK);
        let range = if parameters == PLAIN { Range { min: 20.0, max: 80.0 } } else { Range { min: -5.0, max: 105.0 } };
        let voltages: Vec<f64> = voltages.into_iter().map(|v| range.clamp(v)).collect();
        let reach = model.reach(range).unwrap();
        for y in run(&parameters, &voltages, known) {
            prop_assert!(reach.min - 1e-9 <= y && y <= reach.max + 1e-9, "{y} not in {reach:?}");
        }
    }

    #[test]
    fn rises_with_the_voltage(parameters in any(), voltages in voltages(), low in -5.0f64..105.0, more in 0.0f64..50.0) {
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&parameters, TICK);
        let mut state = model.begin(voltages[0], None);
        voltages.iter().for_each(|&v| { model.step(&mut state, v); });
        let at = |v: f64| model.step(&mut state.clone(), v);
        prop_assert!(at(low + more) >= at(low) - 1e-12);
    }

    #[test]
    fn single_precision_follows(parameters in any(), voltages in voltages()) {
        let single: Vec<f32> = voltages.iter().map(|&v| v as f32).collect();
        let exact: Vec<f64> = single.iter().map(|&v| v.into()).collect();
        for (a, b) in run(&parameters, &single, None).into_iter().zip(run(&parameters, &exact, None)) {
            prop_assert!((f64::from(a) - b).abs() < 1e-4, "{a} {b}");
        }
    }

    /// Without a curvature the columns, weighed, are the displacement.
    #[test]
    fn the_columns_weigh_to_the_displacement(parameters in any(), voltages in voltages()) {
        let parameters = GeneralisedPrandtlIshlinskiiParameters { curvature_per_um: 0.0, ..parameters };
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&parameters, TICK);
        let weights: Vec<f64> = parameters.weights_um.iter().chain(parameters.creep_um_per_v.iter())
            .chain([&parameters.offset_um]).map(|&w| w.into()).collect();
        let (mut state, mut other) = (model.begin(voltages[0], None), model.begin(voltages[0], None));
        for &v in &voltages {
            let displacement = model.step(&mut state, v);
            model.advance(&mut other, v);
            let mut columns = Vec::new();
            model.columns(&other, |column| columns.push(column));
            prop_assert_eq!(columns.len(), weights.len());
            let sum: f64 = columns.iter().zip(&weights).map(|(c, w)| c * w).sum();
            prop_assert!((sum - displacement).abs() < 1e-9);
        }
    }

    #[test]
    fn begins_where_it_is_told(voltage in 20.0f64..80.0, part in 0.05f64..0.95) {
        let at = |known| run(&PLAIN, &[voltage], Some(known))[0];
        // Between the branches: the memory gives it.
        let rest = |from: f64| *run(&PLAIN, &[from, voltage], None).last().unwrap();
        let (low, high) = (rest(0.0), rest(100.0));
        prop_assume!(high - low > 0.1);
        // The creep of the way is not in `rest`'s branches alone; a known displacement is met to what it leaves.
        let known = low + part * (high - low);
        prop_assert!((at(known) - known).abs() < 0.5, "{} not {known}", at(known));
    }
}

#[test]
fn a_delay_is_a_delay() {
    let late = GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 3.0, ..PLAIN };
    let steps: Vec<f64> = (0..40).map(|k| if k < 10 { 20.0 } else { 70.0 }).collect();
    let (now, then) = (run(&PLAIN, &steps, None), run(&late, &steps, None));
    for k in 3..40 {
        assert!((then[k] - now[k - 3]).abs() < 1e-12, "tick {k}");
    }
}

#[test]
fn what_is_foreseen_is_not_remembered() {
    // A step overshoots for a tick when it is looked ahead of, and then is as if it had not been.
    let instant = GeneralisedPrandtlIshlinskiiParameters { delay_ticks: -0.9, ..PLAIN };
    let steps: Vec<f64> = (0..200).map(|k| if k < 10 { 20.0 } else { 60.0 }).collect();
    let (plain, ahead) = (run(&PLAIN, &steps, None), run(&instant, &steps, None));
    assert!(ahead[10] > plain[10] + 0.1);
    for k in 11..200 {
        assert!((ahead[k] - plain[k]).abs() < 1e-12, "tick {k}");
    }
}

#[test]
fn a_slew_limit_and_a_resonance_do_what_they_say() {
    let slow = GeneralisedPrandtlIshlinskiiParameters { slew_v_per_s: 1000.0, ..PLAIN };
    let steps: Vec<f64> = (0..200).map(|k| if k < 10 { 20.0 } else { 60.0 }).collect();
    let (plain, limited, ringing) = (run(&PLAIN, &steps, None), run(&slow, &steps, None), run(&RINGING, &steps, None));
    // 40 V at half a volt a tick.
    assert!(limited[60] < plain[60] - 0.5 && (limited[199] - plain[199]).abs() < 0.05);
    let overshoot = ringing[10..30].iter().copied().fold(f64::MIN, f64::max);
    assert!(overshoot > plain[199] + 0.5 && (ringing[199] - plain[199]).abs() < 0.05);
}

#[test]
fn an_inverse_brings_it_back() {
    let model = GeneralisedPrandtlIshlinskii::<f64>::build(&PLAIN, TICK);
    let mut state = model.begin(0.0, None);
    for k in 0..2000 {
        let wanted = 2.0 + 1.5 * (0.01 * f64::from(k)).sin();
        let voltage = solve(wanted, 0.0, 100.0, |v| model.step(&mut state.clone(), v));
        assert!((model.step(&mut state, voltage) - wanted).abs() < 1e-5, "tick {k}");
    }
}

#[test]
fn every_rule_has_its_fault() {
    for good in [PLAIN, MOVING, AHEAD, CUBIC, RINGING] {
        assert_eq!(good.check(), Ok(()));
    }
    let broken = [
        (GeneralisedPrandtlIshlinskiiParameters { span_v: Range { min: 1.0, max: f32::NAN }, ..PLAIN }, "span_v"),
        (GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 14.5, ..PLAIN }, "delay_ticks"),
        (GeneralisedPrandtlIshlinskiiParameters { slew_v_per_s: f32::INFINITY, ..PLAIN }, "slew"),
        (GeneralisedPrandtlIshlinskiiParameters { lag_s: -1.0, ..PLAIN }, "lag_s"),
        (GeneralisedPrandtlIshlinskiiParameters { damping: 0.1, ..PLAIN }, "resonance_hz"),
        (GeneralisedPrandtlIshlinskiiParameters { half_widths_v: List::of([1.0, 2.0]), ..PLAIN }, "begin with 0"),
        (
            GeneralisedPrandtlIshlinskiiParameters { half_widths_v: List::of([0.0, 10.0, 20.0, 50.0]), ..PLAIN },
            "half of span_v",
        ),
        (
            GeneralisedPrandtlIshlinskiiParameters { weights_um: List::of([1.0, 2.0, 3.0]), ..PLAIN },
            "one, two or three",
        ),
        (
            GeneralisedPrandtlIshlinskiiParameters {
                creep_times_s: List::of([0.0]),
                creep_um_per_v: List::of([0.0]),
                ..PLAIN
            },
            "creep_times_s",
        ),
        (GeneralisedPrandtlIshlinskiiParameters { creep_um_per_v: List::of([0.0]), ..PLAIN }, "as many"),
        (GeneralisedPrandtlIshlinskiiParameters { curvature_per_um: f32::NAN, ..PLAIN }, "curvature"),
    ];
    for (parameters, rule) in broken {
        assert!(parameters.check().is_err_and(|broken| broken.contains(rule)), "{rule}: {:?}", parameters.check());
    }
    for (resonance_hz, damping) in [(1e30, 0.05), (1e-40, 0.05), (1500.0, 0.05), (300.0, 1e-9)] {
        let unsound = GeneralisedPrandtlIshlinskiiParameters { resonance_hz, damping, ..PLAIN };
        assert_eq!(unsound.check(), Ok(()));
        let reach =
            GeneralisedPrandtlIshlinskii::<f32>::build(&unsound, TICK as f32).reach(Range { min: 0.0, max: 100.0 });
        assert_eq!(reach, None, "{resonance_hz} Hz, {damping}");
    }
    assert!(
        GeneralisedPrandtlIshlinskii::<f32>::build(&RINGING, TICK as f32)
            .reach(Range { min: 0.0, max: 100.0 })
            .is_some()
    );
    // A curvature that turns within the stroke has no bound and no inverse.
    let turning = GeneralisedPrandtlIshlinskiiParameters { curvature_per_um: -0.2, ..PLAIN };
    assert_eq!(GeneralisedPrandtlIshlinskii::<f64>::build(&turning, TICK).reach(Range { min: 0.0, max: 100.0 }), None);
}
