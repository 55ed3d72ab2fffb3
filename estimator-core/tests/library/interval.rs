//! The interval beside the estimate.

use crate::common::interval as parameters;
use crate::common::models::table_of;
use estimator_core::interval::{Interval, IntervalState, LARGEST, PLAYS, PROTOTYPES, SPANS, TRIANGLE};
use estimator_core::{
    Admitted, DacCalibration, Estimator, IntervalParameters, Model, Range, Status, Table, TableError,
};

fn table(interval: IntervalParameters) -> Table {
    Table { interval: Some(interval), ..table_of(Model::GeneralisedPrandtlIshlinskii) }
}

fn admitted() -> Admitted {
    table(parameters()).admit().unwrap()
}

const RANGE: Range<f64> = Range { min: -10.0, max: 10.0 };

fn interval(parameters: IntervalParameters) -> Interval<f64> {
    Interval::build(&parameters, RANGE, 5e-4)
}

#[test]
fn there_is_none_before_a_displacement_is_told_or_too_soon() {
    let mut estimator = Estimator::<f32>::new(&admitted());
    assert!(!estimator.tell(), "before the first tick");
    for tick in 0..60 {
        assert_eq!(estimator.tick_volts(0.0).half_width, None, "tick {tick}");
        assert_eq!(estimator.tell(), tick >= 19, "tick {tick}: 10 ms are 20 ticks");
        if tick >= 19 {
            break;
        }
    }
    assert!(estimator.tick_volts(0.0).half_width.unwrap() >= 0.1);
    estimator.restart();
    assert_eq!(estimator.tick_volts(0.0).half_width, None);
    // At rest a start is known at once.
    estimator.start_at(0.0);
    assert!(!estimator.may_be_told() && !estimator.set_zero(1.0), "before the first tick");
    assert!(estimator.tick_volts(0.0).half_width.is_some());
}

/// A jump from end to end in one tick: by the rate alone, the half-width were fifty times the stroke.
#[test]
fn it_is_no_wider_than_the_limits() {
    let table = table(IntervalParameters { rate_ticks: 50.0, ..parameters() }).admit().unwrap();
    let mut estimator = Estimator::<f64>::new(&table);
    let Range { min, max } = table.voltage_range_v.of::<f64>();
    let zero = f64::from(table.voltage_zero_v);
    estimator.start_at(0.0);
    let widths = (0..200).map(|tick| estimator.tick_volts(zero + if tick % 100 < 50 { min } else { max }).half_width);
    let widest = widths.flatten().fold(0.0, f64::max);
    assert_eq!(widest, table.displacement_limits_um.of::<f64>().span());
}

/// A voltage that the model does not see leaves it as little known as a start does, beside what was open before.
#[test]
fn there_is_none_beyond_the_range_and_a_wider_one_until_swings_have_wiped_that_out() {
    let table = admitted();
    let mut estimator = Estimator::<f64>::new(&table);
    let Range { min, max } = table.voltage_range_v.of::<f64>();
    let zero = f64::from(table.voltage_zero_v);
    let ramp = |from: f64, to: f64| (1..=400).map(move |k| zero + from + (to - from) * f64::from(k) / 400.0);
    let over = |estimator: &mut Estimator<f64>, path: &mut dyn Iterator<Item = f64>| {
        path.map(|volts| estimator.tick_volts(volts).half_width).last().unwrap()
    };
    over(&mut estimator, &mut ramp(min, max).chain(ramp(max, min)));
    assert!(estimator.tell());
    let known = over(&mut estimator, &mut ramp(min, max)).unwrap();
    let beyond = over(&mut estimator, &mut ramp(max, max + 5.0));
    assert_eq!(beyond, None);
    let back = over(&mut estimator, &mut ramp(max + 5.0, max)).unwrap();
    let memory = f64::from(table.interval.unwrap().memory_um[0]);
    assert!(back > memory && memory > 0.0, "{back} of {memory}");
    let swept = over(&mut estimator, &mut ramp(max, min).chain(ramp(min, max))).unwrap();
    assert!((swept - known).abs() < 0.02 * memory, "{swept}, not {known}");
}

