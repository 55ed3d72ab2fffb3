//! The DAC drives the amplifier to voltages, beside a sensor.

mod common;

use common::driven::{Bench, REST, STRIDE};
use common::driving;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, DacCode, Status};
use firmware::Conversion;
use firmware::drive::{Following, REFERENCE_TIMEOUT_TICKS};
use firmware::watch::SATURATED;
use protocol::{Faults, Mode};

/// A bench that is to be driven to voltages, before the first.
fn excited(hold: bool) -> Bench {
    let mut bench = Bench::new();
    bench.set(Mode::Excite);
    bench.step();
    bench.go(hold);
    bench.step();
    bench
}

/// The DAC's code of a voltage.
fn code_of(volts: f32) -> DacCode {
    driving().drive.unwrap().code(volts, 4095)
}

/// Drives to a voltage for some ticks, none further from the last than the slew rate allows; the last tick's.
fn drive_to(bench: &mut Bench, volts: f32, ticks: u32) -> (DacCode, Status, Faults) {
    let step = |bench: &mut Bench| {
        let last = bench.dac;
        bench.link.queues.references.enqueue(volts).unwrap();
        let (dac, status, faults) = bench.step();
        assert!(dac.0.abs_diff(last.0) <= STRIDE, "{last:?} → {dac:?}");
        (dac, status, faults)
    };
    (0..ticks).map(|_| step(bench)).last().unwrap()
}

#[test]
fn slow_voltages_are_put_out_as_they_are_beside_the_sensor() {
    let mut bench = excited(false);
    drive_to(&mut bench, 2.0, 200);
    // At most 15 V/s of 40.
    let wave = |k: u32| 2.0 + 1.5 * (k as f32 * 0.005).sin();
    for k in 0..4_000 {
        bench.link.queues.references.enqueue(wave(k)).unwrap();
        let conversion =
            Conversion { monitor: bench.amplifier(), sensor: Some(AdcCode((7 * k) as u16)), setpoint: None };
        let (dac, sample) = bench.read(conversion);
        let sample = sample.unwrap();
        assert_eq!(dac, code_of(wave(k)), "tick {k}");
        assert_eq!((sample.code, sample.sensor), (conversion.monitor.0, Some((7 * k) as u16)), "tick {k}");
        assert!(!sample.status.contains(Status::OUT_OF_REACH), "tick {k}");
        assert_eq!(sample.faults, Faults::empty(), "tick {k}");
        assert!(bench.tick.valid());
    }
    assert!(bench.read(bench.amplifier().into()).1.is_some_and(|sample| sample.sensor.is_none()));
}

#[test]
fn what_the_range_or_the_slew_rate_forbids_is_said_and_not_done() {
    let mut bench = excited(false);
    // From half a volt to 3.6 V at 20 mV a tick are 155 ticks.
    for (wanted, ticks, end, reached) in [
        (100.0, 300, 3.6, false),
        (-5.0, 300, 0.0, false),
        (3.6, 170, 3.6, false),
        (3.6, 30, 3.6, true),
        (2.0, 81, 2.0, true),
    ] {
        let (dac, status, faults) = drive_to(&mut bench, wanted, ticks);
        assert_eq!(
            (dac == code_of(end), status.contains(Status::OUT_OF_REACH)),
            (ticks != 170, !reached),
            "{wanted} V"
        );
        assert_eq!(faults, Faults::empty(), "{wanted} V");
    }
    assert!(bench.link.telemetry.out_of_reach.load(Relaxed) > 600);
    // The link refuses these; were one to come, the voltage would stay.
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (dac, status, _) = drive_to(&mut bench, odd, 50);
        assert_eq!((dac, status.contains(Status::OUT_OF_REACH)), (code_of(2.0), true), "{odd}");
    }
    assert_eq!(drive_to(&mut bench, 2.1, 20).0, code_of(2.1), "and goes on from there");
}

