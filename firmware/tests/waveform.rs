//! A waveform from the memory, line after line, by itself or by a trigger.

mod common;

use common::driven::{Bench, REST, STRIDE};
use common::{PERIOD, driving};
use core::num::NonZeroU16;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Admitted, DacCode, Inverse, Pace, Transition};
use firmware::queues::Command;
use firmware::supply::Measured;
use firmware::watch::{HOLD, SATURATED};
use protocol::{Faults, Mode, Playback};

/// A line that comes back to where it begins.
const ROUND: [f32; 4] = [10.0, 10.4, 10.6, 10.2];
/// A line that ends far from where it begins.
const SAW: [f32; 3] = [10.0, 15.0, 20.0];

fn how(points: &[f32], every: u16, lines: u32, on_trigger: bool) -> Playback {
    let number = |number: u16| NonZeroU16::new(number).expect("at least one");
    Playback { points: number(points.len() as u16), crc: 0, every: number(every), lines, on_trigger }
}

/// A driving tick that has a waveform.
struct Scanner {
    bench: Bench,
    /// The sync pin's level.
    sync: bool,
    /// Whether the trigger's pin is looked at.
    looks: bool,
}

impl Scanner {
    /// It begins with the next tick.
    fn new(points: &[f32], how: Playback) -> Self {
        let mut bench = Bench::new();
        bench.step();
        points.iter().enumerate().for_each(|(at, &um)| bench.link.points.set(at, um));
        bench.link.queues.commands.enqueue(Command::Play(how)).unwrap();
        Self { bench, sync: false, looks: false }
    }

    /// A tick with the trigger input at this level: the code that it gives, its faults, and whether it is of a first
    /// point. No step is longer than the slew rate allows.
    fn step(&mut self, trigger: bool) -> (DacCode, Faults, bool) {
        let before = self.bench.dac;
        if self.looks {
            self.bench.tick.trigger(trigger);
        }
        let (dac, _, faults) = self.bench.step();
        assert!(dac.0.abs_diff(before.0) <= STRIDE, "tick {}: {before:?} → {dac:?}", self.bench.k);
        // As the board does when the code begins to be put out.
        let sync = self.bench.tick.sync();
        (self.sync, self.looks) = (sync.unwrap_or(self.sync), sync.is_some());
        (dac, faults, self.sync)
    }

    fn run(&mut self, ticks: u32) -> (DacCode, Faults, bool) {
        (0..ticks).map(|_| self.step(false)).last().expect("at least one tick")
    }

    /// Until a line begins.
    fn until_sync(&mut self) {
        assert!((0..5_000).any(|_| self.step(false).2), "no line begins");
    }

    fn lines(&self) -> u32 {
        self.bench.link.telemetry.lines.load(Relaxed)
    }

    fn ignored(&self) -> u32 {
        self.bench.link.telemetry.triggers_ignored.load(Relaxed)
    }
}

/// The inverse that the drive runs, and the code for its voltage.
fn core() -> (Admitted, Inverse<f32>) {
    let table = driving();
    let inverse = table.inverse::<f32>(&table.drive.unwrap().limits).unwrap();
    (table, inverse)
}

#[test]
fn each_tick_wants_what_lies_between_two_points_and_the_way_to_the_first_one_is_unhurried() {
    let every = 50;
    let mut scanner = Scanner::new(&ROUND, how(&ROUND, every, 0, false));
    let (table, mut inverse) = core();
    let pace = Pace::of(&table).unwrap();
    // The tick before.
    let from = inverse.release().displacement;
    let ticks = pace.ticks(from, ROUND[0]);
    assert!(ticks > 50, "{ticks}: the way takes its time");
    let way = Transition::new(from, ROUND[0], ticks);
    let mut command = |um: f32| table.drive.unwrap().code(inverse.tick(um).voltage, 4095);
    let line = ROUND.len() as u32 * u32::from(every);
    for tick in 1..ticks + 20 * line {
        let Some(k) = tick.checked_sub(ticks) else {
            let (dac, faults, sync) = scanner.step(false);
            assert_eq!((dac, faults, sync), (command(way.at(tick)), Faults::empty(), false), "on the way, tick {tick}");
            continue;
        };
        let (point, behind) = ((k % line / u32::from(every)) as usize, k % u32::from(every));
        let next = ROUND[(point + 1) % ROUND.len()];
        let wanted = ROUND[point] + (next - ROUND[point]) * (behind as f32 * (1.0 / f32::from(every)));
        let (dac, faults, sync) = scanner.step(false);
        assert_eq!((dac, faults, sync), (command(wanted), Faults::empty(), point == 0), "tick {k}: {wanted} µm");
    }
    assert_eq!(scanner.lines(), 20);
}

