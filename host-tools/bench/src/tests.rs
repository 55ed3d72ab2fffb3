//! Sessions on an emulated board.

use super::*;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::pages;
use device_link::table::{in_use, to_record};
use emulator::{Bench, EmulatedDevice, Emulator};
use estimator_core::{AdcCode, Table};
use excitation::{Drive, Request};
use identifiability::{Experiment, Told};
use parameter_store::RamFlash;
use plants::Kind;
use std::path::Path;

pub use crate::EMULATED as FACTS;

fn wiring() -> Wiring {
    Wiring::new(&FACTS, 500).unwrap()
}

/// A table by which the device drives, other than the straight line's.
fn former() -> estimator_core::Admitted {
    let line = *wiring().line();
    Table { provenance: estimator_core::Provenance { seed: 7, ..line.provenance }, ..*line }.admit().unwrap()
}

/// The straight line as if it had been learnt.
fn model() -> estimator_core::Admitted {
    let line = *wiring().line();
    let provenance = estimator_core::Provenance { tool_version: [0, 1, 0], ..line.provenance };
    Table { provenance, ..*line }.admit().unwrap()
}

fn device(sensor_um: Option<(f64, f64)>) -> EmulatedDevice {
    let bench = Bench { sensor_um, ..emulated(&wiring(), Kind::BoucWen, 1) };
    connected_to(bench.connected())
}

fn connected_to(plant: impl emulator::Plant) -> EmulatedDevice {
    let flash = RamFlash::new(pages::with(&to_record(&former()), 4096).unwrap());
    Emulator::new().flash(flash).plant(plant).speed(8.0).start().unwrap()
}

fn drive(duration_s: f64) -> Drive {
    let request = Request { slew_v_per_s: 500.0, ..wiring().request(None, 20.0, duration_s, 1).unwrap() };
    Drive::design(&request).unwrap()
}

/// Trains on a device; interrupts after so many ticks.
fn trained(device: &EmulatedDevice, folder: &Path, until: usize) -> (Trained, Client) {
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let (wiring, drive, interrupt) = (wiring(), drive(40.0), Interrupt::default());
    let training = Training { wiring: &wiring, drive: &drive, folder, interrupt: &interrupt };
    let trained = train(&mut client, &training, &mut |_, ticks| {
        if ticks == until {
            interrupt.want();
        }
    });
    (trained.unwrap(), client)
}

/// Asserts that the voltage is at rest and the table of before in use.
fn is_home(client: &mut Client, folder: &Path) {
    assert_eq!(in_use(client).unwrap().unwrap(), to_record(&former()));
    client.stream(true).unwrap();
    let batch = client.samples(std::time::Duration::from_secs(2)).unwrap().unwrap();
    let volts: f32 = wiring().adc().voltage(AdcCode(batch.samples[0].code));
    assert!(volts.abs() < 0.2, "{volts} V");
    assert!(!folder.join(FORMER).exists());
}

#[test]
fn two_minutes_tell_creep_and_less_than_one_does_not() {
    let told = |duration_s| {
        let found = taught(&wiring(), &drive(duration_s)).unwrap().unwrap().found;
        let of = |experiment| found.iter().find(|found| found.experiment == experiment).unwrap().told;
        [of(Experiment::Stroke), of(Experiment::Creep)]
    };
    assert_eq!(told(40.0), [Told::Well, Told::Restless]);
    assert_eq!(told(120.0), [Told::Well, Told::Well]);
}

