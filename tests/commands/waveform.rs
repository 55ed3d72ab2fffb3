//! `piezo waveform` on an emulated device.

use super::{json, piezo, refused_json, text};
use assert_cmd::Command;
use device_link::table::to_record;
use device_link::{Client, pages};
use emulator::{EmulatedDevice, Emulator, TABLE, amplifier};
use estimator_core::{DriveCalibration, DriveLimits, Range, Table};
use parameter_store::RamFlash;
use protocol::{References, Reply, Request};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };

/// Its wires, in a board.toml.
const BOARD: &str = "\
adc_span = [-0.378, 3.978]
adc_full_scale = 65520
dac_full_scale = 4095
drive_span = [0.0, 4.0]
drive_range = [0.3, 3.6]
drive_rest = 0.5
drive_slew = 40.0
sensor_span = [0.0, 50.0]
";

/// A device that drives an amplifier.
fn driving() -> EmulatedDevice {
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
    let table = Table { drive: Some(drive), ..TABLE }.admit().unwrap();
    let flash = RamFlash::new(pages::with(&to_record(&table), 4096).unwrap());
    Emulator::new().flash(flash).plant(amplifier(drive, TABLE.adc)).speed(4.0).start().unwrap()
}

/// A line of 200 points, so many milliseconds apart, that comes back to where it begins.
fn line(folder: &Path, ms: f64) -> PathBuf {
    let path = folder.join(format!("line-{ms}.csv"));
    let row = |k: usize| {
        let phase = k as f64 / 200.0 * TAU;
        format!("{:.6},{:.6}\n", k as f64 * ms * 1e-3, 15.0 + 5.0 * phase.sin())
    };
    let rows: String = (0..200).map(row).collect();
    std::fs::write(&path, format!("time_s,displacement_um\n{rows}")).unwrap();
    path
}

/// A verb on a device.
fn asks(device: &EmulatedDevice, arguments: &[&str]) -> Command {
    let mut piezo = piezo();
    piezo.args(arguments).args(["--port", &format!("tcp:{}", device.address())]);
    piezo
}

fn waveform(device: &EmulatedDevice, arguments: &[&str]) -> Command {
    asks(device, &[&["waveform"], arguments].concat())
}

/// What it says that succeeds, or is refused.
fn said(mut command: Command) -> String {
    String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
}

fn refused(mut command: Command) -> String {
    String::from_utf8(command.assert().code(2).get_output().stderr.clone()).unwrap()
}

/// How many points it has in its memory, if it is asked for one behind the first: 0 or 1, for that forgets the others.
fn points(device: &EmulatedDevice) -> u16 {
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    match client.request(Request::Load { first: 1, points: References::new() }).unwrap() {
        Reply::Loaded(count) => count,
        other => panic!("{other:?}"),
    }
}

fn health(device: &EmulatedDevice) -> serde_json::Value {
    json(&mut asks(device, &["info", "--json"]))["health"].clone()
}

#[test]
fn a_line_is_looked_at_played_and_left() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    let path = line(folder.path(), 2.5);
    let path = text(&path);
    let dry = said(waveform(&device, &[path, "--dry-run"]));
    assert!(dry.contains("200 points of 5 ticks: a line takes 0.5000 s") && dry.contains("Nothing was sent"), "{dry}");
    assert!(
        dry.contains("off at most within a line. The model itself was"),
        "its own error beside the inverse's: {dry}"
    );
    assert_eq!(health(&device)["mode"], "Estimate");
    assert_eq!(points(&device), 0, "it was only looked at");
    let played = json(&mut waveform(&device, &[path, "--every", "4", "--json"]));
    assert_eq!((&played["line_ticks"], &played["back_ticks"]), (&800.into(), &serde_json::Value::Null));
    let start = Instant::now();
    while health(&device)["lines"].as_u64() < Some(3) {
        assert!(start.elapsed() < Duration::from_secs(20), "{}", health(&device));
        std::thread::sleep(Duration::from_millis(50));
    }
    let info = said(asks(&device, &["info"]));
    assert!(
        info.contains("plays the waveform in its memory") && info.contains("lines begun, 0 triggers ignored"),
        "{info}"
    );
    assert!(info.contains("Faults   none"), "{info}");
    let again = refused(waveform(&device, &[path]));
    let stop = format!("piezo waveform --stop --port tcp:{}", device.address());
    assert!(again.contains(&format!("it plays a waveform: {stop}")), "{again}");
    let left = said(waveform(&device, &["--stop"]));
    assert!(left.contains("leaves its waveform after") && left.contains("goes to rest"), "{left}");
    assert_eq!(health(&device)["mode"], "Estimate");
    let left = refused(waveform(&device, &["--stop"]));
    assert!(left.contains("estimates from its ADC: there is nothing to leave"), "{left}");
}

