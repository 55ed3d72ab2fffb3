//! `piezo follow` on an emulated device whose DAC drives an amplifier.

use super::{piezo, text};
use device_link::pages;
use device_link::table::to_record;
use emulator::{Emulator, Plant, TABLE, amplifier};
use estimator_core::{AdcCode, DriveCalibration, DriveLimits, Range, Table};
use parameter_store::RamFlash;
use std::fs;
use std::process::Output;

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
/// An amplifier of 0 … 4 V on the DAC's scale.
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint: None };

/// Follows a swing about a displacement (µm); the device's queue of references lasts for half a second.
fn followed_about(about: f64, dry_run: bool, plant: impl Plant) -> (Output, Option<String>) {
    let table = Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap();
    let flash = RamFlash::new(pages::with(&to_record(&table), 4096).unwrap());
    let device = Emulator::new().flash(flash).plant(plant).speed(0.25).start().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let trajectory = folder.path().join("wanted.csv");
    let wave = (0..500).map(|k| {
        let t = f64::from(k) * 1e-3;
        format!("{t:.3},{}\n", about + 5.0 * (t * 20.0).sin())
    });
    fs::write(&trajectory, "time_s,displacement_um\n".to_owned() + &wave.collect::<String>()).unwrap();
    let log = folder.path().join("followed.csv");
    let port = format!("tcp:{}", device.address());
    let mut command = piezo();
    command.args(["follow", text(&trajectory), "--json", "--out", text(&log), "--port", &port]);
    let done = command.args(dry_run.then_some("--dry-run")).output().unwrap();
    (done, fs::read_to_string(log).ok())
}

fn sound() -> impl Plant {
    amplifier(DRIVE, TABLE.adc)
}

#[test]
fn a_dry_run_drives_nothing_and_the_impossible_is_not_tried() {
    let (done, log) = followed_about(20.0, true, sound());
    assert!(done.status.success() && log.is_none());
    let (refused, log) = followed_about(200.0, false, sound());
    let complaint = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        complaint.contains("nothing was driven") && complaint.contains("hold about") && log.is_none(),
        "{complaint}"
    );
}

#[test]
fn what_was_wanted_stands_beside_what_was_estimated() {
    let (done, log) = followed_about(20.0, false, sound());
    assert!(done.status.success());
    let log = log.unwrap();
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = log.lines().skip(1).map(row).collect();
    assert_eq!(rows.len(), 1000);
    assert!(rows.iter().skip(400).all(|row| (row[2] - row[3]).abs() < 0.3));
}

#[test]
fn a_fault_on_the_way_is_a_failure_and_the_log_is_kept() {
    // Saturated from the 80th tick on at which the amplifier has moved, which is a fault after twenty.
    let (mut amplifier, mut moved) = (sound(), 0);
    let rest = DRIVE.code(LIMITS.rest_v, TABLE.dac.full_scale);
    let breaks = move |dac| {
        moved += u32::from(moved > 0 || dac != rest);
        let conversion = amplifier.sample(dac);
        if moved < 80 { conversion } else { AdcCode(TABLE.adc.full_scale).into() }
    };
    let (done, log) = followed_about(20.0, false, breaks);
    assert_eq!(done.status.code(), Some(1));
    assert_eq!(log.unwrap().lines().count(), 100);
}
