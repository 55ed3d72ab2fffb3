//! Properties of the Maxwell-slip model and of its exact inverse.

use crate::laws;
use estimator_core::model::{MaxwellSlip, MaxwellSlipParameters, Published, Recursion, Stop};
use estimator_core::{List, Range, Real};
use proptest::prelude::*;

/// Yield displacements 0.25, 0.5, 2, 4 µm.
const PARAMETERS: MaxwellSlipParameters = MaxwellSlipParameters {
    lag_s: 0.0,
    stiffness_v_per_um: List::of([4.0, 3.0, 2.0, 1.0]),
    saturation_v: List::of([1.0, 1.5, 4.0, 4.0]),
    base_stiffness_v_per_um: 5.0,
    offset_v: 2.0,
};

const RANGE: Range<f64> = Range { min: -20.0, max: 80.0 };

fn model<T: Real>() -> MaxwellSlip<T> {
    MaxwellSlip::build(&PARAMETERS)
}

fn run<T: Real>(voltages: &[T]) -> Vec<T> {
    let model = model();
    let mut state = model.begin(voltages[0], None);
    voltages.iter().map(|&voltage| model.step(&mut state, voltage)).collect()
}

fn voltages() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(RANGE.min..RANGE.max, 2..60)
}

/// Voltage over the offset of the virgin curve at this displacement, straight from Eq. (3.10).
fn virgin_voltage(displacement: f64) -> f64 {
    let elements = PARAMETERS.stiffness_v_per_um.iter().zip(PARAMETERS.saturation_v.iter());
    let slips = elements.map(|(&k, &w)| (f64::from(k) * displacement).clamp(-f64::from(w), f64::from(w)));
    5.0 * displacement + slips.sum::<f64>()
}

#[test]
fn first_rise_follows_the_virgin_curve() {
    for displacement in [0.0, 0.1, 0.25, 0.4, 0.5, 1.0, 2.0, 3.0, 4.0, 10.0, -0.1, -3.0, -10.0] {
        let found = *run(&[2.0, 2.0 + virgin_voltage(displacement)]).last().unwrap();
        assert!((found - displacement).abs() < 1e-12, "{found} for {displacement}");
    }
}

/// Masing: the branch from a reversal is the virgin curve at twice its size, ΔV = 2·V_virgin(Δy/2).
#[test]
fn branches_are_the_virgin_curve_doubled() {
    let top = virgin_voltage(10.0) + 2.0;
    for displacement in [0.1, 0.3, 0.8, 1.5, 3.0, 5.0, 9.0] {
        let branch = 2.0 * virgin_voltage(displacement / 2.0);
        let down = run(&[2.0, top, top - branch]);
        assert!((down[1] - down[2] - displacement).abs() < 1e-12, "down {displacement}");
        let bottom = 2.0 - virgin_voltage(10.0);
        let up = run(&[2.0, top, bottom, bottom + branch]);
        assert!((up[3] - up[2] - displacement).abs() < 1e-12, "up {displacement}");
    }
}

/// With the misprinted `<` an element that has reached its saturation would stretch on.
#[test]
fn an_element_slips_from_its_saturation_on() {
    let mut stop = Stop::new(0.25, 0.0);
    assert_eq!([0.125, 0.25, 0.3125, 7.0].map(|y| stop.step(y)), [0.125, 0.25, 0.25, 0.25]);
    assert_eq!(stop.block(), 6.75);
    assert_eq!([6.75, 6.5, 6.25].map(|y| stop.step(y)), [0.0, -0.25, -0.25]);
    let model = model::<f64>();
    let mut state = model.begin(2.0, None);
    let saturated = model.voltage(&mut state, 4.0);
    assert!((model.voltage(&mut state, 5.0) - saturated - 5.0).abs() < 1e-12, "only the spring goes on");
}

#[test]
fn loops_run_counter_clockwise_and_their_area_is_the_loss() {
    let period: Vec<f64> =
        (0..=4000).map(|i| 30.0 + 40.0 * (f64::from(i) * std::f64::consts::TAU / 2000.0).sin()).collect();
    let displacements = run(&period);
    let (v, y) = (&period[2000..], &displacements[2000..]);
    // ∮ V dy over the second, closed, period: the work that the blocks take up, Σ W·(travel there and back).
    let loss: f64 = (1..v.len()).map(|i| 0.5 * (v[i] + v[i - 1]) * (y[i] - y[i - 1])).sum();
    let travel = y.iter().copied().fold(f64::MIN, f64::max) - y.iter().copied().fold(f64::MAX, f64::min);
    let elements = PARAMETERS.stiffness_v_per_um.iter().zip(PARAMETERS.saturation_v.iter());
    let expected: f64 = elements.map(|(&k, &w)| 2.0 * f64::from(w) * (travel - 2.0 * f64::from(w / k))).sum();
    assert!(loss > 0.0 && (loss / expected - 1.0).abs() < 1e-3, "{loss} against {expected}");
    // Displacement lags: less on the way up than on the way down.
    let up = run(&[2.0, RANGE.min, RANGE.max, RANGE.min, 30.0]);
    let down = run(&[2.0, RANGE.min, RANGE.max, 30.0]);
    assert!(up[4] < down[3] - 0.5);
}

