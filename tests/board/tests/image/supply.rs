//! The supply, which is the converter's reference, drifts; the estimate does not.

use crate::common::{Bench, triangle};
use anyhow::{Context, Result};
use estimator_core::{AdcCode, Estimator};
use protocol::{Faults, Mode, Request, Sample};

/// What the supply is at the start, mV, and how far it goes: a whole twentieth is the end of what is tolerated.
const START_MV: f32 = 3300.0;
const BY_MV: f32 = 160.0;
/// Ticks of the ramp, and of all.
const RAMP: u64 = 20_000;
const ALL: u64 = 22_000;

/// The supply at the n-th sequence.
fn supply(n: u64) -> f32 {
    START_MV + BY_MV * (n as f32 / RAMP as f32).min(1.0)
}

/// The n-th sequence's number, as the sensor's code, which nothing corrects.
fn numbered(n: u64) -> u16 {
    (n % 65_521) as u16
}

#[test]
fn a_supply_that_ramps_by_a_twentieth_moves_the_estimate_by_less_than_a_thousandth_of_the_stroke() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let zero = f32::from(table.adc.code(0.0f32).0);
    let read = move |n: u64| {
        let distance = (f32::from(triangle(n)) - zero) * START_MV / supply(n);
        (zero + distance).round() as u16
    };
    bench.board.feed_sensor(numbered);
    bench.board.feed(read);
    // The estimate begins anew, on what is fed.
    bench.does(Request::SetMode(Mode::Estimate))?;
    bench.does(Request::Stream(true))?;
    for n in (0..ALL).step_by(40) {
        bench.board.set_reference((16.0 * 1650.0 * 3000.0 / supply(n)).round() as u16);
        bench.run(0.02)?;
    }
    let health = bench.health()?;
    assert_eq!((health.faults_seen, health.missed, health.samples_dropped), (Faults::empty(), 0, 0));
    assert!(health.supply_mv.is_some_and(|mv| f32::from(mv) == START_MV + BY_MV), "{:?} mV", health.supply_mv);

    let samples: Vec<&Sample> = bench.samples.iter().flat_map(|batch| &batch.samples).collect();
    let first = samples[0].sensor.context("the sensor is streamed")?;
    let (mut reference, mut uncorrected) = (Estimator::<f32>::new(&table), Estimator::<f32>::new(&table));
    // Its ticks are numbered from where it began.
    for n in u64::from(first) - u64::from(bench.samples[0].first)..u64::from(first) {
        reference.tick(AdcCode(triangle(n)));
        uncorrected.tick(AdcCode(read(n)));
    }
    let (mut least, mut greatest, mut worst, mut worst_uncorrected) =
        (f32::INFINITY, f32::NEG_INFINITY, 0.0f32, 0.0f32);
    for (n, sample) in (u64::from(first)..).zip(&samples) {
        assert_eq!(sample.sensor, Some(numbered(n)), "none is missing");
        let expected = reference.tick(AdcCode(triangle(n))).displacement;
        let without = uncorrected.tick(AdcCode(read(n))).displacement;
        (least, greatest) = (least.min(expected), greatest.max(expected));
        worst = worst.max((sample.displacement - expected).abs());
        worst_uncorrected = worst_uncorrected.max((without - expected).abs());
    }
    let stroke = greatest - least;
    println!(
        "supply by {BY_MV} mV in 10 s: the estimate moves by {:.3} % of the stroke, {:.2} % uncorrected",
        100.0 * worst / stroke,
        100.0 * worst_uncorrected / stroke
    );
    assert!(samples.len() as u64 > ALL - 100, "{} samples", samples.len());
    assert!(worst < 1e-3 * stroke, "{worst} of {stroke} µm");
    assert!(worst_uncorrected > 0.02 * stroke, "{worst_uncorrected} of {stroke} µm, uncorrected");
    Ok(())
}
