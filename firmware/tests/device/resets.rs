//! How a device starts after what went wrong, and how it ends.

use crate::bench::{Bench, TICKS};
use crate::common::{FACTS, PERIOD, SAFE, compiled, driving, linearising, started, triangle};
use embassy_futures::block_on;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Timer};
use estimator_core::DacCode;
use firmware::Facts;
use firmware::drive::Drive;
use firmware::queues::Command;
use firmware::restarts::{Restarts, TOO_MANY};
use firmware::startup::Startup;
use protocol::{Faults, Mode, Refusal, Reply, Request};

/// Asks for a reset and brings the output to rest, which must end within ten seconds.
fn resets(bench: &mut Bench) {
    assert!(matches!(bench.ask(Request::Reset), Reply::Resetting { .. }));
    let rested = block_on(select(bench.device.rest(), Timer::after(Duration::from_secs(10))));
    assert!(matches!(rested, Either::First(())), "the reset never comes");
}

#[test]
fn after_failures_in_a_row_a_driving_compiled_table_drives_nothing_and_a_reset_that_is_asked_for_ends() {
    let kept = DacCode(1234);
    assert_ne!(Drive::rest(&driving()), Some(kept));
    let facts = Facts { restarts: Restarts { count: TOO_MANY, safe: Some(kept), ..Restarts::NONE }, ..FACTS };
    let start = || started(Startup::new(Some(&driving()), &facts, Faults::TABLE_FALLBACK));

    let (mut tick, mut link) = start();
    for (k, mode) in
        [Mode::Estimate, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Pause, Mode::Pil].into_iter().enumerate()
    {
        link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
        link.queues.commands.enqueue(Command::Go { hold: true }).unwrap();
        link.queues.references.enqueue(20.0).unwrap();
        link.queues.fed.enqueue(triangle(700)).unwrap();
        for k in (0..3_000).map(|tick| 3_000 * k as u32 + tick) {
            assert_eq!(tick.sample(triangle(k).into(), k * PERIOD).0, kept.0, "{mode:?}, tick {k}");
        }
    }
    assert_eq!((link.telemetry.safe(), link.telemetry.drives()), (kept, false));

    let mut bench = Bench::of(Some(driving()), start());
    std::thread::sleep(TICKS);
    for mode in [Mode::Follow, Mode::Excite] {
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Refused(Refusal::Faulty));
    }
    assert_eq!(bench.ask(Request::Reset), Reply::Resetting { in_ms: 0 });
    resets(&mut bench);
}

#[test]
fn without_its_crystal_a_device_estimates_and_drives_nothing_and_says_so() {
    let facts = Facts { clock_good: false, ..FACTS };
    for table in [compiled(), driving(), linearising(true)] {
        let safe = Drive::rest(&table).unwrap_or(table.dac.code(0.0f32));
        let start = || started(Startup::new(Some(&table), &facts, Faults::empty()));
        let (mut tick, mut link) = start();
        for mode in [Mode::Estimate, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Pil] {
            link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
            for k in 0..3_000 {
                assert_eq!(tick.sample(triangle(k).into(), k * PERIOD).0, safe.0, "{mode:?}, tick {k}");
                assert!(!tick.valid(), "{mode:?}, tick {k}");
            }
        }
        let mut bench = Bench::of(Some(table), start());
        bench.until(Faults::CLOCK | Faults::SAFE_OUTPUT);
        let drives = table.drive.is_some();
        let refusal = if drives { Refusal::Faulty } else { Refusal::NoDrive };
        assert_eq!(bench.ask(Request::SetMode(Mode::Follow)), Reply::Refused(refusal));
        assert_eq!(bench.ask(Request::SetZero { at_um: 0.0 }), Reply::Refused(Refusal::NotEstimating));
        resets(&mut bench);
    }
}

#[test]
fn a_reset_ends_even_where_the_output_never_comes_to_its_safe_code() {
    // The drive's rest is another code.
    let startup = Startup { safe: DacCode(SAFE.0), ..Startup::new(Some(&driving()), &FACTS, Faults::empty()) };
    let mut bench = Bench::of(Some(driving()), started(startup));
    std::thread::sleep(TICKS);
    assert!(bench.device.telemetry.ticks_to_safe() > 0);
    resets(&mut bench);
    assert!(bench.device.telemetry.ticks_to_safe() > 0);
}

