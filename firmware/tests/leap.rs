//! A monitor's voltage that leaps as the amplifier cannot: what is estimated, streamed and put out.

mod common;

use common::{LinkEnd, PERIOD, SAFE, compiled, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Admitted, Estimator, Status, Table};
use firmware::Tick;
use firmware::leap::TOO_LONG;
use firmware::queues::Command;
use firmware::rate::TICK_HZ;
use firmware::shaping::DacParts;
use firmware::supply::Measured;
use firmware::watch::HOLD;
use protocol::{Faults, Mode, Sample};

/// Three times what the triangle needs, 8 V/s.
const SLEW_V_PER_S: f32 = 24.0;
/// What an open input reads, far from the triangle where it is plugged off.
const OPEN: u16 = 6_000;
/// The tick at which it is.
const OFF: u32 = 800;

fn stated() -> Admitted {
    let table = Table { amplifier_slew_v_per_s: Some(SLEW_V_PER_S), ..*compiled() };
    table.admit().expect("a slew rate is all that it has more")
}

/// A tick that streams.
struct Bench {
    tick: Tick<'static>,
    link: LinkEnd,
    k: u32,
}

impl Bench {
    fn new(table: &Admitted) -> Self {
        let (tick, link) = tick(Some(table), Faults::empty());
        link.telemetry.streaming.store(true, Relaxed);
        Self { tick, link, k: 0 }
    }

    fn step(&mut self, code: u16) -> (DacParts, Sample) {
        self.k += 1;
        let dac = self.tick.sample(AdcCode(code).into(), self.k * PERIOD);
        (dac, self.link.queues.samples.dequeue().expect("a sample a tick").sample)
    }

    /// The tick that begins a mode, and its sample, if it gives one.
    fn begin(&mut self) -> Option<Sample> {
        self.k += 1;
        self.tick.sample(AdcCode(OPEN).into(), self.k * PERIOD);
        self.link.queues.samples.dequeue().map(|numbered| numbered.sample)
    }

    fn set(&mut self, mode: Mode) {
        self.link.queues.commands.enqueue(Command::SetMode(mode)).expect("there is room");
    }
}

/// The triangle with glitches of one tick, of 19, and at the ends of the range.
fn glitches(k: u32) -> u16 {
    match k {
        700 | 1_100 => 65_520,
        900..919 => 2_000,
        _ => triangle(k).0,
    }
}

#[test]
fn the_stream_has_the_codes_that_were_estimated_from_and_feeding_them_gives_its_bits() {
    let (mut bench, mut reference) = (Bench::new(&stated()), Estimator::<f32>::new(&stated()));
    let mut streamed = Vec::new();
    for k in 0..3_000 {
        let (dac, sample) = bench.step(glitches(k));
        let expected = reference.tick(AdcCode(sample.code));
        assert_eq!(sample.displacement.to_bits(), expected.displacement.to_bits(), "tick {k}");
        assert_eq!((dac.0, sample.faults), (expected.dac.0, Faults::empty()), "tick {k}");
        let leapt = glitches(k) != triangle(k).0;
        let behind = matches!(k, 701 | 1_101 | 919..938);
        let at_the_end = if glitches(k) == 65_520 { Status::ADC_SATURATED } else { Status::empty() };
        let said = if leapt || behind { Status::SLEW_EXCEEDED | at_the_end } else { Status::empty() };
        assert_eq!(sample.status, expected.status | said, "tick {k}");
        assert_eq!(sample.code == glitches(k), !leapt, "tick {k}");
        streamed.push(sample);
    }
    bench.set(Mode::Pil);
    bench.begin();
    for (k, sample) in streamed.iter().enumerate() {
        bench.link.queues.fed.enqueue(AdcCode(sample.code)).expect("there is room");
        let (_, fed) = bench.step(OPEN);
        assert_eq!((fed.code, fed.displacement.to_bits()), (sample.code, sample.displacement.to_bits()), "tick {k}");
    }
}

