//! A measured log through the board's whole chain: every DAC code is the one that the host's f32 core predicts, put out
//! exactly one trigger after the conversion it was computed from.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::common::{Bench, EARLY, PARTS, shown};
use anyhow::{Result, ensure};
use board_emulator_test::{CORE_HZ, Reset, exception};
use estimator_core::{Admitted, DacCalibration, Estimator, Table};
use protocol::TableSource;
use recordings::log::{self, ReadOptions};
use recordings::prepare::Recipe;
use serde::Deserialize;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// What of a table's file says how its logs were prepared. The crate that knows the rest takes minutes to build.
#[derive(Deserialize)]
struct Prepared {
    recipe: Recipe,
}

/// The amplifier's voltage at every tick of the measured log, prepared as `piezo validate` does for the compiled table.
fn log_volts() -> Result<Vec<f64>> {
    let Prepared { recipe } = toml::from_str(&fs::read_to_string(repository("tests/data/table/table.toml"))?)?;
    let log = log::read(&repository("tests/data/picma-p885-1hz.csv"), &ReadOptions::default())?;
    let session = recipe.session(&recipe.cut(&log))?;
    Ok(session.voltage.iter().map(|volts| volts + recipe.voltage_zero_v).collect())
}

/// What a table's estimator gives the DAC for these ADC codes, in parts of a code.
fn predicted(table: &Admitted, codes: &[u16]) -> Vec<u16> {
    let (mut estimator, dac) = (Estimator::<f32>::new(table), table.dac.finer(PARTS));
    let displacements = codes.iter().map(|&code| estimator.tick(estimator_core::AdcCode(code)).displacement);
    displacements.map(|displacement| dac.code(displacement).0).collect()
}

/// Feeds the log to a device that starts anew, and compares.
fn follows_the_log(name: &str, mut bench: Bench) -> Result<()> {
    let table = bench.table()?;
    let codes: Vec<u16> = log_volts()?.into_iter().map(|volts| table.adc.code(volts).0).collect();
    let ticks = codes.len();
    let expected = predicted(&table, &codes);

    let (earlier, clock) = (bench.board.record().conversions.len(), bench.board.clock());
    let served = bench.board.instructions(exception::ADC1_2).count();
    bench.board.feed(move |n| codes[(n as usize).min(ticks - 1)]);
    let start = Instant::now();
    bench.reboot(Reset::Pin)?;
    bench.board.run_until(60.0, |board| board.record().conversions.len() > earlier + ticks)?;
    let took = start.elapsed().as_secs_f64();

    let record = bench.board.record();
    let triggers: Vec<u64> = record.conversions[earlier..].iter().map(|conversion| conversion.trigger).collect();
    ensure!(triggers.len() == ticks + 1, "{} conversions of {ticks}", triggers.len());
    let from = record.outputs.partition_point(|latch| latch.clock + EARLY < triggers[0]);
    let latches = shown(record, from);
    // The last has just begun.
    assert!(
        latches.iter().map(|latch| latch.clock).eq(triggers[..ticks].iter().copied()),
        "the DAC moves with the triggers alone"
    );
    assert_eq!(latches[0].code, PARTS * table.dac.code(0.0f32).0, "nothing is estimated before the first conversion");
    let wrong = latches[1..].iter().zip(&expected).position(|(latch, &code)| latch.code != code);
    assert_eq!(wrong, None, "tick of {ticks}; {} predicted", expected[wrong.unwrap_or(0)]);
    let distinct = expected.iter().collect::<std::collections::BTreeSet<_>>().len();
    assert!(ticks > 79_000 && distinct > 1_500, "{ticks} ticks, {distinct} codes: not the whole log");
    println!("{name}: {ticks} DAC codes, {distinct} different ones, all as predicted");
    // The handler's first run after a start only takes what it owns.
    let own: Vec<u64> = bench.board.instructions(exception::ADC1_2).skip(served + 1).collect();
    let mean = own.iter().sum::<u64>() as f64 / own.len() as f64;
    let (least, most) = own.iter().min().zip(own.iter().max()).expect("a tick at least");
    println!("{name}: {least} to {most} instructions in the tick's interrupt, {mean:.1} on average");
    assert!(*most < 1075, "{most} instructions");
    let seconds = (bench.board.clock() - clock) as f64 / f64::from(CORE_HZ);
    println!(
        "{name}: {seconds:.1} s of the board's time emulated in {took:.1} s, {:.1} times real time",
        seconds / took
    );
    Ok(())
}

#[test]
fn the_demonstration_s_table() -> Result<()> {
    follows_the_log("the demonstration's", Bench::started()?)
}

#[test]
fn a_stored_table() -> Result<()> {
    let mut bench = Bench::started()?;
    let compiled = *bench.table()?;
    let table = Table { dac: DacCalibration { gain_codes_per_um: 60.0, ..compiled.dac }, ..compiled }.admit()?;
    bench.push(&table)?;
    bench.restart()?;
    assert_eq!(bench.identity()?.source, TableSource::Stored);
    assert_eq!(bench.table()?, table);
    follows_the_log("stored", bench)
}
