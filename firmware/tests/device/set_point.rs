//! A controller's set-point, as the link has it.

use crate::bench::{Bench, TICKS, push};
use crate::common::{driving, linearising};
use core::sync::atomic::Ordering::Relaxed;
use firmware::supply::Measured;
use protocol::{Faults, Mode, Refusal, Reply, Request};
use std::sync::Arc;
use std::sync::atomic::AtomicU16;

#[test]
fn a_set_point_is_followed_where_board_and_table_have_one_and_for_as_long_as_nobody_says_otherwise() {
    let linearise = Request::SetMode(Mode::Linearise);
    let mut without = Bench::new(Some(driving()));
    assert_eq!(without.ask(linearise.clone()), Reply::Refused(Refusal::NoSetpoint));
    let mut blind = Bench::new(Some(linearising(false)));
    blind.device.facts.has_setpoint = false;
    assert_eq!(blind.ask(linearise.clone()), Reply::Refused(Refusal::NoSetpointInput));
    let mut bench = Bench::new(Some(linearising(false)));
    assert_eq!(bench.ask(linearise), Reply::Done);
    assert!(bench.device.telemetry.mode() == Mode::Linearise && !bench.device.lent());
    let refer = Request::Refer { first: 0, references: [1.0].iter().copied().collect(), go: true, hold: true };
    assert_eq!(bench.ask(refer), Reply::Refused(Refusal::NotFollowing));
    assert_eq!(bench.ask(push(&linearising(true), false)), Reply::Refused(Refusal::Estimating));
}

#[test]
fn a_device_that_is_asked_again_for_its_set_point_goes_on_as_it_was() {
    let linearise = Request::SetMode(Mode::Linearise);
    let code = Arc::new(AtomicU16::new(0));
    let mut bench = Bench::controlled(code.clone());
    let goes_on = |bench: &mut Bench| {
        let epoch = bench.device.telemetry.epoch.load(Relaxed);
        assert_eq!(bench.ask(linearise.clone()), Reply::Done);
        std::thread::sleep(TICKS);
        assert_eq!(bench.device.telemetry.epoch.load(Relaxed), epoch, "nothing has changed");
    };
    bench.until(Faults::SETPOINT | Faults::SAFE_OUTPUT);
    goes_on(&mut bench);
    code.store(32_760, Relaxed);
    bench.until(Faults::empty());
    assert_eq!(bench.ask(Request::Stream(true)), Reply::Done);
    goes_on(&mut bench);
    assert!(bench.device.telemetry.faults().is_empty(), "it follows");
    assert!(bench.device.telemetry.streaming.load(Relaxed), "what is streamed goes on");
}

#[test]
fn a_fault_of_the_set_point_refuses_the_set_point_alone() {
    for mode in [Mode::Follow, Mode::Excite] {
        let code = Arc::new(AtomicU16::new(32_760));
        let mut bench = Bench::controlled(code.clone());
        bench.until(Faults::empty());
        code.store(0, Relaxed);
        bench.until(Faults::SETPOINT | Faults::SAFE_OUTPUT);
        assert_eq!(bench.ask(Request::SetMode(Mode::Linearise)), Reply::Refused(Refusal::Faulty));
        assert_eq!((bench.ask(Request::SetMode(mode)), bench.device.telemetry.mode()), (Reply::Done, mode));
        // What concerns every drive refuses every one.
        bench.device.telemetry.supply.publish(&Measured::of(Some(3000.0)));
        bench.until(Faults::SUPPLY);
        for mode in [Mode::Follow, Mode::Excite, Mode::Linearise] {
            assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Refused(Refusal::Faulty), "{mode:?}");
        }
    }
}
