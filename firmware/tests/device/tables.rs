//! Which tables are stored, and which one a device starts with.

use crate::bench::{Bench, Flash, flash, push};
use crate::common::{FACTS, compiled, driving, other, record, too_long};
use embassy_futures::block_on;
use estimator_core::{AdcCalibration, Admitted, Digest, Provenance, Table};
use firmware::Facts;
use firmware::boot::{self, Chosen};
use firmware::compiled::TABLE;
use firmware::restarts::{Restarts, TOO_MANY};
use parameter_store::{ParameterStore, RamFlash};
use protocol::{Faults, Mode, Refusal, Reply, Request, TableSource, text};

#[test]
fn a_table_is_written_when_nothing_is_estimated_or_when_told_to() {
    let mut bench = Bench::new(Some(compiled()));
    assert_eq!(bench.ask(push(&other(), false)), Reply::Refused(Refusal::Estimating));
    assert_eq!(
        bench.ask(Request::Erase { while_estimating: false, rewired: false }),
        Reply::Refused(Refusal::Estimating)
    );
    assert_eq!(bench.stored(), None);
    assert_eq!(bench.ask(push(&other(), true)), Reply::Done);
    assert_eq!(bench.stored(), Some(record(&other()).to_vec()));
    assert_eq!(bench.ask(Request::Pull), Reply::Table(record(&compiled())), "it is used from the next reset on");
    for mode in [Mode::Pause, Mode::Pil] {
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Done);
        assert_eq!(bench.ask(push(&compiled(), false)), Reply::Done);
        assert_eq!(bench.stored(), Some(record(&compiled()).to_vec()));
        assert_eq!(bench.ask(Request::Erase { while_estimating: false, rewired: false }), Reply::Done);
        assert_eq!(bench.stored(), None);
    }
}

#[test]
fn what_it_cannot_run_is_refused_and_the_old_table_stays() {
    let mut bench = Bench::new(Some(compiled()));
    assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
    assert_eq!(bench.ask(push(&other(), false)), Reply::Done);
    let change = |edit: fn(&mut Table)| {
        let mut table = *compiled();
        edit(&mut table);
        record(&table.admit().expect("still admissible"))
    };
    let mut corrupt = record(&compiled());
    corrupt[40] ^= 1;
    let refused = [
        (corrupt, "corrupt"),
        (record(&compiled())[..60].iter().copied().collect(), "truncated"),
        (Default::default(), "truncated"),
        (change(|table| table.adc.full_scale = 4095), "an ADC up to 4095, not 65520"),
        (change(|table| table.dac.full_scale = 65_535), "a DAC up to 65535, not 4095"),
        (change(|table| table.sample_period_us = 400), "a tick of 400 µs, not 500 µs"),
        (record(&too_long()), "driving takes up to 68700 cycles a tick, 81 % of its time, not 60 % at most"),
    ];
    for (bad, why) in refused {
        match bench.ask(Request::Push { record: bad, while_estimating: false, rewired: false }) {
            Reply::Refused(Refusal::Table(reason)) => assert!(reason.contains(why), "{reason} / {why}"),
            reply => panic!("{why}: {reply:?}"),
        }
        assert_eq!(bench.stored(), Some(record(&other()).to_vec()));
    }
}

#[test]
fn the_dac_is_not_rewired_by_a_table_alone() {
    let push = |table: &Admitted, rewired| Request::Push { record: record(table), while_estimating: true, rewired };
    let erase = |rewired| Request::Erase { while_estimating: true, rewired };
    let (mut plain, mut drives) = (Bench::new(Some(compiled())), Bench::new(Some(driving())));
    for (bench, table) in [(&mut plain, driving()), (&mut drives, compiled())] {
        assert_eq!(bench.ask(push(&table, false)), Reply::Refused(Refusal::Rewired));
        assert_eq!(bench.stored(), None);
        assert_eq!(bench.ask(push(&table, true)), Reply::Done);
    }
    assert_eq!(plain.ask(erase(false)), Reply::Done, "the compiled table has no drive either");
    assert_eq!(drives.ask(erase(false)), Reply::Refused(Refusal::Rewired));
    assert_eq!(drives.ask(erase(true)), Reply::Done);
}

#[test]
fn nothing_is_written_unasked_where_nobody_knows_what_the_dac_is_wired_for() {
    let mut bench = Bench::new(Some(compiled()));
    bench.device.chosen.doubts = Faults::TABLE_FALLBACK;
    for drives_or_not in [driving(), compiled()] {
        let push = |rewired| Request::Push { record: record(&drives_or_not), while_estimating: true, rewired };
        assert_eq!(bench.ask(push(false)), Reply::Refused(Refusal::Rewired));
        assert_eq!(bench.ask(push(true)), Reply::Done);
    }
    let erase = |rewired| Request::Erase { while_estimating: true, rewired };
    assert_eq!(bench.ask(erase(false)), Reply::Refused(Refusal::Rewired));
    assert_eq!(bench.ask(erase(true)), Reply::Done);
}

