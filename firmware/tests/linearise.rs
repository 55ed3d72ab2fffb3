//! A controller's set-point, followed without a host.

mod common;

use common::driven::{Bench, REST, STRIDE};
use common::{FACTS, SETPOINT, linearising, started_on};
use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Table};
use firmware::drive::REFERENCE_TIMEOUT_TICKS;
use firmware::queues::Command;
use firmware::restarts::Restarts;
use firmware::setpoint::CALM_TICKS;
use firmware::startup::Startup;
use firmware::supply::Measured;
use firmware::watch::{HOLD, SATURATED};
use firmware::{Conversion, Facts};
use protocol::{Faults, Mode};

fn code(um: f32) -> AdcCode {
    AdcCode(((um - SETPOINT.offset_um) / SETPOINT.gain_um_per_code) as u16)
}

/// A bench with a controller, which wants so much from the first tick on.
struct Controlled {
    bench: Bench,
    wants: AdcCode,
}

impl Controlled {
    fn new(at_start: bool, facts: &Facts, doubts: Faults) -> Self {
        Self::of(&linearising(at_start), facts, doubts)
    }

    fn of(table: &Admitted, facts: &Facts, doubts: Faults) -> Self {
        let (tick, link) = started_on(facts, Startup::new(Some(table), facts, doubts));
        link.telemetry.streaming.store(true, std::sync::atomic::Ordering::Relaxed);
        let dac = link.telemetry.safe();
        Self { bench: Bench { tick, link, k: 0, dac }, wants: code(30.0) }
    }

    /// A tick; no step is longer than the slew rate allows.
    fn step(&mut self) -> (DacCode, Faults) {
        self.step_with(self.bench.amplifier())
    }

    fn step_with(&mut self, monitor: AdcCode) -> (DacCode, Faults) {
        let before = self.bench.dac;
        // With a converter's noise.
        let setpoint = Some(AdcCode(self.wants.0.saturating_add((self.bench.k % 3) as u16)));
        let (dac, sample) = self.bench.read(Conversion { monitor, sensor: None, setpoint });
        assert!(dac.0.abs_diff(before.0) <= STRIDE, "tick {}: {before:?} → {dac:?}", self.bench.k);
        (dac, sample.map_or(Faults::all(), |sample| sample.faults))
    }

    fn run(&mut self, ticks: u32) -> (DacCode, Faults) {
        (0..ticks).map(|_| self.step()).last().expect("at least one tick")
    }

    fn mode(&self) -> Mode {
        self.bench.link.telemetry.mode()
    }
}

#[test]
fn from_rest_it_goes_to_wherever_the_set_point_is_as_fast_as_the_slew_rate_and_follows_it_as_the_inverse_does() {
    let mut device = Controlled::new(false, &FACTS, Faults::empty());
    device.run(10);
    assert_eq!((device.mode(), device.bench.dac), (Mode::Estimate, REST), "it is not asked to");
    device.bench.set(Mode::Linearise);
    assert_eq!(device.run(CALM_TICKS), (REST, Faults::SAFE_OUTPUT), "at rest while it looks at what there is");
    let table = linearising(false);
    let drive = table.drive.unwrap();
    let mut core = table.inverse::<f32>(&drive.limits).unwrap();
    for _ in 0..10 + CALM_TICKS {
        core.release();
    }
    let mut steps = Vec::new();
    for k in 0..6_000 {
        // A jump from end to end, and a swing.
        let um = if k < 1_500 { 40.0 } else { 20.0 + 15.0 * (k as f32 * 0.01).sin() };
        device.wants = code(um);
        let read = AdcCode(device.wants.0 + (device.bench.k % 3) as u16);
        let expected = drive.code(core.tick(SETPOINT.displacement::<f32>(read)).voltage, 4095);
        let before = device.bench.dac.0;
        assert_eq!(device.step(), (expected, Faults::empty()), "tick {k}");
        steps.push(device.bench.dac.0.abs_diff(before));
    }
    assert!(steps[..50].iter().all(|&step| step >= STRIDE - 1), "as fast as it may: {:?}", &steps[..50]);
}

