//! What the device answers.

mod bench;
#[path = "../common/mod.rs"]
mod common;
mod references;
mod resets;
mod set_point;
mod tables;
mod waveform;

use bench::{Bench, TICKS, push};
use common::{PERIOD, compiled, driving, other, record, tick, triangle};
use core::sync::atomic::{AtomicBool, AtomicU16, Ordering::Relaxed};
use embassy_futures::block_on;
use estimator_core::interval::{PLAYS, TRIANGLE};
use estimator_core::{AdcCode, Admitted, IntervalParameters, Table};
use protocol::{Faults, Mode, Refusal, Reply, Request, ResetCause, TableSource, text};
use std::sync::Arc;

#[test]
fn it_says_who_and_how_it_is() {
    let mut bench = Bench::new(Some(compiled()));
    let Reply::Identity(identity) = bench.ask(Request::Identify) else { panic!() };
    assert_eq!((&*identity.board, identity.tick_us, identity.adc_full_scale), ("bench", 500, 65_520));
    assert_eq!(identity.model, "Voigt (4.8)");
    assert_eq!(identity.source, TableSource::Compiled { reason: text("no table is stored") });
    let checksum = |table: &Admitted| estimator_core::record::checksum(&record(table)).unwrap();
    assert_eq!(identity.table_crc, checksum(&compiled()));
    assert_ne!(identity.table_crc, checksum(&other()));
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert_eq!((health.reset, health.supply_mv, health.flash_errors), (ResetCause::WATCHDOG, Some(3301), 3));
    assert_eq!((health.frames_refused, health.line_errors), (0, 2));
    assert_eq!(health.last_words.unwrap(), "panicked");
    assert_eq!(bench.ask(Request::Forget), Reply::Done);
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert_eq!((health.frames_refused, health.line_errors, health.flash_errors), (0, 0, 0));
    assert_eq!(health.last_words, None);
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done, "which takes a tick");
    assert_eq!(bench.ask(Request::Reset), Reply::Resetting { in_ms: 0 }, "it drives nothing");
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert!(health.ticks > 0);
    let mut empty = Bench::new(None);
    assert_eq!(empty.ask(Request::Pull), Reply::Refused(Refusal::NoTable));
    assert_eq!(empty.ask(push(&compiled(), false)), Reply::Done, "without a table nothing is estimated");
}

/// The compiled table with an interval that is told an hour after the start at the earliest.
fn late() -> Admitted {
    let mut spread_um = [0.0; TRIANGLE];
    (0..PLAYS).for_each(|row| spread_um[row * (row + 3) / 2] = 0.2);
    let interval = IntervalParameters {
        rate_ticks: 1.0,
        spread_um,
        prototype_um: 0.01,
        untrained_um: 0.1,
        gain: 0.02,
        drift_um: 0.05,
        earliest_s: 3_600.0,
        ..IntervalParameters::constant(0.1)
    };
    Table { interval: Some(interval), ..*compiled() }.admit().expect("every part of the interval has a size")
}

#[test]
fn the_bias_is_told_only_where_something_is_estimated_and_in_reason() {
    let span_um = compiled().displacement_limits_um.span();
    type Tell = fn(f32) -> Request;
    let ways: [Tell; 2] = [|at_um| Request::SetZero { at_um }, |by_um| Request::ShiftBias { by_um }];
    for tell in ways {
        let mut early = Bench::new(Some(late()));
        std::thread::sleep(TICKS);
        assert_eq!(early.ask(tell(0.0)), Reply::Refused(Refusal::TooSoon), "it has not run for an hour");
        let mut bench = Bench::new(Some(compiled()));
        std::thread::sleep(TICKS);
        assert_eq!(bench.ask(tell(-span_um)), Reply::Done);
        for odd in [f32::NAN, f32::NEG_INFINITY, 1.01 * span_um] {
            assert_eq!(bench.ask(tell(odd)), Reply::Refused(Refusal::BeyondSpan { span_um }));
        }
        assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
        assert_eq!(bench.ask(tell(0.0)), Reply::Refused(Refusal::NotEstimating));
        assert_eq!(Bench::new(None).ask(tell(0.0)), Reply::Refused(Refusal::NotEstimating));
        let mut excited = Bench::new(Some(driving()));
        assert_eq!(excited.ask(Request::SetMode(Mode::Excite)), Reply::Done);
        std::thread::sleep(TICKS);
        assert_eq!(excited.ask(tell(1.0)), Reply::Done, "the sensor beside it says where it is");
    }
}