#[test]
fn the_output_is_put_on_its_pin_only_where_somebody_knows_what_is_wired_to_it() {
    let kept = DacCode(1234);
    let again = Facts { restarts: Restarts { count: 1, safe: Some(kept), ..Restarts::NONE }, ..FACTS };
    let none = Faults::empty();
    let half = DacCode(FACTS.interface.dac_full_scale / 2);
    for table in [compiled(), driving()] {
        let own = Drive::rest(&table).unwrap_or(table.dac.code(0.0f32));
        for doubts in [Faults::TABLE_FALLBACK, Faults::DEMONSTRATION] {
            for (table, facts, doubts, safe, connected) in [
                (Some(&table), FACTS, none, own, true),
                (Some(&table), again, none, own, true),
                (Some(&table), FACTS, doubts, half, false),
                (None, FACTS, none, half, false),
                (Some(&table), again, doubts, kept, true),
                (None, again, none, kept, true),
            ] {
                let startup = Startup::new(table, &facts, doubts);
                assert_eq!((startup.safe, startup.connected), (safe, connected), "{doubts:?}");
                let (mut tick, link) = started(startup);
                assert_eq!((link.telemetry.safe(), link.telemetry.connected()), (safe, connected));
                let known = doubts.is_empty() && table.is_some();
                for k in 0..3_000 {
                    let given = tick.sample(triangle(k).into(), k * PERIOD);
                    assert!(known || given.0 == safe.0 && !tick.valid(), "{doubts:?}, tick {k}");
                }
            }
        }
    }
}

#[test]
fn a_zero_that_a_reset_has_lost_is_said_without_valid_until_it_is_told_anew() {
    let lost = Facts { restarts: Restarts { told: true, ..FACTS.restarts }, ..FACTS };
    for table in [compiled(), driving()] {
        let (mut tick, mut link) = started(Startup::new(Some(&table), &lost, Faults::empty()));
        let mut k = 0;
        let mut run = |ticks: u32, faults: Faults| {
            for _ in 0..ticks {
                k += 1;
                tick.sample(triangle(k).into(), k * PERIOD);
                assert_eq!((link.telemetry.faults(), tick.valid()), (faults, faults.is_empty()), "tick {k}");
            }
        };
        let rest = if table.drive.is_some() { Faults::SAFE_OUTPUT } else { Faults::empty() };
        run(3_000, Faults::ZERO_LOST | rest);
        link.queues.commands.enqueue(Command::SetMode(Mode::Estimate)).unwrap();
        run(10, Faults::ZERO_LOST | rest);
        link.queues.commands.enqueue(Command::SetZero { at_um: 0.0 }).unwrap();
        run(10, rest);
    }
    // It is kept as it is told, and not where codes are fed or it is refused.
    let mut bench = Bench::new(Some(compiled()));
    std::thread::sleep(TICKS);
    let kept = |bench: &mut Bench, request: Request| (bench.ask(request), bench.told());
    assert_eq!(bench.ask(Request::SetMode(Mode::Pil)), Reply::Done);
    assert_eq!(bench.ask(Request::Feed([30_000; 20].into_iter().collect())), Reply::Fed(20));
    std::thread::sleep(TICKS);
    assert_eq!(kept(&mut bench, Request::SetZero { at_um: 0.0 }), (Reply::Done, false));
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done);
    std::thread::sleep(TICKS);
    assert!(matches!(kept(&mut bench, Request::SetZero { at_um: 1e6 }), (Reply::Refused(_), false)));
    for told in [Request::SetZero { at_um: 0.0 }, Request::ShiftBias { by_um: 1.0 }] {
        assert_eq!(kept(&mut bench, told), (Reply::Done, true));
    }
    assert_eq!((block_on(bench.device.zero()), bench.told()), (Ok(()), true), "by the button, too");
}
