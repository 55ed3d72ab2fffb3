//! Where the DAC drives the amplifier its voltage never jumps: whatever ends the drive, the code goes to rest at
//! the slew rate.

use crate::common::{Bench, PARTS, PERIOD, shown, valid_since};
use anyhow::{Result, ensure};
use board_emulator_test::{Latch, Reset, Stop, exception};
use estimator_core::*;
use protocol::{Faults, Mode, Refusal, Reply, Request, Samples};

/// 20 mV or 20.48 codes a tick.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
const STRIDE: u16 = 21;
/// Half a volt.
const REST: u16 = 512;
/// Memory behind the image's.
const SPARE: u32 = 0x2001_F000;
/// Nothing is there.
const NOWHERE: u32 = 0x6000_0000;
/// ICSR, with the bit that asks for an NMI: a panic.
const ICSR: u32 = 0xE000_ED04;
const NMIPENDSET: u32 = 1 << 31;

/// NVIC_ISER0 and NVIC_ICER0, a bit an interrupt to be enabled or not.
const NVIC_ISER0: u32 = 0xE000_E100;
const NVIC_ICER0: u32 = 0xE000_E180;
/// NVIC_ISPR0, a bit an interrupt to be taken.
const NVIC_ISPR0: u32 = 0xE000_E200;
const TICK: u32 = 1 << (exception::ADC1_2 - 16);
/// TIM7_CR1, whose bit 0 lets it count, and its count.
const TIM7_CR1: u32 = 0x4000_1400;
const TIM7_CNT: u32 = 0x4000_1424;
/// The channel of DMA1 that brings the DAC's codes, whose bit 0 has it on.
const DMA1_CCR2: u32 = 0x4002_001C;

/// The modes that drive, and a reference far from rest: µm, V.
const DRIVING: [(Mode, f32); 2] = [(Mode::Follow, 30.0), (Mode::Excite, 3.0)];

/// A device whose amplifier has been driven far from rest, which the ADC reads, and the first latch on the way.
fn driven(driving_mode: (Mode, f32)) -> Result<(Bench, usize)> {
    let (mut bench, start) = driving(driving_mode)?;
    bench.run(0.1)?;
    assert!(bench.board.output() > Some(REST + 1000), "{:?}", bench.board.output());
    Ok((bench, start))
}

/// The same, on its way there.
fn driving(driving_mode: (Mode, f32)) -> Result<(Bench, usize)> {
    driving_amplifier(driving_mode, None)
}

/// The same with an amplifier of which is said how fast it can go, V/s.
fn driving_amplifier((mode, reference): (Mode, f32), slew: Option<f32>) -> Result<(Bench, usize)> {
    let mut bench = Bench::started()?;
    let table = Table { drive: Some(DRIVE), amplifier_slew_v_per_s: slew, ..*bench.table()? }.admit()?;
    bench.connect(&table, |volts| volts);
    bench.push(&table)?;
    bench.restart()?;
    bench.does(Request::SetMode(mode))?;
    let start = bench.board.record().outputs.len();
    let references = [reference; 64].iter().copied().collect();
    let reply = bench.ask(Request::Refer { first: 0, references, go: true, hold: true })?;
    ensure!(reply == Reply::Referred { next: 64, starved: 0 }, "{reply:?}");
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
    smooth(name, &bench.board.record().outputs[start..]);
    let codes: Vec<u16> = outputs.iter().map(|latch| latch.code).collect();
    assert!(codes.iter().max() > Some(&(PARTS * (REST + 1000))), "{name}: it was never away");
    assert_eq!(codes.last(), Some(&(PARTS * REST)), "{name}");
}

/// The pin itself never jumps: a step of more than the two neighbours that the mean is made of is no longer than a
/// tick's, with the other neighbour on either side, and comes a tick after the last.
fn smooth(name: &str, outputs: &[Latch]) {
    let mut before: Option<u64> = None;
    for pair in outputs.windows(2) {
        let step = pair[0].code.abs_diff(pair[1].code);
        if step > 1 {
            let ticks = before.replace(pair[1].clock).map_or(1.0, |last| (pair[1].clock - last) as f64 / PERIOD as f64);
            assert!(step <= STRIDE + 1 && ticks > 0.95, "{name}: {pair:?}, {ticks} ticks");
        }
    }
}

#[test]
fn every_change_of_mode() -> Result<()> {
    for driving_mode in DRIVING {
        for mode in [Mode::Estimate, Mode::Pause, Mode::Pil, Mode::Follow, Mode::Excite] {
            let (mut bench, start) = driven(driving_mode)?;
            bench.does(Request::SetMode(mode))?;
            bench.run(0.1)?;
            went_to_rest(&format!("{driving_mode:?} to {mode:?}"), &bench, start);
        }
    }
    Ok(())
}

