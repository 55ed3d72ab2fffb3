//! Tables over the link into the flash: which one the device runs after the next start.

use crate::common::{Bench, push, record, reseeded, valid_since};
use anyhow::Result;
use board_emulator_test::{FlashKind, Reset};
use estimator_core::{BoucWenParameters, DriveCalibration, DriveLimits, Parameters, Range, Table};
use protocol::{Faults, Refusal, Reply, Request, TableSource, text};

#[test]
fn a_pushed_table_is_used_from_the_next_start_on_until_it_is_erased() -> Result<()> {
    let mut bench = Bench::erased()?;
    let (compiled, identity) = (bench.table()?, bench.identity()?);
    let new = reseeded(&compiled, 2);
    let push = Request::Push { record: record(&new), while_estimating: false, rewired: true };
    assert_eq!(bench.ask(push)?, Reply::Refused(Refusal::Estimating));
    bench.push(&new)?;
    assert_eq!(bench.identity()?, identity, "not before the reset");
    bench.restart()?;
    let stored = bench.identity()?;
    assert_eq!((stored.source.clone(), record(&bench.table()?)), (TableSource::Stored, record(&new)));
    assert_ne!(stored.table_crc, identity.table_crc);
    for cause in [Reset::Pin, Reset::Watchdog, Reset::PowerOn] {
        bench.reboot(cause)?;
        assert_eq!(bench.identity()?, stored, "{cause:?}");
    }
    bench.does(Request::Erase { while_estimating: true, rewired: true })?;
    bench.restart()?;
    assert_eq!(bench.identity()?, identity);
    Ok(())
}

#[test]
fn the_demonstration_s_table_of_the_image_is_estimated_by_and_neither_shown_nor_called_valid() -> Result<()> {
    let mut bench = Bench::erased()?;
    bench.does(Request::Stream(true))?;
    for cause in [Reset::PowerOn, Reset::Pin, Reset::Watchdog] {
        let clock = bench.board.clock();
        bench.reboot(cause)?;
        bench.does(Request::Stream(true))?;
        bench.run(0.2)?;
        assert_eq!(bench.health()?.faults, Faults::DEMONSTRATION | Faults::SAFE_OUTPUT, "{cause:?}");
        // The pin of VALID is switched on, and has no other edge; that of the DAC is left alone.
        assert_eq!((valid_since(&bench.board, clock), bench.board.output()), (1, None), "{cause:?}");
        let samples: Vec<_> = bench.samples.drain(..).flat_map(|batch| batch.samples).collect();
        assert!(samples.iter().any(|sample| sample.displacement > 1.0), "{cause:?}: it is estimated by");
        assert!(samples.iter().all(|sample| sample.faults.contains(Faults::DEMONSTRATION)), "{cause:?}");
    }
    // Its user has meant it.
    let table = bench.table()?;
    bench.push(&table)?;
    bench.restart()?;
    let clock = bench.board.clock();
    bench.run(0.1)?;
    assert_eq!((bench.identity()?.source, bench.health()?.faults), (TableSource::Stored, Faults::empty()));
    assert!(valid_since(&bench.board, clock) > 150 && bench.board.output().is_some());
    Ok(())
}

#[test]
fn a_table_whose_tick_would_take_too_long_is_refused_to_drive_and_taken_to_estimate() -> Result<()> {
    let mut bench = Bench::started()?;
    // Integrated in steps.
    let of = BoucWenParameters {
        lag_s: 0.0,
        a: 1.0,
        beta: 0.5,
        gamma: 0.3,
        delta: 0.0,
        n: 2.0,
        offset_um: 0.0,
        d1_um_per_v: 15.0,
        d2_um_per_v2: 0.0,
        c_um_per_v: -3.0,
    };
    let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 400.0 };
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits, setpoint: None };
    let displacement_limits_um = Range { min: -50.0, max: 100.0 };
    let estimates = Table { parameters: Parameters::BoucWen(of), displacement_limits_um, ..*bench.table()? };
    let drives = Table { drive: Some(drive), ..estimates }.admit()?;
    let why = "driving takes up to 68700 cycles a tick, 81 % of its time, not 60 % at most";
    assert_eq!(bench.ask(push(&drives))?, Reply::Refused(Refusal::Table(text(why))));
    assert_eq!(bench.operations(), 0, "the flash is not touched");
    bench.push(&estimates.admit()?)?;
    bench.restart()?;
    assert_eq!(bench.table()?, estimates.admit()?);
    Ok(())
}

#[test]
fn a_corrupt_record_changes_nothing() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = reseeded(&bench.table()?, 2);
    bench.push(&table)?;
    bench.restart()?;
    let (identity, flash) = (bench.identity()?, bench.board.record().flash.len());
    let whole = record(&reseeded(&table, 3));
    for at in [0, 5, 60, whole.len() - 1] {
        let mut corrupt = whole.clone();
        corrupt[at] ^= 0x10;
        let reply = bench.ask(Request::Push { record: corrupt, while_estimating: true, rewired: true })?;
        assert!(matches!(reply, Reply::Refused(Refusal::Table(_))), "byte {at}: {reply:?}");
    }
    assert_eq!(bench.board.record().flash.len(), flash, "the flash is not touched");
    bench.restart()?;
    assert_eq!(bench.identity()?, identity);
    Ok(())
}

#[test]
fn a_newest_record_that_has_decayed_in_the_flash_is_said_and_the_one_before_is_not_used_for_it() -> Result<()> {
    for (torn, corrupt) in [(false, false), (true, false), (true, true)] {
        let mut bench = Bench::started()?;
        let compiled = bench.table()?;
        bench.push(&reseeded(&compiled, 2))?;
        let done = bench.operations();
        bench.push(&reseeded(&compiled, 3))?;
        let programs: Vec<_> = bench.board.record().flash[done..]
            .iter()
            .filter(|operation| operation.kind == FlashKind::Program)
            .collect();
        // Amid the last record.
        let address = programs[programs.len() / 2].address;
        let contents = bench.board.contents_mut();
        let byte = contents.bytes(address, 1)[0];
        contents.set(address, &[byte ^ 4]);
        if torn {
            contents.tear(address);
        }
        if corrupt {
            bench.board.corrupt_eccr();
        }
        bench.restart()?;
        let clock = bench.board.clock();
        bench.run(0.1)?;
        let health = bench.health()?;
        assert_eq!(health.flash_errors > 0, torn);
        assert_eq!(health.faults, Faults::TABLE_FALLBACK | Faults::SAFE_OUTPUT);
        assert_eq!((valid_since(&bench.board, clock), bench.board.output()), (0, None));
        let TableSource::Compiled { reason } = bench.identity()?.source else { panic!("a stored table is used") };
        assert!(reason.contains("decayed") && reason.contains("another actuator's"), "{reason}");
        // Stored anew, even the one before is one again.
        bench.push(&reseeded(&compiled, 2))?;
        bench.restart()?;
        assert_eq!(bench.identity()?.source, TableSource::Stored);
        assert_eq!(record(&bench.table()?), record(&reseeded(&compiled, 2)));
    }
    Ok(())
}
