//! `piezo linearise` on an emulated device with a controller at its set-point.

use super::{json, piezo, text};
use device_link::pages;
use device_link::table::to_record;
use emulator::{Conversion, EmulatedDevice, Emulator, Plant, TABLE, amplifier};
use estimator_core::{AdcCode, DacCode, DriveCalibration, DriveLimits, Range, SetpointCalibration, Table};
use parameter_store::RamFlash;
use table_files::TableFile;

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
/// −5 … 45 µm.
const SETPOINT: SetpointCalibration =
    SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start: false };

/// A device behind whose converters there are an amplifier and a controller that gives this code, but for noise.
fn controlled(code: u16, setpoint: Option<SetpointCalibration>) -> EmulatedDevice {
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint };
    let table = Table { drive: Some(drive), ..TABLE }.admit().unwrap();
    let flash = RamFlash::new(pages::with(&to_record(&table), 4096).unwrap());
    let (mut amplifier, mut noise) = (amplifier(drive, TABLE.adc), 0);
    let plant = move |dac: DacCode| {
        noise = 1 - noise;
        Conversion { setpoint: Some(AdcCode(code + noise)), ..amplifier.sample(dac) }
    };
    Emulator::new().setpoint().flash(flash).plant(plant).speed(4.0).start().unwrap()
}

fn asks(device: &EmulatedDevice, arguments: &[&str]) -> assert_cmd::assert::Assert {
    piezo().args(arguments).args(["--port", &format!("tcp:{}", device.address())]).assert()
}

fn said(assert: &assert_cmd::assert::Assert) -> String {
    let output = assert.get_output();
    String::from_utf8([&output.stdout[..], &output.stderr].concat()).unwrap()
}

#[test]
fn it_is_entered_shown_and_left() {
    let device = controlled(32_760, Some(SETPOINT));
    let entered = said(&asks(&device, &["linearise"]).success());
    assert!(entered.contains("follows the set-point") && entered.contains("20.0"), "{entered}");
    let info = said(&asks(&device, &["info"]).success());
    for part in [
        "where the set-point at its ADC wants",
        "a set-point of 0 … 65520 wants -5.000 … 45.000 µm",
        "Setpoint 20.0",
        "Faults   none",
    ] {
        assert!(info.contains(part), "{part:?} is missing in\n{info}");
    }
    let monitor = said(&asks(&device, &["monitor", "--seconds", "1.5"]).success());
    assert!(monitor.contains("where the set-point at its ADC wants"), "{monitor}");
    let port = format!("tcp:{}", device.address());
    let again = said(&asks(&device, &["linearise"]).success());
    assert!(again.contains("follows the set-point"), "{again}");
    let left = json(piezo().args(["linearise", "--stop", "--json", "--port", &port]));
    assert_eq!(left["mode"], "Estimate");
    let again = said(&asks(&device, &["linearise", "--stop"]).code(2));
    assert!(again.contains("estimates from its ADC: there is nothing to leave"), "{again}");
}

#[test]
fn what_keeps_it_waiting_is_said_with_its_remedy() {
    let device = controlled(0, Some(SETPOINT));
    for _ in 0..2 {
        let waits = said(&asks(&device, &["linearise"]).code(1));
        for part in ["waits at rest", "the set-point stands at an end", "is the controller on"] {
            assert!(waits.contains(part), "{part:?} is missing in\n{waits}");
        }
    }
}

#[test]
fn a_table_or_a_board_without_a_set_point_is_refused_with_what_helps() {
    let table = said(&asks(&controlled(32_760, None), &["linearise"]).code(2));
    assert!(table.contains("which displacements a set-point wants: piezo emit --setpoint-span"), "{table}");
    let drive = said(&asks(&Emulator::new().setpoint().start().unwrap(), &["linearise"]).code(2));
    assert!(drive.contains("piezo emit --drive-span"), "{drive}");
    let blind = Emulator::new().flash(RamFlash::new(
        pages::with(&to_record(&Table { drive: Some(drive_of()), ..TABLE }.admit().unwrap()), 4096).unwrap(),
    ));
    let board = said(&asks(&blind.start().unwrap(), &["linearise"]).code(2));
    assert!(board.contains("no input for a set-point: it takes a board that has one"), "{board}");
}

fn drive_of() -> DriveCalibration {
    DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint: Some(SETPOINT) }
}

#[test]
fn a_table_says_what_a_set_point_wants_where_it_drives() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("board");
    let emit = |options: &[&str]| {
        let table = "tests/data/table/table.toml";
        piezo().args(["emit", table, "--out", text(&out)]).args(options).assert()
    };
    let lonely = said(&emit(&["--setpoint-span", "-5:45"]).code(2));
    assert!(lonely.contains("--drive-span and --drive-slew say how it drives"), "{lonely}");
    let drive = ["--adc-full-scale", "65520", "--drive-span", "0:4", "--drive-range", "0.3:3.6", "--drive-slew", "40"];
    let unsaid = said(&emit(&[&drive[..], &["--linearise", "at-start"]].concat()).code(2));
    assert!(unsaid.contains("--setpoint-span says it"), "{unsaid}");
    emit(&[&drive[..], &["--setpoint-span", "-5:45", "--linearise", "at-start"]].concat()).success();
    // What is not said again stays, also for an ADC of another scale.
    let other = folder.path().join("other");
    let again =
        ["emit", text(&out.join("table.toml")), "--adc-full-scale", "4095", "--out", text(&other)].map(str::to_owned);
    piezo().args(again).assert().success();
    let (_, table) = TableFile::load(&other.join("table.toml")).unwrap();
    let setpoint = table.drive.unwrap().setpoint.unwrap();
    assert!((setpoint.gain_um_per_code * 4095.0 - 50.0).abs() < 1e-4, "{setpoint:?}");
    assert_eq!((setpoint.offset_um, setpoint.at_start), (-5.0, true));
    // Another span says nothing of when it is followed, and when it is followed nothing of the span.
    for (options, said) in [
        (["--setpoint-span", "-2:18"], (-2.0, true)),
        (["--linearise", "on-request"], (-2.0, false)),
        (["--setpoint-span", "-3:17"], (-3.0, false)),
    ] {
        piezo().args(["emit", text(&other.join("table.toml")), "--out", text(&other)]).args(options).assert().success();
        let (_, table) = TableFile::load(&other.join("table.toml")).unwrap();
        let setpoint = table.drive.unwrap().setpoint.unwrap();
        assert_eq!((setpoint.offset_um, setpoint.at_start), said, "{options:?}");
    }
}
