//! From power-on to the first estimates: pins and clocks, the DAC's first code, the supply, why the device started.

use crate::common::{Bench, EARLY, PARTS, PERIOD, VALID, push, reseeded, shown, triangle, valid_since};
use anyhow::Result;
use board_emulator_test::{Board, Conversion, Image, Pin, Port, Reset, Stop};
use protocol::{Faults, Refusal, Reply, Request, ResetCause, TableSource};

/// Clocks of 16 MHz in the 100 ms that a crystal is waited for.
const PATIENCE: u64 = 1_600_000;
/// A register of GPIOA.
const AFRL: u32 = 0x4800_0020;

/// A register of DBGMCU: what stands still where a debugger halts the core. Bits of TIM5, TIM6, TIM7 and IWDG.
const APB1FZR1: u32 = 0xE004_2008;
const FROZEN: u32 = 1 << 3 | 1 << 4 | 1 << 5 | 1 << 12;

/// VREFINT's code at a supply, mV, added up sixteen times, where the factory read 1650 at 3.0 V.
fn reference(supply_mv: u32) -> u16 {
    (16 * 1650 * 3000 / supply_mv) as u16
}

/// Registers that the firmware touches and no model has a rule for: plain memory, which is enough for them.
const PLAIN: [(u32, &str); 26] = [
    (0x4000_7000, "PWR_CR1"),
    (0x4000_7008, "PWR_CR3"),
    (0x4000_8004, "LPUART_CR2"),
    (0x4001_0000, "SYSCFG_MEMRMP"),
    (0x4800_0004, "GPIOA_OTYPER"),
    (0x4800_0008, "GPIOA_OSPEEDR"),
    (0x4800_000C, "GPIOA_PUPDR"),
    (AFRL, "GPIOA_AFRL"),
    (0x4800_0404, "GPIOB_OTYPER"),
    (0x4800_0408, "GPIOB_OSPEEDR"),
    (0x4800_040C, "GPIOB_PUPDR"),
    (0x4800_0424, "GPIOB_AFRH"),
    (0x4800_0804, "GPIOC_OTYPER"),
    (0x4800_0808, "GPIOC_OSPEEDR"),
    (0x4800_080C, "GPIOC_PUPDR"),
    (0x4800_0824, "GPIOC_AFRH"),
    (0x5000_0034, "ADC_SQR2"),
    (0x5000_0038, "ADC_SQR3"),
    (0x5000_003C, "ADC_SQR4"),
    (0x5000_00B0, "ADC_DIFSEL"),
    (0x5000_0860, "DAC_STMODR"),
    (0xE000_1000, "DWT_CTRL"),
    (0xE000_ED88, "CPACR"),
    (0xE000_EDFC, "DEMCR"),
    (0xE004_2004, "DBGMCU_CR"),
    (APB1FZR1, "DBGMCU_APB1FZR1"),
];

#[test]
fn pins_clocks_and_converters_are_set_up() -> Result<()> {
    let bench = Bench::started()?;
    let board = &bench.board;
    let mode = |number| board.mode(Pin { port: Port::A, number });
    assert_eq!([0, 1, 4].map(mode), [3, 3, 3], "converters' pins are analogue");
    assert_eq!([2, 3].map(mode), [2, 2], "the link's pins are the UART's");
    assert_eq!(board.mode(VALID), 1, "VALID is an output");
    assert_eq!(board.plain(AFRL) >> 8 & 0xFF, 0xCC, "LPUART1 is alternate function 12");
    assert_eq!(board.oversampling(), (16, 0));
    assert_eq!(board.plain(APB1FZR1), FROZEN, "a debugger halts the timers with the core");
    let record = board.record();
    assert!(record.unclocked.is_empty(), "{:x?}", record.unclocked);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    let unknown: Vec<_> =
        record.plain.iter().filter(|address| PLAIN.iter().all(|(known, _)| known != *address)).collect();
    assert!(unknown.is_empty(), "registers {unknown:x?} need a model or, if plain memory will do, a line in PLAIN");
    Ok(())
}

