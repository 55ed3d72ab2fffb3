//! Tables over the link into the flash: which one the device runs after the next start.

use crate::common::{Bench, record, reseeded};
use anyhow::Result;
use board_emulator_test::{FlashKind, Reset};
use protocol::{Refusal, Reply, Request, TableSource};

#[test]
fn a_pushed_table_is_used_from_the_next_start_on_until_it_is_erased() -> Result<()> {
    let mut bench = Bench::started()?;
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
fn a_record_that_has_decayed_in_the_flash_gives_way_to_the_one_before() -> Result<()> {
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
        assert_eq!(bench.health()?.flash_errors > 0, torn);
        assert_eq!(bench.identity()?.source, TableSource::Stored);
        assert_eq!(record(&bench.table()?), record(&reseeded(&compiled, 2)));
    }
    Ok(())
}
