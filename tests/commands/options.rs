//! What the options and the verbs promise: errors over several logs, what a table was trained on, refusals by name.

use super::logs::{rig, write};
use super::{MEASURED, json, number, piezo, refused, text};
use estimator_core::{Parameters, Published, Scheme};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use table_files::TableFile;

const TABLE: &str = "tests/data/table/table.toml";
const SHORT: [&str; 6] = ["--generations", "15", "--rounds", "3", "--devices", "0"];

/// A Voigt table of the rig's 10 Hz sine, in the folder of that log; returns the table and the log.
fn sin10(folder: &Path, arguments: &[&str]) -> (PathBuf, PathBuf) {
    let (log, out) = (write(folder, &rig("sin10")), folder.join("fit"));
    let mut command = piezo();
    command.arg("identify").arg(&log).args(["--model", "voigt"]).args(SHORT).args(arguments).arg("--out").arg(&out);
    command.assert().success();
    (out.join("table.toml"), log)
}

#[test]
fn the_percentage_over_several_logs_is_the_mean_of_theirs_and_is_what_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let (table, _) = sin10(folder.path(), &[]);
    // Strokes of some 8 and 5 µm.
    let logs = ["tr10", "sin100"].map(|name| write(folder.path(), &rig(name)));
    let validate = |arguments: &[&str]| {
        let mut command = piezo();
        command.arg("validate").arg(&table).args(&logs).args(arguments);
        command
    };
    let report = json(&mut validate(&["--json"]));
    for precision in ["mil", "sil"] {
        let percent = |log: usize| number(&report, &format!("/logs/{log}/{precision}/mae_percent"));
        for log in 0..2 {
            let of = |name: &str| number(&report, &format!("/logs/{log}/{precision}/{name}"));
            assert!((percent(log) - 100.0 * of("mae_um") / of("stroke_um")).abs() < 1e-9);
        }
        let all = number(&report, &format!("/all/{precision}/mae_percent"));
        assert!((all - (percent(0) + percent(1)) / 2.0).abs() < 1e-9, "{all}: {} {}", percent(0), percent(1));
    }
    let all = number(&report, "/all/sil/mae_percent");
    let of_the_largest_stroke = 100.0 * number(&report, "/all/sil/mae_um") / number(&report, "/logs/0/sil/stroke_um");
    assert!(of_the_largest_stroke < 0.95 * all, "these logs do not tell the two apart: {of_the_largest_stroke} {all}");
    let printed = validate(&[]).assert().success().get_output().stdout.clone();
    let printed = String::from_utf8(printed).unwrap();
    let line = printed.lines().skip_while(|line| *line != "all").nth(2).expect("a line for all logs by f32");
    assert!(line.split_whitespace().any(|word| word == format!("{all:.2}")), "{all:.2} is missing in {line}");
    validate(&["--max-percent", &format!("{}", 1.001 * all)]).assert().code(0);
    validate(&["--max-percent", &format!("{}", 0.999 * all)]).assert().code(1);
}

#[test]
fn validate_says_which_logs_the_table_was_trained_on() {
    let folder = tempfile::tempdir().unwrap();
    let unseen = write(folder.path(), &rig("tr100"));
    let held_out = write(folder.path(), &rig("tr10"));
    let validate = |table: &Path, logs: &[&Path]| {
        let mut command = piezo();
        command.arg("validate").arg(table).args(logs);
        let people = command.assert().success().get_output().stdout.clone();
        (json(command.arg("--json")), String::from_utf8(people).unwrap())
    };

    let (table, trained) = sin10(folder.path(), &["--as-judged"]);
    let (report, people) = validate(&table, &[&trained, &unseen]);
    let part = ["/logs/0/trained_on_s/0", "/logs/0/trained_on_s/1"].map(|pointer| number(&report, pointer));
    assert!(part[0] == 0.0 && (part[1] - 0.25).abs() < 1e-9, "half of half a second: {part:?}");
    assert_eq!(report.pointer("/logs/1/trained_on_s"), Some(&Value::Null));
    assert!(people.contains("trained on a part of what is scored: 0.00 … 0.25 s of this log"), "{people}");
    let rest = piezo().arg("validate").arg(&table).arg(&trained).args(["--from", "0.25"]).assert().success();
    let rest = String::from_utf8(rest.get_output().stdout.clone()).unwrap();
    assert!(rest.contains("trained on 0.00 … 0.25 s of this log; nothing of that is scored here"), "{rest}");
    let (_, people) = validate(&table, &[&unseen]);
    assert!(!people.contains("trained on"), "{people}");

    let (table, trained) = sin10(folder.path(), &["--validate-on", text(&held_out)]);
    let (report, people) = validate(&table, &[&held_out, &trained]);
    assert!(people.contains("trained on all that is scored: 0.00 … 0.50 s of this log"), "{people}");
    assert_eq!(report.pointer("/logs/0/trained_on_s"), Some(&Value::Null), "it was held out");
    assert!((number(&report, "/logs/1/trained_on_s/1") - 0.5).abs() < 1e-9, "the whole log");
}