#[test]
fn a_main_loop_that_hangs_is_seen_by_the_tick_which_has_it_at_rest_before_the_watchdog_bites() -> Result<()> {
    for driving_mode in DRIVING {
        let (mut bench, start) = driven(driving_mode)?;
        let clock = bench.board.clock();
        // `b .`, in the main loop: every interrupt goes on.
        bench.board.poke(SPARE, 0xE7FE_E7FE)?;
        bench.board.jump(SPARE);
        bench.run(0.14)?;
        went_to_rest(&format!("{driving_mode:?}"), &bench, start);
        // 60 ms, and up to 20 ms since the main loop's last word; then nothing.
        let good = valid_since(&bench.board, clock);
        assert!((80..=122).contains(&good), "{driving_mode:?}: {good} good ticks");
        assert_eq!(bench.board.run(0.1)?, Stop::Reset(Reset::Watchdog), "{driving_mode:?}");
        assert_eq!(bench.board.output(), Some(REST), "{driving_mode:?}");
        bench.reboot(Reset::Watchdog)?;
        bench.run(0.1)?;
        let faults = bench.health()?.faults_seen;
        assert_eq!(faults, Faults::empty(), "{driving_mode:?}: the next start knows of none");
    }
    Ok(())
}

#[test]
fn a_reset_that_is_asked_for() -> Result<()> {
    let (mut bench, start) = driven(DRIVING[0])?;
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
    let failures: [(&str, Failure); 6] = [
        ("panic", |bench| bench.board.poke(ICSR, NMIPENDSET)),
        ("DMA", |bench| bench.board.poke(DMA1_CCR2, 0)),
        ("DMA has", |bench| bench.board.poke(TIM7_CR1, 0)),
        // Whatever the tick finds its place in the ring to be.
        ("DMA has stopped", |bench| {
            bench.run(0.000_19)?;
            bench.board.poke(TIM7_CR1, 0)
        }),
        ("the DAC's DMA", |bench| {
            // Goes on, out of step: some codes come later.
            for _ in 0..4 {
                bench.board.poke(TIM7_CNT, 0)?;
                bench.run(0.000_009)?;
            }
            Ok(())
        }),
        ("hard fault", |bench| {
            bench.board.jump(NOWHERE);
            Ok(())
        }),
    ];
    for (name, fail) in failures {
        let (mut bench, start) = driven(DRIVING[1])?;
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
fn ticks_that_do_not_come_or_come_late() -> Result<()> {
    // Ticks for which none is served.
    for ticks in [0.7, 0.95, 1.0, 1.2, 1.5, 1.97, 3.0, 3.6, 5.5] {
        let (mut bench, start) = driving(DRIVING[1])?;
        let name = format!("{ticks} ticks");
        let miss = |bench: &mut Bench| -> Result<()> {
            bench.run(0.02)?;
            let before = bench.board.output();
            assert!(before > Some(REST + 100) && before < Some(REST + 2_000), "{name}: {before:?} is amid the way");
            bench.board.poke(NVIC_ICER0, TICK)?;
            bench.run(ticks * 0.000_5)?;
            bench.board.poke(NVIC_ISER0, TICK)?;
            bench.run(0.1)
        };
        miss(&mut bench)?;
        assert!(bench.board.output() > Some(REST + 2_500), "{name}: it arrives");
        bench.does(Request::SetMode(Mode::Estimate))?;
        miss(&mut bench)?;
        let missed = bench.health()?.missed;
        assert!(
            ticks < 1.5 || f64::from(missed) >= 2.0 * (ticks - 1.0).floor().max(1.0),
            "{name}: {missed} are missed"
        );
        went_to_rest(&name, &bench, start);
    }
    Ok(())
}

/// However slow the core has become, the pin follows ticks that are good, or is at rest before the watchdog bites:
/// what a fault commands takes less of a tick than what was followed before it.
#[test]
fn ticks_that_take_too_long() -> Result<()> {
    let mut stopped = 0;
    for clocks in (40..=80).step_by(4) {
        let (mut bench, start) = driven(DRIVING[1])?;
        bench.board.slow(f64::from(clocks));
        bench.board.run(0.5)?;
        if valid_since(&bench.board, bench.board.clock() - 20 * PERIOD) > 10 {
            continue;
        }
        // At this pace DMA may come for codes that are still being written: then two ticks' change is seen at once.
        let mut steps = bench.board.record().outputs[start..].windows(2);
        let most = 2 * STRIDE + 1;
        assert!(steps.all(|pair| pair[0].code.abs_diff(pair[1].code) <= most), "{clocks} clocks an instruction");
        assert_eq!(bench.board.output(), Some(REST), "{clocks} clocks an instruction");
        stopped += 1;
    }
    assert!((1..11).contains(&stopped), "{stopped} of 11 were too slow");
    Ok(())
}

#[test]
fn ticks_that_are_done_just_before_their_trigger_or_just_after() -> Result<()> {
    let mut missed = Vec::new();
    // Their interrupt's delay beyond the conversion, µs: some 430 lie between that and the trigger. After the longest
    // the next tick is done a few µs later.
    for delay_us in (380..450).step_by(2).chain(421..428) {
        let (mut bench, start) = driving(DRIVING[1])?;
        bench.run(0.02)?;
        for _ in 0..5 {
            let ticks = bench.board.record().conversions.len();
            bench.board.poke(NVIC_ICER0, TICK)?;
            bench.board.run_until(0.001, |board| board.record().conversions.len() > ticks)?;
            bench.run(f64::from(delay_us) * 1e-6)?;
            bench.board.poke(NVIC_ISER0, TICK)?;
            bench.run(0.002)?;
        }
        missed.push(bench.health()?.missed);
        bench.run(0.1)?;
        bench.does(Request::SetMode(Mode::Estimate))?;
        bench.run(0.1)?;
        went_to_rest(&format!("{delay_us} µs late"), &bench, start);
    }
    println!("missed, of five that come 380 µs late and so on in steps of 2 µs, then 421 to 427 µs: {missed:?}");
    assert!(missed.iter().all(|&missed| missed >= 5));
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
    for (driving_mode, (name, plant)) in
        DRIVING.into_iter().flat_map(|driving_mode| plants.map(|plant| (driving_mode, plant)))
    {
        let name = format!("{name}, {driving_mode:?}");
        let (mut bench, start) = driven(driving_mode)?;
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
fn a_monitor_that_comes_off_while_driving_is_a_fault_after_ten_milliseconds() -> Result<()> {
    for driving_mode in DRIVING {
        // As slow as the drive: nothing that it does itself is held.
        let (mut bench, start) = driving_amplifier(driving_mode, Some(LIMITS.slew_v_per_s))?;
        bench.does(Request::Stream(true))?;
        bench.run(0.5)?;
        assert_eq!(bench.health()?.faults_seen, Faults::empty(), "{driving_mode:?}");
        let samples = bench.samples.iter().flat_map(Samples::numbered);
        let (moving, said) = samples.fold((0, Status::empty()), |(moving, said), (_, sample)| {
            (moving + u32::from(sample.dac > REST), said | sample.status)
        });
        assert!(moving > 900 && !said.contains(Status::SLEW_EXCEEDED), "{driving_mode:?}: {moving} samples, {said:?}");
        let table = bench.table()?;
        bench.connect(&table, |_| 1.0);
        let clock = bench.board.clock();
        bench.run(0.009)?;
        assert!(bench.board.output() > Some(REST + 1000), "{driving_mode:?}: a glitch may be over by then");
        bench.run(0.2)?;
        went_to_rest(&format!("open, {driving_mode:?}"), &bench, start);
        let health = bench.health()?;
        assert!(health.faults.contains(Faults::SLEW_EXCEEDED | Faults::SAFE_OUTPUT), "{driving_mode:?}: {health:?}");
        assert_eq!(valid_since(&bench.board, clock + 25 * PERIOD), 0, "{driving_mode:?}: VALID is silent");
    }
    Ok(())
}

#[test]
fn a_crystal_that_stops_amid_the_way_of_a_panic() -> Result<()> {
    for driving_mode in DRIVING {
        let (mut bench, start) = driven(driving_mode)?;
        // An interrupt that has no handler.
        bench.board.poke(NVIC_ISER0, 1)?;
        bench.board.poke(NVIC_ISPR0, 1)?;
        bench.run(0.02)?;
        ensure!(bench.board.output() > Some(REST + 500), "{driving_mode:?}: it has arrived");
        bench.board.break_crystal();
        assert_eq!(bench.board.run(1.0)?, Stop::Reset(Reset::Software), "{driving_mode:?}");
        went_to_rest(&format!("{driving_mode:?}, panic and crystal"), &bench, start);
        bench.reboot(Reset::Software)?;
        bench.run(0.2)?;
        let words = bench.health()?.last_words.unwrap_or_default();
        assert!(words.contains("interrupt 0 has no handler"), "{words}");
    }
    Ok(())
}

#[test]
fn a_crystal_that_stops() -> Result<()> {
    for driving_mode in DRIVING {
        let (mut bench, start) = driven(driving_mode)?;
        let clock = bench.board.clock();
        bench.board.break_crystal();
        assert_eq!(bench.board.run(1.0)?, Stop::Reset(Reset::Software), "{driving_mode:?}");
        went_to_rest(&format!("{driving_mode:?}, crystal"), &bench, start);
        assert_eq!(valid_since(&bench.board, clock + PERIOD), 0, "{driving_mode:?}: VALID has died");
        bench.reboot(Reset::Software)?;
        bench.run(0.2)?;
        let health = bench.health()?;
        let words = health.last_words.unwrap_or_default();
        assert!(words.contains("the crystal has stopped"), "{words}");
        assert_eq!(
            (health.faults, bench.board.output()),
            (Faults::CLOCK | Faults::SAFE_OUTPUT, Some(REST)),
            "{driving_mode:?}"
        );
        for mode in [Mode::Follow, Mode::Excite] {
            assert_eq!(bench.ask(Request::SetMode(mode))?, Reply::Refused(Refusal::Faulty), "{driving_mode:?}");
        }
        bench.board.mend_crystal();
        bench.restart()?;
        bench.run(0.1)?;
        assert_eq!(bench.health()?.faults, Faults::SAFE_OUTPUT, "{driving_mode:?}: it waits to be told");
    }
    Ok(())
}
