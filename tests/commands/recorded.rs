//! Logs of `piezo record`: their displacement is the device's estimate, and nobody may take it for a sensor's.

use super::logs::rig;
use super::{MEASURED, json, piezo, text};
use recordings::log::{Displacement, csv_beside};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use table_files::TableFile;

const SHORTEST: [&str; 8] = ["--model", "voigt", "--generations", "5", "--rounds", "1", "--devices", "0"];
const DOUBT: &str = "is a device's estimate";

/// One of the rig's logs as `piezo record` would have written it.
fn recorded(folder: &Path, name: &str) -> PathBuf {
    let (path, log) = (folder.join(name).with_extension("csv"), rig(name));
    let displacement = log.displacement.unwrap();
    csv_beside(&path, log.sample_period, &log.voltage, &displacement, Displacement::Estimated)
        .unwrap()
        .commit()
        .unwrap();
    path
}

/// The logs that `identify` doubts for it.
fn doubted(result: &Value) -> Vec<&str> {
    let doubts = result["doubts"].as_array().unwrap().iter();
    doubts
        .filter(|doubt| doubt["doubt"] == "estimated-displacement")
        .filter_map(|doubt| doubt["log"].as_str())
        .collect()
}

#[test]
fn identify_doubts_every_log_that_is_an_estimate_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let identify = |logs: &[&str]| {
        let mut command = piezo();
        command.arg("identify").args(logs).args(SHORTEST).arg("--out").arg(&out);
        command
    };
    let (first, second) = (recorded(folder.path(), "sin10"), recorded(folder.path(), "tr10"));
    let (first, second) = (text(&first), text(&second));
    // Half of a log is held out: it is one log all the same.
    assert_eq!(doubted(&json(identify(&[first]).arg("--json"))), ["sin10"]);
    assert_eq!(doubted(&json(identify(&[MEASURED, "--validate-on", second]).arg("--json"))), ["tr10"]);
    assert_eq!(doubted(&json(identify(&[first, "--validate-on", second]).arg("--json"))), ["sin10", "tr10"]);
    assert!(doubted(&json(identify(&[MEASURED]).arg("--json"))).is_empty());

    let printed = identify(&[first]).assert().success().get_output().stdout.clone();
    let table = TableFile::load(&out.join("table.toml")).unwrap().0;
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    let shown = [String::from_utf8(printed).unwrap(), table.doubts.join("\n"), report.replace("&#39;", "'")];
    for place in shown {
        assert!(place.contains("sin10 is a device"), "{place}");
        assert!(place.contains(DOUBT), "{place}");
    }
}

#[test]
fn look_says_which_logs_are_estimates_and_proposes_no_identification_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let log = recorded(folder.path(), "sin10");
    let looked = |log: &str| {
        let said = piezo().args(["look", log]).assert().success().get_output().stdout.clone();
        String::from_utf8(said).unwrap()
    };
    let [estimated, measured] = [looked(text(&log)), looked(MEASURED)];
    assert!(estimated.contains(DOUBT) && !estimated.contains("piezo identify"), "{estimated}");
    assert!(!measured.contains(DOUBT) && measured.contains("piezo identify"), "{measured}");
}

#[test]
fn validate_says_which_logs_are_estimates() {
    let folder = tempfile::tempdir().unwrap();
    let log = recorded(folder.path(), "sin10");
    let validate = |log: &str| {
        let mut command = piezo();
        command.args(["validate", "tests/data/table/table.toml", log, "--skip-start", "0"]);
        let people = command.assert().success().get_output().stdout.clone();
        (json(command.arg("--json"))["logs"][0]["displacement_estimated"].clone(), String::from_utf8(people).unwrap())
    };
    for (log, estimated) in [(text(&log), true), (MEASURED, false)] {
        let (flag, people) = validate(log);
        assert_eq!((flag, people.contains(DOUBT)), (json!(estimated), estimated), "{people}");
    }
}
