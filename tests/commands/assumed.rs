//! What is assumed, contradicted or doubted of a log or a table is said, and what is made of it.

use super::{MEASURED, json, piezo, refused, text};
use emulator::Emulator;
use std::fmt::Write;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Output;

const SHORTEST: [&str; 8] = ["--model", "voigt", "--generations", "5", "--rounds", "1", "--devices", "0"];

/// A log of two sines with a little hysteresis: so many V and µm at most, under this heading.
fn log(folder: &Path, name: &str, heading: &str, volts: f64, um: f64) -> PathBuf {
    let rows = (0..4000).fold(format!("{heading}\n"), |mut rows, k| {
        let phase = f64::from(k) * 0.01;
        let (v, y) = (0.5 - 0.5 * phase.cos(), 0.5 - 0.5 * (phase - 0.1).cos());
        writeln!(rows, "{:.4},{:.6},{:.6}", f64::from(k) * 1e-3, volts * v, um * y).unwrap();
        rows
    });
    let path = folder.join(name);
    fs::write(&path, rows).unwrap();
    path
}

fn run(arguments: &[&str]) -> Output {
    piezo().args(arguments).assert().success().get_output().clone()
}

fn printed(arguments: &[&str]) -> String {
    String::from_utf8(run(arguments).stdout).unwrap()
}

fn identify(log: &str, out: &Path, more: &[&str]) -> Output {
    run(&[&["identify", log, "--out", text(out)], &SHORTEST[..], more].concat())
}

#[test]
fn which_of_the_two_calibrations_is_assumed_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let said =
        |more: &[&str]| String::from_utf8(identify(MEASURED, &folder.path().join("model"), more).stdout).unwrap();
    assert!(said(&[]).contains("the ADC and DAC calibration is assumed"));
    let adc = said(&["--adc-span", "-22:22"]);
    assert!(adc.contains("the DAC's calibration is assumed") && !adc.contains("state --adc-span"), "{adc}");
    let table = folder.path().join("model/table.toml");
    // What emit is told is added to what was stated before.
    let board = folder.path().join("board");
    printed(&["emit", text(&table), "--dac-span", "-8:52", "--out", text(&board)]);
    let both = fs::read_to_string(board.join("table.toml")).unwrap();
    assert!(!both.contains("calibration is assumed"), "{both}");
    let dac = said(&["--dac-span", "-8:52"]);
    assert!(dac.contains("the ADC's calibration is assumed") && !dac.contains("state --dac-span"), "{dac}");
    let narrow = said(&["--adc-span", "-1:2", "--dac-span", "52:-8"]);
    assert!(
        narrow.contains("the span of the ADC (--adc-span) does not cover the logs, which need 0 … 3.6 V"),
        "{narrow}"
    );
    assert!(!narrow.contains("(--dac-span)") && !narrow.contains("piezo install"), "{narrow}");
}

#[test]
fn whether_small_voltages_are_a_monitors_is_asked_unless_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let said =
        |more: &[&str]| String::from_utf8(identify(MEASURED, &folder.path().join("model"), more).stdout).unwrap();
    let asks = "The voltage goes from 0.000 to 3.600 V: is this voltage a monitor's";
    assert!(said(&[]).contains(asks) && !said(&["--voltage-scale", "20"]).contains("is this voltage a monitor's"));
    // Beside a session's description it is one of a board's logs, whose volts are known.
    let log = folder.path().join("01-log.csv");
    fs::copy(super::root().join(MEASURED), &log).unwrap();
    fs::write(folder.path().join("session.toml"), "complete = true\nseed = 1\nlogs = []\n").unwrap();
    let recorded = identify(text(&log), &folder.path().join("recorded"), &[]);
    assert!(!String::from_utf8(recorded.stdout).unwrap().contains("is this voltage a monitor's"));
}

#[test]
fn a_table_that_takes_the_place_of_another_says_of_which() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model");
    let first = identify(MEASURED, &model, &[]);
    assert!(!String::from_utf8_lossy(&first.stderr).contains("replace"));
    let second = String::from_utf8(identify(MEASURED, &model, &[]).stderr).unwrap();
    assert!(
        second.contains("what is learnt will replace the voigt table of picma-p885-1hz.csv (checksum "),
        "{second}"
    );
}

#[test]
fn a_displacement_that_no_piezo_actuator_has_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = log(folder.path(), "wrong.csv", "time_s,voltage_V,displacement_um", 40.0, 8000.0);
    let sound = log(folder.path(), "sound.csv", "time_s,voltage_V,displacement_um", 40.0, 8.0);
    let doubt = "200 µm/V";
    let looked = printed(&["look", text(&wrong)]);
    assert!(looked.contains(doubt) && looked.contains("is the unit right"), "{looked}");
    assert!(!printed(&["look", text(&sound)]).contains("is the unit right"));
    let model = folder.path().join("model");
    let learnt = String::from_utf8(identify(text(&wrong), &model, &[]).stdout).unwrap();
    assert!(learnt.contains(doubt) && learnt.contains("is the unit right"), "{learnt}");
}