#[test]
fn a_session_leaves_its_logs_and_the_device_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let device = device(FACTS.sensor_span);
    let (trained, mut client) = trained(&device, folder.path(), usize::MAX);
    assert!(trained.complete(), "{trained:?}");
    let planned: Vec<u64> = drive(40.0).segments.iter().map(|segment| segment.volts.len() as u64).collect();
    let recorded: Vec<u64> = trained.logs.iter().map(|log| log.rows).collect();
    assert!(recorded.iter().zip(&planned).all(|(recorded, planned)| recorded >= planned), "{recorded:?} {planned:?}");
    assert_eq!(recorded.iter().sum::<u64>(), planned.iter().sum::<u64>() + u64::from(trained.starved));
    for written in &trained.logs {
        let log = recordings::log::read(&written.log, &Default::default()).unwrap();
        let displacement = log.displacement.unwrap();
        let extent = |of: &[f64]| of.iter().fold((f64::MAX, f64::MIN), |(low, high), &x| (low.min(x), high.max(x)));
        let ((low, high), (near, far)) = (extent(&log.voltage), extent(&displacement));
        assert!(
            low < 1.0 && high > 99.0 && near > -1.0 && near < 3.0 && far > 13.0,
            "{written:?}: {low} {high} {near} {far}"
        );
    }
    is_home(&mut client, folder.path());
    let session = std::fs::read_to_string(folder.path().join("session.toml")).unwrap();
    assert!(session.contains("complete = true") && session.contains("sensor_span"), "{session}");
    let Session { complete, seed, logs, held_out, tick_us, unfinished, .. } = crate::session(folder.path()).unwrap();
    assert_eq!(tick_us, 500);
    assert!(complete && session.contains(&format!("seed = {seed}\n")));
    let (last, learnt): (Vec<_>, Vec<_>) =
        trained.logs.iter().map(|log| log.log.clone()).partition(|log| log.ends_with("held-out.csv"));
    assert!((logs, held_out, unfinished) == (learnt, last.clone(), None) && last.len() == 1);
    // Another session does not mix with its logs.
    let refused = again(&mut client, folder.path());
    assert!(matches!(refused, BenchError::Occupied { .. }), "{refused}");
    is_home(&mut client, folder.path());
}

/// What a session is refused by.
fn again(client: &mut Client, folder: &Path) -> BenchError {
    let (wiring, drive, interrupt) = (wiring(), drive(40.0), Interrupt::default());
    let training = Training { wiring: &wiring, drive: &drive, folder, interrupt: &interrupt };
    train(client, &training, &mut |_, _| {}).unwrap_err()
}

#[test]
fn the_only_copy_of_a_table_is_neither_overwritten_nor_deleted() {
    let folder = tempfile::tempdir().unwrap();
    let (device, wiring) = (device(FACTS.sensor_span), wiring());
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    // Killed: nobody gives it back.
    let loan = loan::Loan::take(&mut client, &wiring, folder.path()).unwrap();
    assert_eq!(in_use(&mut client).unwrap().unwrap(), to_record(wiring.line()));
    let refused = again(&mut client, folder.path());
    assert!(matches!(refused, BenchError::FormerKept { .. }), "{refused}");
    assert_eq!(std::fs::read(folder.path().join(FORMER)).unwrap(), to_record(&former()).to_vec());
    loan.give_back(&mut client, folder.path()).unwrap();
    is_home(&mut client, folder.path());
}

#[test]
fn a_table_of_another_rest_is_neither_lent_nor_installed_unless_rewired() {
    let folder = tempfile::tempdir().unwrap();
    let device = device(FACTS.sensor_span);
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let wiring = Wiring::new(&BoardFacts { drive_rest: Some(50.0), ..FACTS }, 500).unwrap();
    let (drive, interrupt) = (drive(40.0), Interrupt::default());
    let session = folder.path().join("session");
    let training = Training { wiring: &wiring, drive: &drive, folder: &session, interrupt: &interrupt };
    let refused = train(&mut client, &training, &mut |_, _| {}).unwrap_err();
    assert!(refused.to_string().contains("0 V at rest, code 768") && refused.to_string().contains("50 V"), "{refused}");
    assert!(!session.exists(), "nothing was recorded");
    let codes = rehearsal(wiring.line()).unwrap();
    let mut installed = |rewired| install(&mut client, wiring.line(), rewired, &codes, &interrupt, &mut |_| {});
    assert!(matches!(installed(false).unwrap_err(), BenchError::WouldJump { .. }));
    assert!(installed(true).unwrap().bit_exact());
}