#[test]
fn a_way_back_that_would_be_a_jump_takes_its_time_and_each_line_as_long_as_the_others() {
    let every = 100;
    let mut scanner = Scanner::new(&SAW, how(&SAW, every, 0, false));
    scanner.until_sync();
    let back = Pace::of(&driving()).unwrap().ticks(SAW[2], SAW[0]);
    assert!(back > u32::from(every), "{back}");
    let line = 2 * u32::from(every) + back;
    for k in 1..10 * line {
        let (_, faults, sync) = scanner.step(false);
        let rises = k % line < u32::from(every);
        assert_eq!((faults, sync), (Faults::empty(), rises), "tick {} of {line}", k % line);
    }
    assert_eq!(scanner.lines(), 10);
}

#[test]
fn after_the_last_line_it_goes_to_rest_and_stays_there() {
    for (name, points, every, line) in [("round", &ROUND[..], 50, 200), ("saw", &SAW, 100, 201)] {
        let back = Pace::of(&driving()).unwrap().back(points[points.len() - 1], points[0], every);
        assert_eq!(back.is_some(), name == "saw");
        let mut scanner = Scanner::new(points, how(points, every, 3, false));
        scanner.until_sync();
        let before = 2 * back.map_or(line, |back| line - 1 + back);
        let (_, faults, _) = scanner.run(before + line - 1);
        assert!(faults.is_empty() && scanner.lines() == 3, "{name}: {faults:?}, {} lines", scanner.lines());
        assert!(scanner.bench.link.telemetry.plays(), "{name}");
        assert_eq!(scanner.step(false).1, Faults::SAFE_OUTPUT, "{name}");
        assert!(!scanner.bench.link.telemetry.plays(), "{name}: its memory is free");
        let (dac, faults, sync) = scanner.run(3_000);
        assert_eq!((dac, faults, sync), (REST, Faults::SAFE_OUTPUT, false), "{name}");
        assert_eq!((scanner.lines(), scanner.bench.link.telemetry.mode()), (3, Mode::Waveform), "{name}");
    }
}

#[test]
fn each_rising_edge_begins_a_line_and_those_during_one_are_counted() {
    let mut scanner = Scanner::new(&ROUND, how(&ROUND, 10, 0, true));
    for k in 0..4_000 {
        assert!(!scanner.step(true).2, "high from the start on, tick {k}");
    }
    for k in 0..2_000 {
        assert!(!scanner.step(false).2, "an open pin, tick {k}");
    }
    let held = scanner.bench.dac;
    assert!(held.0 > REST.0 + 100, "it waits at its first point: {held:?}");
    for line in 1..=3 {
        assert!(scanner.step(true).2, "the very tick that sees the edge");
        let mut first = 1;
        for tick in 1..40 {
            // It stays high for a while; and there are two more edges within the line.
            let (_, _, sync) = scanner.step(tick < 15 || tick == 20 || tick == 39);
            first += u32::from(sync);
        }
        assert_eq!((first, scanner.lines(), scanner.ignored()), (10, line, 2 * line));
        // High since the line's last tick: no edge.
        assert!((0..50).all(|_| !scanner.step(true).2), "line {line}");
        scanner.run(1);
    }
}

#[test]
fn an_edge_before_the_first_point_is_reached_is_counted_and_begins_nothing() {
    let mut scanner = Scanner::new(&ROUND, how(&ROUND, 10, 0, true));
    scanner.run(3);
    scanner.step(true);
    assert_eq!((scanner.lines(), scanner.ignored()), (0, 1));
    assert!((0..3_000).all(|_| !scanner.step(false).2));
}

