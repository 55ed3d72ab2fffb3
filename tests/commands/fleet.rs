//! A fleet: what each unit's run leaves, what is searched again, and all of them side by side.

use super::logs::{rig, write};
use super::{json, number, piezo, refused, root, text};
use assert_cmd::Command;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use table_files::TableFile;

const SHORT: [&str; 8] = ["--model", "voigt", "--generations", "5", "--rounds", "1", "--devices", "0"];

/// `identify` of a unit from a log, into the folder of its name.
fn identify(fleet: &Path, unit: &str, log: &Path) -> Command {
    let mut command = piezo();
    command.arg("identify").arg(log).args(SHORT).args(["--unit", unit, "--out"]).arg(fleet.join(unit));
    command
}

fn unit_file(fleet: &Path, unit: &str) -> Value {
    serde_json::from_slice(&fs::read(fleet.join(unit).join("unit.json")).unwrap()).unwrap()
}

fn collect(arguments: &[&str]) -> (i32, String) {
    let output = piezo().arg("collect").args(arguments).output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn a_unit_s_run_leaves_a_file_whether_it_found_a_table_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, log) = (folder.path().join("fleet"), write(folder.path(), &rig("sin10")));
    let result = json(identify(&fleet, "SN042", &log).arg("--json"));
    let unit = unit_file(&fleet, "SN042");
    assert_eq!(
        [&unit["unit"], &unit["status"], &unit["exit_code"]],
        [&json!("SN042"), &json!("identified"), &json!(0)]
    );
    for name in ["mae_um", "mae_percent", "max_um", "stroke_um"] {
        let of_result = number(&result, &format!("/candidates/0/held_out/{name}"));
        assert_eq!(number(&unit, &format!("/held_out/{name}")), of_result, "{name}");
    }
    let kinds = |value: &Value| -> Vec<Value> {
        value["doubts"].as_array().unwrap().iter().map(|doubt| doubt["doubt"].clone()).collect()
    };
    assert_eq!(kinds(&unit), kinds(&result));
    assert!(!kinds(&unit).is_empty() && number(&unit, "/seconds") > 0.0);
    let files = unit["files"].as_object().unwrap();
    for name in ["table.toml", "table.rs", "table.bin", "report.html", "estimate.svg"] {
        let digest = Sha256::digest(fs::read(fleet.join("SN042").join(name)).unwrap());
        let digest: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(files[name], json!(digest), "{name}");
    }
    let (table, _) = TableFile::load(&fleet.join("SN042/table.toml")).unwrap();
    assert_eq!(table.unit.as_deref(), Some("SN042"));
    assert!(fs::read_to_string(fleet.join("SN042/report.html")).unwrap().contains("<h1>SN042: sin10.csv</h1>"));

    // A log without a displacement, into a new folder and into that of a result.
    let wrong = folder.path().join("wrong.csv");
    fs::write(&wrong, "time [s],voltage [V]\n0,0\n0.1,1\n0.2,2\n0.3,3\n").unwrap();
    for unit in ["SN043", "SN042"] {
        let output = identify(&fleet, unit, &wrong).assert().code(2).get_output().stderr.clone();
        let failed = unit_file(&fleet, unit);
        assert_eq!([&failed["status"], &failed["exit_code"]], [&json!("failed"), &json!(2)]);
        let error = failed["error"].as_str().unwrap();
        assert!(String::from_utf8(output).unwrap().ends_with(&format!("piezo: {error}\n")), "{error}");
        assert!(error.contains("wrong.csv"), "{error}");
        assert_eq!(failed["table_before"].is_null(), unit == "SN043", "the table of before is told of: {failed}");
    }
    assert!(!fleet.join("SN043/table.toml").exists());
}

