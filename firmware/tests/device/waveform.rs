//! A waveform that a host loads and has played.

use crate::bench::{Bench, TICKS, push};
use crate::common::{FACTS, PERIOD, compiled, driving, started, triangle};
use core::num::NonZeroU16;
use core::sync::atomic::Ordering::Relaxed;
use firmware::startup::Startup;
use firmware::supply::Measured;
use protocol::waveform::checksum;
use protocol::{Faults, MOST_POINTS, Mode, Playback, Refusal, Reply, Request};

const POINTS: [f32; 3] = [4.0, 4.5, 4.2];

fn load(first: u16, points: &[f32]) -> Request {
    Request::Load { first, points: points.iter().copied().collect() }
}

fn how(points: &[f32]) -> Playback {
    let number = |number: u16| NonZeroU16::new(number).expect("at least one");
    let crc = checksum(points.iter().copied());
    Playback { points: number(points.len() as u16), crc, every: number(10), lines: 0, on_trigger: true }
}

/// A device that has the points in its memory.
fn loaded() -> Bench {
    let mut bench = Bench::new(Some(driving()));
    assert_eq!(bench.ask(load(0, &POINTS)), Reply::Loaded(3));
    bench
}

#[test]
fn points_that_come_twice_are_taken_once_and_none_behind_a_gap() {
    let mut bench = Bench::new(Some(driving()));
    assert_eq!(bench.ask(load(1, &[1.0])), Reply::Loaded(0), "the first one is missing");
    for _ in 0..2 {
        assert_eq!(bench.ask(load(0, &[1.0; 64])), Reply::Loaded(64));
    }
    assert_eq!(bench.ask(load(65, &[1.0])), Reply::Loaded(64), "one is missing");
    assert_eq!(bench.ask(load(60, &POINTS)), Reply::Loaded(63), "those behind are forgotten");
    for odd in [f32::NAN, f32::NEG_INFINITY] {
        assert_eq!(bench.ask(load(63, &[odd])), Reply::Refused(Refusal::NotFinite));
    }
    let mut count = 63;
    while usize::from(count) < MOST_POINTS {
        let next = (MOST_POINTS - usize::from(count)).min(64);
        assert_eq!(bench.ask(load(count, &[0.5; 64][..next])), Reply::Loaded(count + next as u16));
        count += next as u16;
    }
    assert_eq!(bench.ask(load(count, &[0.5])), Reply::Refused(Refusal::TooManyPoints));
    assert_eq!(bench.ask(load(u16::MAX, &[1.0])), Reply::Refused(Refusal::TooManyPoints));
}

#[test]
fn nothing_is_played_but_what_was_loaded() {
    let refused = Reply::Refused(Refusal::NotLoaded { points: 3 });
    let mut bench = loaded();
    let by_mode = bench.ask(Request::SetMode(Mode::Waveform));
    assert_eq!(by_mode, Reply::Refused(Refusal::NotByMode), "nobody has said how");
    assert_eq!(bench.ask(Request::Play(how(&POINTS[..2]))), refused, "another number of points");
    assert_eq!(bench.ask(Request::Play(how(&[4.0, 4.5, 4.3]))), refused, "another point");
    assert_eq!(bench.device.telemetry.mode(), Mode::Estimate);
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), Reply::Done);
    assert_eq!(bench.device.telemetry.mode(), Mode::Waveform);
    let mut empty = Bench::new(Some(driving()));
    assert_eq!(empty.ask(Request::Play(how(&POINTS))), Reply::Refused(Refusal::NotLoaded { points: 0 }));
}

