//! The supply, which is the converters' reference, drifts; the estimate does not, nor do the sensor's code, the
//! set-point's and the output.

use crate::common::{Bench, PARTS, shown, triangle};
use anyhow::{Context, Result};
use board_emulator_test::Board;
use estimator_core::*;
use protocol::{Faults, Mode, Request, Sample};

/// What the supply is at the start, mV, and how far it goes: a whole twentieth is the end of what is tolerated.
const START_MV: f32 = 3300.0;
const BY_MV: f32 = 160.0;
/// The sequence at which it sets out, the ticks of the ramp, and the last sequence.
const FROM: u64 = 6_000;
const RAMP: u64 = 20_000;
const LAST: u64 = FROM + RAMP + 2_000;
/// The code of a sensor's 0 V, which are at 0.15 V of the pin.
const SENSOR_ZERO: f32 = 65_520.0 / 22.0;

/// The supply at the n-th sequence, mV, on its way up or down.
fn supply(n: u64, up: bool) -> f32 {
    let part = (n.saturating_sub(FROM) as f32 / RAMP as f32).min(1.0);
    START_MV + if up { BY_MV } else { -BY_MV } * part
}

/// What the converter reads at the n-th sequence where it would read `code` at the start, and `zero` at 0 V.
fn read(zero: f32, code: f32, n: u64, up: bool) -> u16 {
    (zero + (code - zero) * START_MV / supply(n, up)).round() as u16
}

/// The n-th sequence's number, as what the sensor's code would be at the start.
fn numbered(n: u64) -> u16 {
    (5_000 + 2 * n % 50_000) as u16
}

/// Runs to the last sequence after `fed`, while the supply goes its way.
fn runs(bench: &mut Bench, fed: usize, up: bool, mut looks: impl FnMut(&mut Bench, u64) -> Result<()>) -> Result<()> {
    let sequence = |board: &Board| (board.record().conversions.len() - fed) as u64;
    while sequence(&bench.board) < LAST {
        let mv = supply(sequence(&bench.board), up);
        bench.board.set_reference((16.0 * 1650.0 * 3000.0 / mv).round() as u16);
        bench.run(0.02)?;
        looks(bench, sequence(&bench.board))?;
    }
    let health = bench.health()?;
    assert_eq!((health.faults_seen, health.missed, health.samples_dropped), (Faults::empty(), 0, 0));
    let end = supply(LAST, up);
    assert!(health.supply_mv.is_some_and(|mv| f32::from(mv) == end), "{:?} mV", health.supply_mv);
    Ok(())
}

/// The streamed samples, and the first one's sequence: the supply is then where it starts.
fn streamed(bench: &Bench) -> Result<(u64, Vec<&Sample>)> {
    let samples: Vec<&Sample> = bench.samples.iter().flat_map(|batch| &batch.samples).collect();
    let first = samples[0].sensor.context("the sensor is streamed")?;
    let first = u64::from(first - numbered(0)) / 2;
    assert!(samples.len() as u64 > LAST - FROM && first < FROM, "{} samples from {first} on", samples.len());
    Ok((first, samples))
}

#[test]
fn a_supply_that_ramps_by_a_twentieth_moves_the_estimate_by_less_than_a_thousandth_of_the_stroke() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let zero = f32::from(table.adc.code(0.0f32).0);
    let monitor = move |n: u64| read(zero, triangle(n).into(), n, true);
    bench.board.feed_sensor(|n| read(SENSOR_ZERO, numbered(n).into(), n, true));
    bench.board.feed(monitor);
    let fed = bench.board.record().conversions.len();
    // The estimate begins anew, on what is fed.
    bench.does(Request::SetMode(Mode::Pause))?;
    bench.does(Request::SetMode(Mode::Estimate))?;
    bench.does(Request::Stream(true))?;
    runs(&mut bench, fed, true, |_, _| Ok(()))?;

    let (first, samples) = streamed(&bench)?;
    let (mut reference, mut uncorrected) = (Estimator::<f32>::new(&table), Estimator::<f32>::new(&table));
    // Its ticks are numbered from where it began.
    for n in first - u64::from(bench.samples[0].first)..first {
        reference.tick(AdcCode(triangle(n)));
        uncorrected.tick(AdcCode(monitor(n)));
    }
    let (mut least, mut greatest, mut worst, mut worst_uncorrected) =
        (f32::INFINITY, f32::NEG_INFINITY, 0.0f32, 0.0f32);
    let mut sensor = 0.0f32;
    for (n, sample) in (first..).zip(&samples) {
        let expected = reference.tick(AdcCode(triangle(n))).displacement;
        let without = uncorrected.tick(AdcCode(monitor(n))).displacement;
        (least, greatest) = (least.min(expected), greatest.max(expected));
        worst = worst.max((sample.displacement - expected).abs());
        worst_uncorrected = worst_uncorrected.max((without - expected).abs());
        let read = sample.sensor.context("the sensor is streamed")?;
        sensor = sensor.max((f32::from(read) - f32::from(numbered(n))).abs() / 65_520.0);
    }
    let stroke = greatest - least;
    println!(
        "supply by {BY_MV} mV in 10 s: the estimate moves by {:.3} % of the stroke, {:.2} % uncorrected; the sensor's code by \
         {:.3} % of the range",
        100.0 * worst / stroke,
        100.0 * worst_uncorrected / stroke,
        100.0 * sensor
    );
    assert!(worst < 1e-3 * stroke, "{worst} of {stroke} µm");
    assert!(worst_uncorrected > 0.02 * stroke, "{worst_uncorrected} of {stroke} µm, uncorrected");
    assert!(sensor < 1e-3, "{sensor}");
    Ok(())
}