#[test]
fn what_is_unchanged_is_not_searched_and_anything_else_is() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, log) = (folder.path().join("fleet"), write(folder.path(), &rig("sin10")));
    let (other, renamed) = (write(folder.path(), &rig("tr10")), folder.path().join("SN042 of today.csv"));
    let table = fleet.join("SN042/table.toml");
    // Whether it searched, and what it said.
    let run = |log: &Path, options: &[&str]| {
        let output = identify(&fleet, "SN042", log).arg("--if-changed").args(options).assert().code(0);
        let output = output.get_output();
        let said = [&output.stdout[..], &output.stderr[..]].concat();
        let said = String::from_utf8(said).unwrap();
        assert_ne!(said.contains("nothing was searched"), said.contains("it is searched"), "{said}");
        (said.contains("it is searched"), said)
    };
    let searched = |log: &Path, options: &[&str], why: &str| {
        let (searched, said) = run(log, options);
        assert!(searched && said.contains(why), "{why}: {said}");
        assert!(!run(log, options).0, "and not once more");
    };
    let kept = |log: &Path| {
        let before = fs::read(fleet.join("SN042/unit.json")).unwrap();
        assert!(!run(log, &[]).0);
        assert_eq!(fs::read(fleet.join("SN042/unit.json")).unwrap(), before);
    };
    searched(&log, &[], "there is no result yet");
    // Written again with what it had, and under another name.
    fs::write(&log, fs::read(&log).unwrap()).unwrap();
    kept(&log);
    fs::copy(&log, &renamed).unwrap();
    kept(&renamed);
    let result = json(identify(&fleet, "SN042", &log).args(["--if-changed", "--json"]));
    assert_eq!(result, unit_file(&fleet, "SN042"));

    searched(&log, &["--seed", "2"], "the options changed");
    searched(&log, &["--validate-on", text(&other)], "the logs and the options changed");
    searched(&log, &[], "the logs and the options changed");
    // Another recording under the name of this one.
    let measured = fs::read(&log).unwrap();
    fs::copy(&other, &log).unwrap();
    searched(&log, &[], "the logs changed");
    fs::write(&log, &measured).unwrap();
    searched(&log, &[], "the logs changed");

    let edited = fs::read_to_string(&table).unwrap() + "# by hand\n";
    fs::write(&table, edited).unwrap();
    searched(&log, &[], "table.toml is not as it was written");
    fs::remove_file(fleet.join("SN042/table.bin")).unwrap();
    searched(&log, &[], "table.bin is not as it was written");

    identify(&fleet, "SN042", &folder.path().join("none.csv")).assert().code(2);
    searched(&log, &[], "the run before found no table");
    let mut another = piezo();
    another.arg("identify").arg(&log).args(SHORT).args(["--unit", "SN043", "--if-changed", "--out"]);
    let said = another.arg(fleet.join("SN042")).assert().success().get_output().stderr.clone();
    assert!(String::from_utf8(said).unwrap().contains("the result is that of SN042: it is searched"));
}

#[test]
fn a_board_file_counts_by_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, log) = (folder.path().join("fleet"), write(folder.path(), &rig("sin10")));
    let board = folder.path().join("board.toml");
    let run = |span: &str| {
        fs::write(&board, format!("adc_span = {span}\n")).unwrap();
        let mut command = identify(&fleet, "SN042", &log);
        let output = command.args(["--if-changed", "--board"]).arg(&board).assert().success().get_output().clone();
        String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
    };
    assert!(run("[-22.0, 22.0]").contains("there is no result yet"));
    assert!(run("[-22.0, 22.0] # measured today").contains("nothing was searched"));
    assert!(run("[-22.0, 22.5]").contains("the options changed"));
}