#[test]
fn it_starts_with_the_newest_stored_table_else_the_compiled_else_none_and_says_why() {
    let choose = |store: &mut ParameterStore<Flash>, compiled: Table| block_on(boot::choose(store, compiled, &FACTS));
    let mut store = flash(vec![0xFF; 4096]);
    let Chosen { table, source, doubts } = choose(&mut store, TABLE);
    assert_eq!((table, source), (Some(compiled()), TableSource::Compiled { reason: text("no table is stored") }));
    assert_eq!(doubts, Faults::DEMONSTRATION, "nothing was lost, and it is nobody's here");
    for _ in 0..30 {
        block_on(store.store(&record(&compiled()))).unwrap();
        block_on(store.store(&record(&other()))).unwrap();
    }
    let Chosen { table, source, doubts } = choose(&mut store, TABLE);
    assert_eq!((table, source, doubts), (Some(other()), TableSource::Stored, Faults::empty()));

    let failing = Facts { restarts: Restarts { count: TOO_MANY, ..FACTS.restarts }, ..FACTS };
    let Chosen { table, source, doubts } = block_on(boot::choose(&mut store, TABLE, &failing));
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(
        doubts == Faults::TABLE_FALLBACK && table == Some(compiled()) && reason.contains("failed 3 times"),
        "{reason}"
    );

    // As an older firmware may have left it.
    block_on(store.store(&record(&too_long()))).unwrap();
    let Chosen { table, source, doubts } = choose(&mut store, TABLE);
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(
        doubts == Faults::TABLE_FALLBACK && table == Some(compiled()) && reason.contains("takes up to 68700 cycles"),
        "{reason}"
    );

    block_on(store.store(b"PZTB\x63\x00\x00\x00and more")).unwrap();
    let Chosen { table, source, doubts } = choose(&mut store, TABLE);
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(
        doubts == Faults::TABLE_FALLBACK && table == Some(compiled()) && reason.contains("format version 99"),
        "{reason}"
    );

    let Chosen { table, source, doubts } = choose(&mut store, Table { deadband_v: f32::NAN, ..TABLE });
    let TableSource::None { stored, compiled } = source else { panic!("{source:?}") };
    assert!(
        doubts == Faults::TABLE_FALLBACK
            && table.is_none()
            && stored.contains("format version 99")
            && compiled.contains("deadband_v"),
        "{compiled}"
    );
}

#[test]
fn the_demonstration_s_table_of_the_image_is_nobody_s_but_an_emulated_board_s_and_one_s_own_is_one_s_own() {
    let own = Table { provenance: Provenance { logs: Digest([7; 8]), ..TABLE.provenance }, ..TABLE };
    let emulated = Facts { emulated: true, ..FACTS };
    let recalibrated = Table { adc: AdcCalibration { offset_v: -0.37, ..TABLE.adc }, ..TABLE };
    for (compiled, facts, doubts) in [
        (TABLE, FACTS, Faults::DEMONSTRATION),
        (recalibrated, FACTS, Faults::DEMONSTRATION),
        (TABLE, emulated, Faults::empty()),
        (own, FACTS, Faults::empty()),
    ] {
        let chosen = block_on(boot::choose(&mut flash(vec![0xFF; 4096]), compiled, &facts));
        assert!(matches!(chosen.source, TableSource::Compiled { .. }) && chosen.table.is_some(), "{doubts:?}");
        assert_eq!(chosen.doubts, doubts);
    }
    // Whoever stores it has meant it.
    let mut store = flash(vec![0xFF; 4096]);
    block_on(store.store(&record(&compiled()))).unwrap();
    let chosen = block_on(boot::choose(&mut store, TABLE, &FACTS));
    assert_eq!((chosen.source, chosen.doubts), (TableSource::Stored, Faults::empty()));
}

#[test]
fn a_newest_table_that_has_decayed_is_said_and_the_one_before_is_not_used_for_it() {
    let mut memory = vec![0xFF; 4096];
    let mut write = |table: &Admitted| {
        block_on(store(&mut memory).store(&record(table))).unwrap();
    };
    write(&driving());
    write(&other());
    // Amid the newest record, which is in the second page.
    memory[2048 + 100] ^= 4;
    let Chosen { source, doubts, .. } = block_on(boot::choose(&mut store(&mut memory), TABLE, &FACTS));
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(doubts == Faults::TABLE_FALLBACK && reason.contains("the newest stored table has decayed"), "{reason}");
    // A write that is cut begins with the page's erase: what is whole beside it was stored last.
    memory.fill(0xFF);
    block_on(store(&mut memory).store(&record(&driving()))).unwrap();
    memory[2048..2048 + 64].fill(0x5A);
    let Chosen { table, source, doubts } = block_on(boot::choose(&mut store(&mut memory), TABLE, &FACTS));
    assert_eq!((table, source, doubts), (Some(driving()), TableSource::Stored, Faults::empty()));
}

fn store(memory: &mut [u8]) -> ParameterStore<RamFlash<&mut [u8]>> {
    ParameterStore::new(RamFlash::new(memory), 0..4096).unwrap()
}