#[test]
fn no_zero_is_taken_of_a_voltage_that_is_not_to_be_believed() {
    let table = compiled();
    let beyond = table.adc.code(table.voltage_range_v.max + 0.02).0;
    for (code, why) in [(u16::MAX, "saturated"), (beyond, "out of range")] {
        let read = Arc::new(AtomicU16::new(30_000));
        let reads = read.clone();
        let conversion =
            move |k: u32, _| AdcCode(reads.load(Relaxed).saturating_add((k % 2) as u16).min(65_520)).into();
        let mut bench = Bench::with(Some(table), tick(Some(&table), Faults::empty()), conversion);
        std::thread::sleep(TICKS);
        assert_eq!(bench.ask(Request::SetZero { at_um: 1.0 }), Reply::Done, "{why}");
        read.store(code, Relaxed);
        // Before it is a fault, and after.
        for _ in 0..2 {
            std::thread::sleep(TICKS);
            assert_eq!(bench.ask(Request::SetZero { at_um: 2.0 }), Reply::Refused(Refusal::NotBelieved), "{why}");
        }
        assert_eq!(block_on(bench.device.zero()), Err(Refusal::NotBelieved), "{why}: nor by the button");
    }
}

/// A host that takes "done" for done would measure from a zero that is none.
#[test]
fn a_zero_that_the_tick_does_not_take_is_refused_and_not_kept() {
    let mut bench = Bench::new(Some(compiled()));
    std::thread::sleep(TICKS);
    assert_eq!(bench.ask(Request::SetMode(Mode::Pil)), Reply::Done);
    // Nothing has been fed: there is no displacement to be called anything.
    for told in [Request::SetZero { at_um: 1.0 }, Request::ShiftBias { by_um: 1.0 }] {
        assert_eq!(bench.ask(told), Reply::Refused(Refusal::TooSoon));
    }
    // The tick finds it so, and not the device, which has looked before.
    assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done);
    for _ in 0..100 {
        bench.device.telemetry.may_be_told.store(true, Relaxed);
        let (before, _) = bench.device.telemetry.told();
        let reply = bench.ask(Request::SetZero { at_um: 1.0 });
        let (now, taken) = bench.device.telemetry.told();
        assert_eq!((reply == Reply::Done, now), (taken, before.wrapping_add(1)), "{reply:?}");
    }
    assert!(bench.told());
}

#[test]
fn shifts_add_up_to_no_more_than_one_may_be() {
    let span_um = compiled().displacement_limits_um.span();
    let mut bench = Bench::new(Some(compiled()));
    std::thread::sleep(TICKS);
    for reply in [Reply::Done, Reply::Refused(Refusal::BeyondSpan { span_um })] {
        assert_eq!(bench.ask(Request::ShiftBias { by_um: 0.6 * span_um }), reply);
    }
    for _ in 0..2 {
        assert_eq!(bench.ask(Request::ShiftBias { by_um: -0.6 * span_um }), Reply::Done, "on the way back");
    }
}

#[test]
fn the_button_zeroes_no_fed_codes_and_who_feeds_them_may() {
    let mut bench = Bench::new(Some(compiled()));
    assert_eq!(bench.ask(Request::SetMode(Mode::Pil)), Reply::Done);
    let codes = [30_000, 30_010, 65_520].into_iter().collect();
    assert_eq!(bench.ask(Request::Feed(codes)), Reply::Fed(3));
    std::thread::sleep(TICKS);
    assert_eq!(block_on(bench.device.zero()), Err(Refusal::NotEstimating));
    assert_eq!(bench.ask(Request::SetZero { at_um: 1.0 }), Reply::Done, "the host's own estimate is told it, too");
}

