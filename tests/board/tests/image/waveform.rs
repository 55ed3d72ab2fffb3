//! A scanner: a waveform from the board's memory, with a trigger in and a sync out, and no host.

use crate::common::{Bench, CONVERSION, FULL, PARTS, PERIOD, shown, valid_since};
use anyhow::Result;
use board_emulator_test::{Edge, Pin, Port, Reset, Stop};
use estimator_core::*;
use protocol::waveform::checksum;
use protocol::{Faults, Mode, Playback, Reply, Request};
use std::num::NonZeroU16;

/// 20 mV or 20.48 codes a tick.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const STRIDE: u16 = 21;
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
/// Half a volt.
const REST: u16 = 512;
const TRIGGER: Pin = Pin { port: Port::B, number: 5 };
const SYNC: Pin = Pin { port: Port::C, number: 7 };
/// Clocks from a trigger of the converter within which the sync pin has changed.
const SOON: u64 = CONVERSION + 500;
/// MODER's value of an input.
const INPUT: u32 = 0;
/// GPIOB's PUPDR, and of it the trigger's bits; 2 is a pull-down.
const PUPDR: u32 = 0x4800_040C;

const POINTS: [f32; 3] = [10.0, 10.3, 10.1];
const EVERY: u16 = 40;
const LINE: usize = POINTS.len() * EVERY as usize;

fn how(lines: u32, on_trigger: bool) -> Playback {
    let number = |number: u16| NonZeroU16::new(number).expect("at least one");
    let points = number(POINTS.len() as u16);
    Playback { points, crc: checksum(POINTS.into_iter()), every: number(EVERY), lines, on_trigger }
}

/// A device that drives an amplifier, plays, and its first latch.
fn scanner(how: Playback) -> Result<(Bench, usize)> {
    let mut bench = Bench::started()?;
    let table = Table { drive: Some(DRIVE), ..*bench.table()? }.admit()?;
    bench.push(&table)?;
    bench.connect(&table, |volts| volts);
    bench.restart()?;
    bench.run(0.1)?;
    let start = bench.board.record().outputs.len();
    let points = POINTS.into_iter().collect();
    assert_eq!(bench.ask(Request::Load { first: 0, points })?, Reply::Loaded(3));
    bench.does(Request::Play(how))?;
    Ok((bench, start))
}

/// From the latch `start` on no step is longer than the slew rate allows.
fn never_jumps(name: &str, bench: &Bench, start: usize) {
    for pair in shown(bench.board.record(), start).windows(2) {
        let (step, ticks) =
            (pair[0].code.abs_diff(pair[1].code), (pair[1].clock - pair[0].clock) as f64 / PERIOD as f64);
        assert!(step == 0 || step <= STRIDE * PARTS && ticks > 0.95, "{name}: {pair:?}, {ticks} ticks");
    }
}

/// The edges of the sync pin, but for the one that switches it on.
fn sync(bench: &Bench, since: u64) -> Vec<Edge> {
    let edges = bench.board.record().edges.get(&SYNC).map_or(&[][..], Vec::as_slice);
    edges.iter().copied().filter(|edge| edge.clock >= since).collect()
}

/// What is wanted in the line's tick of this number.
fn wanted(tick: usize) -> f32 {
    let (point, behind) = (tick % LINE / usize::from(EVERY), tick % usize::from(EVERY));
    let next = POINTS[(point + 1) % POINTS.len()];
    POINTS[point] + (next - POINTS[point]) * (behind as f32 * (1.0 / f32::from(EVERY)))
}