#[test]
fn what_is_driven_is_zeroed_and_recorded_as_it_goes() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    said(waveform(&device, &[text(&line(folder.path(), 2.5))]));
    let zeroed = said(asks(&device, &["zero", "--over-cycle"]));
    assert!(zeroed.contains("Over one cycle of the voltage"), "{zeroed}");
    let log = folder.path().join("scan.csv");
    said(asks(&device, &["record", "--seconds", "0.5", "--out", text(&log)]));
    assert!(std::fs::read_to_string(log).unwrap().lines().count() > 900);
    said(waveform(&device, &["--stop"]));
    assert!(health(&device)["bias_age_ticks"].as_u64() > Some(900), "{}", health(&device));
}

#[test]
fn so_many_lines_are_played_and_no_more() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    let path = line(folder.path(), 2.5);
    let told = said(waveform(&device, &[text(&path), "--repeat", "2"]));
    assert!(told.contains("plays 2 lines by itself, then goes to rest"), "{told}");
    assert!(told.contains(&format!("`piezo waveform --stop --port tcp:{}`", device.address())), "{told}");
    assert!(told.contains("µm, relative to the model's zero"), "what can be held: {told}");
    let start = Instant::now();
    while health(&device)["faults"] != serde_json::json!(["SAFE_OUTPUT"]) {
        assert!(start.elapsed() < Duration::from_secs(20), "{}", health(&device));
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!((&health(&device)["lines"], &health(&device)["mode"]), (&2.into(), &"Waveform".into()));
    let info = said(asks(&device, &["info"]));
    assert!(info.contains("2 lines begun, 0 triggers ignored; it is over") && info.contains("Faults   none"), "{info}");
    assert!(info.contains("State    has played its waveform"), "{info}");
    let watched = asks(&device, &["monitor", "--seconds", "0.5"]).assert().success().get_output().stderr.clone();
    let watched = String::from_utf8(watched).unwrap();
    assert!(watched.contains("the device has played its waveform"), "{watched}");
}

#[test]
fn what_cannot_be_played_is_refused_with_what_helps_and_nothing_is_sent() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    let odd = line(folder.path(), 2.7);
    let said = refused(waveform(&device, &[text(&odd)]));
    assert!(said.contains("5.400 ticks") && said.contains("--every TICKS"), "{said}");
    let said = refused(waveform(&device, &[text(&odd), "--every", "1"]));
    assert!(
        said.contains("stand at a limit") && said.contains("nothing was sent") && said.contains("--every"),
        "{said}"
    );
    assert_eq!((&health(&device)["mode"], points(&device)), (&"Estimate".into(), 0));
    let said = refused(waveform(&device, &[text(&line(folder.path(), 2.5)), "--on-trigger"]));
    assert!(said.contains("no input for a trigger: play it without --on-trigger"), "{said}");
    let far = folder.path().join("nanometres.csv");
    let rows: String = (0..20).map(|k| format!("{:.6},{:.1}\n", 5e-3 * f64::from(k), 15e3 + f64::from(k))).collect();
    std::fs::write(&far, format!("time_s,displacement_um\n{rows}")).unwrap();
    let said = refused(waveform(&device, &[text(&far)]));
    assert!(said.contains("its first point, 15000 µm, is beyond") && said.contains("nothing was sent"), "{said}");
    let plain = Emulator::new().start().unwrap();
    let said = refused(waveform(&plain, &[text(&odd), "--every", "5"]));
    assert!(said.contains("does not say how the DAC drives the amplifier: piezo emit --drive-span"), "{said}");
}