#[test]
fn health_has_the_bias_and_its_age() {
    let mut bench = Bench::new(Some(compiled()));
    let bias = |bench: &mut Bench| {
        std::thread::sleep(TICKS);
        let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
        (health.bias_um, health.bias_age_ticks)
    };
    assert_eq!(bias(&mut bench), (0.0, None));
    assert_eq!(bench.ask(Request::ShiftBias { by_um: 1.5 }), Reply::Done);
    let (um, age) = bias(&mut bench);
    assert!(um == 1.5 && age.is_some(), "{um} {age:?}");
    assert!(bias(&mut bench).1 > age, "it grows old");
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done);
    assert_eq!(bias(&mut bench).0, 1.5, "the estimate goes on");
    assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
    assert_eq!(bias(&mut bench), (0.0, None));
}

#[test]
fn no_drive_begins_while_ticks_go_on_being_late_and_one_late_tick_hinders_none() {
    let (mut tick, link) = tick(Some(&driving()), Faults::empty());
    let mut bench = Bench::still(Some(driving()), link);
    let mut now = 0u32;
    let mut after = |periods: u32| {
        now = now.wrapping_add(periods * PERIOD);
        tick.sample(triangle(now / PERIOD).into(), now);
    };
    after(1);
    after(2);
    assert_eq!(bench.device.telemetry.faults(), Faults::MISSED_DEADLINE | Faults::SAFE_OUTPUT, "it drives nothing yet");
    // Nobody obeys here: it is taken, at least.
    assert_eq!(bench.ask(Request::SetMode(Mode::Follow)), Reply::Refused(Refusal::Busy));
    // A gap of 20 ms.
    after(40);
    after(1);
    assert!(bench.device.telemetry.faults().contains(Faults::MISSED_DEADLINE), "it lasts");
    assert_eq!(bench.ask(Request::SetMode(Mode::Follow)), Reply::Refused(Refusal::Faulty));
}

#[test]
fn no_mode_and_no_lease_ends_a_fault_of_the_monitor_s_wire() {
    let table = Table { amplifier_slew_v_per_s: Some(50.0), ..*driving() };
    let table = table.admit().expect("the amplifier is faster than the drive");
    let off = Arc::new(AtomicBool::new(false));
    let wire = off.clone();
    let mut bench = Bench::with(Some(table), tick(Some(&table), Faults::empty()), move |k, dac| {
        let AdcCode(monitor) = table.adc.code(table.drive.unwrap().voltage::<f32>(dac));
        let open = if wire.load(Relaxed) { 20_000 } else { 0 };
        AdcCode(monitor + open + (k % 2) as u16).into()
    });
    assert_eq!(bench.ask(Request::SetMode(Mode::Excite)), Reply::Done);
    std::thread::sleep(TICKS);
    assert!(bench.device.lent(), "a host that vanishes is not waited for");
    off.store(true, Relaxed);
    bench.until(Faults::SLEW_EXCEEDED);
    for mode in [Mode::Pause, Mode::Estimate] {
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Done);
        std::thread::sleep(10 * TICKS);
        assert!(bench.device.telemetry.faults().contains(Faults::SLEW_EXCEEDED), "{mode:?} believes no open input");
    }
    assert_eq!(bench.ask(Request::SetMode(Mode::Excite)), Reply::Refused(Refusal::Faulty));
    off.store(false, Relaxed);
    let begun = std::time::Instant::now();
    while bench.device.telemetry.faults().contains(Faults::SLEW_EXCEEDED) {
        assert!(begun.elapsed().as_secs() < 20, "the wire is back: {:?}", bench.device.telemetry.faults());
        std::thread::sleep(TICKS);
    }
}
