//! The DAC drives the amplifier to voltages, beside a sensor: every code within the slew rate, every sample with what
//! both pins showed, and a way back to rest that never jumps.

use crate::common::{Bench, FULL, PARTS, PERIOD, shown};
use anyhow::{Result, bail};
use board_emulator_test::{Latch, exception};
use estimator_core::*;
use protocol::{Faults, Mode, References, Reply, Request};

/// 20 mV or 20.48 codes a tick, in parts of a code 327.68.
const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
const STRIDE: u16 = 328;
/// Half a volt.
const REST: u16 = 512 * PARTS;

/// A device in the mode, at rest, whose ADC reads the amplifier.
fn excited() -> Result<Bench> {
    let mut bench = Bench::started()?;
    let table = Table { drive: Some(DRIVE), ..*bench.table()? }.admit()?;
    bench.connect(&table, |volts| volts);
    bench.push(&table)?;
    bench.restart()?;
    bench.does(Request::SetMode(Mode::Excite))?;
    Ok(bench)
}

/// Sends voltages as fast as they are taken, and waits until the last has been put out; the ticks that
/// found none meanwhile.
fn refer(bench: &mut Bench, volts: &[f32]) -> Result<u32> {
    let ask = |bench: &mut Bench, first, references, go| match bench.ask(Request::Refer {
        first,
        references,
        go,
        hold: false,
    })? {
        Reply::Referred { next, starved } => Ok((next, starved)),
        other => bail!("{other:?}"),
    };
    let (begin, _) = ask(bench, 0, References::new(), false)?;
    let (mut sent, mut ticks_without) = (0, 0);
    while sent < volts.len() {
        let references = volts[sent..].iter().take(64).copied().collect();
        let (next, starved) = ask(bench, begin + sent as u32, references, true)?;
        (sent, ticks_without) = ((next - begin) as usize, starved);
        bench.run(0.01)?;
    }
    // The queue takes 255 ticks.
    bench.run(0.15)?;
    Ok(ticks_without)
}

/// Their codes, none further from the last than the slew rate allows.
fn codes(bench: &Bench, start: usize) -> Vec<u16> {
    let outputs = shown(bench.board.record(), start);
    let step = |pair: &[Latch]| pair[0].code.abs_diff(pair[1].code);
    let jump = outputs.windows(2).find(|pair| step(pair) > STRIDE || pair[1].clock - pair[0].clock != PERIOD);
    assert_eq!(jump, None, "faster than the slew rate, or off the trigger");
    outputs.iter().map(|latch| latch.code).collect()
}

#[test]
fn voltages_are_put_out_within_the_slew_rate_and_silence_ends_at_rest() -> Result<()> {
    let mut bench = excited()?;
    bench.board.feed_sensor(|n| (n * 4_095 % 65_521) as u16);
    bench.does(Request::Stream(true))?;
    let start = bench.board.record().outputs.len();
    let served = bench.board.instructions(exception::ADC1_2).count();
    // Waves that the slew rate holds, then ends beyond the range, at once.
    let mut wanted: Vec<f32> = (0..2_000).map(|k| 0.5 + 3.0 * (k as f32 * 0.003).sin().abs()).collect();
    wanted.extend([100.0; 300]);
    wanted.extend([-100.0; 300]);
    assert_eq!(refer(&mut bench, &wanted)?, 0, "a voltage was waiting at every tick");
    let shown = codes(&bench, start);

    let mut inverse = bench.table()?.inverse::<f32>(&LIMITS)?;
    let expected: Vec<u16> =
        wanted.iter().map(|&volts| DRIVE.finer(PARTS).code(inverse.steer(volts).voltage, FULL).0).collect();
    let moves = |codes: &[u16]| codes.iter().position(|&code| code != REST).expect("it moves");
    let (begins, first) = (moves(&expected), moves(&shown));
    let expected = &expected[begins..];
    assert!(shown[first..].starts_with(expected), "not the codes of the wanted voltages");
    assert_eq!((expected.iter().max(), expected.last()), (Some(&DRIVE.finer(PARTS).code(3.6f32, FULL).0), Some(&0)));
    let most = bench.board.instructions(exception::ADC1_2).skip(served).max();
    println!("driven to voltages, with a sensor: {} instructions in the tick's interrupt at most", most.unwrap_or(0));

    let samples = bench.samples.iter().flat_map(|batch| &batch.samples);
    let driven: Vec<_> = samples.filter(|sample| !sample.faults.contains(Faults::SAFE_OUTPUT)).collect();
    assert!(driven.len() >= expected.len() && driven.iter().all(|sample| sample.faults.is_empty()));
    let sensor = driven.iter().map(|sample| sample.sensor.map(u32::from)).collect::<Option<Vec<u32>>>();
    let sensor = sensor.expect("every sample has the sensor's code");
    let next = |pair: &[u32]| (pair[0] + 4_095) % 65_521 == pair[1];
    assert!(sensor.windows(2).all(next), "the sensor's code of the next trigger");

    // A second after the last voltage.
    bench.run(0.75)?;
    assert_eq!(bench.board.output(), Some(0), "it is held");
    bench.run(0.3)?;
    assert_eq!(codes(&bench, start).last(), Some(&REST));
    assert_eq!(bench.health()?.missed, 0);
    Ok(())
}

#[test]
fn a_saturated_monitor_ends_it_at_rest_whatever_comes() -> Result<()> {
    let mut bench = excited()?;
    let start = bench.board.record().outputs.len();
    refer(&mut bench, &[3.0; 400])?;
    assert_eq!(bench.board.output(), Some(DRIVE.code(3.0f32, 4095).0));
    bench.board.feed(|n| 65_520 - (n % 2) as u16);
    refer(&mut bench, &[3.0; 400])?;
    assert_eq!(codes(&bench, start).last(), Some(&REST));
    let faults = bench.health()?.faults;
    assert!(faults.contains(Faults::ADC_SATURATED | Faults::SAFE_OUTPUT), "{faults:?}");
    Ok(())
}
