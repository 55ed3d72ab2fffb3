//! Where the DAC drives the amplifier its voltage never jumps: whatever ends the drive, the code goes to rest at the slew rate.

use crate::common::{Bench, PARTS, PERIOD, shown, valid_since};
use anyhow::{Result, ensure};
use board_emulator_test::{Reset, Stop};
use estimator_core::*;
use protocol::{Faults, Mode, Refusal, Reply, Request};

/// 20 mV or 20.48 codes a tick.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
const STRIDE: u16 = 21;
/// Half a volt.
const REST: u16 = 512;
/// Nothing is there.
const NOWHERE: u32 = 0x6000_0000;
/// ICSR, with the bit that asks for an NMI: a panic.
const ICSR: u32 = 0xE000_ED04;
const NMIPENDSET: u32 = 1 << 31;

/// The channel of DMA1 that brings the DAC's codes, whose bit 0 has it on.
const DMA1_CCR2: u32 = 0x4002_001C;

/// The modes that drive, and a reference far from rest: µm, V.
const WAYS: [(Mode, f32); 2] = [(Mode::Follow, 30.0), (Mode::Excite, 3.0)];

/// A device whose amplifier has been driven far from rest, which the ADC reads, and the first latch on the way.
fn driven((mode, reference): (Mode, f32)) -> Result<(Bench, usize)> {
    let mut bench = Bench::started()?;
    let table = Table { drive: Some(DRIVE), ..*bench.table()? }.admit()?;
    bench.connect(&table, |volts| volts);
    bench.push(&table)?;
    bench.restart()?;
    bench.does(Request::SetMode(mode))?;
    let start = bench.board.record().outputs.len();
    let references = [reference; 64].iter().copied().collect();
    let reply = bench.ask(Request::Refer { first: 0, references, go: true, hold: true })?;
    ensure!(reply == Reply::Referred { next: 64, starved: 0 }, "{reply:?}");
    bench.run(0.1)?;
    assert!(bench.board.output() > Some(REST + 1000), "{:?}", bench.board.output());
    Ok((bench, start))
}

/// From the latch `start` on no step is longer than the slew rate allows, and the last code is rest.
fn went_to_rest(name: &str, bench: &Bench, start: usize) {
    let outputs = shown(bench.board.record(), start);
    for pair in outputs.windows(2) {
        let (step, ticks) =
            (pair[0].code.abs_diff(pair[1].code), (pair[1].clock - pair[0].clock) as f64 / PERIOD as f64);
        assert!(step == 0 || step <= STRIDE * PARTS && ticks > 0.95, "{name}: {pair:?}, {ticks} ticks");
    }
    let codes: Vec<u16> = outputs.iter().map(|latch| latch.code).collect();
    assert!(codes.iter().max() > Some(&(PARTS * (REST + 1000))), "{name}: it was never away");
    assert_eq!(codes.last(), Some(&(PARTS * REST)), "{name}");
}

#[test]
fn every_change_of_mode() -> Result<()> {
    for way in WAYS {
        for mode in [Mode::Estimate, Mode::Pause, Mode::Pil, Mode::Follow, Mode::Excite] {
            let (mut bench, start) = driven(way)?;
            bench.does(Request::SetMode(mode))?;
            bench.run(0.1)?;
            went_to_rest(&format!("{way:?} to {mode:?}"), &bench, start);
        }
    }
    Ok(())
}

#[test]
fn a_reset_that_is_asked_for() -> Result<()> {
    let (mut bench, start) = driven(WAYS[0])?;
    let ticks = bench.board.output().map_or(0.0, |code| f32::from(code - REST) / 20.48);
    let in_ms = bench.reset()?;
    assert!((in_ms as f32 - ticks / 2.0).abs() < 3.0, "{in_ms} ms for {ticks} ticks");
    assert_eq!(bench.board.run(0.5)?, Stop::Reset(Reset::Software));
    went_to_rest("reset", &bench, start);
    // Nothing moved until the drive was told to go, and nothing moves after the reset.
    bench.reboot(Reset::Software)?;
    bench.run(0.05)?;
    went_to_rest("start", &bench, start);
    Ok(())
}

