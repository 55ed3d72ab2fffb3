//! The Kelvin-Voigt chain: Eq. (3.20), its bound, its inverse and its resolution.

use crate::laws;
use estimator_core::*;
use proptest::prelude::*;

const PERIOD: f64 = 5e-4;

fn parameters() -> VoigtChainParameters {
    VoigtChainParameters {
        offset_um: -1.5,
        instantaneous_um_per_v: 0.2,
        gains_um_per_v: List::of([0.004, 0.003, 0.005]),
        times_s: List::of([0.01, 0.3, 8.0]),
        memory_v: Range { min: -20.0, max: 120.0 },
        voltage_extremum_um_per_v: 0.0,
        deadband_v: 0.1,
    }
}

/// Twenty elements with times from 1 ms to 100 s.
fn long() -> VoigtChainParameters {
    let times = (0..20).map(|i| 10f32.powf(-3.0 + 5.0 * i as f32 / 19.0));
    VoigtChainParameters {
        gains_um_per_v: List::collect((0..20).map(|i| 0.002 + 0.0001 * i as f32)).unwrap(),
        times_s: List::collect(times).unwrap(),
        ..parameters()
    }
}

#[test]
fn a_step_is_equation_3_20() {
    let p = parameters();
    let chain = VoigtChain::<f64>::build(&p, PERIOD);
    let mut state = chain.begin(10.0, None);
    for k in 1..40_000 {
        let found = chain.step(&mut state, 60.0);
        let creep = |(gain, time): (&f32, &f32)| {
            f64::from(*gain) * (10.0 + 50.0 * (1.0 - (-f64::from(k) * PERIOD / f64::from(*time)).exp()))
        };
        let elements: f64 = p.gains_um_per_v.iter().zip(p.times_s.iter()).map(creep).sum();
        let expected = f64::from(p.offset_um) + f64::from(p.instantaneous_um_per_v) * 60.0 + elements;
        assert!((found - expected).abs() < 1e-10, "{k}: {found} {expected}");
    }
}

#[test]
fn a_rest_is_the_static_gain() {
    let chain = VoigtChain::<f32>::build(&parameters(), PERIOD as f32);
    let mut state = chain.begin(-20.0, None);
    let mut last = 0.0;
    for _ in 0..400_000 {
        last = chain.step(&mut state, 100.0);
    }
    assert!((last - (-1.5 + 100.0 * chain.static_gain())).abs() < 1e-5, "{last}");
    assert!((chain.static_gain() - 0.212).abs() < 1e-7);
}

/// What the module's documentation states, and that a plain sum does not keep it.
#[test]
fn single_precision_stays_within_the_stated_bound() {
    let p = long();
    let (single, double) = (VoigtChain::<f32>::build(&p, PERIOD as f32), VoigtChain::<f64>::build(&p, PERIOD));
    let gains = p.gains_um_per_v.iter().sum::<f32>() + p.instantaneous_um_per_v;
    let bound = (20.0 + 16.0) * 2f64.powi(-24) * f64::from(p.offset_um.abs() + gains * 120.0);
    let signals: [fn(f64) -> f64; 3] =
        [|_| 101.0, |t| 50.0 + 70.0 * (6.0 * t).sin(), |t| if (t as u32) % 7 < 3 { 120.0 } else { 119.99 }];
    for signal in signals {
        let (mut a, mut b) = (single.begin(100.0, None), double.begin(100.0, None));
        let mut worst = 0.0f64;
        for k in 0..200_000 {
            let voltage = signal(f64::from(k) * PERIOD) as f32;
            let error = f64::from(single.step(&mut a, voltage)) - double.step(&mut b, voltage.into());
            worst = worst.max(error.abs());
        }
        assert!(worst < bound, "{worst} beyond {bound}");
    }

    let fraction = -(-PERIOD as f32 / 100.0).exp_m1();
    assert_eq!(100.0f32 + (100.7 - 100.0) * fraction, 100.0, "a plain sum would stand still");
}

