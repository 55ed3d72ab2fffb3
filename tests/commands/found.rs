//! What is found in a log before it is learnt from, and the folder of a session in place of logs.

use super::logs::{rig, write};
use super::{MEASURED, json, piezo, refused, root, text};
use recordings::log::{Log, ReadOptions, read};
use std::fs;

const SHORTEST: [&str; 8] = ["--generations", "5", "--rounds", "1", "--devices", "0", "--model", "voigt"];

/// What a command says, to either end, whether it succeeds or not.
fn said(arguments: &[&str]) -> String {
    let output = piezo().args(arguments).output().unwrap();
    String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
}

#[test]
fn a_last_line_cut_in_mid_number_is_found_and_repair_says_how_much_it_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("cut.csv");
    let whole = fs::read_to_string(root().join(MEASURED)).unwrap();
    let (lines, last) = whole.trim_end().rsplit_once('\n').unwrap();
    let (before, _) = last.rsplit_once(',').unwrap();
    fs::write(&log, format!("{lines}\n{before},-1")).unwrap();
    let rows = read(&log, &ReadOptions::default()).unwrap().voltage.len();
    let looked = said(&["look", text(&log)]);
    let place = format!("row {rows}: --repair");
    assert!(looked.contains("where the log begins or ends") && looked.contains(&place), "{looked}");
    let whole = root().join(MEASURED);
    let sound = said(&["look", text(&whole)]);
    assert!(!sound.contains("flaw") && !sound.contains("doubtful"), "{sound}");

    let out = folder.path().join("out");
    let identify = ["identify", text(&log), "--json", "--out", text(&out)];
    let found = json(piezo().args(identify).args(SHORTEST));
    let spike = |doubt: &serde_json::Value| doubt["worst"]["kind"] == "spike";
    assert!(found["doubts"].as_array().unwrap().iter().any(spike), "{}", found["doubts"]);
    let repaired = json(piezo().args(identify).args(SHORTEST).arg("--repair"));
    let sentence = format!("Of cut, 1 of {rows} samples were left out (--repair).");
    assert!(repaired["verdict"].as_array().unwrap().iter().any(|said| *said == *sentence), "{}", repaired["verdict"]);
    let compare = ["compare", text(&log), "--models", "voigt", "--budget", "10"];
    assert!(!said(&compare).contains("samples were left out"));
    let repaired = said(&[&compare[..], &["--repair"]].concat());
    assert!(repaired.contains(&format!("\nLeft out: {sentence}\n")), "{repaired}");
}

/// Of a log whose second half swings twice as far as its first, and whose last reading is none.
#[test]
fn what_is_held_out_in_stretches_is_said_and_kept_and_repair_counts_both_parts() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let once = rig("sin10");
    let ladder =
        |values: &[f64]| [values.to_vec(), values.iter().map(|value| 2.0 * value).collect::<Vec<_>>()].concat();
    let mut displacement = ladder(once.displacement.as_deref().unwrap());
    displacement.last_mut().into_iter().for_each(|last| *last += 50.0);
    let ladder =
        Log { name: "cut".to_owned(), voltage: ladder(&once.voltage), displacement: Some(displacement), ..once };
    let log = write(folder.path(), &ladder);
    for (as_judged, role) in [(&["--as-judged"][..], "held-out"), (&[], "judged-then-learnt")] {
        let identify = ["identify", text(&log), "--repair", "--json", "--out", text(&out)];
        let found = json(piezo().args(identify).args(SHORTEST).args(as_judged));
        let verdict = found["verdict"].as_array().unwrap();
        let says = |sentence: &str| verdict.iter().any(|said| said.as_str().unwrap().contains(sentence));
        assert!(says("What was held out is up to 16 stretches of each log, and not its end"), "{verdict:?}");
        assert!(says("Of cut, 1 of ") && says(" samples were left out (--repair)."), "{verdict:?}");
        let table = fs::read_to_string(out.join("table.toml")).unwrap();
        assert!(table.contains(&format!("role = \"{role}\"")) && table.contains("\nstretches = 16\n"), "{table}");
        let validated = said(&["validate", text(&out.join("table.toml")), text(&log)]);
        assert!(validated.contains("the table was trained on all that is scored"), "{validated}");
    }
}

