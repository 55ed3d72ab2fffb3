//! The image that is built for the fastest tick, 10 kHz: it ticks in time, takes tables of its tick alone, and streams
//! what the line carries.

use crate::common::{Bench, CONVERTED, EARLY, push, record, reseeded, store, triangle};
use crate::cycles::tables::tables;
use anyhow::{Context, Result};
use board_emulator_test::{Board, CORE_HZ};
use estimator_core::{AdcCode, DacCode, Estimator, Model, Table};
use protocol::{Faults, Mode, Refusal, Reply, Request, Samples, TableSource, text};

const PERIOD: u64 = CORE_HZ as u64 / 10_000;
/// Ticks of which one is streamed.
const EVERY: u32 = 4;
/// Conversions that a code is the sum of, and what the firmware makes of one so that its scale is that of sixteen.
const OVERSAMPLED: u16 = 4;
const SCALE: u16 = 16 / OVERSAMPLED;
/// Clocks of an instruction. What is expected of the core lies between 1.5 and 2.2.
const CLOCKS: f64 = 2.5;
/// Clocks from a code of the DAC to the next.
const SPACING: u64 = CORE_HZ as u64 / 100_000;
/// The sensor's code counts sequences up to this.
const COUNTED: u64 = 16_000;

/// The converter's sums of conversions: the triangle, the number of the sequence, and a supply of 3.3 V.
fn inputs(board: &mut Board) {
    board.feed(|n| triangle(n) / SCALE);
    board.feed_sensor(|n| (n % COUNTED) as u16);
    board.set_reference(24_000 / SCALE);
}

/// With the demonstration's table in its store.
fn started() -> Result<Bench> {
    of(|board| {
        inputs(board);
        store(board, 100);
    })
}

fn of(inputs: impl FnOnce(&mut Board)) -> Result<Bench> {
    let mut bench = Bench::of("FIRMWARE_IMAGE_10KHZ", inputs)?;
    bench.board.slow(CLOCKS);
    Ok(bench)
}

#[test]
fn it_takes_tables_of_its_own_tick_and_no_other() -> Result<()> {
    let mut bench = of(inputs)?;
    let (identity, compiled) = (bench.identity()?, bench.table()?);
    assert_eq!((identity.tick_us, identity.adc_full_scale, compiled.sample_period_us), (100, 65_520, 100));
    assert!(matches!(identity.source, TableSource::Compiled { .. }), "{:?}", identity.source);
    let of_2_khz = compiled.at_tick(500)?.admit()?;
    let why = "made for a tick of 500 µs, not 100 µs";
    assert_eq!(bench.ask(push(&of_2_khz))?, Reply::Refused(Refusal::Table(text(why))));
    let (_, in_time_at_2_khz) = tables(Model::PrandtlIshlinskii, false)?[0];
    let slow = Table { sample_period_us: 100, ..*in_time_at_2_khz }.admit()?;
    let why = slow.in_time().expect_err("more than 60 % of a tick").to_string();
    assert_eq!(bench.ask(push(&slow))?, Reply::Refused(Refusal::Table(text(&why))));
    assert_eq!(bench.operations(), 0, "the flash is not touched");
    let own = reseeded(&of_2_khz.at_tick(100)?.admit()?, 2);
    bench.push(&own)?;
    bench.restart()?;
    assert_eq!((bench.identity()?.source, record(&bench.table()?)), (TableSource::Stored, record(&own)));
    Ok(())
}