#[test]
fn a_known_displacement_is_begun_with_and_one_out_of_reach_comes_nearest() {
    let model = model::<f64>();
    let at = |displacement| model.step(&mut model.begin(30.0, Some(displacement)), 30.0);
    // The elements hold ±10.5 V.
    let (least, most) = ((28.0 - 10.5) / 5.0, (28.0 + 10.5) / 5.0);
    for (wanted, expected) in [(5.0, 5.0), (3.51, 3.51), (7.69, 7.69), (0.0, least), (99.0, most), (-1e9, least)] {
        assert!((at(wanted) - expected).abs() < 1e-12, "{wanted}");
    }
    assert!(at(f64::NAN).is_finite());
}

#[test]
fn every_rule_has_its_fault() {
    assert_eq!(PARAMETERS.check(), Ok(()));
    let none = List::of([]);
    let spring = MaxwellSlipParameters { stiffness_v_per_um: none, saturation_v: none, ..PARAMETERS };
    assert_eq!(spring.check(), Ok(()), "a spring alone is a model");
    let broken = [
        (MaxwellSlipParameters { lag_s: -1.1, ..PARAMETERS }, "lag_s"),
        (MaxwellSlipParameters { saturation_v: List::of([1.0]), ..PARAMETERS }, "as many"),
        (MaxwellSlipParameters { offset_v: f32::INFINITY, ..PARAMETERS }, "finite"),
        (MaxwellSlipParameters { stiffness_v_per_um: List::of([4.0, 0.0, 2.0, 1.0]), ..PARAMETERS }, "positive"),
        (MaxwellSlipParameters { saturation_v: List::of([1.0, -1.5, 4.0, 4.0]), ..PARAMETERS }, "positive"),
        (MaxwellSlipParameters { base_stiffness_v_per_um: 0.0, ..PARAMETERS }, "base_stiffness_v_per_um"),
        (MaxwellSlipParameters { saturation_v: List::of([1.0, 0.5, 4.0, 4.0]), ..PARAMETERS }, "increase"),
    ];
    for (parameters, part) in broken {
        assert!(parameters.check().is_err_and(|rule| rule.contains(part)), "{part}: {:?}", parameters.check());
        let model = MaxwellSlip::<f32>::build(&parameters);
        model.step(&mut model.begin(0.0, Some(1.0)), 10.0);
    }
}

#[test]
fn survives_the_wire() {
    laws::survives_the_wire(PARAMETERS);
}

proptest! {
    #[test]
    fn the_inverse_is_exact(voltages in voltages(), known in prop::option::of(-10.0f64..20.0)) {
        fn worst<T: Real>(voltages: impl Iterator<Item = T> + Clone, known: Option<T>) -> T {
            let model = model::<T>();
            let mut state = model.begin(voltages.clone().next().unwrap(), known);
            let mut other = state;
            voltages.fold(T::zero(), |worst, voltage| {
                let displacement = model.step(&mut state, voltage);
                worst.max((model.voltage(&mut other, displacement) - voltage).abs())
            })
        }
        prop_assert!(worst(voltages.iter().copied(), known) < 1e-11);
        // In f32: 1e-4 V of a range of 100 V.
        prop_assert!(worst(voltages.iter().map(|&v| v as f32), known.map(|y| y as f32)) < 1e-4);
    }

    #[test]
    fn rate_independent(voltages in voltages(), between in 1u32..9) {
        let (fast, slow) = laws::at_two_rates(run, &voltages, between);
        for (fast, slow) in fast.into_iter().zip(slow) {
            prop_assert!((fast - slow).abs() < 1e-12);
        }
    }

    #[test]
    fn stays_within_reach_and_increases(voltages in voltages(), known in prop::option::of(-30.0f64..40.0)) {
        let model = model::<f32>();
        let reach = model.reach(Range { min: RANGE.min as f32, max: RANGE.max as f32 });
        let mut state = model.begin(voltages[0] as f32, known.map(|known| known as f32));
        let mut last = (voltages[0] as f32, model.step(&mut state, voltages[0] as f32));
        for &voltage in &voltages {
            let now = (voltage as f32, model.step(&mut state, voltage as f32));
            prop_assert!(reach.contains(now.1), "{} not in {:?}", now.1, reach);
            prop_assert!((now.0 - last.0).abs() < 1e-3 || (now.0 > last.0) == (now.1 > last.1));
            last = now;
        }
    }

    /// A history of thousands of reversals leaves no drift behind in single precision.
    #[test]
    fn nothing_builds_up(seed in 0u32..1000) {
        let model = model::<f32>();
        let mut state = model.begin(2.0, None);
        let mut noise = seed;
        for _ in 0..4000 {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            model.step(&mut state, 40.0 + (noise >> 8) as f32 * 1e-6);
        }
        model.step(&mut state, 80.0);
        let settled = model.step(&mut state, 10.0);
        let mut fresh = model.begin(2.0, None);
        model.step(&mut fresh, 80.0);
        prop_assert!((settled - model.step(&mut fresh, 10.0)).abs() < 2e-6);
    }

    /// The voltage is the stops' stretches weighed by the stiffnesses, the displacement and 1: the host's columns.
    #[test]
    fn the_stops_are_the_columns(displacements in prop::collection::vec(-10.0f64..10.0, 1..60)) {
        let model = model::<f64>();
        let mut state = model.begin(2.0, Some(0.0));
        let mut stops = [0.25, 0.5, 2.0, 4.0].map(|yields| Stop::new(yields, 0.0));
        for y in displacements {
            let elements = stops.iter_mut().zip(PARAMETERS.stiffness_v_per_um.iter());
            let sum: f64 = elements.map(|(stop, &k)| f64::from(k) * stop.step(y)).sum();
            prop_assert!((model.voltage(&mut state, y) - (2.0 + 5.0 * y + sum)).abs() < 1e-12);
        }
    }
}