#[test]
fn every_log_is_looked_at_though_one_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let (missing, page) = (folder.path().join("missing.csv"), folder.path().join("page.html"));
    let logs = ["look", text(&missing), MEASURED, "--out", text(&page)];
    let output = piezo().args(logs).output().unwrap();
    let (said, why) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(said.contains("8027 rows") && !said.contains("\nNext"), "{said}");
    assert!(why.contains("missing.csv: no such file") && why.contains("1 of the 2 logs could not be read"), "{why}");
    assert_eq!((output.status.code(), page.exists()), (Some(2), false));
    // A name that is no text is none that a panic may be made of.
    #[cfg(unix)]
    {
        let odd: &std::ffi::OsStr = std::os::unix::ffi::OsStrExt::from_bytes(b"odd\xff.csv");
        piezo().arg("look").args([odd, MEASURED.as_ref()]).assert().code(2);
        piezo().args(["look", "--json"]).args([odd, MEASURED.as_ref()]).assert().code(2);
    }
    let output = piezo().args(["look", "--json", text(&missing), MEASURED]).output().unwrap();
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found[0]["survey"].is_null() && found[0]["refusal"].as_str().unwrap().contains("no such file"), "{found}");
    assert_eq!((&found[1]["survey"]["rows"], output.status.code()), (&8027.into(), Some(2)));
}

/// The unit was asked for first, which is right, and nothing that could be pasted left the spike out.
#[test]
fn a_spike_is_the_first_doubt_and_the_next_line_leaves_it_out() {
    let folder = tempfile::tempdir().unwrap();
    let clean = read(&root().join(MEASURED), &ReadOptions::default()).unwrap();
    let mut displacement = clean.displacement.clone().unwrap();
    displacement[2_000] = 9_000.0;
    let log = write(folder.path(), &Log { displacement: Some(displacement), ..clean });
    let out = folder.path().join("out");
    let looked = said(&["look", text(&log)]);
    assert!(looked.trim_end().ends_with(" --repair") && !looked.contains("is the unit right"), "{looked}");
    let identify = [&["identify", text(&log), "--out", text(&out)], &SHORTEST[..]].concat();
    let spiky = said(&identify);
    assert!(
        spiky.contains("When not to trust it:\n- in picma-p885-1hz the displacement leaps away and back"),
        "{spiky}"
    );
    assert!(!spiky.contains("is the unit right") && !spiky.contains("piezo install"), "{spiky}");
    let pasted = spiky.trim_end().rsplit_once('\n').unwrap().1;
    assert_eq!(pasted, format!("    piezo {} --repair", identify.join(" ")));
    let repaired = said(&[&identify[..], &["--repair"]].concat());
    assert!(repaired.contains("was left out (--repair)") && repaired.contains("piezo install"), "{repaired}");
}

/// A sensor that ends at half of the stroke: nothing is left out of such a log, and what could be pasted had said
/// so once more.
#[test]
fn a_log_of_which_most_is_no_measurement_is_to_be_recorded_again() {
    let folder = tempfile::tempdir().unwrap();
    let clean = read(&root().join(MEASURED), &ReadOptions::default()).unwrap();
    let displacement = clean.displacement.clone().unwrap();
    let (low, high) = displacement.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &y| (l.min(y), h.max(y)));
    let ends = displacement.iter().map(|y| y.min(low + 0.3 * (high - low))).collect();
    let log = write(folder.path(), &Log { displacement: Some(ends), ..clean });
    let out = folder.path().join("out");
    let identify = [&["identify", text(&log), "--out", text(&out)], &SHORTEST[..]].concat();
    assert!(said(&identify).trim_end().ends_with(" --repair"));
    let repaired = said(&[&identify[..], &["--repair"]].concat());
    assert!(repaired.contains("more than half of the log is no measurement: nothing was left out"), "{repaired}");
    assert!(repaired.contains("\nNext: record it again without") && !repaired.contains("--repair"), "{repaired}");
    assert!(!repaired.contains("piezo install"), "{repaired}");
}

#[test]
fn rows_that_are_seconds_apart_are_doubted_before_anything_is_learnt() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("slow.csv");
    let row = |row: u32| format!("{},{},{}\n", 5 * row, row % 40, f64::from(row % 40) * 0.1);
    fs::write(&log, format!("time_s,voltage_V,displacement_um\n{}", (0..200).map(row).collect::<String>())).unwrap();
    let out = folder.path().join("out");
    let identify = ["identify", text(&log), "--out", text(&out), "--tick-us", "1000000"];
    for said in [said(&["look", text(&log)]), said(&[&identify[..], &SHORTEST].concat())] {
        assert!(said.contains("its rows are 5 s apart") && said.contains("--columns time=<COLUMN>:<UNIT>"), "{said}");
    }
}