#[test]
fn it_ticks_in_time_and_streams_every_fourth_tick_without_loss() -> Result<()> {
    let mut bench = started()?;
    let table = bench.table()?;
    assert_eq!(bench.board.oversampling(), (OVERSAMPLED.into(), 0));
    // After a pause the estimate begins anew with the mode.
    bench.does(Request::SetMode(Mode::Pause))?;
    bench.does(Request::SetMode(Mode::Estimate))?;
    bench.does(Request::Stream(true))?;
    let first = bench.board.record().conversions.len();
    bench.run(1.0)?;
    let health = bench.health()?;
    assert_eq!((health.missed, health.samples_dropped, health.faults_seen), (0, 0, Faults::empty()), "{health:?}");
    assert!(health.supply_mv.is_some_and(|mv| mv.abs_diff(3300) <= 2), "{:?}", health.supply_mv);

    let record = bench.board.record();
    let conversions = &record.conversions;
    assert!(conversions.windows(2).all(|pair| pair[1].trigger - pair[0].trigger == PERIOD), "a trigger is off");
    let length = u64::from(OVERSAMPLED) * CONVERTED;
    assert!(conversions.iter().all(|of| of.end - of.trigger == length && !of.late), "a conversion is late");
    assert_eq!((record.lost_triggers, record.overruns), (0, 0));

    let batches = &bench.samples;
    assert!(batches.iter().all(|batch| u32::from(batch.every.get()) == EVERY && batch.first % EVERY == 0));
    assert!(batches.windows(2).all(|pair| pair[1].first == pair[0].end()), "a gap");
    let samples: Vec<_> = batches.iter().flat_map(Samples::numbered).collect();
    assert!(samples.len() > 2_450, "{} samples in a second", samples.len());
    // Which sequence the first tick of the mode was.
    let (number, sample) = samples[0];
    let counted = u64::from(sample.sensor.context("the sensor is streamed")? / SCALE);
    let sequence = (0..).map(|turn| counted + turn * COUNTED).find(|n| n + COUNTED > first as u64);
    let begun = sequence.context("it counts")? - u64::from(number);
    let mut estimator = Estimator::<f32>::new(&table);
    let mut next = 0;
    for (number, sample) in samples {
        let mut displacement = 0.0;
        while next <= number {
            displacement = estimator.tick(AdcCode(triangle(begun + u64::from(next)))).displacement;
            next += 1;
        }
        assert_eq!(
            (sample.displacement.to_bits(), sample.faults),
            (displacement.to_bits(), Faults::empty()),
            "{number}"
        );
        // The tick after it puts out ten codes, none but the two beside what is wanted.
        let Some(after) = conversions.get((begun + u64::from(next)) as usize + 1) else { break };
        let start = record.outputs.partition_point(|latch| latch.clock + EARLY < after.trigger - PERIOD);
        let codes = &record.outputs[start..start + 10];
        assert!(codes.windows(2).all(|pair| pair[1].clock - pair[0].clock == SPACING), "{codes:?}");
        assert!(codes.iter().all(|latch| latch.code.abs_diff(sample.dac) <= 1), "{number}: {codes:?}, {}", sample.dac);
    }
    Ok(())
}

#[test]
fn a_drive_takes_its_first_reference_at_a_tick_that_is_streamed() -> Result<()> {
    let mut bench = started()?;
    let line = tables(Model::PrandtlIshlinskii, true)?.into_iter().find(|(name, _)| *name == "line");
    let (_, line) = line.context("there is a straight line")?;
    let table = Table { sample_period_us: 100, ..*line }.admit()?;
    let (adc, drive) = (table.adc, table.drive.context("it drives")?);
    let rest = drive.code(drive.limits.rest_v, table.dac.full_scale);
    bench.board.connect(move |n, pin| {
        let AdcCode(code) = adc.code(drive.voltage::<f32>(pin.map_or(rest, DacCode)));
        code / SCALE + (n % 2) as u16
    });
    bench.push(&table)?;
    bench.restart()?;
    let volts: Vec<f32> =
        (1..=64).map(|k| drive.limits.rest_v + 1e-3 * k as f32 * drive.limits.range_v.span()).collect();
    // From ticks that are not all the same apart.
    for pause in [0.01, 0.0101, 0.0103, 0.0107] {
        bench.does(Request::SetMode(Mode::Excite))?;
        bench.does(Request::Stream(true))?;
        bench.run(pause)?;
        bench.samples.clear();
        let references = volts.iter().copied().collect();
        let reply = bench.ask(Request::Refer { first: 0, references, go: true, hold: true })?;
        assert_eq!(reply, Reply::Referred { next: 64, starved: 0 });
        bench.run(0.02)?;
        let samples = bench.samples.iter().flat_map(Samples::numbered);
        let driven: Vec<_> = samples.filter(|(_, sample)| !sample.faults.contains(Faults::SAFE_OUTPUT)).collect();
        let (first, _) = driven[0];
        for (number, sample) in driven.iter().take(64 / EVERY as usize) {
            let wanted = drive.code(volts[(number - first) as usize], table.dac.full_scale);
            assert!(sample.dac.abs_diff(wanted.0) <= 1, "tick {}: {}, {wanted:?}", number - first, sample.dac);
        }
    }
    assert_eq!(bench.health()?.missed, 0);
    Ok(())
}