#[test]
fn a_run_that_is_killed_is_seen_to_have_not_ended_and_is_searched_again() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, log) = (folder.path().join("fleet"), write(folder.path(), &rig("sin10")));
    let out = fleet.join("SN042");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_piezo"));
    command.arg("identify").arg(&log).args(["--model", "voigt", "--generations", "100000", "--unit", "SN042", "--out"]);
    let mut run = command.arg(&out).stdout(std::process::Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !out.join("unit.json").exists() {
        assert!(begun.elapsed() < Duration::from_secs(30), "it does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    let (code, said) = collect(&[text(&fleet)]);
    assert_eq!(code, 1);
    assert!(said.contains("SN042 (running): its run has not ended yet"), "{said}");
    run.kill().unwrap();
    run.wait().unwrap();
    let (code, said) = collect(&[text(&fleet)]);
    assert_eq!(code, 1);
    assert!(said.contains("SN042 (killed): its run was killed, unless it goes on on another machine"), "{said}");
    let again = identify(&fleet, "SN042", &log).arg("--if-changed").assert().success().get_output().stderr.clone();
    assert!(String::from_utf8(again).unwrap().contains("the run before found no table"));
}

/// The folder of results is held meanwhile, and so is that of a session that is recorded: one is not taken
/// for the other.
#[test]
fn a_killed_session_is_learnt_from_into_its_own_folder_by_a_unit_and_by_none() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("p885");
    fs::create_dir(&session).unwrap();
    fs::rename(write(folder.path(), &rig("sin10")), session.join("01-sine.csv")).unwrap();
    let log = |name: &str| format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = false\ncomplete = false\nrows = 1000\n");
    let logs = log("01-sine") + &log("02-rest");
    let described = format!("complete = false\nunder_way = true\nseed = 1\nplanned = 2\n{logs}");
    fs::write(session.join("session.toml"), described).unwrap();
    for unit in [&[][..], &["--unit", "SN042"]] {
        let mut command = piezo();
        command.arg("identify").arg(&session).args(SHORT).arg("--out").arg(&session).args(unit);
        let said = command.assert().success().get_output().stderr.clone();
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("the session ended before its time: 1 of 2 logs are there"), "{said}");
        assert!(session.join("table.toml").exists() && session.join("unit.json").exists() != unit.is_empty());
    }
    // A session that cannot be learnt from is a unit's error like another.
    let empty = folder.path().join("p886");
    fs::create_dir(&empty).unwrap();
    fs::write(empty.join("session.toml"), "complete = false\nunder_way = true\nseed = 1\nplanned = 2\nlogs = []\n")
        .unwrap();
    identify(folder.path(), "SN043", &empty).assert().code(2);
    let error = unit_file(folder.path(), "SN043")["error"].as_str().unwrap().to_owned();
    assert!(error.contains("ended before it had a log to learn from"), "{error}");
}

#[test]
fn a_folder_of_a_unit_is_not_written_into_by_a_run_of_none_nor_over_a_stranger_s_file() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, log) = (folder.path().join("fleet"), write(folder.path(), &rig("sin10")));
    identify(&fleet, "SN042", &log).assert().success();
    let (out, strangers) = (fleet.join("SN042"), fleet.join("SN043"));
    refused(&["identify", text(&log), "--out", text(&out)], &["says what came of SN042", "--unit", "--out"]);
    // One that is damaged, or of another version, may be a unit's as well.
    let (file, table) = (out.join("unit.json"), out.join("table.toml"));
    let (whole, before) = (fs::read_to_string(&file).unwrap(), fs::read(&table).unwrap());
    for (damaged, why) in [
        (&whole[..whole.len() / 2], "unit.json: is no unit.json ("),
        ("{\"piezo_unit\": 9}", "unit.json: is a unit.json of version 9, and this program reads version 1"),
    ] {
        fs::write(&file, damaged).unwrap();
        let other = ["--seed", "2"];
        let typed = [&["identify", text(&log), "--out", text(&out)], &SHORT[..], &other[..]].concat();
        refused(&typed, &[why, "name another folder with --out"]);
        assert_eq!(fs::read(&table).unwrap(), before);
    }
    fs::create_dir(&strangers).unwrap();
    fs::write(strangers.join("unit.json"), "{\"of\": \"somebody else\"}").unwrap();
    refused(
        &["identify", text(&log), "--unit", "SN043", "--out", text(&strangers)],
        &["unit.json: is there already", "--force"],
    );
    assert_eq!(fs::read_to_string(strangers.join("unit.json")).unwrap(), "{\"of\": \"somebody else\"}");
    refused(&["identify", text(&log), "--unit", "=1+1", "--out", text(&strangers)], &["`=1+1` is no unit's name"]);
    refused(&["identify", text(&log), "--if-changed", "--out", text(&out)], &["--unit"]);
}