#[test]
fn without_triggers_the_input_says_nothing() {
    let mut scanner = Scanner::new(&ROUND, how(&ROUND, 10, 0, false));
    for k in 0..4_000 {
        scanner.step(k % 3 == 0);
    }
    assert!(scanner.lines() > 50 && scanner.ignored() == 0, "{}, {}", scanner.lines(), scanner.ignored());
}

#[test]
fn every_way_out_is_a_ramp() {
    type End = fn(&mut Scanner);
    let ends: [(&str, End); 8] = [
        ("estimate", |scanner| scanner.bench.set(Mode::Estimate)),
        ("pause, as a reset does first", |scanner| scanner.bench.set(Mode::Pause)),
        ("pil", |scanner| scanner.bench.set(Mode::Pil)),
        ("follow", |scanner| scanner.bench.set(Mode::Follow)),
        ("excite", |scanner| scanner.bench.set(Mode::Excite)),
        ("supply", |scanner| {
            scanner.bench.link.telemetry.supply.publish(&Measured::of(Some(3000.0)));
        }),
        ("monitor", |scanner| {
            for _ in 0..SATURATED + 200 {
                let before = scanner.bench.dac;
                let (dac, ..) = scanner.bench.step_with(AdcCode(65_520));
                assert!(dac.0.abs_diff(before.0) <= STRIDE);
            }
        }),
        ("late ticks", |scanner| {
            for _ in 0..SATURATED + 200 {
                let before = scanner.bench.dac;
                let late = (scanner.bench.k + 1) * 3 * PERIOD;
                let dac = DacCode(scanner.bench.tick.sample(scanner.bench.amplifier().into(), late).0);
                (scanner.bench.dac, scanner.bench.k) = (dac, scanner.bench.k + 1);
                assert!(dac.0.abs_diff(before.0) <= STRIDE);
            }
            let telemetry = scanner.bench.link.telemetry;
            assert!(!telemetry.plays() && telemetry.mode() == Mode::Waveform, "late ticks are a fault, which ends it");
        }),
    ];
    for (name, end) in ends {
        let mut scanner = Scanner::new(&SAW, how(&SAW, 200, 0, false));
        scanner.until_sync();
        let (high, ..) = scanner.run(300);
        assert!(high.0 > REST.0 + 200, "{name}: {high:?}");
        end(&mut scanner);
        let (dac, faults, sync) = scanner.run(2_000);
        assert!(dac == REST && faults.contains(Faults::SAFE_OUTPUT) && !sync, "{name}: {dac:?} {faults:?}");
        let lines = scanner.lines();
        assert_eq!(
            (scanner.run(HOLD + 2_000).0, scanner.lines()),
            (REST, lines),
            "{name}: it is not begun again by itself"
        );
    }
}

#[test]
fn points_that_are_too_far_apart_for_their_difference_neither_jump_nor_stay() {
    let far = [10.0, f32::MAX, f32::MIN, 10.0];
    let mut scanner = Scanner::new(&far, how(&far, 40, 3, false));
    scanner.until_sync();
    scanner.run(2 * 160);
    assert_eq!(scanner.lines(), 3);
    let (mut low, mut high) = (u16::MAX, 0);
    for _ in 0..160 {
        let DacCode(code) = scanner.step(false).0;
        (low, high) = (low.min(code), high.max(code));
    }
    assert!(high - low > 10 * STRIDE, "{low} … {high}: it goes where it is wanted as far as it may");
    let (dac, faults, _) = scanner.run(3_000);
    assert_eq!((dac, faults), (REST, Faults::SAFE_OUTPUT));
    // What the inverse remembers is a number still.
    let again = how(&ROUND, 10, 0, false);
    ROUND.iter().enumerate().for_each(|(at, &um)| scanner.bench.link.points.set(at, um));
    scanner.bench.link.queues.commands.enqueue(Command::Play(again)).unwrap();
    scanner.until_sync();
    assert!(scanner.run(400).0.0 > REST.0 + 100);
}