/// What was told in the middle of a start's memory is off by it for good.
#[test]
fn what_was_open_when_it_was_told_stays_so_after_a_voltage_beyond_the_range() {
    let of = interval(IntervalParameters {
        misfit_um: 0.0,
        rate_ticks: 0.0,
        spread_um: [0.0; TRIANGLE],
        drift_um: 0.0,
        ..parameters()
    });
    let mut state = of.begin(RANGE.middle(), 0.0);
    of.tell_at_rest(&mut state);
    let memory = f64::from(parameters().memory_um[0]);
    let after = |state: &mut IntervalState<f64>, voltage: f64| of.step(state, voltage, 0.0).half.unwrap();
    for voltage in [RANGE.min, RANGE.max] {
        after(&mut state, voltage);
    }
    for _ in 0..3 {
        state.mislead(RANGE.max);
        let half = after(&mut state, RANGE.max);
        assert!((half - 2.0 * memory).abs() < 1e-9 * memory, "{half}, not twice {memory}");
    }
    let half = [RANGE.min, RANGE.max].map(|voltage| after(&mut state, voltage))[1];
    assert!((half - memory).abs() < 1e-9 * memory, "{half}, not {memory}");
}

#[test]
fn a_table_without_an_interval_gives_none() {
    let mut estimator = Estimator::<f32>::new(&table_of(Model::GeneralisedPrandtlIshlinskii).admit().unwrap());
    estimator.start_at(0.0);
    assert_eq!(estimator.tick_volts(0.0).half_width, None);
    assert!(!estimator.tell());
}

/// Between two tellings the memory is what the sweep has wiped out of it.
#[test]
fn a_sweep_wipes_out_the_memory_of_the_start() {
    let of =
        interval(IntervalParameters { rate_ticks: 0.0, spread_um: [0.0; TRIANGLE], drift_um: 0.0, ..parameters() });
    let mut state = of.begin(0.0, 0.0);
    of.tell_at_rest(&mut state);
    let holds = |state: &mut IntervalState<f64>, voltage: f64, memory: f64, why: &str| {
        let half = of.step(state, voltage, 0.0).half.unwrap();
        assert!((half - memory.hypot(0.1)).abs() < 1e-7, "{half}: {why}");
    };
    holds(&mut state, 0.0, 0.0, "nothing is swept");
    holds(&mut state, 2.5, 1.0, "an eighth of 20 V");
    holds(&mut state, 1.25, 1.0, "it has swept as much as before");
    holds(&mut state, 10.0, 2.0, "half of 20 V");
    of.tell_at_rest(&mut state);
    holds(&mut state, -10.0, 0.0, "all was wiped out before");
}

/// An end of the range is come to from one side only, and from the middle of it both are as far.
#[test]
fn a_start_at_an_end_of_the_range_leaves_as_much_open_as_the_table_says() {
    for memory_at_ends in [0.0, 0.25] {
        let of = interval(IntervalParameters { memory_at_ends, ..parameters() });
        let swept = |start: f64| {
            let mut state = of.begin(start, 0.0);
            of.tell_at_rest(&mut state);
            for end in [-10.0, 10.0] {
                of.step(&mut state, end, 0.0);
            }
            of.parts(&state).unwrap().memory
        };
        let ends = f64::from(memory_at_ends);
        for (start, between) in [(-10.0, 0.0), (-5.0, 0.75), (0.0, 1.0), (5.0, 0.75), (10.0, 0.0), (11.0, 0.0)] {
            let expected = 2.0 * (ends + (1.0 - ends) * between);
            assert!((swept(start) - expected).abs() < 1e-12, "from {start} V: {}", swept(start));
        }
    }
}

