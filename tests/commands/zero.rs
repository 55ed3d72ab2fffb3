//! `piezo zero` over a cycle of an emulated device.

use super::{bench::Emulated, json, piezo, text};
use device_link::Client;
use emulator::faults::{lose_samples_at, replies, samples, told_in_vain};
use emulator::{Emulator, Fault, FaultyLine};
use estimator_core::Status;
use protocol::{Faults, Health, Reply};
use std::process::Output;

/// Zeroes over a cycle, to 3 µm; what came of it, and how the device is then.
fn zeroed(fault: impl Fault, seconds: f64) -> (Output, Health) {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let line = FaultyLine::to(device.address(), fault).unwrap();
    let (seconds, port) = (seconds.to_string(), format!("tcp:{}", line.address()));
    let over_cycle = ["zero", "--over-cycle", "--at", "3", "--seconds", &seconds, "--json", "--port", &port];
    let done = piezo().args(over_cycle).output().unwrap();
    drop(line);
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    (done, client.health().unwrap())
}

fn complaint(fault: impl Fault, seconds: f64) -> String {
    let (done, health) = zeroed(fault, seconds);
    assert_eq!((health.bias_um, health.bias_age_ticks), (0.0, None), "nothing is changed");
    let complaint = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert!(complaint.contains("nothing was changed on the device"), "{complaint}");
    complaint
}

#[test]
fn the_mean_over_a_cycle_is_told() {
    let (done, health) = zeroed(|_, _: &mut Vec<u8>| {}, 10.0);
    assert!(done.status.success() && health.bias_um != 0.0 && health.bias_age_ticks.is_some(), "{health:?}");
}

#[test]
fn a_voltage_that_moves_is_said_and_one_at_rest_is_not() {
    // The emulated converter goes up and down once a second.
    let device = Emulator::new().speed(8.0).start().unwrap();
    let port = format!("tcp:{}", device.address());
    let zero = |more: &[&str]| piezo().args(["zero", "--json", "--port", &port]).args(more).output().unwrap();
    let said = String::from_utf8(zero(&[]).stderr).unwrap();
    assert!(said.contains("careful: the voltage is moving, by ") && said.contains("--over-cycle"), "{said}");
    let over_cycle = zero(&["--over-cycle", "--seconds", "20"]);
    assert!(over_cycle.status.success() && over_cycle.stderr.is_empty(), "{over_cycle:?}");
    // An amplifier at rest.
    let folder = tempfile::tempdir().unwrap();
    let board = folder.path().join("board.toml");
    let emulated = Emulated::start(&board, &["--speed", "8"]);
    let made = folder.path().join("made");
    let table = ["--board", text(&board), "--amplifier-slew", "20000", "--out", text(&made)];
    piezo().args(["emit", "tests/data/table/table.toml"]).args(table).assert().success();
    let install = ["install", text(&made), "--narrow", "--doubted", "--board", text(&board), "--port", &emulated.port];
    piezo().args(install).assert().success();
    let rests = piezo().args(["zero", "--json", "--port", &emulated.port]).assert().success().get_output().clone();
    assert!(rests.stderr.is_empty(), "{rests:?}");
    assert!(json(piezo().args(["zero", "--json", "--port", &emulated.port]))["moved_V"].is_null());
}

#[test]
fn without_a_sound_cycle_nothing_is_told() {
    let short = complaint(|_, _: &mut Vec<u8>| {}, 0.1);
    assert!(short.contains("no full cycle within 0.1 s") && short.contains("--seconds"), "{short}");
    // The first batch shows the displacement before.
    let lost = complaint(lose_samples_at(600), 10.0);
    assert!(lost.contains("samples were lost"), "{lost}");
    let stuck = samples(|batch| {
        batch.samples.iter_mut().for_each(|sample| sample.faults |= Faults::ADC_STUCK);
        true
    });
    let stuck = complaint(stuck, 10.0);
    assert!(stuck.contains("one and the same code") && stuck.contains("check the wire"), "{stuck}");
    let clamped = samples(|batch| {
        batch.samples.iter_mut().for_each(|sample| sample.status |= Status::CLAMPED);
        true
    });
    let clamped = complaint(clamped, 10.0);
    assert!(clamped.contains("clamped") && clamped.contains("as large a stroke"), "{clamped}");
}

#[test]
fn a_lost_reply_says_how_to_find_out() {
    // Stream, identity, health, table, the stream on and off, twice, and health.
    let lost = replies(|number, reply, frame| {
        if number == 9 {
            assert_eq!(*reply, Reply::Done);
            frame.clear();
        }
    });
    let (done, health) = zeroed(lost, 10.0);
    let complaint = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert!(complaint.contains("not known") && complaint.contains("piezo info --port tcp:"), "{complaint}");
    assert!(health.bias_age_ticks.is_some(), "it was done");
}

#[test]
fn a_zero_of_before_is_not_taken_for_one_that_the_device_did_not_take() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    piezo().args(["zero", "--port", &format!("tcp:{}", device.address())]).assert().success();
    let line = FaultyLine::to(device.address(), told_in_vain()).unwrap();
    let port = format!("tcp:{}", line.address());
    for more in [&["--at", "3"][..], &["--over-cycle", "--seconds", "20"]] {
        let done = piezo().args(["zero", "--port", &port]).args(more).output().unwrap();
        let complaint = String::from_utf8(done.stderr).unwrap();
        assert_eq!((done.status.code(), done.stdout.len()), (Some(2), 0), "{complaint}");
        assert!(complaint.contains("the device has not taken it"), "{complaint}");
        assert!(complaint.contains(&format!("`piezo info --port {port}` says why; then zero again")), "{complaint}");
    }
    drop(line);
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    assert!(client.health().unwrap().bias_age_ticks.is_some(), "the one of before is there");
}