#[test]
fn a_stated_calibration_is_no_longer_doubted() {
    let out = tempfile::tempdir().unwrap();
    let doubted = |table: &Path| TableFile::load(table).unwrap().0.doubts.iter().any(|d| d.contains("calibration"));
    let emit = |arguments: &[&str]| {
        piezo().args(["emit", TABLE]).args(arguments).arg("--out").arg(out.path()).assert().success();
        doubted(&out.path().join("table.toml"))
    };
    assert!(emit(&[]), "the committed table's calibration is assumed");
    assert!(emit(&["--adc-span", "-0.1:3.9"]), "the DAC's is still assumed");
    assert!(!emit(&["--adc-span", "-0.1:3.9", "--dac-span", "-5:50"]));
}

#[test]
fn every_choice_of_the_search_is_kept_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let choices = "--scheme zero-order-hold --selection roulette --decimate average --cost multi-step --norm l2";
    let more = ["--feedback-weight", "0.2", "--hold-out", "0.3", "--note", "carries <20 g"];
    let choices: Vec<&str> = choices.split(' ').chain(more).collect();
    let (table, _) = sin10(folder.path(), &choices);
    let (file, admitted) = TableFile::load(&table).unwrap();
    assert_eq!(admitted.scheme, Scheme::ZeroOrderHold);
    let written = fs::read_to_string(&table).unwrap();
    for line in [
        "scheme = \"zero-order-hold\"",
        "selection = \"roulette\"",
        "decimation = \"average\"",
        "cost = \"multi-step\"",
        "norm = \"l2\"",
        "feedback_weight = 0.2",
    ] {
        assert!(written.lines().any(|there| there == line), "{line} is missing in {written}");
    }
    let report = fs::read_to_string(table.with_file_name("report.html")).unwrap();
    assert!(report.contains("multi-step with feedback weight 0.2, root mean square error"));
    assert!(report.contains("carries &#60;20 g"), "the note is missing");
    let parts: Vec<(f64, f64)> = file.logs.iter().map(|log| (log.from_s, log.to_s)).collect();
    let [(from, to), (split, end)] = parts[..] else { panic!("{parts:?}") };
    assert!(from == 0.0 && (split - 0.35).abs() < 1e-9 && to == end && (to - 0.5).abs() < 1e-9, "{parts:?}");
}