#[test]
fn plays_elsewhere_fast_change_and_time_widen_it() {
    let still = IntervalParameters { memory_um: [0.0; SPANS], ..parameters() };
    let of = interval(still);
    let told = || {
        let mut state = of.begin(0.0, 0.0);
        of.step(&mut state, 0.0, 0.0);
        of.tell_at_rest(&mut state);
        state
    };
    let mut state = told();
    let here = of.step(&mut state, 0.0, 0.0);
    assert!(!here.untrained);
    assert!(of.step(&mut state, 10.0, 0.0).untrained, "every play but the widest has moved");
    let parts = of.parts(&state).unwrap();
    // Half-widths 0.04 … 0.9 of half the range: the plays stand at 10 V less that; 0.2 µm for each half range.
    let expected: f64 = [0.96f64, 0.925, 0.86, 0.74, 0.52, 0.1].iter().map(|at| (0.2 * at).powi(2)).sum();
    assert!((parts.moved - expected.sqrt()).abs() < 1e-7, "{parts:?}");
    let mut state = told();
    of.step(&mut state, 0.0, 0.5);
    assert_eq!(of.parts(&state).unwrap().rate, 0.5);
    for _ in 0..10 {
        of.step(&mut state, 0.0, 0.5);
    }
    assert!((of.parts(&state).unwrap().rate - 0.5 * libm::exp(-1.0)).abs() < 1e-6, "5 ms later");
}

/// A way through places where the training has been costs only what lies beside them.
#[test]
fn prototypes_are_places_that_cost_nothing() {
    let mut prototypes = [[0; PLAYS]; PROTOTYPES];
    // Where the plays stand at 10 V, in hundredths of a µm.
    prototypes[7] = [19, 18, 17, 15, 10, 2];
    let of = interval(IntervalParameters { prototypes, memory_um: [0.0; SPANS], ..parameters() });
    let mut state = of.begin(0.0, 0.0);
    of.tell_at_rest(&mut state);
    assert!(!of.step(&mut state, 10.0, 0.0).untrained);
    let there = of.parts(&state).unwrap().moved;
    let off = [
        0.2 * 0.96 - 0.19,
        0.2 * 0.925 - 0.18,
        0.2 * 0.86 - 0.17,
        0.2 * 0.74 - 0.15,
        0.2 * 0.52 - 0.1,
        0.2 * 0.1 - 0.02,
    ];
    let expected = off.iter().map(|off: &f64| off * off).sum::<f64>().sqrt();
    assert!((there - expected).abs() < 1e-6, "{there}, {expected}");
    // Told there, the way back costs the same.
    of.tell_at_rest(&mut state);
    for _ in 0..2 {
        of.step(&mut state, -10.0, 0.0);
        of.step(&mut state, 10.0, 0.0);
    }
    let back = of.parts(&state).unwrap().moved;
    assert!(back < 1e-6, "{back}: it is where it was told");
}

#[test]
fn displacement_gone_since_it_was_told_widens_it() {
    let of = interval(IntervalParameters { gain: 0.02, ..parameters() });
    let mut state = of.begin(0.0, 3.0);
    of.step(&mut state, 0.0, 3.0);
    of.tell_at_rest(&mut state);
    for (estimate, gone) in [(3.0, 0.0), (8.0, 5.0), (1.0, 2.0)] {
        of.step(&mut state, 0.0, estimate);
        let parts = of.parts(&state).unwrap();
        assert!((parts.gain - 0.02 * gone).abs() < 1e-7, "{parts:?}");
    }
}

/// From 1 s to 100 s after the start the drift is two decades, to the clock's steps of 1.6 %.
#[test]
fn age_counts_decades_since_it_was_told() {
    let of = interval(IntervalParameters { drift_um: 1.0, ..parameters() });
    let mut state = of.begin(0.0, 0.0);
    for _ in 0..1_900 {
        of.step(&mut state, 0.0, 0.0);
    }
    of.tell_at_rest(&mut state);
    for _ in 0..198_000 {
        of.step(&mut state, 0.0, 0.0);
    }
    let drift = of.parts(&state).unwrap().drift;
    assert!((drift - 2.0).abs() < 0.02, "{drift}");
}

