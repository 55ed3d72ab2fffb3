//! What the output shows behind the low-pass of the wiring: a wish of a nanometre more, and no ripple as large.

use crate::common::{Bench, shown};
use anyhow::Result;
use board_emulator_test::{CORE_HZ, Latch};
use estimator_core::{DacCalibration, Table};
use protocol::{Faults, Request};

/// The low-pass of the wiring: 4.7 kΩ and 68 nF, 498 Hz.
const TIME_CONSTANT_S: f64 = 4.7e3 * 68e-9;
/// Displacements at 0 V and 3.3 V of the pin, −8 and 52 µm, for 0 to 45 µm between: a code is 14.65 nm.
const NM_A_CODE: f64 = 60e3 / 4095.0;
const DAC: DacCalibration =
    DacCalibration { gain_codes_per_um: 4095.0 / 60.0, offset_code: 8.0 * 4095.0 / 60.0, full_scale: 4095 };

/// What is behind the low-pass when each code comes, in codes.
fn low_passed(outputs: &[Latch]) -> Vec<f64> {
    let mut behind = f64::from(outputs[0].code);
    outputs
        .windows(2)
        .map(|pair| {
            let seconds = (pair[1].clock - pair[0].clock) as f64 / f64::from(CORE_HZ);
            behind += (f64::from(pair[0].code) - behind) * (1.0 - (-seconds / TIME_CONSTANT_S).exp());
            behind
        })
        .collect()
}

/// A device that shows this voltage by [`DAC`], virgin and at rest there: nothing creeps. Its code moves now and then,
/// by less than is followed, so that it has not stopped.
fn at_rest() -> Result<Bench> {
    let mut bench = Bench::started()?;
    let table = Table { dac: DAC, ..*bench.table()? }.admit()?;
    bench.push(&table)?;
    bench.board.feed(|n| 30_000 + u16::from(n % 1_500 == 0));
    bench.restart()?;
    bench.run(2.0)?;
    Ok(bench)
}

#[test]
fn a_nanometre_of_45_micrometres_is_a_step_behind_the_low_pass_and_its_ripple_is_smaller() -> Result<()> {
    let mut bench = at_rest()?;
    let (mut before, mut least_step, mut worst, mut ripple) = (None, f64::INFINITY, 0.0f64, 0.0f64);
    for nm in 0..=32 {
        bench.does(Request::SetZero { at_um: 20.0 + 1e-3 * nm as f32 })?;
        let start = bench.board.record().outputs.len();
        bench.run(0.04)?;
        let behind = low_passed(&bench.board.record().outputs[start..]);
        // A hundred time constants' settling away.
        let settled = &behind[behind.len() - 800..];
        let mean = settled.iter().sum::<f64>() / settled.len() as f64;
        let (least, most) =
            settled.iter().fold((f64::INFINITY, 0.0f64), |(least, most), &code| (least.min(code), most.max(code)));
        ripple = ripple.max((most - least) * NM_A_CODE);
        let wanted = f64::from(DAC.offset_code) + f64::from(DAC.gain_codes_per_um) * (20.0 + 1e-3 * f64::from(nm));
        worst = worst.max((mean - wanted).abs() * NM_A_CODE);
        if let Some(before) = before.replace(mean) {
            least_step = least_step.min((mean - before) * NM_A_CODE);
        }
    }
    println!(
        "behind the low-pass, for wishes that grow by 1 nm: steps of {least_step:.2} nm at least, off by {worst:.2} nm at most, \
         ripple {ripple:.2} nm from peak to peak; a code is {NM_A_CODE:.2} nm"
    );
    assert!(least_step > 0.5, "{least_step} nm");
    assert!(worst < 0.6, "{worst} nm");
    assert!(ripple < 1.0, "{ripple} nm");
    assert_eq!(bench.health()?.faults_seen, Faults::empty());
    Ok(())
}

#[test]
fn what_the_pin_has_toggles_between_neighbours_at_100_khz() -> Result<()> {
    let mut bench = at_rest()?;
    // 546 and 1,365.2 codes.
    bench.does(Request::SetZero { at_um: 20.003 })?;
    bench.run(0.15)?;
    let start = bench.board.record().outputs.len() - 10_000;
    let record = bench.board.record();
    let outputs = &record.outputs[start..];
    assert!(outputs.windows(2).all(|pair| pair[1].clock - pair[0].clock == u64::from(CORE_HZ) / 100_000));
    let codes = outputs.iter().map(|latch| latch.code);
    let (least, most) = (codes.clone().min(), codes.max());
    assert!(most.zip(least).is_some_and(|(most, least)| most - least == 1), "{least:?} … {most:?}");
    let shown: Vec<u16> = shown(record, start).iter().map(|latch| latch.code).collect();
    assert!(shown[1..].windows(2).all(|pair| pair[0] == pair[1]), "the mean of a tick stands still");
    Ok(())
}