#[test]
fn a_proof_is_refused_before_the_drive_where_it_can_say_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (device, wiring, interrupt) = (device(FACTS.sensor_span), wiring(), Interrupt::default());
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let log = folder.path().join("proven.csv");
    let mut proof = Proof {
        wiring: &wiring,
        range: None,
        up_to_hz: 20.0,
        duration_s: 8.0,
        seed: 2,
        max_percent: None,
        log: &log,
        interrupt: &interrupt,
    };
    let refused = prove(&mut client, &proof, &mut |_| panic!("it was driven")).unwrap_err();
    assert!(matches!(refused, BenchError::NoModel(_)), "{refused}");
    let codes = rehearsal(&model()).unwrap();
    install(&mut client, &model(), false, &codes, &interrupt, &mut |_| {}).unwrap();
    let refused = prove(&mut client, &proof, &mut |_| panic!("it was driven")).unwrap_err();
    assert!(matches!(refused, BenchError::NothingStated), "{refused}");
    (proof.max_percent, proof.range) = (Some(2.0), Some((0.0, 130.0)));
    let refused = prove(&mut client, &proof, &mut |_| panic!("it was driven")).unwrap_err();
    assert!(matches!(refused, BenchError::Wiring(WiringError::BeyondRange { .. })), "{refused}");
    // A line is no model of this actuator: it says so, at rest, within the range that was asked for.
    proof.range = Some((0.0, 50.0));
    let proven = prove(&mut client, &proof, &mut |_| {}).unwrap();
    assert!(
        !proven.verdict.passed && proven.home.is_ok() && proven.verdict.to_string().starts_with("FAIL"),
        "{proven:?}"
    );
    let driven = recordings::log::read(&log, &Default::default()).unwrap().voltage;
    assert!(driven.iter().all(|volts| (-1.0..51.0).contains(volts)));
    let refused = prove(&mut client, &proof, &mut |_| panic!("it was driven")).unwrap_err();
    assert!(matches!(refused, BenchError::Occupied { .. }), "{refused}");
}

#[test]
fn a_sensor_that_is_not_there_is_what_a_proof_complains_of() {
    let folder = tempfile::tempdir().unwrap();
    let (device, wiring, interrupt) = (device(None), wiring(), Interrupt::default());
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let codes = rehearsal(&model()).unwrap();
    install(&mut client, &model(), false, &codes, &interrupt, &mut |_| {}).unwrap();
    let log = folder.path().join("proven.csv");
    let (up_to_hz, duration_s, seed) = (20.0, 8.0, 2);
    let (wiring, interrupt, log) = (&wiring, &interrupt, &*log);
    let proof = Proof { wiring, range: None, up_to_hz, duration_s, seed, max_percent: Some(2.0), log, interrupt };
    let refused = prove(&mut client, &proof, &mut |_| {}).unwrap_err();
    // Nothing was measured: no file is in the way of the next proof, and none is named.
    assert!(matches!(refused, BenchError::Sensor { complaint: Complaint::NoSensor, log: None }), "{refused}");
    assert!(!log.exists() && !refused.to_string().contains("proven.csv"), "{refused}");
}

#[test]
fn an_interrupted_session_keeps_what_it_has_and_brings_the_device_home() {
    let folder = tempfile::tempdir().unwrap();
    let device = device(FACTS.sensor_span);
    let (trained, mut client) = trained(&device, folder.path(), 6_000);
    assert!(matches!(trained.ended, Some(Ended::Play(_))) && trained.home.is_ok(), "{trained:?}");
    assert!(trained.logs.iter().map(|log| log.rows).sum::<u64>() >= 6_000);
    assert!(trained.logs.last().is_some_and(|log| !log.complete));
    let unfinished = session(folder.path()).unwrap().unfinished.unwrap();
    assert!(unfinished.cut_short.len() == 1 && unfinished.planned > Some(unfinished.there), "{unfinished:?}");
    is_home(&mut client, folder.path());
}