#[test]
fn the_dac_shows_its_safe_code_first_and_nothing_else_before_the_first_estimate() -> Result<()> {
    let mut bench = Bench::started()?;
    let safe = bench.table()?.dac.code(0.0f32).0;
    for cause in [Reset::PowerOn, Reset::Pin, Reset::Watchdog] {
        let before = bench.board.record().outputs.len();
        bench.board.reboot(cause)?;
        assert_eq!(bench.board.output(), None, "{cause:?}");
        let clock = bench.board.clock();
        bench.start()?;
        bench.run(0.01)?;
        let record = bench.board.record();
        let first = record.conversions.iter().find(|conversion| conversion.trigger > clock).map(|first| first.trigger);
        let outputs = shown(record, before);
        let safe = PARTS * safe;
        let early = outputs.iter().take_while(|latch| Some(latch.clock) <= first).collect::<Vec<_>>();
        println!(
            "{cause:?}: the pin is driven after {:.2} ms, the first estimate is out after {:.2} ms",
            (early[0].clock - clock) as f64 / 170e3,
            (outputs[early.len()].clock - clock) as f64 / 170e3
        );
        assert!(
            early.len() > 1 && early.iter().all(|latch| latch.code == safe),
            "{cause:?}: {early:?}, safe is {safe}"
        );
        assert!(outputs.len() > early.len() + 15 && outputs[early.len()].code != safe, "{cause:?}: it estimates then");
    }
    Ok(())
}

#[test]
fn the_first_trigger_is_a_period_before_the_second() -> Result<()> {
    let mut bench = Bench::started()?;
    bench.run(0.01)?;
    let triggers: Vec<u64> =
        bench.board.record().conversions.iter().map(|Conversion { trigger, .. }| *trigger).collect();
    assert!(triggers.len() > 15 && triggers.windows(2).all(|pair| pair[1] - pair[0] == PERIOD), "{triggers:?}");
    // A tick's first code is out before its trigger.
    let outputs = &bench.board.record().outputs;
    for trigger in &triggers[..2] {
        let early = outputs.iter().rev().find_map(|latch| trigger.checked_sub(latch.clock)).expect("codes before it");
        println!("a tick's first code is out {early} clocks before its trigger");
        assert!((1..=EARLY).contains(&early), "{early} clocks");
    }
    Ok(())
}

#[test]
fn a_supply_out_of_tolerance_at_the_start_makes_the_output_safe_from_there_on() -> Result<()> {
    let mut bench = Bench::started()?;
    for (supply_mv, good) in [(3000, false), (3120, false), (3150, true), (3300, true), (3450, true), (3480, false)] {
        bench.board.set_reference(reference(supply_mv));
        bench.reboot(Reset::PowerOn)?;
        let (first, clock) = (bench.board.record().outputs.len(), bench.board.clock());
        let safe = bench.table()?.dac.code(0.0f32).0;
        bench.run(0.05)?;
        let health = bench.health()?;
        let measured = u32::from(health.supply_mv.expect("the board can measure it"));
        assert!(measured.abs_diff(supply_mv) <= 2, "{supply_mv} mV, measured {measured}");
        assert_eq!(
            health.faults,
            if good { Faults::empty() } else { Faults::SUPPLY | Faults::SAFE_OUTPUT },
            "{supply_mv} mV"
        );
        assert_eq!(valid_since(&bench.board, clock) > 0, good, "{supply_mv} mV");
        let shown = &bench.board.record().outputs[first..];
        assert_eq!(shown[2..].iter().all(|latch| latch.code == safe), !good, "{supply_mv} mV");
    }
    Ok(())
}