#[test]
fn an_edge_at_the_trigger_begins_a_line_whose_first_point_shows_at_the_sync_pin() -> Result<()> {
    let (mut bench, start) = scanner(how(0, true))?;
    let table = bench.table()?;
    let mut inverse = table.inverse::<f32>(&LIMITS)?;
    let from = (0..400).map(|_| inverse.release().displacement).last().expect("some ticks");
    let pace = Pace::of(&table).expect("it drives");
    let approach = pace.ticks(from, POINTS[0]);
    let way = Transition::new(from, POINTS[0], approach);
    let begun = bench.board.clock();
    bench.run(f64::from(approach) / 2e3 + 0.05)?;
    assert_eq!((bench.board.mode(TRIGGER), bench.board.plain(PUPDR) >> 10 & 3), (INPUT, 2), "it is pulled down");
    assert_eq!(sync(&bench, begun), [], "an open pin is no trigger");
    let held = bench.board.output().expect("it is driven");
    assert!(held > REST + 100, "it waits at its first point: {held}");

    bench.board.drive(TRIGGER, true);
    let raised = bench.board.clock();
    // An edge within the line is one too many.
    bench.run(0.01)?;
    bench.board.drive(TRIGGER, false);
    bench.run(0.01)?;
    bench.board.drive(TRIGGER, true);
    bench.run(LINE as f64 / 2e3 + 0.05)?;
    never_jumps("trigger", &bench, start);
    let health = bench.health()?;
    assert_eq!((health.lines, health.triggers_ignored, health.missed), (1, 1, 0));
    assert_eq!((health.mode, health.faults), (Mode::Waveform, Faults::empty()));

    // The tick that sees the edge is the line's first; its code, and the sync with it, come out a tick later.
    let edges = sync(&bench, begun);
    let [Edge { clock: rises, high: true }, Edge { clock: falls, high: false }] = edges[..] else {
        panic!("{edges:?}");
    };
    let record = bench.board.record();
    let sees = record.conversions.iter().find(|conversion| conversion.end > raised).expect("it goes on").trigger;
    let late = rises - (sees + PERIOD);
    println!("sync rises {late} clocks after the trigger that puts the first point out");
    assert!(late < SOON, "{late}");
    assert_eq!((falls - rises + PERIOD / 2) / PERIOD, u64::from(EVERY));
    assert!((falls - rises) % PERIOD < 100 || (falls - rises) % PERIOD > PERIOD - 100, "it has no jitter");

    // Each code is the inverse's, from the beginning of the way on.
    let latches = shown(record, start);
    let drive = DRIVE.finer(PARTS);
    let mut expected = |um: f32| drive.code(inverse.tick(um).voltage, FULL).0;
    let first = latches.partition_point(|latch| latch.clock < sees + PERIOD);
    let set_out = latches.iter().position(|latch| latch.code != PARTS * REST).expect("it moves");
    let mut ticks = (1..).map(|tick| expected(way.at(tick)));
    let still = ticks.by_ref().position(|code| code != PARTS * REST).expect("it moves");
    assert!(still < 20, "{still}");
    for (latch, code) in latches[set_out + 1..first].iter().zip(ticks) {
        assert_eq!(latch.code, code, "on the way to the first point, or there: {latch:?}");
    }
    for (tick, latch) in latches[first..].iter().take(LINE).enumerate() {
        assert_eq!(latch.code, expected(wanted(tick)), "the line's tick {tick}");
    }
    Ok(())
}

#[test]
fn it_plays_its_lines_without_a_word_from_the_host_and_goes_to_rest() -> Result<()> {
    // Longer than a host's lease, five seconds.
    let lines = 90;
    let (mut bench, start) = scanner(how(lines, false))?;
    let begun = bench.board.clock();
    bench.run(f64::from(lines) * LINE as f64 / 2e3 + 2.0)?;
    never_jumps("lines", &bench, start);
    let edges = sync(&bench, begun);
    assert_eq!(edges.len(), 2 * lines as usize);
    let line = LINE as u64 * PERIOD;
    assert!(
        edges.windows(3).all(|of| (of[2].clock - of[0].clock).abs_diff(line) < 100),
        "a line is as long as every other"
    );
    let last = edges.last().expect("some").clock;
    assert!(valid_since(&bench.board, begun) > lines as usize * LINE, "VALID");
    assert_eq!(valid_since(&bench.board, last + line), 0, "VALID is silent at rest");
    assert_eq!(bench.board.output(), Some(REST));
    assert_eq!((bench.health()?.lines, bench.health()?.faults), (lines, Faults::SAFE_OUTPUT));
    Ok(())
}

#[test]
fn whatever_ends_it_brings_it_to_rest_without_a_jump() -> Result<()> {
    type End = fn(&mut Bench) -> Result<()>;
    let ends: [(&str, End); 4] = [
        ("mode", |bench| bench.does(Request::SetMode(Mode::Estimate))),
        ("monitor", |bench| {
            bench.board.feed(|n| 65_519 + (n % 2) as u16);
            Ok(())
        }),
        // Three volts.
        ("supply", |bench| {
            bench.board.set_reference(16 * 1650);
            Ok(())
        }),
        ("reset", |bench| {
            bench.reset()?;
            let stop = bench.board.run(0.5)?;
            assert_eq!(stop, Stop::Reset(Reset::Software));
            bench.reboot(Reset::Software)
        }),
    ];
    for (name, end) in ends {
        let (mut bench, start) = scanner(how(0, false))?;
        bench.run(0.4)?;
        assert!(bench.board.output() > Some(REST + 100), "{name}: {:?}", bench.board.output());
        end(&mut bench)?;
        bench.run(1.0)?;
        never_jumps(name, &bench, start);
        assert_eq!(bench.board.output(), Some(REST), "{name}");
        let ended = bench.board.clock();
        bench.run(1.5)?;
        assert_eq!((bench.board.output(), sync(&bench, ended)), (Some(REST), Vec::new()), "{name}: it stays there");
    }
    Ok(())
}