#[test]
fn numbers_that_make_no_sense_are_refused_by_the_name_of_their_option() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let out = text(&out);
    let slow = ["--columns", "voltage=1,displacement=5", "--fs", "0.1", "--tick-us", "10"];
    let table = "tests/data/picma-p885-1hz/measured.dat";
    let message = refused(&[&["identify", table, "--out", out], &slow[..]].concat(), &["ticks", "--tick-us"]);
    // A million ticks a row.
    let longest = message.split(|c: char| !c.is_ascii_digit()).map(str::len).max();
    assert!(longest >= Some(9), "the number of ticks is missing: {message}");
    refused(&["identify", MEASURED, "--generations", "99999999999", "--out", out], &["--generations", "99999999999"]);
    for option in ["--seed", "--devices", "--population"] {
        let said = refused(&["identify", MEASURED, option, "-1", "--out", out], &[option, "-1"]);
        assert!(!said.contains("tip:"), "{said}");
    }
    refused(&["reproduce", "--limit", "nan"], &["--limit"]);
    refused(&["validate", TABLE, MEASURED, "--skip-start", "nan"], &["--skip-start"]);
    refused(&["simulate", "--creep", "nan", "--out", out], &["--creep"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// So few candidates that some models find none that is admissible within so narrow limits. With this seed Maxwell-slip
/// is one of those where all are tried, and the enhanced model where it is asked for.
const HARDLY_SEARCHED: [&str; 16] = [
    "--start",
    "random",
    "--generations",
    "5",
    "--rounds",
    "1",
    "--evaluations",
    "20",
    "--population",
    "8",
    "--limit",
    "1.25",
    "--seed",
    "3",
    "--devices",
    "0",
];

/// At one frequency the lag is what somebody says, and the error hardly tells.
#[test]
fn a_lag_that_is_stated_is_kept_to() {
    let folder = tempfile::tempdir().unwrap();
    let late = |ms: &str| {
        let out = folder.path().join(ms);
        let mut command = piezo();
        command.args(["identify", MEASURED, "--lag", ms, "--json"]);
        command.args(["--evaluations", "60", "--devices", "0", "--out"]).arg(&out);
        let result = json(&mut command);
        let doubts = result["doubts"].as_array().unwrap();
        assert!(doubts.iter().any(|doubt| doubt["doubt"] == "single-frequency" && doubt["lag_known"] == true));
        let (_, table) = TableFile::load(&out.join("table.toml")).unwrap();
        let Parameters::GeneralisedPrandtlIshlinskii(of) = table.parameters else { panic!("{table:?}") };
        0.5 * f64::from(of.delay_ticks()) + 1e3 * f64::from(of.lag_s)
    };
    for ms in [11.0, 14.0] {
        let found = late(&ms.to_string());
        assert!((found - ms).abs() < 0.1 * ms, "{found} ms, not {ms} ms");
    }
    let out = text(folder.path());
    refused(&["identify", MEASURED, "--lag", "-3", "--out", out], &["--lag"]);
    refused(&["identify", MEASURED, "--lag", "5000", "--out", out], &["5000 ms", "57.5 ms", "--lag takes ms"]);
    refused(
        &["identify", MEASURED, "--deadband", "1000", "--out", out],
        &["deadband of 999.999", "--deadband, which takes V"],
    );
}

#[test]
fn a_model_that_finds_nothing_admissible_does_not_take_the_others_along() {
    let folder = tempfile::tempdir().unwrap();
    let run = |model: &str, out: &Path| {
        let mut command = piezo();
        command.args(["identify", MEASURED, "--model", model, "--json", "--out"]).arg(out).args(HARDLY_SEARCHED);
        command
    };
    let out = folder.path().join("auto");
    let result = json(&mut run("auto", &out));
    let failed = result["failed"].as_array().expect("an array");
    let model = |value: &Value| value["model"].as_str().expect("a model's name").to_owned();
    assert!(failed.iter().any(|entry| model(entry) == "maxwell-slip"), "{failed:?}: another seed would show it");
    assert!(failed.iter().all(|entry| entry["reason"].as_str().is_some_and(|reason| reason.len() > 20)), "{failed:?}");
    let found: Vec<String> = result["candidates"].as_array().unwrap().iter().map(model).collect();
    assert!(failed.iter().all(|entry| !found.contains(&model(entry))), "{found:?} {failed:?}");
    assert_eq!((found.len() + failed.len(), &result["model"]), (12, &json!("generalised-prandtl-ishlinskii")));
    TableFile::load(&out.join("table.toml")).unwrap();

    let out = folder.path().join("enhanced");
    let refusal = run("enhanced", &out).assert().code(2).get_output().stderr.clone();
    let refusal = String::from_utf8(refusal).unwrap();
    assert!(refusal.contains("enhanced") && refusal.contains("admissible"), "{refusal}");
    assert!(!out.exists(), "nothing may be written");
}

#[test]
fn a_folder_that_cannot_be_made_is_refused_and_nothing_else_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "here stands a file").unwrap();
    for out in [file.clone(), file.join("below")] {
        let out = text(&out);
        let short = ["--model", "voigt", "--generations", "1", "--rounds", "1"];
        refused(&[&["identify", MEASURED, "--out", out], &short[..]].concat(), &[out]);
        refused(&["emit", TABLE, "--out", out], &[out]);
        refused(&["simulate", "--out", out], &[out]);
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "here stands a file");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_usage_of_a_mistake_asks_for_no_port_that_the_environment_gives() {
    for verb in [&["install", "--nonsense"][..], &["info", "--nonsense"], &["install"]] {
        let output = piezo().args(verb).env("PIEZO_PORT", "tcp:127.0.0.1:9").output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        let usage = said.lines().find(|line| line.starts_with("Usage:")).expect("how it is used");
        assert!(usage.starts_with(&format!("Usage: piezo {} [OPTIONS]", verb[0])), "{said}");
        assert!(!usage.contains("--port") && output.status.code() == Some(2), "{said}");
    }
    let help = piezo().args(["info", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    assert!(help.contains("PIEZO_PORT"), "{help}");
}

#[test]
fn a_value_that_is_wrong_comes_without_a_usage() {
    let said = refused(&["look", MEASURED, "--fs", "fast"], &["invalid value 'fast' for '--fs"]);
    assert!(!said.contains("Usage:"), "{said}");
}

#[test]
fn a_proof_s_length_has_one_unit_and_a_frequency_may_have_its_own() {
    let prove = ["prove", "--out", "nowhere", "--minutes", "2"];
    refused(&[&prove[..], &["--seconds", "30"]].concat(), &["cannot be used with"]);
    refused(&[&prove[..], &["--up-to", "50V"]].concat(), &["expected a frequency, as 50Hz or 50"]);
    let dry = ["train", "--dry-run", "--out", "nowhere", "--board", "nowhere.toml", "--up-to", "0.05kHz"];
    refused(&dry, &["nowhere.toml"]);
}

#[cfg(unix)]
#[test]
fn what_is_no_text_is_a_mistake_like_any_other() {
    use std::os::unix::ffi::OsStrExt;
    let said = piezo().arg(std::ffi::OsStr::from_bytes(b"\xff")).assert().code(2).get_output().stderr.clone();
    assert!(String::from_utf8_lossy(&said).contains("unrecognized subcommand"), "{said:?}");
}