#[test]
fn a_supply_that_sags_is_a_fault_within_70_ms_and_until_a_second_after() -> Result<()> {
    let mut bench = Bench::started()?;
    let safe = bench.table()?.dac.code(0.0f32).0;
    bench.run(0.1)?;
    let about = |mv: u16| move |found: u16| found.abs_diff(mv) <= 3;
    assert!(bench.health()?.supply_mv.is_some_and(about(3300)));
    // A measurement that is wrong alone is none.
    let clock = bench.board.clock();
    bench.board.set_reference(reference(3000));
    bench.run(0.02)?;
    bench.board.set_reference(reference(3300));
    bench.run(0.1)?;
    assert!(valid_since(&bench.board, clock) > 230);
    assert_eq!(bench.health()?.faults_seen, Faults::empty());
    // Begun, read and confirmed, each after 20 ms at most.
    bench.board.set_reference(reference(3000));
    bench.run(0.07)?;
    let clock = bench.board.clock();
    bench.run(0.2)?;
    let health = bench.health()?;
    assert_eq!(health.faults, Faults::SUPPLY | Faults::SAFE_OUTPUT);
    assert!(health.supply_mv.is_some_and(about(3000)));
    assert_eq!((valid_since(&bench.board, clock), bench.board.output()), (0, Some(safe)));
    bench.board.set_reference(reference(3300));
    bench.run(0.9)?;
    assert_eq!(valid_since(&bench.board, clock), 0, "it lasts a second longer");
    bench.run(0.2)?;
    let health = bench.health()?;
    assert_eq!((health.faults, health.faults_seen), (Faults::empty(), Faults::SUPPLY));
    // The measurements have not disturbed the conversions.
    let record = bench.board.record();
    assert!(record.lost_triggers == 0 && record.conversions.iter().all(|conversion| !conversion.late));
    assert_eq!(health.missed, 0);
    Ok(())
}

#[test]
fn a_supply_whose_measurement_does_not_end_is_a_fault_within_100_ms_and_until_a_second_after() -> Result<()> {
    let mut bench = Bench::started()?;
    bench.run(0.1)?;
    let clock = bench.board.clock();
    // The code of before stays in its register.
    bench.board.end_measurements(false);
    bench.run(0.1)?;
    assert!(valid_since(&bench.board, clock) > 80, "not at once");
    let clock = bench.board.clock();
    bench.run(0.1)?;
    assert_eq!(bench.health()?.faults, Faults::SUPPLY | Faults::SAFE_OUTPUT);
    assert_eq!(valid_since(&bench.board, clock), 0);
    bench.board.end_measurements(true);
    bench.run(1.1)?;
    assert_eq!(bench.health()?.faults, Faults::empty());
    Ok(())
}

#[test]
fn the_level_of_the_brown_out_reset_is_told_and_never_written() -> Result<()> {
    let mut bench = Bench::started()?;
    assert_eq!(bench.health()?.brown_out_level, Some(0), "as delivered");
    bench.board.set_brown_out_level(4);
    bench.reboot(Reset::PowerOn)?;
    assert_eq!(bench.health()?.brown_out_level, Some(4));
    Ok(())
}

#[test]
fn a_crystal_that_does_not_start_leaves_a_device_that_says_so_and_estimates_nothing() -> Result<()> {
    let mut bench = Bench::started()?;
    let safe = bench.table()?.dac.code(0.0f32).0;
    for cause in [Reset::PowerOn, Reset::Pin, Reset::Software] {
        bench.board.break_crystal();
        let first = bench.board.record().outputs.len();
        bench.board.reboot(cause)?;
        let clock = bench.board.clock();
        bench.start()?;
        let started = bench.board.clock();
        assert!(started - clock > PATIENCE, "{cause:?}: it has waited for the crystal");
        bench.run(1.0)?;
        let health = bench.health()?;
        assert_eq!((health.faults, health.missed), (Faults::CLOCK | Faults::SAFE_OUTPUT, 0), "{cause:?}");
        assert!(health.ticks.abs_diff(2000) < 20, "{cause:?}: {} ticks", health.ticks);
        assert!(bench.board.record().outputs[first..].iter().all(|latch| latch.code == safe), "{cause:?}");
        assert_eq!(valid_since(&bench.board, started), 0, "{cause:?}: VALID is silent");
        bench.does(Request::Stream(true))?;
        bench.run(0.1)?;
        let samples = std::mem::take(&mut bench.samples);
        assert!(!samples.is_empty(), "{cause:?}");
        for sample in samples.iter().flat_map(|batch| &batch.samples) {
            assert!(sample.faults.contains(Faults::CLOCK) && sample.displacement == 0.0, "{cause:?}: {sample:?}");
        }
        bench.board.mend_crystal();
        bench.restart()?;
        bench.run(0.1)?;
        assert_eq!(bench.health()?.faults, Faults::empty(), "{cause:?}: it has started");
    }
    Ok(())
}

