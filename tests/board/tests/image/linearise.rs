//! The box that linearises: a controller's set-point in by the third channel, the amplifier's command out by the
//! DAC, no host.

use crate::common::{Bench, FULL, PARTS, PERIOD, shown, valid_since};
use anyhow::Result;
use board_emulator_test::{Reset, Stop};
use estimator_core::*;
use protocol::{Faults, Mode, Request};
use std::cell::Cell;
use std::rc::Rc;

/// 20 mV or 20.48 codes a tick.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const STRIDE: u16 = 21;
/// Half a volt.
const REST: u16 = 512;
/// −5 … 45 µm.
const SETPOINT: SetpointCalibration =
    SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start: true };
/// Ticks from the trigger that samples a set-point to the one that puts the command for it out.
const LATENCY: usize = 1;
/// Seconds at rest before a set-point is followed.
const CALM: f64 = 1.0;

fn driving(at_start: bool) -> DriveCalibration {
    let setpoint = Some(SetpointCalibration { at_start, ..SETPOINT });
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint }
}

/// The code of a displacement that is wanted, µm.
fn code(um: f32) -> u16 {
    ((um - SETPOINT.offset_um) / SETPOINT.gain_um_per_code) as u16
}

/// A swing, with a converter's noise.
fn sine(n: u64) -> u16 {
    code(20.0 + 12.0 * (n as f32 * 0.02).sin()) + (n % 2) as u16
}

/// A device with a controller and an amplifier, just started, its first latch, and its first sequence that
/// reads the set-point.
fn controlled(at_start: bool, setpoint: impl FnMut(u64) -> u16 + 'static) -> Result<(Bench, usize, usize)> {
    let mut bench = Bench::started()?;
    let table = Table { drive: Some(driving(at_start)), ..*bench.table()? }.admit()?;
    bench.push(&table)?;
    bench.connect(&table, |volts| volts);
    bench.board.feed_setpoint(setpoint);
    let fed = bench.board.record().conversions.len();
    bench.restart()?;
    let start = bench.board.record().outputs.len();
    Ok((bench, start, fed))
}

/// Ends what goes on, by the device's host, its board or its controller's input.
type End = dyn Fn(&mut Bench, &Cell<Option<u16>>) -> Result<()>;

/// From the latch `start` on no step is longer than the slew rate allows.
fn never_jumps(name: &str, bench: &Bench, start: usize) {
    for pair in shown(bench.board.record(), start).windows(2) {
        let (step, ticks) =
            (pair[0].code.abs_diff(pair[1].code), (pair[1].clock - pair[0].clock) as f64 / PERIOD as f64);
        assert!(step == 0 || step <= STRIDE * PARTS && ticks > 0.95, "{name}: {pair:?}, {ticks} ticks");
    }
}

#[test]
fn without_a_host_each_set_point_is_the_inverse_s_command_a_tick_later() -> Result<()> {
    let (mut bench, start, fed) = controlled(true, sine)?;
    bench.run(0.9)?;
    assert_eq!((bench.board.output(), bench.health()?.mode), (Some(REST), Mode::Linearise), "it looks before it moves");
    bench.run(3.0)?;
    never_jumps("sine", &bench, start);
    let health = bench.health()?;
    assert_eq!((health.faults, health.missed, health.mode), (Faults::empty(), 0, Mode::Linearise));
    let swing = bench.board.record().outputs[start..].iter().map(|latch| latch.code);
    assert!(swing.clone().max() > Some(REST + 1000), "{:?}", swing.max());

    let (mut inverse, drive) = (bench.table()?.inverse::<f32>(&LIMITS)?, driving(true).finer(PARTS));
    // The code that a sequence's set-point gives comes out with the trigger after it.
    let record = bench.board.record();
    let latches = shown(record, start);
    let put_out = |n: usize| {
        let trigger = record.conversions[fed + n + LATENCY].trigger;
        latches[latches.partition_point(|latch| latch.clock < trigger)].code
    };
    let from = record.conversions[fed..].partition_point(|conversion| conversion.trigger < record.outputs[start].clock);
    let ticks = from..record.conversions.len() - fed - LATENCY - 1;
    let moves = ticks.clone().find(|&n| put_out(n) != PARTS * REST).expect("it sets out");
    for n in moves..ticks.end.min(moves + 3_000) {
        let wanted = SETPOINT.displacement::<f32>(AdcCode(sine(n as u64)));
        assert_eq!(
            put_out(n),
            drive.code(inverse.tick(wanted).voltage, FULL).0,
            "sequence {n}, it sets out at {moves}"
        );
    }
    Ok(())
}

