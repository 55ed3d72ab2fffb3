//! When the firmware itself fails: watchdog, hard fault, panic. The output is safe, the device starts again
//! and tells why.

use crate::common::{Bench, valid_since};
use anyhow::Result;
use board_emulator_test::{Board, CORE_HZ, Reset, Stop, exception};
use protocol::{Health, Request, ResetCause};

/// TIM6_CR1, whose bit 0 lets it count.
pub const TIM6_CR1: u32 = 0x4000_1000;
/// The same of TIM7, which is the output's.
const TIM7_CR1: u32 = 0x4000_1400;
/// NVIC_ICER0, a bit an interrupt to be disabled.
const NVIC_ICER0: u32 = 0xE000_E180;
/// ICSR, with the bit that asks for an NMI.
const ICSR: u32 = 0xE000_ED04;
const NMIPENDSET: u32 = 1 << 31;
/// NVIC_ISER0 and NVIC_ISPR0, a bit an interrupt to be enabled and to be pending; one that the firmware does not use.
const NVIC_ISER0: u32 = 0xE000_E100;
const NVIC_ISPR0: u32 = 0xE000_E200;
const TIM2: u32 = 28;
/// Memory behind the image's.
const SPARE: u32 = 0x2001_F000;
/// The stack and, above it, the variables, as memory.x has them.
const STACK: std::ops::Range<u32> = 0x2000_0000..0x2000_F400;
const STATICS: std::ops::Range<u32> = 0x2000_F400..0x2001_C000;
/// Nothing is there.
pub const NOWHERE: u32 = 0x6000_0000;

/// A device that has run for a while, and its safe code.
pub fn running() -> Result<(Bench, u16)> {
    let mut bench = Bench::started()?;
    let safe = bench.table()?.dac.code(0.0f32).0;
    bench.run(0.1)?;
    assert_ne!(bench.board.output(), Some(safe));
    Ok((bench, safe))
}

/// Runs to the reset, which must come within `ms`, and over it.
pub fn resets(bench: &mut Bench, cause: Reset, ms: f64) -> Result<Health> {
    let clock = bench.board.clock();
    assert_eq!(bench.board.run(1.0)?, Stop::Reset(cause));
    assert!(bench.board.output().is_some(), "the pin is driven until the reset");
    let took = (bench.board.clock() - clock) as f64 * 1e3 / f64::from(CORE_HZ);
    assert!(took <= ms, "the reset comes after {took:.1} ms");
    println!("{cause:?} reset after {took:.3} ms");
    bench.reboot(cause)?;
    bench.health()
}

#[test]
fn a_tick_that_stops_is_the_watchdogs_to_end() -> Result<()> {
    let irq = exception::ADC1_2 - 16;
    for (address, value) in [(TIM6_CR1, 0), (NVIC_ICER0, 1 << irq)] {
        let (mut bench, _) = running()?;
        bench.board.poke(address, value)?;
        // The main loop goes on and answers.
        let ticks = bench.health()?.ticks;
        assert_eq!(bench.health()?.ticks, ticks);
        let health = resets(&mut bench, Reset::Watchdog, 221.0)?;
        assert_eq!((health.reset, health.last_words), (ResetCause::WATCHDOG | ResetCause::PIN, None));
        bench.run(0.5)?;
        assert!(bench.health()?.ticks > 900, "it ticks again");
    }
    Ok(())
}

#[test]
fn a_timer_of_the_output_that_stops_is_a_failure_wherever_it_stops() -> Result<()> {
    let (mut bench, safe) = running()?;
    // Among these it stops where the tick looks for it.
    for us in (0..500).step_by(5) {
        let ticks = bench.board.record().conversions.len();
        bench.board.run_until(0.001, |board| board.record().conversions.len() > ticks)?;
        bench.run(f64::from(us) * 1e-6)?;
        bench.board.poke(TIM7_CR1, 0)?;
        // By the tick after the next.
        assert_eq!(bench.board.run(1.1e-3)?, Stop::Reset(Reset::Software), "stopped {us} µs after a conversion");
        assert_eq!(bench.board.output(), Some(safe), "{us} µs");
        bench.reboot(Reset::Software)?;
        bench.run(0.01)?;
    }
    let words = bench.health()?.last_words.unwrap_or_default();
    assert!(words.contains("the DAC's DMA has stopped"), "{words}");
    Ok(())
}

#[test]
fn a_stack_that_grows_too_large_spoils_nothing_else_and_ends_in_a_fault() -> Result<()> {
    let (mut bench, _) = running()?;
    // `movs r0, #0xA5; 1: push {r0}; b 1b`, in memory that the image does not use.
    bench.board.poke(SPARE, 0xB401_20A5)?;
    bench.board.poke(SPARE + 4, 0xBF00_E7FD)?;
    bench.board.jump(SPARE);
    let pushed = |board: &Board, words: std::ops::Range<u32>| -> Result<usize> {
        let words = words.step_by(4).map(|at| board.peek(at)).collect::<Result<Vec<_>>>()?;
        Ok(words.into_iter().filter(|&word| word == 0xA5).count())
    };
    let before = pushed(&bench.board, STATICS)?;
    let clock = bench.board.clock();
    assert_eq!(bench.board.run(1.0)?, Stop::Lockup, "there is no stack for a handler");
    assert_eq!(valid_since(&bench.board, clock + CORE_HZ as u64 / 2_000), 0, "VALID has died");
    assert!(pushed(&bench.board, STACK)? > 1_000, "it has grown");
    assert_eq!(pushed(&bench.board, STATICS)?, before, "and stayed away from the variables");
    bench.reboot(Reset::Watchdog)?;
    assert_eq!(bench.health()?.reset, ResetCause::WATCHDOG | ResetCause::PIN);
    Ok(())
}