#[test]
fn collect_says_what_failed_is_missing_or_broken_and_hides_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = folder.path().join("fleet");
    for (unit, name) in [("SN001", "sin10"), ("SN002", "tr10")] {
        identify(&fleet, unit, &write(folder.path(), &rig(name))).assert().success();
    }
    let csv = folder.path().join("fleet.csv");
    let (code, said) = collect(&[text(&fleet), "--csv", text(&csv)]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("2 of 2 identified;") && !said.contains("Without a table"), "{said}");

    identify(&fleet, "SN003", &folder.path().join("none.csv")).assert().code(2);
    for (unit, file) in [("SN004", "{\"piezo_unit\": 1, \"un"), ("SN005", "{\"piezo_unit\": 9}"), ("SN006", "[]")] {
        fs::create_dir(fleet.join(unit)).unwrap();
        fs::write(fleet.join(unit).join("unit.json"), file).unwrap();
    }
    fs::create_dir(fleet.join("SN007")).unwrap();
    let missing = fleet.join("SN008");
    let (code, said) = collect(&[text(&fleet), text(&missing), "--csv", text(&csv)]);
    assert_eq!(code, 1);
    for part in [
        "2 of 8 identified, 1 failed, 2 missing, 3 unreadable;",
        "- SN003 (failed): ",
        "none.csv: no such file",
        "SN004/unit.json: is no unit.json (EOF while parsing",
        "SN005/unit.json: is a unit.json of version 9, and this program reads version 1",
        "SN006/unit.json: is no unit.json (",
        "- SN007 (missing): ",
        "- SN008 (missing): ",
        "has no unit.json: identify it with `piezo identify LOG --unit NAME --out FOLDER`",
    ] {
        assert!(said.contains(part), "{part:?} is missing in {said}");
    }
    let formats = fs::read_to_string(root().join("book/src/formats.md")).unwrap();
    let (_, chapter) = formats.split_once("**`piezo collect --csv FILE`**").unwrap();
    let (columns, _) = chapter.split_once("**board.toml**").unwrap();
    for column in csv::Reader::from_path(&csv).unwrap().headers().unwrap() {
        assert!(columns.contains(&format!("`{column}`")), "the chapter does not say what {column} is");
    }
    let rows: Vec<Vec<String>> = csv::Reader::from_path(&csv)
        .unwrap()
        .records()
        .map(|row| row.unwrap().iter().map(str::to_owned).collect())
        .collect();
    let states: Vec<_> = rows.iter().map(|row| (row[0].as_str(), row[2].as_str())).collect();
    assert_eq!(states[..3], [("SN001", "identified"), ("SN002", "identified"), ("SN003", "failed")]);
    assert_eq!(states[6..], [("SN007", "missing"), ("SN008", "missing")]);
    let all = piezo().args(["collect", "--json"]).arg(&fleet).assert().code(1).get_output().stdout.clone();
    let all: Value = serde_json::from_slice(&all).unwrap();
    assert_eq!(all["units"][0]["held_out_mae_um"], unit_file(&fleet, "SN001")["held_out"]["mae_um"]);
    assert_eq!(rows[0][4].parse::<f64>().unwrap(), number(&all, "/units/0/held_out_mae_um"));

    let log = folder.path().join("sin10.csv");
    refused(&["collect", text(&fleet), "--csv", text(&log)], &["sin10.csv: is there already", "--force"]);
    refused(&["collect", text(&fleet), "--csv", text(folder.path())], &["is a folder, --csv names a file"]);
    refused(&["collect", text(&fleet), "--csv", text(&fleet.join("SN001/unit.json"))], &["unit.json: is a unit's"]);
}