/// 20 mV or 20.48 codes a tick.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const SETPOINT: SetpointCalibration =
    SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start: true };
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: Some(SETPOINT) };

/// The set-point's code of a displacement, µm.
fn code(um: f32) -> f32 {
    (um - SETPOINT.offset_um) / SETPOINT.gain_um_per_code
}

/// What a controller has at the n-th sequence, µm: a swing, with a converter's noise.
fn wanted(n: u64) -> f32 {
    20.0 + 12.0 * (n as f32 * 0.005).sin() + (n % 2) as f32 * SETPOINT.gain_um_per_code
}

#[test]
fn nor_does_it_move_set_point_and_output_of_the_box_that_linearises() -> Result<()> {
    for up in [true, false] {
        let mut bench = Bench::started()?;
        let table = Table { drive: Some(DRIVE), ..*bench.table()? }.admit()?;
        bench.push(&table)?;
        let (adc, zero) = (table.adc, f32::from(table.adc.code(0.0f32).0));
        // The pin's voltage goes with the supply, and the amplifier with it.
        bench.board.connect(move |n, pin| {
            let volts = DRIVE.voltage::<f32>(DacCode(pin.unwrap_or(512))) * supply(n, up) / START_MV;
            read(zero, (volts - adc.offset_v) / adc.gain_v_per_code + (n % 2) as f32, n, up)
        });
        let fed = bench.board.record().conversions.len();
        bench.board.feed_sensor(move |n| read(SENSOR_ZERO, numbered(n).into(), n, up));
        bench.board.feed_setpoint(move |n| read(code(0.0), code(wanted(n)), n, up));
        bench.restart()?;
        bench.does(Request::Stream(true))?;
        let mut setpoint = 0.0f32;
        runs(&mut bench, fed, up, |bench, n| {
            let read = bench.health()?.setpoint.context("the set-point is read")?;
            // Of the sequences until the answer.
            let off = |n: u64| (f32::from(read) - code(wanted(n))).abs() / 65_520.0;
            setpoint = setpoint.max((n - 2..n + 20).map(off).fold(f32::INFINITY, f32::min));
            Ok(())
        })?;
        let (first, samples) = streamed(&bench)?;
        let (mut output, mut uncorrected, mut stroke) = (0.0f32, 0.0f32, 0.0f32);
        let (mut last, mut step) = (None, 0.0f32);
        let record = bench.board.record();
        let latches = shown(record, 0);
        for (n, sample) in (first..).zip(&samples) {
            // What a sequence gives comes out with the trigger after it.
            let Some(next) = record.conversions.get(fed + n as usize + 1) else { break };
            let at = latches.partition_point(|latch| latch.clock < next.trigger);
            let Some(latch) = latches.get(at) else { break };
            assert_eq!(latch.clock, next.trigger);
            let pin = f32::from(latch.code) / f32::from(PARTS) * supply(n, up) / START_MV;
            output = output.max((pin - f32::from(sample.dac)).abs() / 4_095.0);
            uncorrected = uncorrected.max(f32::from(sample.dac) * (supply(n, up) / START_MV - 1.0).abs() / 4_095.0);
            stroke = stroke.max(f32::from(sample.dac) / 4_095.0);
            step = step.max((pin - last.replace(pin).unwrap_or(pin)).abs());
        }
        println!(
            "to {} mV: of full scale the output moves by {:.3} %, {:.2} % uncorrected, the set-point by {:.3} %; the longest \
             step is {step:.1} codes",
            supply(LAST, up),
            100.0 * output,
            100.0 * uncorrected,
            100.0 * setpoint
        );
        assert!(output < 1e-3 && uncorrected > 0.02 && setpoint < 1e-3 && stroke > 0.5);
        // 20.48 codes, of which both what is commanded and what is given for it are rounded to parts.
        assert!(step < 20.7, "{step}");
    }
    Ok(())
}
