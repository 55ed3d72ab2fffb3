//! `piezo follow` on an emulated device whose DAC drives an amplifier.

use super::{piezo, refused, text};
use device_link::Client;
use device_link::pages;
use device_link::table::to_record;
use emulator::faults::silent_from;
use emulator::{EmulatedDevice, Emulator, FaultyLine, Plant, TABLE, amplifier};
use estimator_core::{AdcCode, DriveCalibration, DriveLimits, Range, Table};
use parameter_store::RamFlash;
use std::fs;
use std::process::Output;

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
/// An amplifier of 0 … 4 V on the DAC's scale.
pub const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint: None };

/// Follows a swing about a displacement (µm); the device's queue of references lasts for half a second.
fn followed_about(about: f64, dry_run: bool, plant: impl Plant) -> (Output, Option<String>) {
    followed(&|t| about + 5.0 * (t * 20.0).sin(), if dry_run { &["--json", "--dry-run"] } else { &["--json"] }, plant)
}

fn followed(wanted: &dyn Fn(f64) -> f64, options: &[&str], plant: impl Plant) -> (Output, Option<String>) {
    followed_by(&driven(plant), wanted, options)
}

/// A device that drives.
fn driven(plant: impl Plant) -> EmulatedDevice {
    let table = Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap();
    let flash = RamFlash::new(pages::with(&to_record(&table), 4096).unwrap());
    Emulator::new().flash(flash).plant(plant).speed(0.25).start().unwrap()
}

/// Follows half a second of what is wanted at a time, s.
fn followed_by(device: &EmulatedDevice, wanted: &dyn Fn(f64) -> f64, options: &[&str]) -> (Output, Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    let trajectory = folder.path().join("wanted.csv");
    let wave = (0..500).map(|k| {
        let t = f64::from(k) * 1e-3;
        format!("{t:.3},{}\n", wanted(t))
    });
    fs::write(&trajectory, "time_s,displacement_um\n".to_owned() + &wave.collect::<String>()).unwrap();
    let log = folder.path().join("followed.csv");
    let port = format!("tcp:{}", device.address());
    let mut command = piezo();
    command.args(["follow", text(&trajectory), "--out", text(&log), "--port", &port]);
    let done = command.args(options).output().unwrap();
    (done, fs::read_to_string(log).ok())
}

fn sound() -> impl Plant {
    amplifier(DRIVE, TABLE.adc)
}

#[test]
fn a_rest_is_no_fault_in_what_record_and_monitor_say() {
    let device = driven(sound());
    let (folder, port) = (tempfile::tempdir().unwrap(), format!("tcp:{}", device.address()));
    let log = folder.path().join("rest.csv");
    for verb in [&["record", "--out", text(&log), "--seconds", "0.3"][..], &["monitor", "--seconds", "3"]] {
        let said = String::from_utf8(piezo().args(verb).args(["--port", &port]).output().unwrap().stdout).unwrap();
        assert!(said.contains("the DAC is at its rest, as it is while nothing is followed"), "{verb:?}: {said}");
        assert!(!said.contains("safe value") && !said.contains("mend what else is wrong"), "{verb:?}: {said}");
    }
}

#[test]
fn a_dry_run_drives_nothing_and_the_impossible_is_not_tried() {
    let (done, log) = followed_about(20.0, true, sound());
    assert!(done.status.success() && log.is_none());
    let (refused, log) = followed_about(200.0, false, sound());
    let complaint = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        complaint.contains("nothing was sent") && complaint.contains("can be held") && log.is_none(),
        "{complaint}"
    );
}

#[test]
fn what_leaves_the_reach_on_its_way_is_refused_before_anything_moves_unless_so_much_is_allowed() {
    let leaves = |t: f64| 20.0 + 200.0 * t;
    for options in [&[][..], &["--dry-run"], &["--max-error", "1"]] {
        let (refused, log) = followed(&leaves, options, sound());
        let complaint = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(2), "{options:?} {complaint}");
        assert!(complaint.contains("stand at a limit") && complaint.contains("--max-error"), "{options:?} {complaint}");
        assert!(complaint.contains("nothing was sent") && log.is_none(), "{options:?} {complaint}");
    }
    let (done, log) = followed(&leaves, &["--max-error", "200"], sound());
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success() && log.is_some(), "{said}");
    assert!(said.contains("was out of reach") && said.contains("(on "), "{said}");
}

#[test]
fn the_way_to_its_first_point_is_no_part_of_a_trajectory_and_no_limit_in_its_way() {
    let (done, log) = followed(&|t| 20.0 - 5.0 * (t * 20.0).cos(), &[], sound());
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success() && log.is_some(), "{said}");
    assert!(said.contains("of them from rest to where the trajectory begins"), "{said}");
    assert!(!said.contains("out of reach"), "{said}");
}

#[test]
fn what_was_wanted_stands_beside_what_was_estimated() {
    let (done, log) = followed_about(20.0, false, sound());
    assert!(done.status.success());
    let log = log.unwrap();
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = log.lines().skip(1).map(row).collect();
    let said: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let way = said["approach_ticks"].as_u64().unwrap() as usize;
    assert_eq!(rows.len(), way + 1000);
    assert!(rows.iter().skip(way + 3).all(|row| (row[2] - row[3]).abs() < 0.4), "all but the way there");
    assert!(said["estimate_off_max_um"].as_f64().unwrap() < 0.4);
}