/// The host sleeps once a segment is over: longer than the device holds a voltage for it, 5 s of this machine's
/// clock, whatever the speed of the emulation: that is of its ticks.
#[test]
fn a_host_that_was_suspended_between_two_segments_is_told_so_and_keeps_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let device = device(FACTS.sensor_span);
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let (wiring, drive, interrupt) = (wiring(), drive(40.0), Interrupt::default());
    let training = Training { wiring: &wiring, drive: &drive, folder: folder.path(), interrupt: &interrupt };
    let first = drive.segments[0].volts.len();
    let mut slept = false;
    let trained = train(&mut client, &training, &mut |_, ticks| {
        if ticks >= first && !slept {
            slept = true;
            std::thread::sleep(std::time::Duration::from_millis(5_500));
        }
    });
    let trained = trained.unwrap();
    assert!(matches!(trained.ended, Some(Ended::Play(device_link::play::PlayError::LetGo))), "{trained:?}");
    let session = session(folder.path()).unwrap();
    assert!(trained.logs[0].complete && session.logs == [trained.logs[0].log.clone()], "{trained:?}");
    is_home(&mut client, folder.path());
}

#[test]
fn a_sensor_that_saturates_or_is_not_there_ends_it_with_a_ramp() {
    for (sensor, expected) in [(Some((-1.0, 6.0)), "end of its range"), (None, "no second channel")] {
        let folder = tempfile::tempdir().unwrap();
        let device = device(sensor);
        let (trained, mut client) = trained(&device, folder.path(), usize::MAX);
        let Some(Ended::Complaint(complaint)) = &trained.ended else { panic!("{trained:?}") };
        assert!(complaint.to_string().contains(expected), "{complaint}");
        is_home(&mut client, folder.path());
    }
}

#[test]
fn an_amplifier_that_does_nothing_ends_it() {
    let (rest, mut noise) = (wiring().adc().code(0.0f64), 0);
    let dead = move |_| {
        noise = 1 - noise;
        emulator::Conversion { monitor: AdcCode(rest.0 + noise), sensor: Some(AdcCode(11_000 + noise)), setpoint: None }
    };
    let folder = tempfile::tempdir().unwrap();
    let device = connected_to(dead);
    let (trained, mut client) = trained(&device, folder.path(), usize::MAX);
    let Some(Ended::Fault(faults)) = trained.ended else { panic!("{trained:?}") };
    assert!(faults.contains(protocol::Faults::AMPLIFIER), "{faults:?}");
    assert!(trained.logs.len() == 1 && !trained.logs[0].complete && trained.home.is_ok(), "{trained:?}");
    is_home(&mut client, folder.path());
}

#[test]
fn a_device_whose_dac_shows_the_displacement_is_not_driven() {
    let device = Emulator::new().start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (wiring, drive, interrupt) = (wiring(), drive(40.0), Interrupt::default());
    let training = Training { wiring: &wiring, drive: &drive, folder: folder.path(), interrupt: &interrupt };
    let refused = train(&mut client, &training, &mut |_, _| {}).unwrap_err();
    assert!(matches!(refused, BenchError::NotDriving), "{refused}");
    assert_eq!(in_use(&mut client).unwrap().unwrap(), to_record(&emulator::TABLE.admit().unwrap()));
}

#[test]
fn what_is_installed_is_the_host_s_to_the_last_bit() {
    let device = device(Some((-5.0, 25.0)));
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let wiring = wiring();
    let codes = rehearsal(wiring.line()).unwrap();
    let installed = install(&mut client, wiring.line(), false, &codes, &Interrupt::default(), &mut |_| {}).unwrap();
    assert!(installed.bit_exact() && installed.ticks == codes.len(), "{installed:?}");
    assert_eq!(in_use(&mut client).unwrap().unwrap(), to_record(wiring.line()));
}

#[test]
fn a_board_whose_dac_shows_the_displacement_gets_the_line_when_it_is_rewired_and_not_before() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let wiring = wiring();
    let codes = rehearsal(wiring.line()).unwrap();
    let mut installed =
        |rewired| install(&mut client, wiring.line(), rewired, &codes, &Interrupt::default(), &mut |_| {});
    let refused = installed(false).unwrap_err().to_string();
    assert!(refused.contains("may change, what the DAC output is connected to"), "{refused}");
    assert!(installed(true).unwrap().bit_exact());
}
