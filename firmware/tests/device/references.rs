//! Codes and displacements that a host sends ahead of their ticks.

use crate::bench::{Bench, push};
use crate::common::{FACTS, PERIOD, compiled, driving, started, triangle};
use firmware::drive::Following;
use firmware::queues::Command;
use firmware::startup::Startup;
use protocol::{Faults, Mode, Refusal, Reply, Request};
use std::time::{Duration, Instant};

#[test]
fn codes_are_taken_in_their_mode_and_as_many_as_there_is_room() {
    let mut bench = Bench::new(Some(compiled()));
    let codes = || Request::Feed([30_000; 64].iter().copied().collect());
    assert_eq!(bench.ask(codes()), Reply::Refused(Refusal::NotPil));
    assert_eq!(bench.ask(Request::SetMode(Mode::Pil)), Reply::Done);
    let mut taken = 0;
    // Much faster than ticks: the queue fills.
    let full = (0..1_000).any(|_| match bench.ask(codes()) {
        Reply::Fed(64) => {
            taken += 64;
            false
        }
        Reply::Fed(some) => {
            taken += usize::from(some);
            true
        }
        reply => panic!("{reply:?}"),
    });
    assert!(full && taken >= 255, "{taken}");
}

#[test]
fn references_are_taken_where_the_dac_drives_and_are_numbers() {
    let refer = |first, wanted: f32| {
        let references = [wanted; 64].iter().copied().collect();
        Request::Refer { first, references, go: false, hold: false }
    };
    let mut plain = Bench::new(Some(compiled()));
    let mut bench = Bench::new(Some(driving()));
    assert_eq!(bench.ask(refer(0, 10.0)), Reply::Refused(Refusal::NotFollowing));
    for mode in [Mode::Excite, Mode::Follow] {
        assert_eq!(plain.ask(Request::SetMode(mode)), Reply::Refused(Refusal::NoDrive));
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Done);
        for odd in [f32::NAN, f32::INFINITY] {
            assert_eq!(bench.ask(refer(0, odd)), Reply::Refused(Refusal::NotFinite));
        }
        assert_eq!(bench.ask(push(&driving(), false)), Reply::Refused(Refusal::Estimating), "flash may cost ticks");
        assert!(bench.device.lent(), "{mode:?} ends with the host that has set it");
        assert_eq!(bench.ask(refer(0, 2.0)), Reply::Referred { next: 64, starved: 0 }, "{mode:?} counts from 0");
    }
    let next = |bench: &mut Bench, first| match bench.ask(refer(first, 10.0)) {
        Reply::Referred { next, starved: 0 } => next,
        reply => panic!("{reply:?}"),
    };
    // Those of the mode before leave the queue with the ticks.
    let (mut taken, start) = (64, Instant::now());
    while taken < 255 {
        assert!(start.elapsed() < Duration::from_secs(20), "{taken} are taken");
        taken = next(&mut bench, taken);
    }
    assert_eq!(next(&mut bench, 255), 255, "nothing is taken before it is to go");
    assert_eq!(
        bench.ask(Request::Refer { first: 255, references: Default::default(), go: true, hold: true }),
        Reply::Referred { next: 255, starved: 0 }
    );
    let start = Instant::now();
    while next(&mut bench, 255) == 255 {
        assert!(start.elapsed() < Duration::from_secs(10), "ticks make room");
    }
}

/// A device that follows, and what runs so many of its ticks.
fn following() -> (Bench, impl FnMut(u32)) {
    let (mut tick, link) = started(Startup::new(Some(&driving()), &FACTS, Faults::empty()));
    let mut bench = Bench::still(Some(driving()), link);
    bench.device.queues.commands.enqueue(Command::SetMode(Mode::Follow)).unwrap();
    let mut clock = 0u32;
    let mut run = move |ticks: u32| {
        for _ in 0..ticks {
            tick.sample(triangle(clock).into(), clock.wrapping_mul(PERIOD));
            clock += 1;
        }
    };
    run(1);
    (bench, run)
}

#[test]
fn references_that_come_twice_are_taken_once_and_none_behind_a_gap() {
    let (mut bench, mut run) = following();
    let mut refer = |first, count, go| {
        let references = (first..first + count).map(|k| k as f32 * 1e-3).collect();
        match bench.ask(Request::Refer { first, references, go, hold: false }) {
            Reply::Referred { next, starved } => (next, starved),
            reply => panic!("{reply:?}"),
        }
    };
    assert_eq!(refer(0, 0, false), (0, 0), "how far it is");
    assert_eq!(refer(0, 20, true), (20, 0));
    assert_eq!(refer(0, 20, true), (20, 0), "its reply was lost");
    assert_eq!(refer(30, 10, true), (20, 0), "ten are missing");
    assert_eq!(refer(10, 20, true), (30, 0), "ten of them are new");
    // Thirty references, and five ticks that find none.
    run(35);
    assert_eq!(refer(10, 20, true), (30, 0), "as they were taken: nothing was starved");
    assert_eq!(refer(30, 10, true), (40, 5));
    run(12);
    assert_eq!(refer(20, 10, true), (40, 5), "a frame that is late");
    assert_eq!(refer(40, 1, true), (41, 7));
}

/// A host that dies behind a frame of which a part found no room leaves nothing on the way that is held.
#[test]
fn the_displacement_is_held_once_the_last_reference_is_in() {
    let (mut bench, mut run) = following();
    let mut taken = 0;
    let refer = |bench: &mut Bench, first: u32| {
        let references = (first..300).take(64).map(|k| k as f32 * 1e-3).collect();
        let last = first + 64 >= 300;
        match bench.ask(Request::Refer { first, references, go: last, hold: last }) {
            Reply::Referred { next, .. } => next,
            reply => panic!("{reply:?}"),
        }
    };
    for _ in 0..5 {
        taken = refer(&mut bench, taken);
    }
    assert!((236..300).contains(&taken), "the queue is full within the last frame: {taken}");
    run(60);
    assert_eq!(bench.device.telemetry.following(), Following::UntilTimeout, "references are missing");
    assert_eq!(refer(&mut bench, taken), 300);
    run(1);
    assert_eq!(bench.device.telemetry.following(), Following::UntilModeEnds);
}