#[test]
fn what_plays_is_ended_by_no_other_verb_unless_it_is_told_so() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    let path = line(folder.path(), 2.5);
    said(waveform(&device, &[text(&path)]));
    let port = format!("tcp:{}", device.address());
    let table = folder.path().join("own.bin");
    said(asks(&device, &["pull", "--out", text(&table)]));
    let push = ["push", text(&table), "--reset"];
    let erase = ["erase", "--reset", "--rewired"];
    for verb in [&["reset"][..], &push, &erase] {
        let complaint = refused(asks(&device, verb));
        let stop = format!("piezo waveform --stop --port {port}");
        assert!(complaint.contains("plays a waveform") && complaint.contains("--force"), "{verb:?}: {complaint}");
        assert!(complaint.contains(&stop), "{verb:?}: {complaint}");
        let looked_at = asks(&device, &[verb, &["--dry-run"]].concat()).assert().code(1).get_output().clone();
        let complaint = String::from_utf8(looked_at.stderr).unwrap();
        assert!(complaint.contains("plays a waveform"), "{verb:?}: {complaint}");
        assert_eq!(health(&device)["mode"], "Waveform", "{verb:?}");
    }
    let unchanged = refused_json(&mut asks(&device, &["reset", "--dry-run", "--json"]));
    assert_eq!(unchanged["restarted"], false, "{unchanged}");
    assert!(unchanged["refused"][0].as_str().unwrap().contains("plays a waveform"), "{unchanged}");
    // A session leaves it alone, too, and has no --force.
    let board = folder.path().join("board.toml");
    std::fs::write(&board, BOARD).unwrap();
    let session = folder.path().join("session");
    let complaint = refused(asks(&device, &["train", "--board", text(&board), "--out", text(&session)]));
    assert!(complaint.contains("piezo waveform --stop") && !complaint.contains("--force"), "{complaint}");
    assert!(!session.exists(), "nothing was recorded");
    // Nor is a session that is whole learnt from for minutes, only to be refused then.
    let learnt = folder.path().join("learnt");
    std::fs::create_dir(&learnt).unwrap();
    std::fs::write(learnt.join("session.toml"), "complete = true\nseed = 1\ntick_us = 500\nlogs = []\n").unwrap();
    let complaint = refused(asks(&device, &["learn", "--board", text(&board), "--out", text(&learnt)]));
    assert!(complaint.contains("piezo waveform --stop") && !complaint.contains("--force"), "{complaint}");
    let proof = folder.path().join("proof");
    let prove = ["prove", "--board", text(&board), "--out", text(&proof)];
    let calibrate = ["calibrate", "--board", text(&board), "--drive-to", "1:3", "--low", "1", "--high", "3"];
    for verb in [&prove[..], &calibrate, &["pil", super::MEASURED]] {
        let complaint = refused(asks(&device, verb));
        assert!(complaint.contains("plays a waveform") && complaint.contains("--force"), "{verb:?}: {complaint}");
        assert_eq!(health(&device)["mode"], "Waveform", "{verb:?}");
    }
    let restarted = json(&mut asks(&device, &["reset", "--force", "--json"]));
    assert_eq!(restarted["restarted"], true, "{restarted}");
    assert_eq!(health(&device)["mode"], "Estimate");
    // A dry run looks at what is to be written whatever the device does.
    let looked_at = asks(&device, &["push", text(&table), "--dry-run"]).assert().code(1).get_output().stdout.clone();
    let looked_at = String::from_utf8(looked_at).unwrap();
    assert!(looked_at.contains("nothing was written"), "{looked_at}");
}

