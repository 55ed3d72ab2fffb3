//! The DAC as the amplifier's input.

mod common;

use common::driven::{Bench, REST, STRIDE};
use common::{PERIOD, SAFE, compiled, driving, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, DacCode, Status};
use firmware::drive::{Following, REFERENCE_TIMEOUT_TICKS};
use firmware::telemetry::STALLED;
use firmware::watch::{HOLD, SATURATED};
use protocol::{Faults, Mode};

#[test]
fn without_references_it_rests_whatever_is_estimated() {
    let mut bench = Bench::new();
    for mode in [Mode::Estimate, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Pause, Mode::Pil] {
        bench.set(mode);
        for _ in 0..500 {
            let (dac, _, faults) = bench.step();
            assert!(dac == REST && faults.contains(Faults::SAFE_OUTPUT), "{mode:?}: {dac:?} {faults:?}");
        }
    }
    let (mut plain, _) = tick(Some(&compiled()), Faults::empty());
    assert_ne!(plain.sample(triangle(900).into(), 0), SAFE, "without a drive the DAC shows the displacement");
}

#[test]
fn it_gives_the_codes_of_the_core_s_inverse_and_holds_the_last_reference() {
    let table = driving();
    let drive = table.drive.unwrap();
    let mut core = table.inverse::<f32>(&drive.limits).unwrap();
    // As many ticks at rest as the bench has been given.
    let mut bench = Bench::new();
    bench.set(Mode::Follow);
    for _ in 0..10 {
        bench.step();
        core.release();
    }
    bench.link.queues.references.enqueue(20.0).unwrap();
    for _ in 0..10 {
        assert_eq!(bench.step().0, REST, "references wait until they are to be followed");
        core.release();
    }
    bench.go(true);
    let first = core.tick(20.0);
    assert_eq!(bench.step().0, drive.code(first.voltage, 4095));
    let wave = |k: u32| 18.0 + 12.0 * (k as f32 * 0.02).sin();
    for k in 0..2_000 {
        bench.link.queues.references.enqueue(wave(k)).unwrap();
        let expected = core.tick(wave(k));
        let (dac, status, faults) = bench.step();
        assert_eq!(dac, drive.code(expected.voltage, 4095), "tick {k}");
        assert_eq!(status.contains(Status::OUT_OF_REACH), !expected.reached);
        assert!(!faults.contains(Faults::SAFE_OUTPUT));
    }
    for _ in 0..2_000 {
        let expected = core.tick(wave(1_999));
        assert_eq!(bench.step().0, drive.code(expected.voltage, 4095));
    }
    assert!(bench.link.telemetry.out_of_reach.load(Relaxed) > 0, "the first reference is a jump");
}

#[test]
fn references_of_the_mode_before_are_discarded_a_few_a_tick_and_never_followed() {
    let mut bench = Bench::new();
    bench.set(Mode::Follow);
    bench.step();
    let stale = std::iter::repeat_with(|| bench.link.queues.references.enqueue(3.0)).take_while(Result::is_ok).count();
    bench.set(Mode::Follow);
    bench.go(true);
    for waiting in (0..=stale).rev().step_by(32).skip(1) {
        assert_eq!(bench.step().0, REST, "{waiting} of {stale} wait");
        assert_eq!(bench.link.queues.references.len(), waiting, "as many go as a tick has time for");
    }
    bench.link.queues.references.enqueue(1.0).unwrap();
    bench.step();
    assert_eq!(bench.link.telemetry.following(), Following::UntilModeEnds, "the first of this one is followed");
}

#[test]
fn what_was_held_for_long_may_be_gone_on_from() {
    let mut bench = Bench::new();
    bench.set(Mode::Follow);
    bench.go(true);
    // As the mode is entered its queue is emptied.
    bench.step();
    bench.link.queues.references.enqueue(20.0).unwrap();
    for _ in 0..2 * REFERENCE_TIMEOUT_TICKS {
        bench.step();
    }
    let held = bench.step().0;
    assert_ne!(held, REST);
    // The tick between the word to go and the first reference.
    bench.go(false);
    let (dac, _, faults) = bench.step();
    assert!(dac == held && !faults.contains(Faults::SAFE_OUTPUT), "{dac:?} {held:?} {faults:?}");
}

#[test]
fn a_fault_brings_it_to_rest_without_a_jump_and_it_stays_there() {
    let mut bench = Bench::new();
    bench.set(Mode::Follow);
    let mut last = REST.0;
    let mut follow = |bench: &mut Bench, code: Option<AdcCode>| {
        let _ = bench.link.queues.references.enqueue(30.0);
        let code = code.unwrap_or(bench.amplifier());
        let (dac, _, faults) = bench.step_with(code);
        assert!(dac.0.abs_diff(last) <= STRIDE, "{last} → {}", dac.0);
        last = dac.0;
        (dac, faults)
    };
    bench.go(true);
    for _ in 0..1_000 {
        follow(&mut bench, None);
    }
    assert!(follow(&mut bench, None).0.0 > REST.0 + 500);
    let faults = (0..SATURATED + 200).map(|_| follow(&mut bench, Some(AdcCode(65_520))).1).last();
    assert!(faults.is_some_and(|faults| faults.contains(Faults::ADC_SATURATED | Faults::SAFE_OUTPUT)), "{faults:?}");
    // The fault passes; references still come.
    for _ in 0..5_000 {
        follow(&mut bench, None);
    }
    let (dac, faults) = follow(&mut bench, None);
    assert_eq!((dac, faults), (REST, Faults::SAFE_OUTPUT));
    bench.set(Mode::Follow);
    bench.go(true);
    let dac = (0..1_000).map(|_| follow(&mut bench, None).0).last().unwrap();
    assert!(dac.0 > REST.0 + 500, "set again, it follows again");
}

