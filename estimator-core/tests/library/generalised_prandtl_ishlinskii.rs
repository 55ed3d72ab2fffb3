//! Properties of the generalised Prandtl–Ishlinskii model: bounded, monotone, begun where it is told.

use crate::laws;
use estimator_core::{
    GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiParameters, Inadmissible, List, Published, Range, Real,
    Recursion, solve,
};
use proptest::prelude::*;

const TICK: f64 = 5e-4;

const PLAIN: GeneralisedPrandtlIshlinskiiParameters = GeneralisedPrandtlIshlinskiiParameters {
    span_v: Range { min: 0.0, max: 100.0 },
    delay_ticks: 0.0,
    slew_v_per_s: 0.0,
    lag_s: 0.0,
    resonance_hz: 0.0,
    damping: 0.0,
    reversible_um_per_v: List::of([0.06, 0.04, 0.05]),
    envelope_um_per_v: List::of([0.05, 0.1, 0.12, 0.06, 0.03]),
    half_widths_v: List::of([2.0, 10.0, 20.0, 50.0]),
    weights: List::of([0.5, 0.3, 0.2, 0.1]),
    creep_times_s: List::of([0.01, 0.1, 1.0, 10.0, 100.0]),
    creep_gains: List::of([0.02, 0.015, 0.02, 0.025, 0.03]),
    rest_memory: 0.3,
    offset_um: -2.0,
};

const MOVING: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 2.4, slew_v_per_s: 40_000.0, lag_s: 0.002, ..PLAIN };
const AHEAD: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { delay_ticks: -0.8, lag_s: 0.002, ..PLAIN };
const SATURATED: GeneralisedPrandtlIshlinskiiParameters = GeneralisedPrandtlIshlinskiiParameters {
    reversible_um_per_v: List::of([0.0, 0.1]),
    envelope_um_per_v: List::of([0.0, 0.0, 0.2, 0.2, 0.2, 0.1, 0.0, 0.0, 0.0]),
    half_widths_v: List::of([15.0]),
    weights: List::of([1.0]),
    ..PLAIN
};
/// An envelope for each play.
const OWN: GeneralisedPrandtlIshlinskiiParameters = GeneralisedPrandtlIshlinskiiParameters {
    envelope_um_per_v: List::of([0.05, 0.1, 0.2, 0.1, 0.0, 0.06, 0.0, 0.02, 0.03, 0.1, 0.0, 0.12]),
    ..PLAIN
};
const RINGING: GeneralisedPrandtlIshlinskiiParameters =
    GeneralisedPrandtlIshlinskiiParameters { resonance_hz: 300.0, damping: 0.05, ..PLAIN };

fn parameters() -> impl Strategy<Value = GeneralisedPrandtlIshlinskiiParameters> {
    let kinds = prop::sample::select(vec![PLAIN, MOVING, AHEAD, SATURATED, OWN, RINGING]);
    let memories = prop::sample::select(vec![-2.0f32, -1.4, -1.0, -0.6, 0.0, 0.3, 1.0]);
    (kinds, memories).prop_map(|(kind, rest_memory)| GeneralisedPrandtlIshlinskiiParameters { rest_memory, ..kind })
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
    fn stays_within_reach(
        parameters in parameters(),
        voltages in voltages(),
        known in prop::option::of(-30.0f64..30.0),
        inner in any::<bool>(),
    ) {
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&parameters, TICK);
        let range = if inner { Range { min: 20.0, max: 80.0 } } else { Range { min: -5.0, max: 105.0 } };
        let reach = model.reach(range).unwrap();
        laws::stays_within(reach, 1e-9, &model, voltages.into_iter().map(|v| range.clamp(v)), known)?;
    }

    #[test]
    fn rises_with_the_voltage(parameters in parameters(), voltages in voltages(), low in -5.0f64..105.0, more in 0.0f64..50.0) {
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&parameters, TICK);
        let mut state = model.begin(voltages[0], None);
        voltages.iter().for_each(|&v| { model.step(&mut state, v); });
        let at = |v: f64| model.step(&mut state.clone(), v);
        prop_assert!(at(low + more) >= at(low) - 1e-12);
    }

    #[test]
    fn single_precision_follows(parameters in parameters(), voltages in voltages()) {
        let single: Vec<f32> = voltages.iter().map(|&v| v as f32).collect();
        let exact: Vec<f64> = single.iter().map(|&v| v.into()).collect();
        // micromath's exp makes other coefficients of the f32.
        let near = if cfg!(feature = "micromath") { 1e-2 } else { 1e-4 };
        for (a, b) in run(&parameters, &single, None).into_iter().zip(run(&parameters, &exact, None)) {
            prop_assert!((f64::from(a) - b).abs() < near, "{a} {b}");
        }
    }

    #[test]
    fn begins_where_it_is_told(voltage in 5.0f64..95.0, part in 0.01f64..0.99) {
        let still = GeneralisedPrandtlIshlinskiiParameters { creep_gains: List::of([0.0; 5]), ..PLAIN };
        // Between the branches of the largest loop the memory gives it.
        let after = |way: &[f64]| *run(&still, way, None).last().unwrap();
        let (low, high) = (after(&[50.0, 100.0, 0.0, voltage]), after(&[50.0, 0.0, 100.0, voltage]));
        let known = low + part * (high - low);
        let found = run(&still, &[voltage], Some(known))[0];
        prop_assert!((found - known).abs() < 1e-6, "{found} not {known}");
    }
}

