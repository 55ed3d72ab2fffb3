//! VALID, the lamp and the button: VALID has an edge at every good tick and none within a tick of anything else. What
//! the ADC may bring is in `faults`.

use crate::common::{Bench, CONVERSION, PERIOD, triangle, valid, valid_since};
use anyhow::Result;
use board_emulator_test::{Board, Pin, Port, Reset, Stop, exception};
use protocol::{Faults, Mode, Reply, Request};

const LAMP: Pin = Pin { port: Port::A, number: 5 };
const BUTTON: Pin = Pin { port: Port::C, number: 13 };
/// Clocks from a trigger within which its tick's edge has come: the conversion, and a generous tick.
const SOON: u64 = CONVERSION + 2000;
/// TIM6_CR1, whose bit 0 lets it count; NVIC_ISER0 and NVIC_ICER0, a bit an interrupt to be enabled or not.
const TIM6_CR1: u32 = 0x4000_1000;
const NVIC_ISER0: u32 = 0xE000_E100;
const NVIC_ICER0: u32 = 0xE000_E180;
const TICK: u32 = 1 << (exception::ADC1_2 - 16);
/// ICSR, with the bit that asks for an NMI; memory behind the image's; nothing is there.
const ICSR: u32 = 0xE000_ED04;
const NMIPENDSET: u32 = 1 << 31;
const SPARE: u32 = 0x2001_F000;
const NOWHERE: u32 = 0x6000_0000;

/// A device that has estimated for a while.
fn running() -> Result<Bench> {
    let mut bench = Bench::started()?;
    bench.run(0.1)?;
    Ok(bench)
}

#[test]
fn every_good_tick_has_one_edge_soon_after_its_conversion() -> Result<()> {
    let bench = running()?;
    let record = bench.board.record();
    let after = |edge: u64| {
        let next = record.conversions.partition_point(|conversion| conversion.trigger <= edge);
        edge - record.conversions[next - 1].trigger
    };
    // The pin is switched on low, which is no edge of a tick; the first tick takes over what it owns, and is longer.
    let edges = &valid(&bench.board)[2..];
    assert!(edges.len() + 3 > record.conversions.len(), "{} of {}", edges.len(), record.conversions.len());
    assert!(edges.iter().all(|edge| after(edge.clock) < SOON));
    assert!(edges.windows(2).all(|pair| pair[1].clock - pair[0].clock > PERIOD / 2 && pair[1].high != pair[0].high));
    Ok(())
}

#[test]
fn no_edge_comes_where_nothing_is_estimated() -> Result<()> {
    for mode in [Mode::Pause, Mode::Pil] {
        let mut bench = running()?;
        bench.does(Request::SetMode(mode))?;
        let clock = bench.board.clock();
        bench.run(0.1)?;
        assert_eq!(valid_since(&bench.board, clock), 0, "{mode:?}");
        bench.does(Request::SetMode(Mode::Estimate))?;
        bench.run(0.1)?;
        assert!(valid_since(&bench.board, clock) > 150, "{mode:?}: it goes on");
    }
    Ok(())
}

#[test]
fn no_edge_comes_after_a_fault_that_has_cost_the_zero_until_it_is_told_anew() -> Result<()> {
    let mut bench = running()?;
    bench.does(Request::SetZero { at_um: 0.0 })?;
    bench.board.feed(|_| 65_520);
    bench.run(0.05)?;
    bench.board.feed(triangle);
    bench.run(1.1)?;
    let clock = bench.board.clock();
    bench.run(0.5)?;
    assert_eq!((bench.health()?.faults, valid_since(&bench.board, clock)), (Faults::ZERO_LOST, 0));
    let safe = bench.table()?.dac.code(0.0f32).0;
    assert_ne!(bench.board.output(), Some(safe), "it is shown relative to the model's zero");
    bench.does(Request::SetZero { at_um: 0.0 })?;
    let clock = bench.board.clock();
    bench.run(0.1)?;
    assert_eq!(bench.health()?.faults, Faults::empty());
    assert!(valid_since(&bench.board, clock) > 190);
    Ok(())
}