#[test]
fn a_unit_that_is_stated_against_the_header_is_taken_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path(), "mv.csv", "time_ms,voltage_mV,displacement_um", 40.0, 8.0);
    let columns = ["--columns", "time=1:s,voltage=2:V"];
    let said = ["the header says mV, --columns says V; V is used", "the header says ms, --columns says s; s is used"];
    let looked = printed(&[&["look", text(&path)], &columns[..]].concat());
    let learnt = identify(text(&path), &folder.path().join("model"), &columns);
    let learnt = String::from_utf8(learnt.stderr).unwrap();
    for part in said {
        assert!(looked.contains(part), "{part:?} is missing in\n{looked}");
        assert!(learnt.contains(part) && learnt.contains("mv.csv"), "{part:?} is missing in\n{learnt}");
    }
    let machine = json(piezo().args(["look", text(&path), "--json"]).args(columns));
    let [of_v, of_s] = ["voltage", "time"].map(|quantity| {
        let remarks = machine[0]["survey"]["remarks"].as_array().expect("what people are told, machines are, too");
        remarks.iter().find(|remark| remark["quantity"] == quantity).unwrap().clone()
    });
    assert_eq!((&of_v["remark"], &of_v["header"], &of_v["stated"]), (&"overruled".into(), &"mV".into(), &"V".into()));
    assert_eq!(of_s["header"], "ms");
    let same = printed(&["look", text(&path), "--columns", "displacement=3:um,time=1:s,voltage=2:V"]);
    assert!(!same.contains("the header says µm"), "{same}");
}

#[test]
fn what_comes_after_look_can_be_pasted() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path(), "day 1.csv", "voltage_mV,foo,displacement_um", 40.0, 8.0);
    let options = ["--columns", "voltage=2:V,displacement=3:um", "--fs", "1000"];
    let looked = printed(&[&["look", text(&path)], &options[..]].concat());
    let next = looked.lines().find(|line| line.trim_start().starts_with("piezo identify")).expect("a line to paste");
    let expected =
        format!("piezo identify '{}' --columns voltage=2:V,displacement=3:um --fs 1000 --out 'out/day 1'", text(&path));
    assert_eq!(next.trim(), expected);
    let words = shlex::split(next).expect("a shell's line");
    piezo().current_dir(folder.path()).args(&words[1..]).args(SHORTEST).assert().success();
    assert!(folder.path().join("out/day 1/table.toml").is_file());
}

#[test]
fn a_wanted_trajectory_without_names_is_taken_for_a_displacement() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, columns: usize| {
        let row = |k: u32| {
            if columns == 1 { format!("{}\n", k % 7) } else { format!("{:.3},{}\n", f64::from(k) * 1e-3, k % 7) }
        };
        let path = folder.path().join(name);
        fs::write(&path, (0..50).map(row).collect::<String>()).unwrap();
        path
    };
    let table = "tests/data/table/table.toml";
    let out = folder.path().join("out.csv");
    for (path, example) in [
        (of("one.csv", 1), "--columns displacement=1:um --fs '<HZ>'"),
        (of("two.csv", 2), "--columns time=1:s,displacement=2:um"),
    ] {
        let wanted = ["feedforward", table, text(&path), "--slew", "200", "--out", text(&out)];
        let said = refused(&wanted, &[example]);
        assert!(!said.contains("voltage=1"), "{said}");
    }
    // A log still has its voltage first.
    refused(&["look", text(&of("three.csv", 2))], &["voltage="]);
}

#[test]
fn points_that_are_not_equally_far_apart_are_to_be_resampled_and_not_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("line.csv");
    let rows: String =
        (0..60u32).map(|k| format!("{:.4},{}\n", f64::from(k) + 0.2 * f64::from(k % 3), k % 7)).collect();
    fs::write(&path, format!("time_s,displacement_um\n{rows}")).unwrap();
    let said =
        refused(&["waveform", text(&path), "--port", "tcp:127.0.0.1:9"], &["resample", "displacement=2", "--fs"]);
    assert!(!said.contains("record with"), "{said}");
    let rows: String = [0, 1, 2, 6, 7].map(|t: u32| format!("{t},{}\n", t % 7)).concat();
    fs::write(&path, format!("time_s,displacement_um\n{rows}")).unwrap();
    let said = refused(&["waveform", text(&path), "--port", "tcp:127.0.0.1:9"], &["3 points are missing", "resample"]);
    assert!(!said.contains("record again"), "{said}");
    let logged = folder.path().join("log.csv");
    let rows: String =
        (0..60u32).map(|k| format!("{:.4},{},{}\n", f64::from(k) + 0.2 * f64::from(k % 3), k % 5, k % 7)).collect();
    fs::write(&logged, format!("time_s,voltage_V,displacement_um\n{rows}")).unwrap();
    let model = folder.path().join("model");
    refused(&["identify", text(&logged), "--out", text(&model)], &["record with a hardware clock"]);
}