#[test]
fn collect_names_what_is_unlike_the_fleet_and_what_is_too_much_alike() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = folder.path().join("fleet");
    identify(&fleet, "SN001", &write(folder.path(), &rig("sin10"))).assert().success();
    let found = unit_file(&fleet, "SN001");
    // Siblings of it: errors some per cent apart, logs of their own.
    let sibling = |unit: &str, times: f64, inputs: &str| {
        let mut of = found.clone();
        (of["unit"], of["asked"]["inputs"]) = (json!(unit), json!(inputs));
        of["held_out"]["mae_percent"] = json!(times * number(&found, "/held_out/mae_percent"));
        fs::create_dir(fleet.join(unit)).unwrap();
        fs::write(fleet.join(unit).join("unit.json"), of.to_string()).unwrap();
    };
    for (n, times) in [(2, 1.02), (3, 0.97), (4, 1.05), (5, 0.99)] {
        sibling(&format!("SN00{n}"), times, &n.to_string());
    }
    let (code, said) = collect(&[text(&fleet)]);
    assert_eq!(code, 0);
    assert!(!said.contains("Far from the rest") && !said.contains("Alike"), "{said}");
    sibling("SN006", 4.0, "6");
    sibling("SN007", 1.01, "5");
    let (code, said) = collect(&[text(&fleet)]);
    assert_eq!(code, 0);
    assert!(said.contains("Far from the rest of the fleet:\n- SN006: held-out error "), "{said}");
    assert!(said.contains("\n- SN005 and SN007 were learnt from the same logs"), "{said}");
}

/// The shell of the chapter, as it stands there: each block that begins with `#!`.
#[cfg(unix)]
fn scripts() -> Vec<String> {
    let chapter = fs::read_to_string(root().join("book/src/fleet.md")).unwrap();
    let blocks = chapter.split("\n\n").filter(|block| block.starts_with("    #!"));
    blocks.map(|block| block.lines().map(|line| line.trim_start().to_owned() + "\n").collect()).collect()
}

/// What a task of a job array does, without the scheduler: its number is all that it is told.
#[cfg(unix)]
#[test]
fn the_chapter_s_scripts_identify_the_unit_of_their_task() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let [unit, array] = &scripts()[..] else { panic!("two scripts stand in the chapter") };
    // The logs of a test need less of a search than one's own.
    let short = unit.replace("--if-changed", &format!("--if-changed {}", SHORT.join(" ")));
    fs::write(at("unit.sh"), short).unwrap();
    fs::write(at("fleet.sh"), array).unwrap();
    fs::write(at("units.txt"), "SN001\nSN002\nSN003\n").unwrap();
    fs::create_dir(at("logs")).unwrap();
    for (unit, name) in [("SN001", "sin10"), ("SN003", "tr10")] {
        fs::rename(write(folder.path(), &rig(name)), at("logs").join(format!("{unit}.csv"))).unwrap();
    }
    let program = PathBuf::from(env!("CARGO_BIN_EXE_piezo"));
    let path = format!("{}:/usr/bin:/bin", program.parent().unwrap().display());
    let task = |number: &str| {
        let mut bash = std::process::Command::new("bash");
        bash.current_dir(folder.path()).arg("fleet.sh").env("PATH", &path).env("SLURM_CPUS_PER_TASK", "1");
        bash.env("SLURM_ARRAY_TASK_ID", number).output().unwrap().status.code()
    };
    assert_eq!(["1", "2", "3"].map(task), [Some(0), Some(2), Some(0)]);
    let fleet = at("fleet");
    let states = ["SN001", "SN002", "SN003"].map(|unit| unit_file(&fleet, unit)["status"].clone());
    assert_eq!(states, ["identified", "failed", "identified"].map(Value::from));
}
