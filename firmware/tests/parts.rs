//! A DAC that is given parts of a code: each way to the output, sixteen times as fine as what a sample says of it.

mod common;

use common::{FACTS, LinkEnd, PERIOD, compiled, driving, started_on, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Admitted, DacCode, Status, Table};
use firmware::drive::Drive;
use firmware::queues::Command;
use firmware::ramp::Slewed;
use firmware::shaping::{DacParts, PARTS};
use firmware::startup::Startup;
use firmware::supply::Measured;
use firmware::{Facts, Tick};
use protocol::{Faults, Mode, Sample};

const FINE: Facts = Facts { dac_parts: PARTS, ..FACTS };
const FULL: u16 = 4095 * PARTS;
/// 20 mV or 20.48 codes a tick.
const STRIDE: u16 = 328;

fn fine(table: &Admitted, supply_mv: f32) -> (Tick<'static>, LinkEnd) {
    let facts = Facts { supply_mv: Some(supply_mv), ..FINE };
    let (tick, link) = started_on(&facts, Startup::new(Some(table), &facts, Faults::empty()));
    link.telemetry.begin(&facts, &Measured::of(facts.supply_mv));
    link.telemetry.streaming.store(true, Relaxed);
    (tick, link)
}

fn sample(link: &mut LinkEnd) -> Sample {
    link.queues.samples.dequeue().expect("a sample a tick").sample
}

#[test]
fn a_displacement_is_shown_to_a_part_and_the_sample_has_the_code() {
    let table = compiled();
    let (mut tick, mut link) = fine(&table, 3300.0);
    assert_eq!(link.telemetry.safe_given(), DacParts(table.dac.code(0.0f32).0 * PARTS));
    let mut between = 0;
    for k in 0..4_000 {
        let given = tick.sample(triangle(k).into(), k * PERIOD);
        let sample = sample(&mut link);
        assert_eq!(DacCode(given.0), table.dac.finer(PARTS).code(sample.displacement));
        assert_eq!(DacCode(sample.dac), table.dac.code(sample.displacement));
        assert!(given.0.abs_diff(sample.dac * PARTS) <= PARTS / 2, "{given:?}, {}", sample.dac);
        between += u32::from(given.0 % PARTS != 0);
    }
    assert!(between > 3_000, "{between}");
    link.queues.commands.enqueue(Command::SetMode(Mode::Pause)).expect("there is room");
    assert_eq!(tick.sample(triangle(0).into(), 4_000 * PERIOD), link.telemetry.safe_given());
}

#[test]
fn a_supply_that_is_off_is_made_up_for_to_a_part() {
    for mv in [3150.0f32, 3300.0, 3450.0] {
        let (mut tick, mut link) = fine(&compiled(), mv);
        for k in 0..2_000 {
            let given = tick.sample(AdcCode(20_000 + 3 * k as u16).into(), k * PERIOD);
            let wanted = compiled().dac.finer(PARTS).code(sample(&mut link).displacement);
            let exact = f32::from(wanted.0) * 3300.0 / mv;
            assert!((f32::from(given.0) - exact.min(FULL.into())).abs() <= 1.5, "{given:?} for {exact} at {mv} mV");
        }
    }
}

#[test]
fn a_drive_goes_by_parts_and_never_faster_than_it_may() {
    let table = driving();
    let (drive, limits) = (table.drive.expect("it drives").finer(PARTS), table.drive.expect("it drives").limits);
    let mut core = table.inverse::<f32>(&limits).expect("it has one");
    let (mut tick, mut link) = fine(&table, 3300.0);
    let rest = DacParts(drive.code(limits.rest_v, FULL).0);
    let amplifier = |DacParts(given): DacParts, k: u32| {
        let AdcCode(code) = table.adc.code(drive.voltage::<f32>(DacCode(given)));
        AdcCode(code + (k % 2) as u16)
    };
    link.queues.commands.enqueue(Command::SetMode(Mode::Follow)).expect("there is room");
    let mut given = tick.sample(amplifier(rest, 0).into(), 0);
    core.release();
    assert_eq!(given, rest);
    link.queues.commands.enqueue(Command::Go { hold: true }).expect("there is room");
    for k in 1..3_000 {
        let wanted = if k < 1_000 { 30.0 } else { 18.0 + 12.0 * (k as f32 * 0.02).sin() };
        link.queues.references.enqueue(wanted).expect("there is room");
        let (before, expected) = (given, DacParts(drive.code(core.tick(wanted).voltage, FULL).0));
        given = tick.sample(amplifier(before, k).into(), k * PERIOD);
        assert_eq!(given, expected, "tick {k}");
        assert!(given.0.abs_diff(before.0) <= STRIDE, "{before:?} → {given:?}");
    }
    // Without the tick.
    let way: Vec<DacParts> = link.telemetry.ramp(given).collect();
    let steps = std::iter::once(&given).chain(&way).zip(&way).map(|(a, b)| a.0.abs_diff(b.0));
    assert!(steps.max() <= Some(STRIDE), "{way:?}");
    assert_eq!(way.last(), Some(&link.telemetry.safe_given()));
    link.queues.commands.enqueue(Command::SetMode(Mode::Estimate)).expect("there is room");
    for k in 3_000..3_200 {
        let before = given;
        given = tick.sample(amplifier(before, k).into(), k * PERIOD);
        assert!(given.0.abs_diff(before.0) <= STRIDE, "{before:?} → {given:?}");
    }
    assert_eq!(given, rest);
}

/// A tick's change of a slow voltage is rounded, over a whole range always the same way.
#[test]
fn what_the_dac_is_given_does_not_fall_behind_a_slow_drive() {
    for slew_v_per_s in [0.014, 0.015, 0.02, 0.05, 0.3, 40.0] {
        let drive = driving().drive.map(|mut drive| {
            drive.limits.slew_v_per_s = slew_v_per_s;
            drive
        });
        let table = Table { drive, ..*driving() }.admit().expect("it is gone through in ten minutes");
        let (_, link) = fine(&table, 3300.0);
        let (mut drive, stride) =
            (Drive::new(&table, PARTS).expect("the table has one"), link.telemetry.stride_given());
        let mut slewed = Slewed::at(link.telemetry.safe_given());
        drive.go(true);
        let mut goes_on = |up: bool| {
            let (DacParts(wanted), status) = if up {
                let (codes, status) = drive.excite(Some(3.6));
                (codes.parts, status)
            } else {
                (drive.release().parts, Status::empty())
            };
            assert_eq!(slewed.step(DacParts(wanted), stride, 4), DacParts(wanted), "{slew_v_per_s} V/s");
            if up { status.contains(Status::OUT_OF_REACH) } else { !drive.rests() }
        };
        while goes_on(true) {}
        while goes_on(false) {}
    }
}