#[test]
fn it_dies_with_the_tick_and_lives_again_after_the_reset() -> Result<()> {
    type Failure = fn(&mut Bench) -> Result<()>;
    let failures: [(&str, Failure, Stop); 6] = [
        ("the trigger stops", |bench| bench.board.poke(TIM6_CR1, 0), Stop::Reset(Reset::Watchdog)),
        ("the interrupt is off", |bench| bench.board.poke(NVIC_ICER0, TICK), Stop::Reset(Reset::Watchdog)),
        ("panic", |bench| bench.board.poke(ICSR, NMIPENDSET), Stop::Reset(Reset::Software)),
        (
            "hard fault",
            |bench| {
                bench.board.jump(NOWHERE);
                Ok(())
            },
            Stop::Reset(Reset::Software),
        ),
        (
            "lock-up",
            |bench| {
                // `mov sp, r0` with r0 = 0x6000_0000 (`movs r0, #3; lsls r0, #29`), and an entry has no stack.
                bench.board.poke(SPARE, 0x0740_2003)?;
                bench.board.poke(SPARE + 4, 0xDE00_4685)?;
                bench.board.jump(SPARE);
                Ok(())
            },
            Stop::Lockup,
        ),
        (
            "interrupts masked",
            |bench| {
                // `cpsid i; b .`
                bench.board.poke(SPARE, 0xE7FE_B672)?;
                bench.board.jump(SPARE);
                Ok(())
            },
            Stop::Reset(Reset::Watchdog),
        ),
    ];
    for (name, fail, stop) in failures {
        let mut bench = running()?;
        let clock = bench.board.clock();
        fail(&mut bench)?;
        assert_eq!(bench.board.run(1.0)?, stop, "{name}");
        // That of a tick which had begun.
        let late = valid(&bench.board).iter().filter(|edge| edge.clock > clock + PERIOD).count();
        assert!(late == 0, "{name}: {late} edges more than a tick later");
        let clock = bench.board.clock();
        bench.reboot(Reset::Watchdog)?;
        // The pin is switched on; nothing was estimated yet.
        assert_eq!(valid_since(&bench.board, clock), 1, "{name}");
        bench.run(0.05)?;
        assert!(valid_since(&bench.board, clock) > 90, "{name}: it lives again");
    }
    Ok(())
}

#[test]
fn a_late_tick_has_no_edge() -> Result<()> {
    let mut bench = running()?;
    bench.board.poke(NVIC_ICER0, TICK)?;
    bench.run(3.2 * PERIOD as f64 / 170e6)?;
    bench.board.poke(NVIC_ISER0, TICK)?;
    let (clock, ticks) = (bench.board.clock(), bench.board.record().services[&exception::ADC1_2].len());
    bench.board.run_until(0.01, |board| board.record().services[&exception::ADC1_2].len() > ticks + 4)?;
    let served = &bench.board.record().services[&exception::ADC1_2][ticks..];
    let edges: Vec<usize> = served
        .windows(2)
        .map(|pair| valid_since(&bench.board, pair[0].entry) - valid_since(&bench.board, pair[1].entry))
        .collect();
    assert!(served[0].entry >= clock);
    assert_eq!(edges, [0, 1, 1, 1]);
    assert!(bench.health()?.missed > 0);
    Ok(())
}

/// The lamp's changes in the next second.
fn blinks(bench: &mut Bench) -> Result<usize> {
    let clock = bench.board.clock();
    bench.run(1.0)?;
    let edges = bench.board.record().edges.get(&LAMP).map_or(&[][..], Vec::as_slice);
    Ok(edges.iter().filter(|edge| edge.clock >= clock).count())
}

#[test]
fn the_lamp_tells_good_paused_and_faulty_apart() -> Result<()> {
    let mut bench = running()?;
    assert_eq!(blinks(&mut bench)?, 0);
    assert!(bench.board.record().edges[&LAMP].last().is_some_and(|edge| edge.high));
    bench.does(Request::SetMode(Mode::Pause))?;
    assert_eq!(blinks(&mut bench)?, 2);
    bench.does(Request::SetMode(Mode::Estimate))?;
    bench.board.feed(|_| 65_520);
    bench.run(0.1)?;
    // Begun between two changes, a second ends between two.
    let changes = |board: &Board| board.record().edges[&LAMP].len();
    let before = changes(&bench.board);
    bench.board.run_until(1.0, |board| changes(board) > before)?;
    bench.run(0.05)?;
    assert_eq!(blinks(&mut bench)?, 10);
    Ok(())
}

#[test]
fn the_button_calls_the_displacement_of_now_zero() -> Result<()> {
    let mut bench = Bench::started()?;
    bench.run(0.5)?;
    assert_eq!(bench.health()?.bias_age_ticks, None);
    bench.board.drive(BUTTON, true);
    bench.run(0.2)?;
    bench.board.drive(BUTTON, false);
    let health = bench.health()?;
    assert!(health.bias_age_ticks.is_some_and(|age| (250..400).contains(&age)), "{health:?}");
    assert!(bench.board.record().edges[&LAMP].last().is_some_and(|edge| !edge.high), "the lamp says so");
    // Where nothing is estimated it does nothing.
    bench.run(0.1)?;
    bench.does(Request::SetMode(Mode::Pause))?;
    bench.board.drive(BUTTON, true);
    bench.run(0.2)?;
    assert_eq!(bench.health()?.bias_age_ticks, None);
    assert_eq!(bench.ask(Request::SetZero { at_um: 0.0 })?, Reply::Refused(protocol::Refusal::NotEstimating));
    Ok(())
}

#[test]
fn a_button_that_is_held_during_a_reset_does_nothing_when_it_is_released() -> Result<()> {
    let mut bench = Bench::started()?;
    bench.board.drive(BUTTON, true);
    bench.reboot(Reset::Pin)?;
    bench.run(0.2)?;
    bench.board.drive(BUTTON, false);
    bench.run(0.2)?;
    assert_eq!(bench.health()?.bias_age_ticks, None);
    bench.board.drive(BUTTON, true);
    bench.run(0.2)?;
    assert!(bench.health()?.bias_age_ticks.is_some(), "pressed again, it is obeyed");
    Ok(())
}