#[test]
fn a_fault_of_the_set_point_brings_it_to_rest_and_there_it_stays_until_it_is_told_again() {
    let open = [("an end", AdcCode(0)), ("the other end", AdcCode(65_520)), ("near an end", AdcCode(300))];
    for (name, at) in open {
        let mut device = Controlled::new(true, &FACTS, Faults::empty());
        let (held, faults) = device.run(CALM_TICKS + 1_000);
        assert!(held.0 > REST.0 + 500 && faults.is_empty(), "{name}: {held:?} {faults:?}");
        device.wants = at;
        // Nobody wants to be where a broken wire is: what was wanted last is held, but for creep.
        let (after, faults) = device.run(SATURATED - 2);
        assert!(after.0.abs_diff(held.0) < 5 && faults.is_empty(), "{name}: {held:?} → {after:?} {faults:?}");
        let (_, faults) = device.run(2);
        assert_eq!(faults, Faults::SETPOINT | Faults::SAFE_OUTPUT, "{name}");
        device.wants = code(30.0);
        let (dac, faults) = device.run(HOLD + 2 * CALM_TICKS + 2 * REFERENCE_TIMEOUT_TICKS);
        assert_eq!((dac, faults, device.mode()), (REST, Faults::SAFE_OUTPUT, Mode::Linearise), "{name}");
        device.bench.set(Mode::Linearise);
        assert!(device.run(CALM_TICKS + 1_000).0.0 > REST.0 + 500, "{name}: set again, it follows again");
    }
}

#[test]
fn a_fault_that_begins_as_it_would_set_out_keeps_it_waiting() {
    let mut device = Controlled::new(true, &FACTS, Faults::empty());
    assert_eq!(device.run(CALM_TICKS).0, REST);
    device.wants = AdcCode(0);
    let (dac, faults) = device.run(SATURATED + 10);
    assert_eq!((dac, faults), (REST, Faults::SETPOINT | Faults::SAFE_OUTPUT));
    device.wants = code(30.0);
    for tick in 0..HOLD / 2 {
        let (dac, faults) = device.step();
        assert!(dac == REST && faults.contains(Faults::SAFE_OUTPUT), "tick {tick}: {dac:?} {faults:?}");
    }
    assert!(device.run(HOLD + CALM_TICKS + 1_000).0.0 > REST.0 + 500, "once all is sound it sets out");
}

/// The rest voltage less the model's zero and plus it again is another `f32`, whose code may be the next one.
#[test]
fn it_sets_out_from_a_rest_voltage_half_way_between_two_codes() {
    let table = Table { voltage_zero_v: -0.1, ..*linearising(true) }.admit().expect("a zero within the range");
    let drive = table.drive.unwrap();
    let elsewhere = |rest_v: f32| (rest_v - table.voltage_zero_v) + table.voltage_zero_v;
    let near = |code: u32| {
        let half = (code as f32 + 0.5) / drive.gain_codes_per_v;
        (half.to_bits() - 8..half.to_bits() + 8).map(f32::from_bits)
    };
    let mut halves = (300..1_000).flat_map(near).map(|rest_v| {
        let limits = DriveLimits { rest_v, ..drive.limits };
        DriveCalibration { limits, ..drive }
    });
    let code = |drive: &DriveCalibration, volts: f32| drive.code(volts, 4095);
    let rest_of =
        |drive: &DriveCalibration| (code(drive, drive.limits.rest_v), code(drive, elsewhere(drive.limits.rest_v)));
    let drive = halves.find(|drive| rest_of(drive).0 != rest_of(drive).1).expect("one of so many");
    let table = Table { drive: Some(drive), ..*table }.admit().expect("it has an inverse");
    let mut device = Controlled::of(&table, &FACTS, Faults::empty());
    assert!(device.run(CALM_TICKS + 1_000).0.0 > REST.0 + 500, "it waits at {:?}", device.bench.dac);
}

#[test]
fn it_sets_out_from_rest_however_long_the_way_there_takes() {
    let table = linearising(true);
    let drive = table.drive.unwrap();
    // A code in four ticks.
    let limits = DriveLimits { slew_v_per_s: 0.5, ..drive.limits };
    let slow = Table { drive: Some(DriveCalibration { limits, ..drive }), ..*table }.admit().unwrap();
    let mut device = Controlled::of(&slow, &FACTS, Faults::empty());
    let (high, _) = device.run(5 * CALM_TICKS);
    assert!(high.0 > REST.0 + 4 * STRIDE, "{high:?}");
    device.bench.set(Mode::Pause);
    device.run(10);
    device.bench.set(Mode::Linearise);
    let codes: Vec<DacCode> = (0..6 * CALM_TICKS).map(|_| device.step().0).collect();
    let arrives = codes.iter().position(|&code| code == REST).expect("it goes to rest first");
    assert!(arrives > CALM_TICKS as usize, "{arrives}: the way takes longer than the wait");
    assert!(codes[..arrives].windows(2).all(|pair| pair[1] <= pair[0]), "straight there");
    let leaves = codes[arrives..].iter().position(|&code| code != REST).expect("it sets out again");
    assert!(leaves >= CALM_TICKS as usize, "{leaves} ticks at rest");
}