/// The target's precision, over minutes of ticks with a wild voltage: never anything but a positive number, and none
/// beyond the range.
#[test]
fn it_is_a_positive_number_whatever_happens() {
    let mut single = Estimator::<f32>::new(&admitted());
    let mut double = Estimator::<f64>::new(&admitted());
    single.start_at(0.0);
    double.start_at(0.0);
    let (mut noise, mut none) = (1u32, 0);
    for tick in 0..200_000 {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let volts = match tick % 5_000 {
            4_000 => f32::NAN,
            4_001 => f32::INFINITY,
            _ => (noise >> 16) as f32 / 1000.0 - 30.0,
        };
        let (here, there) = (single.tick_volts(volts), double.tick_volts(volts.into()));
        assert_eq!(here.status.contains(Status::UNTRAINED), there.status.contains(Status::UNTRAINED));
        let (Some(half), Some(reference)) = (here.half_width, there.half_width) else {
            assert_eq!(here.half_width.is_some(), there.half_width.is_some(), "tick {tick}");
            assert!(here.status.contains(Status::VOLTAGE_OUT_OF_RANGE), "tick {tick}: {:?}", here.status);
            none += 1;
            continue;
        };
        assert!(half.is_finite() && half >= 0.1, "tick {tick}: {half}");
        assert!((f64::from(half) - reference).abs() < 2e-3 * reference, "tick {tick}: {half}, {reference}");
    }
    assert!((1..100_000).contains(&none), "{none} without");
}

#[test]
fn numbers_that_are_none_are_refused() {
    let refused = |change: fn(&mut IntervalParameters)| {
        let mut wrong = parameters();
        change(&mut wrong);
        assert!(matches!(table(wrong).admit(), Err(TableError::OutOfRange { .. })), "{wrong:?}");
    };
    refused(|p| p.misfit_um = 0.0);
    refused(|p| p.misfit_um = f32::NAN);
    refused(|p| p.memory_um[8] = -1.0);
    refused(|p| p.memory_at_ends = 1.1);
    refused(|p| p.spread_um[3] = f32::INFINITY);
    refused(|p| p.prototype_um = f32::NAN);
    refused(|p| p.untrained_um = -0.1);
    refused(|p| p.gain = -0.1);
    refused(|p| p.earliest_s = f32::NAN);
}

/// Their squares would be infinite, and two infinities no number.
#[test]
fn numbers_so_large_that_the_half_width_would_overflow_are_refused() {
    let of = |largest: f32| IntervalParameters {
        memory_um: [0.0, largest, 0.0, largest, 0.0, largest, 0.0, largest, 0.0],
        memory_at_ends: 1.0,
        misfit_um: largest,
        rate_ticks: largest,
        spread_um: [-largest; TRIANGLE],
        prototypes: [[i8::MAX; PLAYS]; PROTOTYPES],
        prototype_um: largest,
        untrained_um: largest,
        gain: largest,
        drift_um: largest,
        earliest_s: 0.0,
    };
    let limits = Range { min: -LARGEST, max: LARGEST };
    let widest = Table { displacement_limits_um: limits, ..table(of(LARGEST)) };
    let dac = DacCalibration { gain_codes_per_um: 1e-3, ..widest.dac };
    let mut estimator = Estimator::<f32>::new(&Table { dac, drive: None, ..widest }.admit().unwrap());
    estimator.start_at(-LARGEST);
    for volts in [-20.0, 80.0, -20.0, 30.0, 80.0] {
        let half = estimator.tick_volts(volts).half_width.unwrap();
        assert!(half.is_finite() && half >= LARGEST, "{half}");
    }
    let error = table(of(1.01 * LARGEST)).admit().unwrap_err().to_string();
    assert!(error.contains("beyond a million"), "{error}");
}