#[test]
fn a_glitch_costs_no_more_than_the_way_that_the_voltage_went_meanwhile() {
    let (mut bench, mut sound) = (Bench::new(&stated()), Estimator::<f32>::new(&compiled()));
    let (mut without, mut worst, mut unchecked) = (Bench::new(&compiled()), 0.0f32, 0.0f32);
    for k in 0..3_000 {
        let expected = sound.tick(triangle(k)).displacement;
        worst = worst.max((bench.step(glitches(k)).1.displacement - expected).abs());
        unchecked = unchecked.max((without.step(glitches(k)).1.displacement - expected).abs());
    }
    // 19 ticks of the triangle are 75 mV.
    assert!(worst < 1.0 && unchecked > 5.0, "{worst} µm, {unchecked} µm unchecked");
}

/// What an open input reads at a tick.
fn open(k: u32) -> u16 {
    OPEN + (k % 2) as u16
}

/// One whose displacement was told, and whose wire was then found to be off.
fn off() -> Bench {
    let mut bench = Bench::new(&stated());
    (0..OFF).for_each(|k| assert_eq!(bench.step(triangle(k).0).1.faults, Faults::empty(), "tick {k}"));
    bench.link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).expect("there is room");
    let (_, told) = bench.step(triangle(OFF).0);
    for k in 1..TOO_LONG {
        let (_, sample) = bench.step(open(k));
        assert_eq!((sample.code, sample.faults), (told.code, Faults::empty()), "tick {k}");
        assert!(sample.status.contains(Status::SLEW_EXCEEDED), "tick {k}");
    }
    let (dac, sample) = bench.step(open(0));
    assert_eq!((dac, sample.code, sample.faults), (SAFE, told.code, Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT));
    bench
}

#[test]
fn a_wire_that_comes_off_is_a_fault_for_as_long_as_it_is_off_and_leaves_no_zero() {
    let mut bench = off();
    let faulty = |(dac, sample): (DacParts, Sample), valid: bool, k: u32| {
        assert_eq!((dac, sample.faults), (SAFE, Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT), "tick {k}");
        assert!(!valid, "tick {k}");
    };
    for k in 0..5 * TICK_HZ {
        let found = bench.step(open(k));
        faulty(found, bench.tick.valid(), k);
    }
    // Plugged in again: a second later, and the tick at which all is forgotten still says so.
    for k in 0..TOO_LONG + HOLD {
        let found = bench.step(triangle(OFF + k).0);
        faulty(found, bench.tick.valid(), k);
    }
    let mut anew = Estimator::<f32>::new(&stated());
    for k in 0..100 {
        let code = triangle(OFF + TOO_LONG + HOLD + k);
        let (dac, sample) = bench.step(code.0);
        let expected = anew.tick(code);
        assert_eq!(
            (dac.0, sample.displacement.to_bits()),
            (expected.dac.0, expected.displacement.to_bits()),
            "tick {k}"
        );
        assert_eq!((sample.half_width, sample.status), (None, expected.status), "tick {k}");
        assert_eq!((sample.faults, bench.tick.valid()), (Faults::ZERO_LOST, false), "tick {k}: it had been told");
    }
    bench.link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).expect("there is room");
    let (_, sample) = bench.step(triangle(OFF + TOO_LONG + HOLD + 100).0);
    assert_eq!((sample.faults, bench.tick.valid()), (Faults::empty(), true), "it is told anew");
    assert!(bench.step(open(0)).1.status.contains(Status::SLEW_EXCEEDED));
}

#[test]
fn no_mode_that_is_set_ends_the_fault_of_a_wire_that_is_off() {
    let lasting = Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT;
    for between in [Mode::Pause, Mode::Pil, Mode::Estimate] {
        let mut bench = off();
        bench.set(between);
        (0..100).for_each(|_| _ = bench.begin());
        assert!(bench.link.telemetry.faults().contains(lasting), "{between:?}");
        bench.set(Mode::Estimate);
        bench.begin();
        for k in 0..2 * HOLD {
            let (dac, sample) = bench.step(open(k));
            assert_eq!((dac, sample.faults & lasting, bench.tick.valid()), (SAFE, lasting, false), "{between:?}, {k}");
        }
    }
}