#[test]
fn a_known_displacement_is_creep_of_the_slowest_elements() {
    let chain = VoigtChain::<f64>::build(&parameters(), PERIOD);
    let rested = -1.5 + 50.0 * chain.static_gain();
    let voltages = |displacement: f64| laws::columns(&chain, &chain.begin(50.0, Some(displacement)));
    let found = voltages(rested + 0.1);
    assert!(
        (found[3] - 70.0).abs() < 1e-4 && (found[2] - 50.0).abs() < 1e-9 && (found[1] - 50.0).abs() < 1e-9,
        "{found:?}"
    );
    let found = voltages(rested + 0.35 + 0.03);
    assert!(found[3] == 120.0 && (found[2] - 60.0).abs() < 1e-4 && (found[1] - 50.0).abs() < 1e-9, "{found:?}");
    assert_eq!(voltages(1e6), [50.0, 120.0, 120.0, 120.0, 0.0, 1.0]);
    let mut state = chain.begin(50.0, Some(rested + 0.2));
    assert!((chain.step(&mut state, 50.0) - rested - 0.2).abs() < 2e-5);
}

/// From the first reversal on, and only then, the loop's two sides differ by g times the voltage between the turning
/// points.
#[test]
fn the_extremum_term_opens_a_slow_loop() {
    let p = VoigtChainParameters { voltage_extremum_um_per_v: -0.01, ..parameters() };
    let plain = VoigtChain::<f64>::build(&parameters(), PERIOD);
    let chain = VoigtChain::<f64>::build(&p, PERIOD);
    let (mut state, mut linear) = (chain.begin(0.0, None), plain.begin(0.0, None));
    // 0 → 100 → 20 → 100 V at 0.2 V a tick: 400 ticks and more each, against a lag of 20.
    let ramp = (0..=500).map(|k| 0.2 * f64::from(k)).chain((100..500).rev().map(|k| 0.2 * f64::from(k)));
    let ramp: Vec<f64> = ramp.chain((101..=500).map(|k| 0.2 * f64::from(k))).collect();
    let middle = [300, 500 + 250, 900 + 250];
    for (k, &voltage) in ramp.iter().enumerate() {
        let term = chain.step(&mut state, voltage) - plain.step(&mut linear, voltage);
        if let Some(index) = middle.iter().position(|&at| at == k) {
            let expected = [0.0, -0.01 * 100.0, -0.01 * 20.0][index];
            assert!((term - expected).abs() < 1e-4, "{k}: {term} {expected}");
        }
    }
}

#[test]
fn what_breaks_a_rule_is_refused_and_still_builds() {
    let good = parameters();
    assert_eq!((good.check(), long().check()), (Ok(()), Ok(())));
    let bad = [
        VoigtChainParameters { offset_um: f32::NAN, ..good },
        VoigtChainParameters { gains_um_per_v: List::of([]), times_s: List::of([]), ..good },
        VoigtChainParameters { times_s: List::of([1.0]), ..good },
        VoigtChainParameters { times_s: List::of([0.0, 1.0, 2.0]), ..good },
        VoigtChainParameters { times_s: List::of([1.0, 1.0, 2.0]), ..good },
        VoigtChainParameters { times_s: List::of([1.0, 2.0, f32::INFINITY]), ..good },
        VoigtChainParameters { times_s: List::of([1.0, f32::NAN, 2.0]), ..good },
        VoigtChainParameters { gains_um_per_v: List::of([1.0, -1.0, 1.0]), ..good },
        VoigtChainParameters { instantaneous_um_per_v: -0.1, ..good },
        VoigtChainParameters { memory_v: Range { min: 1.0, max: 0.0 }, ..good },
        VoigtChainParameters { voltage_extremum_um_per_v: f32::INFINITY, ..good },
        VoigtChainParameters { deadband_v: -0.1, ..good },
        VoigtChainParameters { deadband_v: f32::NAN, ..good },
    ];
    for bad in bad {
        assert!(bad.check().is_err(), "{bad:?}");
        let chain = VoigtChain::<f32>::build(&bad, PERIOD as f32);
        let mut state = chain.begin(1.0, Some(2.0));
        chain.step(&mut state, 3.0);
    }
}