#[test]
fn what_is_played_is_not_changed_and_lasts_without_a_host() {
    let mut bench = loaded();
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), Reply::Done);
    let epoch = bench.device.telemetry.epoch.load(Relaxed);
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), Reply::Done, "it does so already");
    std::thread::sleep(TICKS);
    assert_eq!(bench.device.telemetry.epoch.load(Relaxed), epoch, "nothing has changed");
    for other in [load(0, &POINTS), Request::Play(Playback { lines: 1, ..how(&POINTS) })] {
        assert_eq!(bench.ask(other), Reply::Refused(Refusal::Playing));
    }
    let refer = Request::Refer { first: 0, references: [1.0].iter().copied().collect(), go: true, hold: true };
    assert_eq!(bench.ask(refer), Reply::Refused(Refusal::NotFollowing));
    assert_eq!(bench.ask(push(&driving(), false)), Reply::Refused(Refusal::Estimating), "flash may cost ticks");
    assert!(!bench.device.lent());
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done);
    assert_eq!(bench.ask(load(0, &POINTS)), Reply::Loaded(3), "its memory is free");
}

#[test]
fn it_takes_a_drive_a_trigger_input_where_one_is_waited_for_and_an_output_without_a_fault() {
    let mut plain = Bench::new(Some(compiled()));
    assert_eq!(plain.ask(load(0, &POINTS)), Reply::Loaded(3));
    assert_eq!(plain.ask(Request::Play(how(&POINTS))), Reply::Refused(Refusal::NoDrive));
    let mut blind = loaded();
    blind.device.facts.has_trigger = false;
    assert_eq!(blind.ask(Request::Play(how(&POINTS))), Reply::Refused(Refusal::NoTriggerInput));
    assert_eq!(blind.ask(Request::Play(Playback { on_trigger: false, ..how(&POINTS) })), Reply::Done);
    let mut faulty = loaded();
    faulty.device.telemetry.supply.publish(&Measured::of(Some(3000.0)));
    faulty.until(Faults::SUPPLY);
    assert_eq!(faulty.ask(Request::Play(how(&POINTS))), Reply::Refused(Refusal::Faulty));
}

/// A device that has the points in its memory, and one of its ticks.
fn still() -> (Bench, impl FnMut()) {
    let (mut tick, link) = started(Startup::new(Some(&driving()), &FACTS, Faults::empty()));
    let mut bench = Bench::still(Some(driving()), link);
    assert_eq!(bench.ask(load(0, &POINTS)), Reply::Loaded(3));
    let mut clock = 0u32;
    let run = move || {
        tick.sample(triangle(clock).into(), clock.wrapping_mul(PERIOD));
        clock += 1;
    };
    (bench, run)
}

#[test]
fn what_waits_for_the_tick_to_be_played_is_not_changed() {
    let (mut bench, mut run) = still();
    let busy = Reply::Refused(Refusal::Busy);
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), busy, "no tick comes");
    assert_eq!(bench.ask(load(0, &[1.0])), busy);
    assert_eq!(bench.ask(Request::Play(Playback { lines: 1, ..how(&POINTS) })), busy);
    run();
    assert!(bench.device.telemetry.plays());
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), Reply::Done, "it does so already");
    assert_eq!(bench.ask(Request::Play(Playback { lines: 1, ..how(&POINTS) })), Reply::Refused(Refusal::Playing));
}

#[test]
fn nothing_is_played_before_what_was_asked_earlier_is_done() {
    let (mut bench, mut run) = still();
    assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Refused(Refusal::Busy), "no tick comes");
    assert_eq!(bench.ask(Request::Play(how(&POINTS))), Reply::Refused(Refusal::Busy));
    run();
    run();
    assert_eq!(bench.device.telemetry.mode(), Mode::Pause);
    assert_eq!(bench.ask(load(0, &POINTS)), Reply::Loaded(3));
}

#[test]
fn triggers_that_began_no_line_are_forgotten_and_lines_are_not() {
    let mut bench = loaded();
    bench.device.telemetry.lines.store(5, Relaxed);
    bench.device.telemetry.triggers_ignored.store(2, Relaxed);
    assert_eq!(bench.ask(Request::Forget), Reply::Done);
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!("it says how it is") };
    assert_eq!((health.lines, health.triggers_ignored), (5, 0));
}