#[test]
fn a_dry_run_says_what_would_be_refused() {
    let (device, folder) = (driving(), tempfile::tempdir().unwrap());
    let own = folder.path().join("own.bin");
    said(asks(&device, &["pull", "--out", text(&own)]));
    let tried = |verb: &[&str]| {
        let output = asks(&device, verb).arg("--dry-run").output().unwrap();
        let [said, careful] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert_eq!(output.status.code(), Some(i32::from(!careful.is_empty())), "{said}{careful}");
        (said, careful)
    };
    let careful = |verb: &[&str]| tried(verb).1;
    let estimating = "the device is estimating, and writing flash may cost ticks";
    assert!(careful(&["push", text(&own)]).contains(estimating));
    assert!(careful(&["erase"]).contains(estimating));
    assert_eq!(careful(&["push", text(&own), "--reset"]), "");
    // This one's DAC shows the displacement.
    let shown = folder.path().join("shown");
    let emit = ["emit", "tests/data/table/table.toml", "--adc-full-scale", "65520", "--out", text(&shown)];
    piezo().args(emit).assert().success();
    let shows = ["push", text(&shown.join("table.toml")), "--reset"].map(str::to_owned);
    let shows = shows.each_ref().map(String::as_str);
    assert!(careful(&shows).contains("repeat with --rewired"), "{}", careful(&shows));
    assert!(!careful(&[&shows[..], &["--rewired"]].concat()).contains("--rewired"));
    // What it prints says the same, and so does the JSON.
    let (looked_at, _) = tried(&["push", text(&own)]);
    assert!(looked_at.contains(" fits emulated, but would be refused; nothing was written"), "{looked_at}");
    let (looked_at, _) = tried(&["push", text(&own), "--reset"]);
    assert!(looked_at.contains(" fits emulated; nothing was written"), "{looked_at}");
    let (looked_at, _) = tried(&["erase"]);
    assert!(looked_at.contains("would be refused") && looked_at.contains("nothing was erased"), "{looked_at}");
    let refusals = |verb: &[&str]| {
        let output = asks(&device, verb).args(["--dry-run", "--json"]).output().unwrap();
        let refused = serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["refused"].clone();
        assert_eq!(output.status.code(), Some(i32::from(!refused.as_array().unwrap().is_empty())), "{refused}");
        refused
    };
    for verb in [&["push", text(&own)][..], &["erase"]] {
        assert!(refusals(verb)[0].as_str().unwrap().contains(estimating), "{verb:?}");
        assert_eq!(refusals(&[verb, &["--reset"]].concat()), serde_json::json!([]), "{verb:?}");
    }
    // By this board's file the DAC rests elsewhere.
    let board = folder.path().join("board.toml");
    std::fs::write(&board, BOARD.replace("drive_rest = 0.5", "drive_rest = 1.0")).unwrap();
    let install = ["install", "--line", "--board", text(&board)];
    assert!(careful(&install).contains("would jump"), "{}", careful(&install));
    assert!(refusals(&install)[0].as_str().unwrap().contains("would jump"));
    assert_eq!(refusals(&[&install[..], &["--rewired"]].concat()), serde_json::json!([]));
    // A DAC that shows the displacement is another's wire.
    let shows = ["install", text(&shown), "--board", text(&board)];
    std::fs::write(
        &board,
        BOARD.lines().filter(|line| !line.starts_with("drive_")).fold(String::new(), |a, b| a + b + "\n"),
    )
    .unwrap();
    assert!(refusals(&shows)[0].as_str().unwrap().contains("repeat with --rewired"), "{}", refusals(&shows));
    // What hinders the dry run itself ends it.
    drop(device);
    super::refused(&["push", text(&own), "--dry-run", "--port", "tcp:127.0.0.1:1"], &["tcp:127.0.0.1:1"]);
}

#[test]
fn a_number_of_nothing_is_refused_in_words_that_say_what_would_do() {
    for option in ["--every", "--repeat"] {
        let output = piezo().args(["waveform", "line.csv", option, "0", "--port", "tcp:127.0.0.1:9"]).output().unwrap();
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(complaint.contains("a whole number of at least 1; leave it out for"), "{complaint}");
    }
    let waveform = ["waveform", "line.csv"];
    for (verb, option, most) in [
        (&waveform[..], "--every", "65535"),
        (&waveform, "--repeat", "4294967295"),
        (&["monitor", "--udp", "127.0.0.1:9"], "--every", "4294967295"),
    ] {
        let more = format!("{most}0");
        super::refused(&[verb, &[option, &more]].concat(), &[option, &format!("a whole number of at most {most}")]);
    }
}