/// The displacement is the sum of what each play with its own envelope gives, creep included.
#[test]
fn plays_with_envelopes_of_their_own_add_up() {
    let voltages: Vec<f64> =
        (0..4_000).map(|k| 50.0 + 0.0125 * f64::from(k) * libm::sin(0.01 * f64::from(k))).collect();
    let of = |play: usize| GeneralisedPrandtlIshlinskiiParameters {
        reversible_um_per_v: if play == 0 { OWN.reversible_um_per_v } else { List::of([0.0, 0.0]) },
        envelope_um_per_v: List::collect(OWN.envelope_um_per_v.chunks(3).nth(play).unwrap().iter().copied()).unwrap(),
        half_widths_v: List::of([OWN.half_widths_v[play]]),
        weights: List::of([OWN.weights[play]]),
        offset_um: if play == 0 { OWN.offset_um } else { 0.0 },
        ..OWN
    };
    let parts: Vec<Vec<f64>> = (0..4).map(|play| run(&of(play), &voltages, None)).collect();
    for (tick, whole) in run(&OWN, &voltages, None).into_iter().enumerate() {
        let sum: f64 = parts.iter().map(|part| part[tick]).sum();
        assert!((whole - sum).abs() < 1e-9, "tick {tick}: {whole} µm, {sum} µm");
    }
}

/// As an actuator that was never driven rests at 0 V, and as one that comes from full voltage does.
#[test]
fn at_an_end_of_the_span_it_may_have_come_there_or_never_left() {
    let still = GeneralisedPrandtlIshlinskiiParameters { creep_gains: List::of([0.0; 5]), ..PLAIN };
    let after = |way: &[f64]| *run(&still, way, None).last().unwrap();
    for (end, other) in [(0.0, 100.0), (100.0, 0.0)] {
        let (never_left, come) = (after(&[end]), after(&[50.0, other, end]));
        assert!((come - never_left).abs() > 0.1, "{never_left} {come}");
        for part in [0.0, 0.3, 1.0] {
            let known = never_left + part * (come - never_left);
            let found = run(&still, &[end], Some(known))[0];
            assert!((found - known).abs() < 1e-6, "{found} not {known} at {end} V");
        }
    }
}