#[test]
fn every_change_of_mode_goes_on_from_the_voltage_where_it_is() {
    let table = driving();
    let drive = table.drive.unwrap();
    let mut core = table.inverse::<f32>(&drive.limits).unwrap();
    let mut bench = Bench::new();
    // What is driven in each mode, by which inverse's tick.
    let mut last = REST;
    let mut drive_in = |bench: &mut Bench, mode: Mode, wanted: f32| {
        bench.set(mode);
        let mut check = |bench: &mut Bench, voltage: f32, what: &str| {
            let (dac, ..) = bench.step();
            assert_eq!(dac, drive.code(voltage, 4095), "{mode:?}: {what}");
            assert!(dac.0.abs_diff(last.0) <= STRIDE, "{mode:?}: {last:?} → {dac:?}");
            last = dac;
        };
        // On the way to rest until references come.
        for _ in 0..5 {
            check(bench, core.release().voltage, "on the way to rest");
        }
        bench.go(false);
        for _ in 0..60 {
            bench.link.queues.references.enqueue(wanted).unwrap();
            let commanded = if mode == Mode::Excite { core.steer(wanted) } else { core.tick(wanted) };
            check(bench, commanded.voltage, "driven");
        }
        assert_ne!(last, REST, "{mode:?}: left in mid-way");
    };
    drive_in(&mut bench, Mode::Follow, 30.0);
    drive_in(&mut bench, Mode::Excite, 3.0);
    drive_in(&mut bench, Mode::Follow, 15.0);
    drive_in(&mut bench, Mode::Excite, 2.5);
    for mode in [Mode::Estimate, Mode::Pause, Mode::Pil] {
        bench.set(Mode::Excite);
        bench.go(true);
        bench.step();
        assert!(drive_to(&mut bench, 3.0, 200).0 == code_of(3.0));
        bench.set(mode);
        for _ in 0..200 {
            let last = bench.dac;
            let (dac, ..) = bench.step();
            assert!(dac.0.abs_diff(last.0) <= STRIDE, "{mode:?}: {last:?} → {dac:?}");
        }
        assert_eq!(bench.dac, REST, "{mode:?}");
    }
}

#[test]
fn a_fault_brings_it_to_rest_without_a_jump_and_it_stays_there_until_it_is_set_again() {
    let mut bench = excited(true);
    drive_to(&mut bench, 3.0, 300);
    for _ in 0..SATURATED + 200 {
        let last = bench.dac;
        let _ = bench.link.queues.references.enqueue(3.0);
        let (dac, _, faults) = bench.step_with(AdcCode(65_520));
        assert!(dac.0.abs_diff(last.0) <= STRIDE, "{last:?} → {dac:?}");
        assert!(faults.contains(Faults::ADC_SATURATED | Faults::SAFE_OUTPUT) || dac == code_of(3.0), "{faults:?}");
    }
    assert_eq!(bench.dac, REST);
    // The fault passes, and voltages still come.
    let (dac, _, faults) = drive_to(&mut bench, 3.0, 5_000);
    assert_eq!((dac, faults), (REST, Faults::SAFE_OUTPUT));
    bench.set(Mode::Excite);
    bench.go(true);
    bench.step();
    assert_eq!(drive_to(&mut bench, 3.0, 200).0, code_of(3.0));
}

#[test]
fn an_amplifier_that_does_not_go_along_is_a_fault() {
    let mut bench = excited(false);
    let unmoved = bench.amplifier();
    let mut faults = Faults::empty();
    for k in 0..1_000 {
        let last = bench.dac;
        bench.link.queues.references.enqueue(3.0).unwrap();
        let (dac, _, found) = bench.step_with(AdcCode(unmoved.0 + k % 2));
        assert!(dac.0.abs_diff(last.0) <= STRIDE, "{last:?} → {dac:?}");
        faults |= found;
    }
    assert_eq!((faults, bench.dac), (Faults::AMPLIFIER | Faults::SAFE_OUTPUT, REST));
}

#[test]
fn where_nobody_speaks_any_more_it_goes_back_to_rest_unless_it_is_to_hold() {
    for hold in [true, false] {
        let mut bench = excited(hold);
        drive_to(&mut bench, 3.0, 200);
        let (held, ..) = (1..REFERENCE_TIMEOUT_TICKS).map(|_| bench.step()).last().unwrap();
        assert_eq!(held, code_of(3.0));
        for _ in 0..200 {
            let last = bench.dac;
            let (dac, ..) = bench.step();
            assert!(dac.0.abs_diff(last.0) <= STRIDE, "{last:?} → {dac:?}");
        }
        let (later, _, faults) = bench.step();
        assert_eq!(later, if hold { code_of(3.0) } else { REST });
        assert_eq!(faults.contains(Faults::SAFE_OUTPUT), !hold);
        let held = bench.link.telemetry.following() == Following::UntilModeEnds;
        assert_eq!(held, hold);
    }
}