#[test]
fn survives_the_wire() {
    laws::survives_the_wire(parameters());
}

prop_compose! {
    fn any_set()(
        offset_um in -50f32..50.0,
        instantaneous_um_per_v in 0f32..0.5,
        elements in prop::collection::vec((0f32..0.1, 1e-4f32..50.0), 1..=20),
        memory in (-150f32..150.0, 0f32..100.0),
        extremum in prop_oneof![Just(0f32), -0.05f32..0.05],
    ) -> VoigtChainParameters {
        let mut time = 0.0;
        VoigtChainParameters {
            offset_um,
            instantaneous_um_per_v: instantaneous_um_per_v + 1e-3,
            gains_um_per_v: List::collect(elements.iter().map(|e| e.0)).unwrap(),
            times_s: List::collect(elements.iter().map(|e| { time += e.1; time })).unwrap(),
            memory_v: Range { min: memory.0, max: memory.0 + memory.1 },
            voltage_extremum_um_per_v: extremum,
            deadband_v: 0.1,
        }
    }
}

proptest! {
    #[test]
    fn never_leaves_its_reach(
        p in any_set(),
        start in prop::option::of(-200f32..200.0),
        voltages in prop::collection::vec((-20f32..120.0, 1usize..50), 1..60),
    ) {
        prop_assert_eq!(p.check(), Ok(()));
        let chain = VoigtChain::<f32>::build(&p, PERIOD as f32);
        let reach = chain.reach(Range { min: -20.0, max: 120.0 });
        let slack = 1e-5 * (1.0 + reach.min.abs() + reach.max.abs() + p.offset_um.abs());
        let voltages = voltages.into_iter().flat_map(|(voltage, ticks)| std::iter::repeat_n(voltage, ticks));
        laws::stays_within(reach, slack, &chain, voltages, start)?;
    }

    /// The inverse gives back the voltages that a displacement came from.
    #[test]
    fn the_inverse_is_one(p in any_set(), voltages in prop::collection::vec(-20f64..120.0, 1..9)) {
        // A tick that reveals a reversal is the exception that an extremum term makes; within this deadband there is
        // none.
        let p = VoigtChainParameters { deadband_v: 200.0, ..p };
        let discretisation = Discretisation { sample_period: PERIOD, scheme: Scheme::ForwardEuler, deadband: 0.0 };
        let engine = Parameters::VoigtChain(p).build(&discretisation);
        let context = InverseContext { voltage_zero: 0.0, sample_period: PERIOD, displacement_span: 1e-4 };
        let range_v = Range { min: -20.0, max: 120.0 };
        let limits = DriveLimits { range_v, rest_v: 0.0, slew_v_per_s: 1e6 };
        let mut inverse = Inverse::build(&engine, &context, &limits).unwrap();
        let chain = VoigtChain::<f64>::build(&p, PERIOD);
        let mut state = chain.begin(0.0, None);
        chain.step(&mut state, 0.0);
        for voltage in voltages {
            let found = inverse.tick(chain.step(&mut state, voltage)).voltage;
            prop_assert!((found - voltage).abs() < 1e-6, "{found} instead of {voltage}");
        }
        prop_assert!((inverse.tick(1e9).voltage - 120.0).abs() < 1e-9);
    }

    #[test]
    fn the_columns_weigh_to_the_displacement(p in any_set(), voltages in prop::collection::vec(-20f64..120.0, 1..9)) {
        let chain = VoigtChain::<f64>::build(&p, PERIOD);
        let weights: Vec<f64> = [p.instantaneous_um_per_v].iter().chain(p.gains_um_per_v.iter())
            .chain(&[p.voltage_extremum_um_per_v, p.offset_um])
            .map(|&w| w.into()).collect();
        laws::columns_weigh_to_the_displacement(&chain, &weights, voltages[0], voltages.iter().copied(), 1e-9)?;
    }
}