#[test]
fn a_flash_of_one_bank_is_told_over_the_link_and_never_written() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let stored = reseeded(&table, 7);
    bench.push(&stored)?;
    let operations = bench.operations();
    bench.board.set_two_banks(false);
    for cause in [Reset::PowerOn, Reset::Pin, Reset::Software, Reset::Software, Reset::Software, Reset::Pin] {
        bench.reboot(cause)?;
        for _ in 0..20 {
            bench.run(0.005)?;
            assert_eq!(bench.board.output(), None, "{cause:?}: nobody knows what is wired to it");
        }
        assert_eq!(bench.health()?.faults, Faults::TABLE_FALLBACK | Faults::SAFE_OUTPUT, "{cause:?}");
    }
    let TableSource::Compiled { reason } = bench.identity()?.source else { panic!("a table was read") };
    assert!(reason.contains("set the option bit DBANK"), "{reason}");
    for request in [push(&stored), Request::Erase { while_estimating: true, rewired: true }] {
        let Reply::Refused(Refusal::Store(reason)) = bench.ask(request)? else { panic!("the flash is written") };
        assert!(reason.contains("set the option bit DBANK"), "{reason}");
    }
    assert_eq!(bench.operations(), operations);
    bench.board.set_two_banks(true);
    bench.reboot(Reset::PowerOn)?;
    assert_eq!((bench.identity()?.source, bench.health()?.faults), (TableSource::Stored, Faults::empty()));
    Ok(())
}

#[test]
fn the_cause_of_a_start_is_told_and_garbage_in_memory_is_no_message() -> Result<()> {
    let mut bench = Bench::started()?;
    for _ in 0..6 {
        for (cause, told) in [
            (Reset::PowerOn, ResetCause::BROWN_OUT | ResetCause::PIN),
            (Reset::Pin, ResetCause::PIN),
            (Reset::Watchdog, ResetCause::WATCHDOG | ResetCause::PIN),
            (Reset::Software, ResetCause::SOFTWARE | ResetCause::PIN),
            (Reset::PowerOn, ResetCause::BROWN_OUT | ResetCause::PIN),
        ] {
            bench.reboot(cause)?;
            let health = bench.health()?;
            assert_eq!((health.reset, health.last_words), (told, None), "{cause:?}");
        }
    }
    bench.restart()?;
    let own = ResetCause::SOFTWARE | ResetCause::PIN;
    assert_eq!(bench.health()?.reset, own | ResetCause::ASKED);
    bench.reboot(Reset::Software)?;
    assert_eq!(bench.health()?.reset, own, "once alone");
    Ok(())
}

#[test]
fn two_runs_are_equal() -> Result<()> {
    let run = || {
        let mut board = Board::power_on(&Image::from_environment("FIRMWARE_IMAGE")?)?;
        board.feed(triangle);
        assert_eq!(board.run(0.1)?, Stop::Time);
        Ok::<_, anyhow::Error>(board)
    };
    let (one, other) = (run()?, run()?);
    assert_eq!((one.clock(), one.skipped()), (other.clock(), other.skipped()));
    assert_eq!(one.record().outputs, other.record().outputs);
    assert_eq!(one.record().services, other.record().services);
    Ok(())
}