#[test]
fn a_zero_outlives_what_is_followed_which_is_relative_to_the_model_s() {
    let device = driven(sound());
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    client.set_zero(30.0).unwrap();
    drop(client);
    let (done, _) = followed_by(&device, &|t| 20.0 + 5.0 * (t * 20.0).sin(), &["--json"]);
    let said: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(said["estimate_off_max_um"].as_f64().unwrap() < 0.4, "{said}");
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    assert!(client.health().unwrap().bias_um > 10.0);
}

#[test]
fn a_log_that_is_there_is_in_no_dry_run_s_way_and_json_says_whether_it_passed() {
    let device = driven(sound());
    let folder = tempfile::tempdir().unwrap();
    let (wanted, log) = (folder.path().join("wanted.csv"), folder.path().join("followed.csv"));
    fs::write(&wanted, "time_s,displacement_um\n0.0,15\n0.1,20\n").unwrap();
    fs::write(&log, "kept").unwrap();
    let port = format!("tcp:{}", device.address());
    let follow = |options: &[&str]| {
        let mut command = piezo();
        command.args(["follow", text(&wanted), "--out", text(&log), "--port", &port]).args(options).output().unwrap()
    };
    assert!(follow(&["--dry-run"]).status.success());
    assert_eq!((follow(&[]).status.code(), fs::read_to_string(&log).unwrap().as_str()), (Some(2), "kept"));
    let done = follow(&["--force", "--json"]);
    let said: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((said["passed"].as_bool(), done.status.code()), (Some(true), Some(0)), "{said}");
}

#[test]
fn the_moment_in_which_a_speed_is_come_to_counts_neither_in_the_plan_nor_in_what_is_allowed() {
    let (done, _) = followed(&|t| 15.0 + 100.0 * t.min(0.06), &["--max-error", "0.1"], sound());
    let said = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success() && said.contains("it begins at a speed"), "{said}");
}

/// The table's 45 µm take the voltage 90 ms.
#[test]
fn a_trajectory_that_begins_faster_than_the_voltage_can_go_is_refused_before_it_is_driven() {
    let step = |t: f64| if t < 0.01 { 15.0 + 1000.0 * t } else { 25.0 };
    let peak = |t: f64| 15.0 + 1000.0 * (0.01 - (t - 0.01).abs()).max(0.0);
    let later = |t: f64| if t < 0.02 { 15.0 + 50.0 * t } else { 16.0 + 1000.0 * (t - 0.02).min(0.01) };
    for wanted in [&step as &dyn Fn(f64) -> f64, &peak, &later] {
        for options in [&["--dry-run"][..], &[], &["--max-error", "0.1"]] {
            let (done, log) = followed(wanted, options, sound());
            let said = String::from_utf8(done.stderr).unwrap();
            assert!(done.status.code() == Some(2) && said.contains(" µm off"), "{options:?}: {said}");
            assert_eq!(log, None);
        }
    }
}

#[test]
fn a_fault_on_the_way_is_a_failure_and_the_log_is_kept() {
    // Saturated from the 80th tick on at which the amplifier has moved, which is a fault after twenty, on the way to
    // the first point.
    let (mut amplifier, mut moved) = (sound(), 0);
    let rest = DRIVE.code(LIMITS.rest_v, TABLE.dac.full_scale);
    let breaks = move |dac| {
        moved += u32::from(moved > 0 || dac != rest);
        let conversion = amplifier.sample(dac);
        if moved < 80 { conversion } else { AdcCode(TABLE.adc.full_scale).into() }
    };
    let (done, log) = followed(&|t| 20.0 + 5.0 * (t * 20.0).sin(), &[], breaks);
    let said = String::from_utf8(done.stdout).unwrap();
    assert_eq!(done.status.code(), Some(1));
    assert!(said.contains("a fault sent the drive back") && !said.contains("never came near"), "{said}");
    // The way there begins slowly: some ticks have the code of the rest.
    let rows = log.unwrap().lines().count();
    assert!((100..110).contains(&rows), "{rows}");
}

#[test]
fn a_device_that_falls_silent_on_the_way_costs_nothing_of_what_it_has_said() {
    let (device, folder) = (driven(sound()), tempfile::tempdir().unwrap());
    let (wanted, log) = (folder.path().join("wanted.csv"), folder.path().join("followed.csv"));
    fs::write(&wanted, "time_s,displacement_um\n0.0,15\n0.5,20\n").unwrap();
    let line = FaultyLine::to(device.address(), silent_from(400)).unwrap();
    let port = format!("tcp:{}", line.address());
    let says = ["followed.csv holds the ", " samples before"];
    refused(&["follow", text(&wanted), "--out", text(&log), "--port", &port], &says);
    let rows = fs::read_to_string(&log).unwrap().lines().count();
    assert!(rows > 100, "{rows}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "nothing else is left");
}

/// A plan begins at rest: what is held elsewhere, or still on its way back, is brought there before it.
#[test]
fn a_drive_that_something_holds_elsewhere_is_let_go_to_rest_first() {
    let device = driven(sound());
    let wanted = |t: f64| 20.0 + 5.0 * (t * 20.0).sin();
    let (stays, log) = followed_by(&device, &wanted, &["--json", "--stay"]);
    let volts = |row: &str| row.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    let held = volts(log.as_deref().unwrap().lines().last().unwrap());
    assert!(stays.status.success() && (held - 0.5).abs() > 0.5, "{held} V");
    let (next, log) = followed_by(&device, &wanted, &["--json"]);
    let begins = volts(log.as_deref().unwrap().lines().nth(1).unwrap());
    assert!(next.status.success() && (begins - 0.5).abs() < 0.02, "{begins} V after {held} V");
}