/// Nothing but a rise from the lowest voltage, at which it had rested, is behind an actuator of memory −1.
#[test]
fn a_negative_memory_is_that_of_a_rise_from_the_lowest_voltage() {
    let still = |rest_memory: f32| GeneralisedPrandtlIshlinskiiParameters {
        creep_gains: List::of([0.0; 5]),
        rest_memory,
        ..PLAIN
    };
    for voltage in [0.0, 7.0, 30.0, 80.0, 100.0] {
        let rested = |memory: f32| run::<f64>(&still(memory), &[voltage], None)[0];
        let risen = run::<f64>(&still(0.0), &[0.0, voltage], None)[1];
        assert!((rested(-1.0) - risen).abs() < 1e-9, "{voltage} V: {} µm, not {risen} µm", rested(-1.0));
        // Down from the middle, and up again.
        let fallen = *run::<f64>(&still(1.0), &[50.0, 100.0, 0.0, voltage], None).last().unwrap();
        assert!((rested(-2.0) - fallen).abs() < 1e-9, "{voltage} V: {} µm, not {fallen} µm", rested(-2.0));
        let half = 0.5 * (rested(0.0) + risen);
        let tolerance = 0.2 * (rested(0.0) - risen).abs();
        assert!((rested(-0.5) - half).abs() <= tolerance + 1e-9, "{voltage} V: {} µm", rested(-0.5));
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
    // No play has moved; of creep, the fastest element has, for a tick.
    for k in 11..200 {
        assert!((ahead[k] - plain[k]).abs() < 1e-2 * (ahead[10] - plain[10]), "tick {k}");
    }
    assert!((ahead[199] - plain[199]).abs() < 2e-3 * (ahead[10] - plain[10]));
}

#[test]
fn creep_goes_on_in_decades() {
    let steps: Vec<f64> = (0..20_000).map(|k| if k < 10 { 20.0 } else { 80.0 }).collect();
    let y = run(&PLAIN, &steps, None);
    let hysteretic = GeneralisedPrandtlIshlinskiiParameters { creep_gains: List::of([0.0; 5]), ..PLAIN };
    let still = run(&hysteretic, &steps, None);
    // What the plays moved by drives the creep; the reversible part does not.
    let reversible = GeneralisedPrandtlIshlinskiiParameters { weights: List::of([0.0; 4]), ..hysteretic };
    let moved = |y: &[f64]| y[10] - y[9];
    let driving = moved(&still) - moved(&run(&reversible, &steps, None));
    let gained = |from: usize, to: usize| (y[10 + to] - y[10 + from]) / driving;
    for (from, to, gain) in [(20, 60, 0.015 + 0.02), (200, 600, 0.015 + 0.02), (2_000, 6_000, 0.02 + 0.025)] {
        let found = gained(from, to);
        assert!(0.2 * gain < found && found < 0.7 * gain, "{from} to {to} ticks: {found} of {driving} µm");
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
    for good in [PLAIN, MOVING, AHEAD, SATURATED, RINGING] {
        assert_eq!(good.check(), Ok(()));
    }
    let broken = [
        (GeneralisedPrandtlIshlinskiiParameters { span_v: Range { min: 1.0, max: f32::NAN }, ..PLAIN }, "span_v"),
        (GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 14.5, ..PLAIN }, "delay_ticks"),
        (GeneralisedPrandtlIshlinskiiParameters { slew_v_per_s: f32::INFINITY, ..PLAIN }, "slew"),
        (GeneralisedPrandtlIshlinskiiParameters { lag_s: -1.0, ..PLAIN }, "lag_s"),
        (GeneralisedPrandtlIshlinskiiParameters { damping: 0.1, ..PLAIN }, "resonance_hz"),
        (
            GeneralisedPrandtlIshlinskiiParameters { half_widths_v: List::of([0.0, 10.0, 20.0, 50.0]), ..PLAIN },
            "above 0",
        ),
        (
            GeneralisedPrandtlIshlinskiiParameters { half_widths_v: List::of([2.0, 10.0, 20.0, 51.0]), ..PLAIN },
            "half of",
        ),
        (GeneralisedPrandtlIshlinskiiParameters { weights: List::of([1.0, 2.0, 3.0]), ..PLAIN }, "as many"),
        (GeneralisedPrandtlIshlinskiiParameters { weights: List::of([1.0, -2.0, 3.0, 1.0]), ..PLAIN }, "weights"),
        (GeneralisedPrandtlIshlinskiiParameters { reversible_um_per_v: List::of([0.1]), ..PLAIN }, "two to nine"),
        (GeneralisedPrandtlIshlinskiiParameters { envelope_um_per_v: List::of([0.1, -0.1]), ..PLAIN }, "envelope"),
        (
            GeneralisedPrandtlIshlinskiiParameters { envelope_um_per_v: List::of([0.1; 13]), ..PLAIN },
            "as many for each",
        ),
        (GeneralisedPrandtlIshlinskiiParameters { envelope_um_per_v: List::of([0.1; 40]), ..PLAIN }, "two to nine"),
        (
            GeneralisedPrandtlIshlinskiiParameters {
                creep_times_s: List::of([0.0]),
                creep_gains: List::of([0.0]),
                ..PLAIN
            },
            "creep_times_s",
        ),
        (GeneralisedPrandtlIshlinskiiParameters { creep_gains: List::of([0.0]), ..PLAIN }, "as many"),
        (GeneralisedPrandtlIshlinskiiParameters { rest_memory: 1.1, ..PLAIN }, "rest_memory"),
        (GeneralisedPrandtlIshlinskiiParameters { offset_um: f32::NAN, ..PLAIN }, "offset"),
    ];
    for (parameters, rule) in broken {
        assert!(parameters.check().is_err_and(|broken| broken.contains(rule)), "{rule}: {:?}", parameters.check());
    }
    use Inadmissible::{Slow, Undamped};
    let reach = |parameters: &GeneralisedPrandtlIshlinskiiParameters| {
        GeneralisedPrandtlIshlinskii::<f32>::build(parameters, TICK as f32).reach(Range { min: 0.0, max: 100.0 })
    };
    let unsound = [
        (1e30, 0.05, Undamped),
        (1500.0, 0.05, Undamped),
        (300.0, 1e-9, Undamped),
        (1e-40, 0.05, Slow),
        (0.1, 0.95, Slow),
        (4.9, 0.5, Slow),
    ];
    for (resonance_hz, damping, why) in unsound {
        let unsound = GeneralisedPrandtlIshlinskiiParameters { resonance_hz, damping, ..PLAIN };
        assert_eq!(unsound.check(), Ok(()));
        assert_eq!(reach(&unsound), Err(why), "{resonance_hz} Hz, {damping}");
    }
    assert!(Inadmissible::<f32>::Slow.to_string().contains("creep_times_s"));
    assert!(reach(&RINGING).is_ok());
}