#[test]
fn the_latency_is_one_tick_from_trigger_to_trigger() -> Result<()> {
    let wanted = Rc::new(Cell::new(code(15.0)));
    let at = wanted.clone();
    let (mut bench, start, _) = controlled(true, move |n| at.get() + (n % 2) as u16)?;
    bench.run(3.0)?;
    let before = bench.board.output().expect("it is driven");
    wanted.set(code(25.0));
    let clock = bench.board.clock();
    bench.run(0.05)?;
    never_jumps("step", &bench, start);
    let record = bench.board.record();
    // The first trigger whose conversions end after the step.
    let sampled = record.conversions.iter().find(|conversion| conversion.end > clock).expect("it goes on").trigger;
    let moved = record.outputs.iter().find(|latch| latch.clock > clock && latch.code >= before + STRIDE / 2);
    let moved = moved.expect("it sets out").clock;
    let ticks = (moved - sampled) as f64 / PERIOD as f64;
    println!("the DAC moves {ticks:.3} ticks after the trigger that samples the set-point");
    assert!((ticks - LATENCY as f64).abs() < 0.01, "{ticks}");
    Ok(())
}

#[test]
fn whatever_ends_it_brings_it_to_rest_without_a_jump_and_there_it_stays() -> Result<()> {
    let ended = |name: &str, end: &End, fault: Faults| -> Result<()> {
        let broken = Rc::new(Cell::new(None));
        let input = broken.clone();
        let (mut bench, start, _) = controlled(true, move |n| input.get().unwrap_or_else(|| sine(n)))?;
        bench.run(CALM + 0.5)?;
        assert!(bench.board.output() > Some(REST + 300), "{name}: {:?}", bench.board.output());
        let clock = bench.board.clock();
        assert!(valid_since(&bench.board, clock - 100 * PERIOD) > 90, "{name}: VALID");
        end(&mut bench, &broken)?;
        bench.run(0.02)?;
        let ended = bench.board.clock();
        bench.run(0.3)?;
        never_jumps(name, &bench, start);
        assert_eq!(bench.board.output(), Some(REST), "{name}");
        assert!(bench.health()?.faults.contains(fault | Faults::SAFE_OUTPUT), "{name}: {:?}", bench.health()?.faults);
        assert_eq!(valid_since(&bench.board, ended), 0, "{name}: VALID is silent");
        // The input comes back, and the fault passes.
        broken.set(None);
        bench.run(1.5 + CALM)?;
        assert_eq!(bench.board.output(), Some(REST), "{name}: it stays until it is told again");
        never_jumps(name, &bench, start);
        Ok(())
    };
    let breaks = |code: u16| {
        move |_: &mut Bench, input: &Cell<Option<u16>>| {
            input.set(Some(code));
            Ok(())
        }
    };
    ended("an open wire that reads nothing", &breaks(0), Faults::SETPOINT)?;
    ended("an open wire that reads everything", &breaks(65_520), Faults::SETPOINT)?;
    ended(
        "the monitor",
        &|bench, _| {
            bench.board.connect(|_, _| 65_520);
            Ok(())
        },
        Faults::ADC_SATURATED,
    )?;
    ended("told to estimate", &|bench, _| bench.does(Request::SetMode(Mode::Estimate)), Faults::empty())?;
    ended("told to follow", &|bench, _| bench.does(Request::SetMode(Mode::Follow)), Faults::empty())
}

#[test]
fn a_reset_brings_it_to_rest_first_and_it_sets_out_again_as_the_table_says() -> Result<()> {
    for at_start in [true, false] {
        let (mut bench, start, _) = controlled(at_start, sine)?;
        if !at_start {
            bench.run(1.2)?;
            assert_eq!(bench.board.output(), Some(REST), "nobody has asked it to");
            bench.does(Request::SetMode(Mode::Linearise))?;
        }
        bench.run(CALM + 0.5)?;
        assert!(bench.board.output() > Some(REST + 300));
        bench.reset()?;
        assert_eq!(bench.board.run(0.5)?, Stop::Reset(Reset::Software));
        never_jumps("reset", &bench, start);
        assert_eq!(bench.board.record().outputs.last().map(|latch| latch.code), Some(REST));
        bench.reboot(Reset::Software)?;
        let start = bench.board.record().outputs.len();
        bench.run(CALM + 0.5)?;
        assert_eq!(bench.board.output() > Some(REST + 300), at_start);
        never_jumps("start", &bench, start);
    }
    Ok(())
}

#[test]
fn after_a_failure_it_does_not_set_out_of_itself() -> Result<()> {
    const ICSR: u32 = 0xE000_ED04;
    const NMIPENDSET: u32 = 1 << 31;
    let (mut bench, start, _) = controlled(true, sine)?;
    bench.run(CALM + 0.5)?;
    bench.board.poke(ICSR, NMIPENDSET)?;
    assert_eq!(bench.board.run(0.5)?, Stop::Reset(Reset::Software));
    never_jumps("panic", &bench, start);
    bench.reboot(Reset::Software)?;
    bench.run(CALM + 0.5)?;
    assert_eq!((bench.board.output(), bench.health()?.mode), (Some(REST), Mode::Estimate));
    Ok(())
}
