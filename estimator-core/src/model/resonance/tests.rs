//! Step response, gain and rounding of the resonance.

use super::*;

/// How near an `f32` comes to its worst, and to the `f64`, as parts of the reach; with the feature `micromath` its exp
/// and ln make other coefficients.
const NEAR: [f64; 2] = if cfg!(feature = "micromath") { [2e-2, 2e-3] } else { [5e-3, 2e-6] };
const TICK: f64 = 5e-4;

#[test]
fn a_step_response_is_the_closed_form() {
    let (f, z) = (340.0, 0.03);
    let resonance = Resonance::build(f, z, TICK);
    let mut state = ResonanceState::rest(0.0);
    // The input steps between the ticks; the answer to a straight rise within the first tick comes as two ramps.
    let omega = 2.0 * core::f64::consts::PI * f;
    let damped = omega * (1.0 - z * z).sqrt();
    let ramp = |t: f64| {
        if t <= 0.0 {
            return 0.0;
        }
        let free = (-z * omega * t).exp()
            * (2.0 * z / omega * (damped * t).cos() + (2.0 * z * z - 1.0) / damped * (damped * t).sin());
        t - 2.0 * z / omega + free
    };
    for k in 1..400 {
        let t = f64::from(k) * TICK;
        let exact = (ramp(t) - ramp(t - TICK)) / TICK;
        let found = resonance.step(&mut state, 1.0);
        assert!((found - exact).abs() < 1e-6, "tick {k}: {found} {exact}");
    }
}

/// Answers to a hat, one after the other, until nothing of them is left.
fn hats<T: Real>(resonance: &Resonance<T>, ticks: usize) -> Vec<T> {
    let mut state = ResonanceState::rest(T::zero());
    let mut hat = core::iter::once(T::one());
    (0..ticks).map(|_| resonance.step(&mut state, hat.next().unwrap_or(T::zero()))).collect()
}

#[test]
fn the_gain_is_at_least_the_sum_of_its_answers_and_little_more_where_a_swing_has_many_ticks() {
    for z in [0.003, 0.02, 0.1, 0.33, 0.7, 0.95] {
        for f in [5.0, 18.0, 100.0, 340.0, 700.0, 990.0] {
            if z * f < 0.04 {
                continue;
            }
            let resonance = Resonance::build(f, z, TICK);
            let sum: f64 = hats(&resonance, 200_000).iter().map(|h| h.abs()).sum();
            assert!(sum <= resonance.gain() * (1.0 + 1e-9), "{f} Hz, {z}: {sum} above {}", resonance.gain());
            // The hat itself takes away what is near half the tick rate.
            let least = if f <= 100.0 { 0.95 } else { 0.3 };
            assert!(sum >= least * resonance.gain(), "{f} Hz, {z}: {sum} far below {}", resonance.gain());
        }
    }
}

/// The worst input there is, the signs of the answers backwards, in an `f32`.
#[test]
fn the_worst_input_stays_within_reach_in_single_precision_and_comes_close() {
    let input = Range { min: -4.0f32, max: 16.0 };
    for (f, z) in [(5.0, 0.01), (5.0, 0.95), (18.0, 0.0025), (100.0, 0.02), (340.0, 0.003), (340.0, 0.3), (900.0, 0.05)]
    {
        let resonance = Resonance::build(f, z, TICK as f32);
        let reach = resonance.reach(input).unwrap();
        let answers = hats(&resonance, 40_000);
        let mut state = ResonanceState::rest(input.middle());
        let drive = |h: &f32| if *h > 0.0 { input.max } else { input.min };
        let found = Range::of_values(answers.iter().rev().map(drive).map(|w| resonance.step(&mut state, w)));
        assert!(reach.hull(found) == reach, "{f} Hz, {z}: {found:?} beyond {reach:?}");
        let sum: f64 = hats(&Resonance::build(f.into(), z.into(), TICK), 40_000).iter().map(|h| h.abs()).sum();
        let most = f64::from(input.middle()) + f64::from(input.span()) / 2.0 * sum;
        assert!((f64::from(found.max) - most).abs() < NEAR[0] * most, "{f} Hz, {z}: {} of {most}", found.max);
    }
}

/// What swings from end to end at every tick, and sawtooths, whose mean it must keep: a velocity that is off
/// would pile up.
#[test]
fn an_f32_keeps_the_mean_of_a_fast_input_down_to_the_slowest_resonance() {
    let input = Range { min: -4.0f32, max: 16.0 };
    for (f, z) in [5.0, 10.0, 40.0, 300.0].into_iter().flat_map(|f| [0.3, 0.7, 0.9, 0.95].map(|z| (f, z))) {
        let single = Resonance::build(f, z, TICK as f32);
        let double = Resonance::<f64>::build(f.into(), z.into(), TICK);
        let reach = single.reach(input).unwrap();
        for teeth in [2u16, 3, 7, 37, 400] {
            let mut states = (ResonanceState::rest(6.0f32), ResonanceState::rest(6.0f64));
            for tick in 0..60_000u32 {
                let part = (tick % u32::from(teeth)) as f32 / f32::from(teeth - 1);
                let w = input.min + input.span() * part;
                let (one, other) = (single.step(&mut states.0, w), double.step(&mut states.1, w.into()));
                assert!(reach.contains(one), "{f} Hz, {z}, {teeth} teeth: {one} beyond {reach:?}");
                let apart = (f64::from(one) - other).abs();
                assert!(apart <= NEAR[1] * f64::from(reach.span()), "{f} Hz, {z}, {teeth} teeth: {apart} µm apart");
            }
        }
    }
}

#[test]
fn what_an_f32_cannot_damp_has_no_reach() {
    let at = |f, z| Resonance::build(f, z, TICK as f32).reach(Range { min: 0.0, max: 1.0 });
    for (f, z) in [(340.0, 1e-6), (1e30, 0.05), (1500.0, 0.05), (340.0, f32::NAN), (f32::NAN, 0.05), (5.0, 0.005)] {
        assert_eq!(at(f, z), Err(Inadmissible::Undamped), "{f} Hz, {z}");
    }
    for (f, z) in [(1e-40, 0.05), (0.1, 0.95), (0.2, 0.9), (4.9, 0.5)] {
        assert_eq!(at(f, z), Err(Inadmissible::Slow), "{f} Hz, {z}");
    }
    assert!(at(340.0, 0.003).is_ok() && at(5.0, 0.5).is_ok());
}

#[test]
fn sine_and_cosine_are_the_library_s() {
    for k in 0..=1000 {
        let angle = core::f64::consts::PI * f64::from(k) / 1000.0;
        let (sin, cos) = sin_cos(angle);
        assert!((sin - angle.sin()).abs() < 1e-13 && (cos - angle.cos()).abs() < 1e-13, "{angle}");
        let (sin, cos) = sin_cos(angle as f32);
        let (sin, cos) = (f64::from(sin), f64::from(cos));
        assert!((sin - angle.sin()).abs() < 1e-6 && (cos - angle.cos()).abs() < 1e-6, "{angle}");
    }
}

#[test]
fn it_settles_at_its_input_and_f32_follows() {
    let resonance = Resonance::build(100.0f32, 0.05, 5e-4);
    let mut state = ResonanceState::rest(-3.0);
    let last = (0..20_000).map(|_| resonance.step(&mut state, 7.0)).last();
    assert!(last.is_some_and(|y| (y - 7.0).abs() < 1e-4), "{last:?}");
}