#[test]
fn a_panic_a_hard_fault_and_a_dac_that_gets_no_codes() -> Result<()> {
    type Failure = fn(&mut Bench) -> Result<()>;
    let failures: [(&str, Failure); 3] = [
        ("panic", |bench| bench.board.poke(ICSR, NMIPENDSET)),
        ("DMA", |bench| bench.board.poke(DMA1_CCR2, 0)),
        ("hard fault", |bench| {
            bench.board.jump(NOWHERE);
            Ok(())
        }),
    ];
    for (name, fail) in failures {
        let (mut bench, start) = driven(WAYS[1])?;
        fail(&mut bench)?;
        // Longer than the watchdog's period, were the rest ten times as far.
        assert_eq!(bench.board.run(0.5)?, Stop::Reset(Reset::Software), "{name}");
        went_to_rest(name, &bench, start);
        bench.reboot(Reset::Software)?;
        let words = bench.health()?.last_words.unwrap_or_default();
        assert!(words.contains(name), "{name}: {words}");
    }
    Ok(())
}

#[test]
fn an_amplifier_that_does_not_go_along() -> Result<()> {
    type Amplifier = fn(f32) -> f32;
    let plants: [(&str, Amplifier); 3] = [
        ("an open wire", |_| 1.0),
        ("a tripped amplifier", |_| 0.0),
        ("a span a quarter too wide", |volts| 1.25 * volts),
    ];
    for (way, (name, plant)) in WAYS.into_iter().flat_map(|way| plants.map(|plant| (way, plant))) {
        let name = format!("{name}, {way:?}");
        let (mut bench, start) = driven(way)?;
        let table = bench.table()?;
        // The command moves as the model creeps; it must stand for the fault to come at its earliest.
        bench.run(0.4)?;
        bench.connect(&table, plant);
        let clock = bench.board.clock();
        // It is a fault after 100 ms.
        bench.run(0.09)?;
        assert!(bench.board.output() > Some(REST + 1000), "{name}: not at once");
        bench.run(0.21)?;
        went_to_rest(&name, &bench, start);
        let health = bench.health()?;
        assert!(health.faults.contains(Faults::AMPLIFIER | Faults::SAFE_OUTPUT), "{name}: {health:?}");
        assert!(valid_since(&bench.board, clock + 240 * PERIOD) == 0, "{name}: VALID is silent");
    }
    Ok(())
}

#[test]
fn a_crystal_that_stops() -> Result<()> {
    for way in WAYS {
        let (mut bench, start) = driven(way)?;
        let clock = bench.board.clock();
        bench.board.break_crystal();
        assert_eq!(bench.board.run(1.0)?, Stop::Reset(Reset::Software), "{way:?}");
        went_to_rest(&format!("{way:?}, crystal"), &bench, start);
        assert_eq!(valid_since(&bench.board, clock + PERIOD), 0, "{way:?}: VALID has died");
        bench.reboot(Reset::Software)?;
        bench.run(0.2)?;
        let health = bench.health()?;
        let words = health.last_words.unwrap_or_default();
        assert!(words.contains("the crystal has stopped"), "{words}");
        assert_eq!((health.faults, bench.board.output()), (Faults::CLOCK | Faults::SAFE_OUTPUT, Some(REST)), "{way:?}");
        for mode in [Mode::Follow, Mode::Excite] {
            assert_eq!(bench.ask(Request::SetMode(mode))?, Reply::Refused(Refusal::Faulty), "{way:?}");
        }
        bench.board.mend_crystal();
        bench.restart()?;
        bench.run(0.1)?;
        assert_eq!(bench.health()?.faults, Faults::SAFE_OUTPUT, "{way:?}: it waits to be told");
    }
    Ok(())
}