#[test]
fn a_main_loop_that_hangs_is_the_watchdogs_to_end() -> Result<()> {
    let (mut bench, safe) = running()?;
    // `b .`, in memory that the image does not use.
    bench.board.poke(SPARE, 0xE7FE_E7FE)?;
    bench.board.jump(SPARE);
    let ticks = bench.board.record().conversions.len();
    let health = resets(&mut bench, Reset::Watchdog, 201.0)?;
    assert_eq!(health.reset, ResetCause::WATCHDOG | ResetCause::PIN);
    let record = bench.board.record();
    assert!(record.conversions.len() - ticks > 350, "the tick goes on meanwhile");
    assert!(record.outputs[record.outputs.len() - 300..].iter().any(|latch| latch.code != safe));
    Ok(())
}

/// The device fails by `cause`: safe output, reset, and a message with these parts, until it is forgotten.
fn leaves_its_last_words(cause: impl Fn(&mut Bench) -> Result<()>, parts: &[&str]) -> Result<()> {
    let (mut bench, safe) = running()?;
    cause(&mut bench)?;
    assert_eq!(bench.board.run(1e-3)?, Stop::Reset(Reset::Software), "{parts:?}");
    assert_eq!(bench.board.output(), Some(safe), "{parts:?}");
    bench.reboot(Reset::Software)?;
    let health = bench.health()?;
    let words = health.last_words.expect("last words");
    println!("{words}");
    assert!(parts.iter().all(|part| words.contains(part)), "{words}");
    assert_eq!(health.reset, ResetCause::SOFTWARE | ResetCause::PIN);
    assert_eq!(bench.health()?.last_words.as_deref(), Some(&*words), "as often as it is asked");
    bench.does(Request::Forget)?;
    assert_eq!(bench.health()?.last_words, None);
    bench.restart()?;
    assert_eq!(bench.health()?.last_words, None);
    Ok(())
}

#[test]
fn a_hard_fault_leaves_its_place_and_status() -> Result<()> {
    // IBUSERR
    let message = "hard fault at 0x60000000, called from";
    leaves_its_last_words(
        |bench| {
            bench.board.jump(NOWHERE);
            Ok(())
        },
        &[message, "status 0x00000100"],
    )?;
    // BFARVALID, PRECISERR; `ldr r0, [pc]; ldr r0, [r0]`
    leaves_its_last_words(
        |bench| {
            bench.board.poke(SPARE, 0x6800_4800)?;
            bench.board.poke(SPARE + 4, NOWHERE)?;
            bench.board.jump(SPARE);
            Ok(())
        },
        &["hard fault at 0x2001f002", "status 0x00008200, address 0x60000000"],
    )?;
    // In the tick's interrupt.
    leaves_its_last_words(
        |bench| {
            let ticks = |board: &Board| board.record().services[&exception::ADC1_2].len();
            let before = ticks(&bench.board);
            assert_eq!(bench.board.run_until(1e-3, |board| ticks(board) > before)?, Stop::Condition);
            bench.board.jump(NOWHERE);
            Ok(())
        },
        &[message, "from 0xffffffe9"],
    )
}

#[test]
fn a_panic_leaves_its_message() -> Result<()> {
    leaves_its_last_words(
        |bench| bench.board.poke(ICSR, NMIPENDSET),
        &["panic", "non-maskable interrupt, flash ECC state 0x00000000", "failure.rs"],
    )?;
    leaves_its_last_words(
        |bench| {
            bench.board.poke(NVIC_ISER0, 1 << TIM2)?;
            bench.board.poke(NVIC_ISPR0, 1 << TIM2)
        },
        &["panic", "interrupt 28 has no handler"],
    )
}

/// Bytes that the firmware has logged for a probe, where they have not gone round: the write offset of the first
/// channel of RTT, whose control block begins with a name of 16 bytes.
fn logged(board: &Board) -> Result<u32> {
    let name = [*b"SEGG", *b"ER R"].map(u32::from_le_bytes);
    for at in STATICS.step_by(4) {
        if name == [board.peek(at)?, board.peek(at + 4)?] {
            return board.peek(at + 36);
        }
    }
    anyhow::bail!("there is no RTT")
}

#[test]
fn a_panic_is_told_to_a_probe() -> Result<()> {
    let (mut bench, safe) = running()?;
    let before = logged(&bench.board)?;
    bench.board.poke(ICSR, NMIPENDSET)?;
    assert_eq!(bench.board.run(1e-3)?, Stop::Reset(Reset::Software));
    assert!(logged(&bench.board)? > before + 40, "its message");
    assert_eq!(bench.board.output(), Some(safe));
    Ok(())
}

#[test]
fn last_words_survive_the_watchdog_and_the_pin_but_not_the_loss_of_power() -> Result<()> {
    for (cause, survives) in [(Reset::Pin, true), (Reset::Watchdog, true), (Reset::PowerOn, false)] {
        let (mut bench, _) = running()?;
        bench.board.jump(NOWHERE);
        assert_eq!(bench.board.run(1e-3)?, Stop::Reset(Reset::Software));
        bench.reboot(cause)?;
        assert_eq!(bench.health()?.last_words.is_some(), survives, "{cause:?}");
    }
    Ok(())
}