#[test]
fn a_glitch_of_the_set_point_moves_nothing() {
    let mut device = Controlled::new(true, &FACTS, Faults::empty());
    let (held, _) = device.run(CALM_TICKS + 4_000);
    device.wants = AdcCode(0);
    let (after, faults) = device.run(SATURATED / 2);
    assert!(after.0.abs_diff(held.0) < 6 && faults.is_empty(), "{held:?} → {after:?}");
    device.wants = code(30.0);
    assert!(device.run(5_000).1.is_empty());
}

#[test]
fn every_way_out_is_a_ramp() {
    type End = fn(&mut Controlled);
    let ends: [(&str, End); 7] = [
        ("estimate", |device| device.bench.set(Mode::Estimate)),
        ("pause", |device| device.bench.set(Mode::Pause)),
        ("pil", |device| device.bench.set(Mode::Pil)),
        ("follow", |device| device.bench.set(Mode::Follow)),
        ("excite", |device| device.bench.set(Mode::Excite)),
        ("supply", |device| {
            device.bench.link.telemetry.supply.publish(&Measured::of(Some(3000.0)));
        }),
        ("monitor", |device| {
            for _ in 0..SATURATED + 200 {
                device.step_with(AdcCode(65_520));
            }
        }),
    ];
    for (name, end) in ends {
        let mut device = Controlled::new(true, &FACTS, Faults::empty());
        assert!(device.run(CALM_TICKS + 1_000).0.0 > REST.0 + 500, "{name}");
        end(&mut device);
        let (dac, faults) = device.run(2_000);
        assert!(dac == REST && faults.contains(Faults::SAFE_OUTPUT), "{name}: {dac:?} {faults:?}");
    }
}

#[test]
fn after_a_start_it_waits_for_a_controller_that_comes_later_and_for_an_amplifier() {
    let mut device = Controlled::new(true, &FACTS, Faults::empty());
    device.wants = AdcCode(0);
    let (dac, faults) = device.run(3 * CALM_TICKS);
    assert_eq!((dac, faults, device.mode()), (REST, Faults::SETPOINT | Faults::SAFE_OUTPUT, Mode::Linearise));
    // The controller comes on for less than a second, then the monitor goes.
    device.wants = code(30.0);
    assert_eq!(device.run(CALM_TICKS - 1).0, REST);
    for _ in 0..500 {
        assert_eq!(device.step_with(AdcCode(65_520)).0, REST);
    }
    assert_eq!(device.run(HOLD).0, REST);
    assert!(device.run(CALM_TICKS + 1_000).0.0 > REST.0 + 500, "all is sound");
}

#[test]
fn it_is_not_entered_of_itself_after_a_failure_or_with_another_table_or_without_the_channel() {
    let failed = Facts { restarts: Restarts { count: 1, ..FACTS.restarts }, ..FACTS };
    let blind = Facts { has_setpoint: false, ..FACTS };
    let none = Faults::empty();
    for (name, facts, doubts, mode) in [
        ("sound", FACTS, none, Mode::Linearise),
        ("failed", failed, none, Mode::Estimate),
        ("fallback", FACTS, Faults::TABLE_FALLBACK, Mode::Estimate),
        ("no channel", blind, none, Mode::Estimate),
    ] {
        let mut device = Controlled::new(true, &facts, doubts);
        let (dac, _) = device.run(CALM_TICKS + 1_000);
        let moves = dac > device.bench.link.telemetry.safe();
        assert_eq!((device.mode(), moves), (mode, mode == Mode::Linearise), "{name}");
    }
}

#[test]
fn a_board_that_gives_no_code_stays_at_rest() {
    let mut device = Controlled::new(true, &FACTS, Faults::empty());
    for _ in 0..3 * CALM_TICKS {
        assert_eq!(device.bench.step().0, REST);
    }
}

/// Of the set-point nothing is estimated: a controller that is off for a while takes no zero with it.
#[test]
fn a_set_point_that_fails_and_comes_back_leaves_the_zero_alone_and_a_monitor_s_end_does_not() {
    let mut device = Controlled::new(false, &FACTS, Faults::empty());
    device.run(10);
    device.bench.link.queues.commands.enqueue(Command::SetZero { at_um: 2.0 }).unwrap();
    device.run(10);
    device.bench.set(Mode::Linearise);
    device.run(2 * CALM_TICKS);
    let told = |device: &Controlled| device.bench.link.telemetry.bias.age_ticks().is_some();
    device.wants = AdcCode(0);
    assert!(device.run(2 * SATURATED).1.contains(Faults::SETPOINT) && told(&device));
    device.wants = code(30.0);
    assert!(!device.run(2 * HOLD).1.contains(Faults::SETPOINT) && told(&device));
    (0..2 * SATURATED).for_each(|_| _ = device.step_with(AdcCode(0)));
    assert!(!device.run(2 * HOLD).1.contains(Faults::ADC_SATURATED) && !told(&device));
}