#[test]
fn columns_that_nothing_names_are_said_to_be_assumed() {
    let said = printed(&["look", "tests/data/formats/rows.mat"]);
    assert!(
        said.contains("the file names no columns: they are taken for time=1:s,voltage=2:V,displacement=3:um"),
        "{said}"
    );
    assert!(!printed(&["look", MEASURED]).contains("names no columns"));
    let machine = json(piezo().args(["look", "tests/data/formats/rows.mat", "--json"]));
    assert_eq!(machine[0]["survey"]["remarks"][0]["columns"], "time=1:s,voltage=2:V,displacement=3:um", "{machine}");
}

#[test]
fn voltages_beyond_what_the_logs_taught_are_said() {
    let folder = tempfile::tempdir().unwrap();
    // Its logs went from 0 to 3.6 V, and it covers a little more.
    let table = "tests/data/table/table.toml";
    let planned = |highest: f64, range: &[&str]| {
        let row = |k: u32| {
            format!("{:.3},{:.4}\n", f64::from(k) * 1e-3, 10.0 + highest * (0.5 - 0.5 * (f64::from(k) * 3e-3).cos()))
        };
        let path = folder.path().join("wanted.csv");
        fs::write(&path, "time_s,displacement_um\n".to_owned() + &(0..2100).map(row).collect::<String>()).unwrap();
        let out = folder.path().join("voltages.csv");
        let more = ["--slew", "100", "--out", text(&out), "--max-error", "100", "--rest", "1.2"];
        let output = piezo().args(["feedforward", table, text(&path)]).args(more).args(range).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let beyond = planned(60.0, &["--range", "0:3.78"]);
    assert!(beyond.contains("V beyond what the logs taught"), "{beyond}");
    // Nobody goes there unasked.
    let unasked = planned(60.0, &[]);
    assert!(unasked.contains("0 … 3.6 V") && !unasked.contains("beyond what the logs taught"), "{unasked}");
    let within = planned(15.0, &[]);
    assert!(!within.contains("beyond what the logs taught"), "{within}");
}

#[test]
fn a_folder_for_a_result_is_made_where_there_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a/b/log.svg");
    printed(&["look", MEASURED, "--out", text(&picture)]);
    assert!(picture.is_file());
    // What comes to nothing leaves none.
    let table = folder.path().join("c/table.bin");
    refused(&["pull", "--out", text(&table), "--port", "tcp:127.0.0.1:1"], &["tcp:127.0.0.1:1"]);
    assert!(!folder.path().join("c").exists());
    let recordings = folder.path().join("d/e");
    let web = ["monitor", "--web", "127.0.0.1:0", "--out", text(&recordings), "--port", "tcp:127.0.0.1:1"];
    let said = refused(&web, &["tcp:127.0.0.1:1"]);
    assert!(!said.contains("no folder") && !folder.path().join("d").exists(), "{said}");
    let (device, taken) = (Emulator::new().start().unwrap(), TcpListener::bind("127.0.0.1:0").unwrap());
    let (address, port) = (taken.local_addr().unwrap().to_string(), format!("tcp:{}", device.address()));
    refused(&["monitor", "--web", &address, "--out", text(&recordings), "--port", &port], &[&address]);
    assert!(!folder.path().join("d").exists());
}

#[test]
fn the_same_recording_from_another_program_is_known_by_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model");
    let whole = log(folder.path(), "whole.csv", "time_s,voltage_V,displacement_um", 40.0, 8.0);
    identify(text(&whole), &model, &[]);
    // Other names, other units, fewer digits, and cut at its beginning.
    let rows: String = fs::read_to_string(&whole)
        .unwrap()
        .lines()
        .skip(1 + 300)
        .map(|line| {
            let [t, v, y] = line.split(',').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>()[..] else {
                panic!()
            };
            format!("{t:.4};{v:.3};{:.1}\n", 1e3 * y)
        })
        .collect();
    let again = folder.path().join("again.csv");
    fs::write(&again, format!("Zeit (s);Spannung (V);Weg (nm)\n{rows}")).unwrap();
    let table = model.join("table.toml");
    let said = printed(&["validate", text(&table), text(&again)]);
    assert!(said.contains("the table was trained on"), "{said}");
    assert!(said.contains("holds the samples of whole.csv"), "{said}");
    let report = json(piezo().args(["validate", text(&table), text(&again), "--json"]));
    assert!(report["logs"][0]["trained_on_s"].is_array(), "{report}");
    // Another recording of the same actuator is another one.
    let other = log(folder.path(), "other.csv", "time_s,voltage_V,displacement_um", 39.0, 7.8);
    let said = printed(&["validate", text(&table), text(&other)]);
    assert!(!said.contains("the table was trained on"), "{said}");
}
