//! What a start makes of the failures before it: a zero that is lost, a store that is left alone, an output
//! that nobody knows.

use crate::common::{Bench, valid_since};
use crate::resets::{NOWHERE, TIM6_CR1, resets, running};
use anyhow::Result;
use board_emulator_test::{Reset, Stop};
use estimator_core::{DacCalibration, Table};
use protocol::{Faults, Request, TableSource};

/// The device fails; it has started again when this returns.
fn fail(bench: &mut Bench) -> Result<()> {
    bench.board.jump(NOWHERE);
    assert_eq!(bench.board.run(1e-2)?, Stop::Reset(Reset::Software));
    bench.reboot(Reset::Software)
}

#[test]
fn a_zero_that_a_reset_nobody_asked_for_has_lost_is_said_without_valid_until_it_is_told_anew() -> Result<()> {
    let (mut bench, _) = running()?;
    bench.does(Request::SetZero { at_um: 0.0 })?;
    let started = |bench: &mut Bench| -> Result<(Faults, usize)> {
        bench.run(0.1)?;
        let clock = bench.board.clock();
        bench.run(0.1)?;
        Ok((bench.health()?.faults, valid_since(&bench.board, clock)))
    };
    // By the watchdog, a fault and the pin, one after the other.
    bench.board.poke(TIM6_CR1, 0)?;
    resets(&mut bench, Reset::Watchdog, 221.0)?;
    assert_eq!(started(&mut bench)?, (Faults::ZERO_LOST, 0));
    fail(&mut bench)?;
    assert_eq!(started(&mut bench)?, (Faults::ZERO_LOST, 0));
    bench.reboot(Reset::Pin)?;
    assert_eq!(started(&mut bench)?, (Faults::ZERO_LOST, 0));
    bench.does(Request::SetZero { at_um: 0.0 })?;
    let (faults, edges) = started(&mut bench)?;
    assert!(faults.is_empty() && edges > 150, "{faults:?}, {edges} edges");
    bench.reboot(Reset::Pin)?;
    assert_eq!(started(&mut bench)?, (Faults::ZERO_LOST, 0), "that one is lost as well");
    // Whoever asks for a reset knows; where power was lost, nobody does.
    bench.restart()?;
    let (faults, edges) = started(&mut bench)?;
    assert!(faults.is_empty() && edges > 150, "{faults:?}, {edges} edges");
    bench.does(Request::SetZero { at_um: 0.0 })?;
    bench.reboot(Reset::PowerOn)?;
    let (faults, edges) = started(&mut bench)?;
    assert!(faults.is_empty() && edges > 150, "{faults:?}, {edges} edges");
    Ok(())
}

/// A device with a stored table, which it uses.
fn stored() -> Result<Bench> {
    let mut bench = Bench::started()?;
    let compiled = *bench.table()?;
    // Another safe code than the compiled one's.
    let dac = DacCalibration { offset_code: compiled.dac.offset_code + 300.0, ..compiled.dac };
    bench.push(&Table { dac, ..compiled }.admit()?)?;
    bench.restart()?;
    assert_eq!(bench.identity()?.source, TableSource::Stored);
    Ok(bench)
}

#[test]
fn three_failures_in_a_row_leave_the_store_alone_until_it_is_asked_to_start() -> Result<()> {
    let mut bench = stored()?;
    let safe = bench.table()?.dac.code(0.0f32).0;
    for _ in 0..2 {
        fail(&mut bench)?;
        assert_eq!(bench.identity()?.source, TableSource::Stored);
    }
    // The third, by the watchdog.
    bench.board.poke(TIM6_CR1, 0)?;
    assert_eq!(bench.board.run(1.0)?, Stop::Reset(Reset::Watchdog));
    let clock = bench.board.clock();
    bench.reboot(Reset::Watchdog)?;
    bench.run(0.1)?;
    let TableSource::Compiled { reason } = bench.identity()?.source else { panic!("the store was read") };
    assert!(reason.contains("failed 3 times in a row"), "{reason}");
    assert_ne!(bench.table()?.dac.code(0.0f32).0, safe);
    assert_eq!(bench.health()?.faults, Faults::TABLE_FALLBACK | Faults::SAFE_OUTPUT);
    // What is connected to the output is what it was: so is the safe code.
    // The pin of VALID is switched on, and has no other edge.
    assert_eq!((bench.board.output(), valid_since(&bench.board, clock)), (Some(safe), 1));
    bench.restart()?;
    assert_eq!(bench.identity()?.source, TableSource::Stored);
    Ok(())
}

#[test]
fn a_failure_after_the_store_was_erased_does_not_bring_the_output_back_to_what_an_earlier_table_knew() -> Result<()> {
    let mut bench = stored()?;
    bench.run(0.1)?;
    assert!(bench.board.output().is_some());
    bench.does(Request::Erase { while_estimating: true, rewired: true })?;
    bench.restart()?;
    bench.run(0.1)?;
    assert_eq!(bench.board.output(), None, "nobody knows what is wired to it");
    for _ in 0..4 {
        fail(&mut bench)?;
        bench.run(0.1)?;
        assert_eq!(bench.board.output(), None, "nor does the start before");
    }
    Ok(())
}

#[test]
fn failures_far_apart_and_other_starts_are_not_counted() -> Result<()> {
    let mut bench = stored()?;
    for _ in 0..4 {
        fail(&mut bench)?;
        fail(&mut bench)?;
        bench.board.reboot(Reset::Pin)?;
        bench.start()?;
    }
    fail(&mut bench)?;
    fail(&mut bench)?;
    bench.run(10.1)?;
    fail(&mut bench)?;
    assert_eq!(bench.identity()?.source, TableSource::Stored);
    Ok(())
}