/// Its code leaps where the correction for the supply does.
#[test]
fn a_supply_that_steps_does_not_call_a_wire_back_that_is_off() {
    let supply = |bench: &Bench, mv: f32| bench.link.telemetry.supply.publish(&Measured::of(Some(mv)));
    for mv in [3170.0, 3430.0] {
        let mut bench = Bench::new(&stated());
        supply(&bench, 3300.0);
        (0..OFF).for_each(|k| _ = bench.step(triangle(k).0));
        (0..HOLD).for_each(|k| _ = bench.step(65_000 + (k % 2) as u16));
        supply(&bench, mv);
        for mode in [Mode::Pause, Mode::Estimate] {
            bench.set(mode);
            bench.begin();
        }
        for k in 0..2 * HOLD {
            let (_, sample) = bench.step(65_000 + (k % 2) as u16);
            assert!(sample.faults.contains(Faults::SLEW_EXCEEDED), "{mv} mV, tick {k}");
        }
    }
}

#[test]
fn a_wire_that_comes_off_in_a_pause_or_while_codes_are_fed_is_a_fault_then_and_after_it() {
    let lasting = Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT;
    for between in [Mode::Pause, Mode::Pil] {
        let mut bench = Bench::new(&stated());
        (0..OFF).for_each(|k| _ = bench.step(triangle(k).0));
        bench.set(between);
        let tick = |bench: &mut Bench, code: u16| {
            if between == Mode::Pil {
                bench.link.queues.fed.enqueue(AdcCode(30_000)).expect("there is room");
            }
            bench.k += 1;
            bench.tick.sample(AdcCode(code).into(), bench.k * PERIOD);
            let sample = bench.link.queues.samples.dequeue().map(|numbered| numbered.sample);
            assert!(
                sample.is_none_or(|sample| sample.code == 30_000 && !sample.status.contains(Status::SLEW_EXCEEDED))
            );
            bench.link.telemetry.faults()
        };
        for k in 0..100 {
            assert_eq!(tick(&mut bench, triangle(OFF + k).0), Faults::SAFE_OUTPUT, "{between:?}, {k}");
        }
        for k in 1..=2 * TOO_LONG {
            let faults = if k < TOO_LONG { Faults::SAFE_OUTPUT } else { lasting };
            assert_eq!(tick(&mut bench, open(k)), faults, "{between:?}, {k}");
        }
        bench.set(Mode::Estimate);
        for k in 0..2 * HOLD {
            let (dac, sample) = bench.step(open(k));
            assert_eq!((dac, sample.faults, bench.tick.valid()), (SAFE, lasting, false), "{between:?}, {k}");
        }
    }
}

#[test]
fn a_wire_that_is_plugged_in_again_in_a_pause_is_back_a_second_later() {
    let mut bench = off();
    bench.set(Mode::Pause);
    bench.begin();
    let back = 2 * TOO_LONG + HOLD;
    for k in 0..back {
        bench.k += 1;
        bench.tick.sample(triangle(OFF + k).into(), bench.k * PERIOD);
    }
    bench.set(Mode::Estimate);
    for k in 0..HOLD {
        let (_, sample) = bench.step(triangle(OFF + back + k).0);
        assert!(
            !sample.faults.intersects(Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT),
            "tick {k}: {:?}",
            sample.faults
        );
    }
}

#[test]
fn fed_codes_are_not_judged_and_a_mode_begins_with_whatever_comes() {
    let mut bench = Bench::new(&stated());
    bench.step(30_000);
    for mode in [Mode::Pause, Mode::Estimate, Mode::Pil] {
        bench.set(mode);
        let first = bench.begin();
        assert_eq!(first.map(|sample| sample.code), (mode == Mode::Estimate).then_some(OPEN), "{mode:?}");
        assert!(first.is_none_or(|sample| !sample.status.contains(Status::SLEW_EXCEEDED)), "{mode:?}");
    }
    for code in [3_000, 60_000, 3_000].into_iter().cycle().take(60) {
        bench.link.queues.fed.enqueue(AdcCode(code)).expect("there is room");
        let (_, sample) = bench.step(OPEN);
        assert_eq!((sample.code, sample.faults), (code, Faults::SAFE_OUTPUT));
        assert!(!sample.status.contains(Status::SLEW_EXCEEDED));
    }
}
