//! Laws of every drive, and what it holds.

use super::*;
use proptest::prelude::*;

const PICMA: Request = Request {
    min_v: 0.0,
    max_v: 100.0,
    rest_v: 0.0,
    slew_v_per_s: 500.0,
    up_to_hz: 20.0,
    duration_s: 120.0,
    tick_s: 5e-4,
    seed: 1,
};

/// Asserts that every sample is one that the amplifier may be given, from rest to rest.
fn keeps_to_its_limits(request: &Request, segments: &[Segment]) {
    let (min, max) = (request.min_v as f32, request.max_v as f32);
    let most = request.slew_v_per_s * request.tick_s;
    let mut before = request.rest_v;
    for segment in segments {
        for (tick, &volts) in segment.volts.iter().enumerate() {
            assert!((min..=max).contains(&volts), "{} {tick}: {volts} V of {request:?}", segment.name);
            let step = (f64::from(volts) - before).abs();
            assert!(step <= most, "{} {tick}: a step of {step} V, {most} V may be, of {request:?}", segment.name);
            before = volts.into();
        }
        let end = segment.volts.last().copied().unwrap();
        assert!((f64::from(end) - request.rest_v).abs() < 1e-4 * request.span_v(), "{} ends at {end} V", segment.name);
    }
}

#[test]
fn a_session_of_some_minutes_holds_a_step_long_enough_for_creep_to_show() {
    let longest_s = |duration_s: f64| {
        let drive = Drive::design(&Request { duration_s, ..PICMA }).unwrap();
        let staircase = drive.segments.iter().find(|segment| segment.name == "staircase").unwrap();
        let held = staircase.volts.chunk_by(|a, b| a == b).map(<[f32]>::len).max().unwrap();
        held as f64 * PICMA.tick_s
    };
    assert!(longest_s(120.0) > 10.0, "{} s", longest_s(120.0));
    assert!(longest_s(60.0) < 5.0, "{} s: the steps share what there is", longest_s(60.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_sample_is_beyond_the_range_or_the_slew_limit(
        min_v in -200.0f64..100.0,
        span in 0.5f64..300.0,
        rest in 0.0f64..=1.0,
        slew_spans in 1.0f64..200.0,
        up_to_hz in 0.2f64..200.0,
        duration_s in 5.0f64..60.0,
        seed: u64,
    ) {
        let max_v = min_v + span;
        let rest_v = (min_v + rest * span).clamp(min_v, max_v);
        let request =
            Request { min_v, max_v, rest_v, slew_v_per_s: slew_spans * span, up_to_hz, duration_s, tick_s: 5e-4, seed };
        let (request, drive) = match Drive::design(&request) {
            Err(ExcitationError::TooShort { least_s, .. }) => {
                let longer = Request { duration_s: least_s, ..request };
                (longer, Drive::design(&longer).expect("the time that it asked for suffices"))
            }
            designed => (request, designed.unwrap()),
        };
        keeps_to_its_limits(&request, &drive.segments);
        prop_assert!(drive.duration_s() <= 1.11 * request.duration_s);
        prop_assert!(drive.swings.iter().all(|swing| swing.span_v > 0.0 && swing.span_v <= swing.wanted_v));
    }
}

#[test]
fn it_reaches_both_ends_and_uses_the_time() {
    let drive = Drive::design(&PICMA).unwrap();
    assert!((100.0..125.0).contains(&drive.duration_s()), "{}", drive.duration_s());
    for segment in &drive.segments {
        let reached = segment.volts.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)));
        assert_eq!(reached, (0.0, 100.0), "{}", segment.name);
        let rests = segment.lead_in == 0 || segment.volts[segment.lead_in - 1] == 0.0;
        assert!(rests && (segment.lead_in == 0) == (segment.name == "first-branch"), "{}", segment.name);
    }
    let held_out: Vec<&str> = drive.segments.iter().filter(|of| of.held_out).map(|of| of.name).collect();
    assert_eq!(held_out, ["held-out"]);
}

#[test]
fn what_the_slew_limit_forbids_is_said_with_its_numbers() {
    let drive = Drive::design(&PICMA).unwrap();
    let said = drive.forbidden().join("\n");
    assert!(said.contains("100.000 V peak to peak at 20.000 Hz need 4000 V/s, the slew limit is 500 V/s"), "{said}");
    assert!(drive.covers().iter().any(|line| line.starts_with("20.000 Hz at 11.875, 5.938, 2.375 V")));
    let free = Drive::design(&Request { slew_v_per_s: 1e5, ..PICMA }).unwrap();
    assert_eq!(free.forbidden(), [""; 0]);
}

#[test]
fn a_seed_draws_the_random_part_alone() {
    let [one, other] = [1, 2].map(|seed| Drive::design(&Request { seed, ..PICMA }).unwrap());
    for (a, b) in one.segments.iter().zip(&other.segments) {
        assert_eq!(a.volts != b.volts, a.held_out, "{}", a.name);
    }
    assert_eq!(one, Drive::design(&PICMA).unwrap());
    let proof = Drive::random(&Request { duration_s: 20.0, seed: 3, ..PICMA }).unwrap();
    keeps_to_its_limits(&PICMA, std::slice::from_ref(&proof));
    assert!(proof.held_out && (18.0..22.0).contains(&(proof.volts.len() as f64 * 5e-4)));
}

#[test]
fn a_request_without_sense_is_refused_by_its_own_numbers() {
    let refused = |request: Request| Drive::design(&request).unwrap_err().to_string();
    assert!(refused(Request { max_v: -1.0, ..PICMA }).contains("from 0 to -1 V"));
    assert!(refused(Request { rest_v: 120.0, ..PICMA }).contains("rest at 120 V"));
    assert!(refused(Request { slew_v_per_s: f64::NAN, ..PICMA }).contains("slew limit"));
    assert!(refused(Request { up_to_hz: 900.0, ..PICMA }).contains("at most 200 Hz"));
    assert!(refused(Request { duration_s: 1.0, ..PICMA }).contains("are too few"));
    assert!(refused(Request { duration_s: 1e6, ..PICMA }).contains("too long"));
    assert!(refused(Request { slew_v_per_s: 1e-6, ..PICMA }).contains("too long"));
}