#[test]
fn the_folder_of_a_session_stands_for_its_logs() {
    let folder = tempfile::tempdir().unwrap();
    let [session, out] = ["p885", "out"].map(|name| folder.path().join(name));
    fs::create_dir(&session).unwrap();
    for (name, of) in [("01-loops", "sin10"), ("held-out", "tr10")] {
        write(&session, &Log { name: name.to_owned(), ..rig(of) });
    }
    refused(&["identify", text(&session), "--out", text(&out)], &["is a directory: name one log file in it"]);
    let logs = [("01-loops", false), ("held-out", true)]
        .map(|(name, held_out)| format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {held_out}\n"));
    fs::write(session.join("session.toml"), format!("complete = true\nseed = 1\n{}", logs.concat())).unwrap();
    let roles = |arguments: &[&str]| {
        let identify = ["identify", text(&session), "--json", "--out", text(&out)];
        let found = json(piezo().args(identify).args(SHORTEST).args(arguments));
        let logs = found["logs"].as_array().unwrap().clone();
        logs.iter().map(|log| format!("{} {}", log["file"], log["role"])).collect::<Vec<_>>()
    };
    assert_eq!(roles(&[]), [r#""01-loops.csv" "training""#, r#""held-out.csv" "held-out""#]);
    assert_eq!(roles(&["--hold-out", "0"]), [r#""01-loops.csv" "training""#]);
    // Its own tick, unless one is typed, be it the usual one.
    let session_file = |tick: &str| {
        fs::write(session.join("session.toml"), format!("complete = true\nseed = 1\n{tick}{}", logs.concat())).unwrap();
    };
    let tick = |arguments: &[&str]| {
        let identify = ["identify", text(&session), "--json", "--out", text(&out)];
        json(piezo().args(identify).args(SHORTEST).args(arguments))["recipe"]["tick_us"].clone()
    };
    session_file("tick_us = 250\n");
    assert_eq!([tick(&[]), tick(&["--tick-us", "500"])], [250, 500]);
    session_file("");
    // One that ended before its time is learnt from as far as it goes, and not silently.
    let identify = [&["identify", text(&session), "--out", text(&out)], &SHORTEST[..]].concat();
    assert!(!said(&identify).contains("before its time"));
    fs::write(session.join("session.toml"), format!("complete = false\nseed = 1\nplanned = 8\n{}", logs[0])).unwrap();
    let found = said(&identify);
    assert!(
        found.contains("p885: the session ended before its time: 1 of 8 logs are there, none to prove with"),
        "{found}"
    );
    let table = fs::read_to_string(out.join("table.toml")).unwrap();
    assert!(table.contains("1 of 8 logs are there") && table.contains("identify again once it is whole"), "{table}");
}

/// Time stamps that an identification takes or refuses: what look says of them, and whether it proposes to learn from
/// them, as they are or with what helps.
#[test]
fn look_says_of_time_stamps_what_identify_does() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("log.csv"), folder.path().join("out"));
    let of = |time: &dyn Fn(u32) -> String| {
        let row = |row: u32| {
            let volts = 50.0 - 50.0 * (f64::from(row) * 0.02).cos();
            format!("{},{volts:.4},{:.5}\n", time(row), 0.1 * volts + 1e-3 * f64::from(row % 7))
        };
        let rows: String = (0..1_500).map(row).collect();
        fs::write(&log, format!("time_s,voltage_V,displacement_um\n{rows}")).unwrap();
        let identify = piezo().args(["identify", text(&log), "--out", text(&out)]).args(SHORTEST).output().unwrap();
        (said(&["look", text(&log)]), identify.status.success(), String::from_utf8(identify.stderr).unwrap())
    };
    let even = |row: u32| f64::from(row) * 5e-4;
    for (what, time) in [
        ("even", &(|row| format!("{:.4}", even(row))) as &dyn Fn(u32) -> String),
        ("rounded to twice the period", &|row| format!("{:.3}", even(row))),
        ("of a little jitter", &|row| format!("{:.7}", even(row) + 2e-6 * (f64::from(row) * 1.7).sin())),
    ] {
        let (looked, taken, said) = of(time);
        assert!(taken && looked.contains("Next:\n    piezo identify"), "{what}: {looked}\n{said}");
        assert!(!looked.contains("gap") && !looked.contains("not learnable"), "{what}: {looked}");
    }
    for (what, time, remedy) in [
        (
            "jitter",
            &(|row| format!("{:.7}", even(row) + 2e-5 * (f64::from(row) * 1.7).sin())) as &dyn Fn(u32) -> String,
            true,
        ),
        ("backwards", &|row| format!("{:.4}", if row == 700 { 0.2 } else { even(row) }), false),
        ("a gap", &|row| format!("{:.4}", even(if row < 700 { row } else { row + 40 })), false),
    ] {
        let (looked, taken, said) = of(time);
        let proposed = looked.split_once("Next:").map(|(_, next)| next.trim_end().ends_with(" --repair"));
        assert!(!taken && proposed == (what == "a gap").then_some(true), "{what}: {looked}\n{said}");
        let why = said.lines().find_map(|line| line.split_once("log.csv:")).expect("a place in the log").1;
        assert!(looked.contains(why), "{what}: {looked}, but identify says: {why}");
        assert_eq!(looked.contains("--fs '<HZ>'"), remedy, "{what}: {looked}");
        assert_eq!(said.contains("--fs '<HZ>'"), remedy, "{what}: {said}");
    }
}

/// What identify refuses before it searches is not proposed by look, which says it in the same words.
#[test]
fn look_proposes_no_log_that_identify_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let write = |name: &str, hz: f64, course: &dyn Fn(u32) -> (f64, f64)| {
        let log = folder.path().join(name).with_extension("csv");
        let row = |row: u32| {
            let (volts, micrometres) = course(row);
            format!("{:.6},{volts:.4},{micrometres:.5}\n", f64::from(row) / hz)
        };
        let rows: String = (0..3_000).map(row).collect();
        fs::write(&log, format!("time_s,voltage_V,displacement_um\n{rows}")).unwrap();
        log
    };
    let sine = |row: u32| 50.0 - 50.0 * (f64::from(row) * 0.02).cos();
    let noise = |row: u32| 1e-3 * f64::from(row * 7_919 % 1_009) / 1_009.0;
    let sound = write("sound", 2_000.0, &|row| (sine(row), 0.1 * sine(row) + noise(row)));
    for (name, course, line) in [
        (
            "rising",
            &(|row| (f64::from(row) * 0.03, f64::from(row) * 3e-3 + noise(row))) as &dyn Fn(u32) -> _,
            "not alone",
        ),
        ("still", &|row| (sine(row), noise(row)), "not alone"),
        ("falling", &|row| (sine(row), -0.1 * sine(row) + noise(row)), "not as it is"),
    ] {
        let log = write(name, 2_000.0, course);
        let refused = said(&[&["identify", text(&log), "--out", text(&out)], &SHORTEST[..]].concat());
        // Below it stands a line of identify's own.
        let why = refused.trim().rsplit("piezo: ").next().unwrap().lines().next().unwrap();
        let looked = said(&["look", text(&log)]);
        assert!(looked.contains(&format!("  {line:<13} {why}")) && !looked.contains("\nNext"), "{looked}\n{refused}");
        let found = json(piezo().args(["look", text(&log), "--json"]));
        assert!(found[0]["refusal"].as_str().is_some_and(|refusal| refusal.starts_with(why)), "{found}");
        // Beside a log that shows something, one that does not is no hindrance.
        let both = [text(&sound), text(&log)];
        let taken =
            piezo().args(["identify"]).args(both).args(["--out", text(&out), "--force"]).args(SHORTEST).output();
        let looked = said(&[&["look"], &both[..]].concat());
        assert_eq!(looked.contains("\nNext"), taken.unwrap().status.success(), "{name}: {looked}");
    }
}

/// Of what the usual tick alone is in the way of, look does not say that it cannot be learnt from.
#[test]
fn look_says_that_another_tick_helps() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let looked = |rows: u32, hz: f64| {
        let row = |row: u32| {
            let volts = 50.0 - 50.0 * (f64::from(row) * 0.02).cos();
            format!("{:.9},{volts:.4},{:.5}\n", f64::from(row) / hz, 0.1 * volts)
        };
        let rows: String = (0..rows).map(row).collect();
        fs::write(&log, format!("time_s,voltage_V,displacement_um\n{rows}")).unwrap();
        said(&["look", text(&log)])
    };
    // No multiple of the tick's rate is no hindrance.
    let taken = looked(3_000, 3_000.0);
    assert!(taken.contains("Next:") && !taken.contains("not as it is"), "{taken}");
    let slow = looked(12_000, 0.2);
    assert!(slow.contains("\n  not as it is  ") && slow.contains("use a longer --tick-us"), "{slow}");
    assert!(!slow.contains("not learnable") && !slow.contains("\nNext"), "{slow}");
}