#[test]
fn where_nobody_speaks_any_more_it_goes_back_to_rest_unless_it_is_to_hold() {
    for hold in [true, false] {
        let mut bench = Bench::new();
        bench.set(Mode::Follow);
        bench.step();
        bench.link.queues.references.enqueue(20.0).unwrap();
        bench.go(hold);
        let held = (0..REFERENCE_TIMEOUT_TICKS).map(|_| bench.step().0).last().unwrap();
        assert!(held.0 > REST.0 + 300);
        let (later, _, faults) = (0..REFERENCE_TIMEOUT_TICKS).map(|_| bench.step()).last().unwrap();
        assert_eq!(later == REST, !hold, "{later:?}");
        assert_eq!(faults.contains(Faults::SAFE_OUTPUT), !hold);
    }
}

#[test]
fn with_a_table_that_is_not_the_stored_one_the_output_stays_safe() {
    let (mut tick, _) = tick(Some(&compiled()), Faults::TABLE_FALLBACK);
    assert!((0..3_000).all(|k| tick.sample(triangle(k).into(), k * PERIOD) == SAFE));
}

#[test]
fn an_amplifier_that_does_not_go_along_is_a_fault_and_one_that_does_is_none() {
    // A monitor's open wire, a tripped amplifier, a span that is a quarter off, and a sound one.
    type Amplifier = fn(f32) -> f32;
    let plants: [(&str, Amplifier, bool); 4] = [
        ("open wire", |_| 1.0, true),
        ("tripped", |_| 0.0, true),
        ("wrong span", |volts| 1.25 * volts, true),
        ("sound", |volts| 1.01 * volts, false),
    ];
    for (name, plant, wrong) in plants {
        let mut bench = Bench::new();
        bench.set(Mode::Follow);
        bench.step();
        bench.go(true);
        bench.link.queues.references.enqueue(25.0).unwrap();
        let table = driving();
        let mut last = REST.0;
        let mut faults = Faults::empty();
        for _ in 0..1_000 {
            let volts = plant(table.drive.unwrap().voltage(bench.dac));
            let code = table.adc.code(volts).0 + (bench.k % 2) as u16;
            let (dac, _, found) = bench.step_with(AdcCode(code));
            assert!(dac.0.abs_diff(last) <= STRIDE, "{name}: {last} → {}", dac.0);
            (last, faults) = (dac.0, faults | found);
        }
        assert_eq!(faults.contains(Faults::AMPLIFIER), wrong, "{name}: {faults:?}");
        assert_eq!(last == REST.0, wrong, "{name}: {last}");
    }
}

#[test]
fn the_amplifier_is_not_looked_at_where_nothing_is_driven() {
    let mut bench = Bench::new();
    assert!((0..500).all(|k| bench.step_with(triangle(k)).2 == Faults::SAFE_OUTPUT));
}

#[test]
fn a_main_loop_that_stands_still_brings_it_to_rest_at_the_slew_rate_and_there_it_stays() {
    for (mode, reference) in [(Mode::Follow, 20.0), (Mode::Excite, 2.5)] {
        let mut bench = Bench::new();
        bench.set(mode);
        bench.go(true);
        bench.step();
        bench.link.queues.references.enqueue(reference).unwrap();
        bench.link.telemetry.beat();
        for tick in 0..STALLED {
            let (_, _, faults) = bench.step();
            assert!(!faults.intersects(Faults::STALLED | Faults::SAFE_OUTPUT), "{mode:?}, tick {tick}: {faults:?}");
        }
        let mut before = bench.dac;
        assert!(before > DacCode(REST.0 + 5 * STRIDE), "{mode:?}: {before:?}");
        for tick in 0..2_000 {
            let (dac, _, faults) = bench.step();
            assert!(
                faults.contains(Faults::STALLED | Faults::SAFE_OUTPUT) && !bench.tick.valid(),
                "{mode:?}: {faults:?}"
            );
            assert!(before.0 - dac.0 <= STRIDE && (tick < 200 || dac == REST), "{mode:?}, tick {tick}: {dac:?}");
            before = dac;
        }
        // It goes on after all.
        for tick in 0..HOLD + 100 {
            bench.link.telemetry.beat();
            let (dac, _, faults) = bench.step();
            let lasts = if tick < HOLD { Faults::STALLED } else { Faults::empty() };
            assert_eq!((dac, faults), (REST, lasts | Faults::SAFE_OUTPUT), "{mode:?}, tick {tick}");
        }
    }
}
