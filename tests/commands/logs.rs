//! What a log may be like: a sensor with any offset, late, falling or of something else, a glitch, a
//! voltage that rests.

use super::{MEASURED, json, number, piezo, refused, root, text};
use recordings::log::{Displacement, Log, ReadOptions, csv_beside, read};
use recordings::rig::{EXCITATIONS, Rig};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use table_files::TableFile;

/// A search that is as short as each test can do with.
const SHORT: [&str; 6] = ["--generations", "15", "--rounds", "3", "--devices", "0"];
const SHORTEST: [&str; 6] = ["--generations", "5", "--rounds", "1", "--devices", "0"];

fn measured() -> Log {
    read(&root().join(MEASURED), &ReadOptions::default()).unwrap()
}

/// Half a second of one of the rig's logs.
pub fn rig(name: &str) -> Log {
    let excitation = EXCITATIONS.into_iter().find(|excitation| excitation.name == name).expect("one of the six logs");
    Rig { duration: 0.5, ..Rig::default() }.log(excitation)
}

/// The log with other displacements, each from its row and what it was.
fn displaced(log: &Log, change: impl Fn(usize, f64) -> f64) -> Log {
    let rows = log.displacement.as_ref().expect("these logs have one").iter().enumerate();
    Log { displacement: Some(rows.map(|(row, &y)| change(row, y)).collect()), ..log.clone() }
}

/// Writes a log into a folder under its name.
pub fn write(folder: &Path, log: &Log) -> PathBuf {
    let path = folder.join(&log.name).with_extension("csv");
    csv_beside(&path, log.sample_period, &log.voltage, log.displacement.as_ref().unwrap(), Displacement::Measured)
        .unwrap()
        .commit()
        .unwrap();
    path
}

/// What `identify` makes of some logs.
fn identify(logs: &[Log], arguments: &[&[&str]]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let paths = logs.iter().map(|log| write(folder.path(), log));
    let out = folder.path().join("out");
    json(piezo().arg("identify").args(paths).args(arguments.concat()).args(["--json", "--out"]).arg(out))
}

fn doubts(result: &Value) -> Vec<&str> {
    result["doubts"].as_array().unwrap().iter().filter_map(|doubt| doubt["doubt"].as_str()).collect()
}

#[test]
fn the_offset_of_the_sensor_does_not_matter() {
    let unipolar = Log { voltage: rig("sin10").voltage.iter().map(|v| 1.8 + 0.09 * v).collect(), ..rig("sin10") };
    for log in [measured(), unipolar] {
        let run = |offset: f64| {
            let result = identify(&[displaced(&log, |_, y| y + offset)], &[&SHORT, &["--model", "voigt"]]);
            let mae = number(&result, "/candidates/0/held_out/mae_um");
            (mae, number(&result, "/recipe/displacement_zero_um") - offset)
        };
        let (mae, zero) = run(0.0);
        for offset in [96.0, -30.0, 500.0] {
            let (there, zero_there) = run(offset);
            assert!((there - mae).abs() <= 1e-6_f64.max(1e-3 * mae), "{}: {offset:+} µm: {there}, not {mae}", log.name);
            assert!((zero_there - zero).abs() < 1e-6, "{}: {offset:+} µm: {zero_there}, not {zero}", log.name);
        }
    }
}

#[test]
fn one_glitch_of_the_voltage_is_no_second_amplitude_or_frequency() {
    // High and rising, at the top, low and falling, low and rising; all in the training half.
    for row in [1020, 1050, 1130, 1170] {
        let mut log = measured();
        log.voltage[row] -= 0.12;
        let result = identify(&[log], &[&SHORTEST, &["--model", "voigt"]]);
        for doubt in ["single-amplitude", "single-frequency"] {
            assert!(doubts(&result).contains(&doubt), "row {row}: {doubt} is missing in {:?}", doubts(&result));
        }
    }
}

#[test]
fn a_displacement_that_falls_while_the_voltage_rises_is_refused_and_a_negative_scale_mends_it() {
    let falling = displaced(&measured(), |_, y| -y);
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (write(folder.path(), &falling), folder.path().join("out"));
    refused(&["identify", text(&log), "--out", text(&out)], &[&falling.name, "falls", "--displacement-scale -1"]);
    assert!(!out.exists(), "nothing may be written");
    identify(&[falling], &[&SHORTEST, &["--model", "voigt", "--displacement-scale", "-1"]]);
}

/// What was seen of such logs before: no word, an error ten times as large, or a percentage that looks ten
/// times as good.
#[test]
fn what_is_no_measurement_is_found_and_repair_gives_the_error_of_a_log_without_it() {
    let fit = |log: &Log, repair: &[&str]| {
        let result = identify(std::slice::from_ref(log), &[&SHORT, &["--model", "voigt"], repair]);
        let stroke = number(&result, "/candidates/0/held_out/stroke_um");
        let flaws: Vec<String> = result["doubts"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|doubt| doubt["doubt"] == "flawed")
            .map(|doubt| {
                assert_eq!(doubt["left_out"], !repair.is_empty());
                doubt["worst"]["kind"].as_str().unwrap().to_owned()
            })
            .collect();
        let first = result["doubts"][0]["doubt"] == "flawed";
        (number(&result, "/candidates/0/held_out/mae_um"), stroke, flaws, first)
    };
    let clean = measured();
    let (mae, stroke, flaws, _) = fit(&clean, &[]);
    assert_eq!(flaws, Vec::<String>::new(), "the measured log is sound");
    let spike = displaced(&clean, |row, y| if row == 2_000 { 9_000.0 } else { y });
    let spikes = displaced(&clean, |row, y| if row % 400 == 17 { 900.0 } else { y });
    let frozen = displaced(&clean, |row, y| if (3_000..3_600).contains(&row) { -80.0 } else { y });
    let (low, high) = clean.displacement.iter().flatten().fold((0.0, -1e9), |(l, h), &y| (y.min(l), y.max(h)));
    let beyond = displaced(&clean, |_, y| y.min(low + 0.8 * (high - low)));
    let most = clean.voltage.iter().copied().fold(0.0, f64::max);
    let cut = Log { voltage: clean.voltage.iter().map(|v| v.min(0.6 * most)).collect(), ..clean.clone() };
    let misread = |row: usize, v: f64| if [2_000, 2_001, 6_000].contains(&row) { v - 300.0 } else { v };
    let misread = clean.voltage.iter().enumerate().map(|(row, &v)| misread(row, v)).collect();
    let misread = Log { voltage: misread, ..clean.clone() };
    let stepped = displaced(&clean, |row, y| if row < 2_500 { y } else { y + 5.0 });
    for (log, kind) in [
        (spike, "spike"),
        (spikes, "spike"),
        (frozen, "frozen"),
        (beyond, "frozen"),
        (cut, "clipped"),
        (misread, "voltage-spike"),
        (stepped, "step"),
    ] {
        let (spoilt, its, flaws, first) = fit(&log, &[]);
        assert_eq!((flaws, first), (vec![kind.to_owned()], true));
        assert!((its / stroke - 1.0).abs() < 0.25, "{kind}, as it is: {its} of {stroke} µm");
        let (repaired, theirs, flaws, _) = fit(&log, &["--repair"]);
        assert_eq!(flaws, [kind]);
        assert!((theirs / stroke - 1.0).abs() < 0.25, "{kind}: {theirs} of {stroke} µm");
        assert!(repaired < 2.0 * mae, "{kind}: {repaired} instead of {mae} µm (unrepaired {spoilt})");
    }
}

/// The log begins with a jump from 0 V: a spike that hid it had cost 0.5 µm of error and 0.8 µm of interval.
#[test]
fn a_spike_that_is_left_out_costs_neither_error_nor_interval() {
    let clean = measured().split(0.75).0;
    let found = |log: &Log| {
        let options = ["--model", "generalised-prandtl-ishlinskii", "--devices", "6", "--repair"];
        let result = identify(std::slice::from_ref(log), &[&options]);
        ["/candidates/0/held_out/mae_um", "/interval/misfit_um"].map(|pointer| number(&result, pointer))
    };
    let [mae_um, half_um] = found(&clean);
    let rows = clean.voltage.len();
    for (row, leap_um) in [(rows * 2 / 5, 50.0), (rows / 4, 9_000.0), (rows * 3 / 4, 200.0), (rows * 7 / 8, 9_000.0)] {
        let spiky = displaced(&clean, |at, y| if at == row { y + leap_um } else { y });
        let [mae, half] = found(&spiky);
        let of = format!("{leap_um} µm in row {row} of {rows}");
        assert!((mae / mae_um - 1.0).abs() < 0.05, "{of}: {mae} instead of {mae_um} µm");
        // Which readings are left moves one device or another.
        assert!((half / half_um - 1.0).abs() < 0.3, "{of}: ± {half} instead of {half_um} µm");
    }
}

#[test]
fn what_has_no_number_or_was_lost_is_left_out_by_the_line_that_its_refusal_prints() {
    let folder = tempfile::tempdir().unwrap();
    let clean = Rig { duration: 0.5, voltage_noise: 0.02, ..Rig::default() }.log(EXCITATIONS[1]);
    let path = write(folder.path(), &clean);
    let mut lines: Vec<String> = fs::read_to_string(&path).unwrap().lines().map(str::to_owned).collect();
    let learn = |out: &str| {
        let mut command = piezo();
        command
            .arg("identify")
            .arg(&path)
            .args(["--model", "voigt", "--out", text(&folder.path().join(out))])
            .args(SHORTEST);
        command
    };
    learn("clean").assert().success();
    // An oscilloscope's overload, and a field that is empty.
    for (line, column, value) in [(200, 2, "\u{221e}"), (201, 2, "\u{221e}"), (400, 1, "")] {
        let mut cells: Vec<&str> = lines[line].split(',').collect();
        cells[column] = value;
        lines[line] = cells.join(",");
    }
    // The way on that the refusal prints, and that `look` prints before; what was learnt on it.
    let repaired = |lines: &[String], out: &str, refused: &str| {
        fs::write(&path, lines.join("\n")).unwrap();
        let looked = piezo().arg("look").arg(&path).assert().success().get_output().stdout.clone();
        let looked = String::from_utf8(looked).unwrap();
        assert!(looked.contains(refused) && looked.trim_end().ends_with(" --repair"), "{looked}");
        let output = learn(out).assert().code(2).get_output().stderr.clone();
        let refusal = String::from_utf8(output).unwrap();
        assert!(refusal.contains(refused), "{refusal}");
        let pasted = refusal.trim_end().lines().last().unwrap().trim();
        assert!(pasted.ends_with(" --repair"), "{refusal}");
        let words = pasted.split(' ').skip(1).map(|word| word.trim_matches('\''));
        let learnt = piezo().args(words).assert().success().get_output().stdout.clone();
        String::from_utf8(learnt).unwrap()
    };
    let infinite = ":201: the displacement is not a number (\"\u{221e}\"): correct it, or leave";
    let learnt = repaired(&lines, "holes", infinite);
    let told = "has no number for the voltage or the displacement, or no row, 2 times, the longest time from 0.";
    assert!(learnt.contains(told), "{learnt}");
    lines.drain(600..603);
    let learnt = repaired(&lines, "lost", infinite);
    assert!(learnt.contains(&told.replace("2 times", "3 times")), "{learnt}");
    lines.retain(|line| !line.contains('\u{221e}') && !line.contains(",,"));
    repaired(&lines, "gaps", ":201: 2 samples are missing after t = 0.0198 s (gaps in all: 3): record again, ");
    let mae = |out: &str| {
        let table = fs::read_to_string(folder.path().join(out).join("table.toml")).unwrap();
        let figure = table.lines().find(|line| line.starts_with("validation_mae_um")).unwrap();
        figure.split(' ').nth(2).unwrap().parse::<f64>().unwrap()
    };
    for out in ["holes", "lost", "gaps"] {
        assert!((mae(out) / mae("clean") - 1.0).abs() < 0.05, "{out}: {} {}", mae(out), mae("clean"));
    }
}

#[test]
fn the_noise_is_kept_in_the_table_and_what_is_no_measurement_stands_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let noisy = Rig { duration: 0.5, voltage_noise: 0.05, ..Rig::default() }.log(EXCITATIONS[1]);
    let spiky = displaced(&noisy, |row, y| if row == 1_000 { y + 20.0 } else { y });
    let (path, out) = (write(folder.path(), &spiky), folder.path().join("out"));
    piezo().args(["identify", text(&path), "--model", "voigt", "--out", text(&out)]).args(SHORTEST).assert().success();
    let (file, table) = TableFile::load(&out.join("table.toml")).unwrap();
    let noise = file.noise.unwrap();
    assert!(
        (noise.voltage_v / 0.05 - 1.0).abs() < 0.15 && (noise.displacement_um / 0.007 - 1.0).abs() < 0.2,
        "{noise:?}"
    );
    let told = noise.told(table.deadband_v);
    let times = f64::from(table.deadband_v) / noise.voltage_v;
    assert!((7.5..8.5).contains(&times) && told.contains("times the voltage's"), "{told}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let marked = page.contains("<h2>What is no measurement</h2>") && page.contains(r#"class="flaw""#);
    assert!(marked && page.contains(&told.replace('\'', "&#39;")));
    let again = folder.path().join("again");
    let emitted = piezo().args(["emit", text(&out.join("table.toml")), "--out", text(&again)]).assert().success();
    assert!(String::from_utf8_lossy(&emitted.get_output().stdout).contains(&told));
    assert_eq!(TableFile::load(&again.join("table.toml")).unwrap().0.noise, Some(noise));
}

#[test]
fn samples_that_were_lost_without_a_gap_are_suspected_and_no_repair_is_promised() {
    let folder = tempfile::tempdir().unwrap();
    let whole = measured();
    // At 1 Hz and 200 Hz: a quarter of a period.
    let rest = |values: &[f64]| [&values[..3_010], &values[3_060..]].concat();
    let lost = Log { voltage: rest(&whole.voltage), displacement: whole.displacement.as_deref().map(rest), ..whole };
    let path = write(folder.path(), &lost);
    let output = piezo().args(["look", text(&path)]).assert().success().get_output().clone();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains(
            "samples may be missing here, unless the drive leapt or recordings were joined, row 3010: nothing"
        ),
        "{said}"
    );
    let result = identify(&[lost], &[&SHORTEST, &["--model", "voigt", "--repair"]]);
    let found = result["doubts"].as_array().unwrap().iter().find(|doubt| doubt["worst"]["kind"] == "missing");
    assert_eq!(found.map(|doubt| &doubt["left_out"]), Some(&Value::from(false)), "{}", result["doubts"]);
}

#[test]
fn validate_says_of_a_log_what_in_it_is_no_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let clean = measured();
    let spoilt = displaced(&clean, |row, y| match row {
        2_000 => y + 40.0,
        5_000 => y + 30.0,
        _ => y,
    });
    let of = |log: &Log, arguments: &[&str]| {
        let path = write(folder.path(), log);
        let table = "tests/data/table/models/generalised-prandtl-ishlinskii.toml";
        let output =
            piezo().args(["validate", table, text(&path)]).args(arguments).assert().success().get_output().clone();
        String::from_utf8(output.stdout).unwrap()
    };
    let said = of(&spoilt, &[]);
    assert!(
        said.contains("leaps away and back 2 times, the gravest by 4")
            && said.contains("at 10.0000 s: the errors above take it for a measurement"),
        "{said}"
    );
    let stroke = |log: &Log| number(&serde_json::from_str(&of(log, &["--json"])).unwrap(), "/logs/0/sil/stroke_um");
    assert_eq!(stroke(&spoilt), stroke(&clean), "a spike makes no error smaller beside it");
    let said = of(&spoilt, &["--from", "11"]);
    assert!(said.contains("leaps away and back by 3"), "what is not scored spoils nothing: {said}");
    let found: Value = serde_json::from_str(&of(&spoilt, &["--json"])).unwrap();
    assert_eq!(
        (&found["logs"][0]["flaws"][0]["worst"]["kind"], &found["logs"][0]["flaws"][0]["count"]),
        (&"spike".into(), &2.into())
    );
    let said = of(&clean, &[]);
    assert!(!said.contains("for a measurement"), "{said}");
}

#[test]
fn a_displacement_that_has_nothing_to_do_with_the_voltage_is_a_poor_fit() {
    let log = measured();
    let unrelated = displaced(&log, |row, _| 20.0 * (TAU * 0.37 * row as f64 * log.sample_period).sin());
    for (log, poor) in [(unrelated, true), (log, false)] {
        let result = identify(&[log], &[&SHORT, &["--model", "voigt"]]);
        assert_eq!(doubts(&result).contains(&"poor-fit"), poor, "{:?}", doubts(&result));
    }
}

#[test]
fn a_voltage_that_rests_where_it_should_teach_or_test_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (half, end) = (measured().voltage.len() / 2, measured().voltage.len());
    let rests = |name: &str, rests: std::ops::Range<usize>| {
        let mut log = Log { name: name.to_owned(), ..measured() };
        // As a converter reads it: a step to and fro.
        log.voltage[rests.clone()].iter_mut().enumerate().for_each(|(row, v)| *v = 1.8 + 0.001 * (row % 2) as f64);
        log.displacement.as_mut().unwrap()[rests].fill(-95.0);
        write(folder.path(), &log)
    };
    let (last, first) = (rests("rests-last", half..end), rests("rests-first", 0..half));
    // What moves at the end alone is held out in stretches; fitted to is nothing that moves where its end is cut off.
    for (path, cut) in [(last, &[][..]), (first, &["--hold-out", "0", "--skip-end", "20"])] {
        let identify = ["identify", path.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let message = refused(&[&identify, cut, &SHORTEST[..]].concat(), &["rests-", "does not move"]);
        assert!(message.contains("--hold-out") || message.contains("--skip-"), "no remedy: {message}");
    }
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "nothing may be written beside the two logs: {left:?}");
}

#[test]
fn a_late_sensor_is_found_out() {
    let logs = || ["sin10", "tr10", "sin100"].map(rig);
    let learnt = |logs: &[Log], most_ms: &str| {
        let automatic = ["--delay", "auto", "--max-delay", most_ms, "--model", "voigt", "--repair"];
        identify(logs, &[&SHORT, &automatic])
    };
    let delay = |logs: &[Log]| number(&learnt(logs, "3"), "/recipe/delay_ticks");
    // 20 samples at 10 kHz are 4 ticks at 2 kHz.
    let late = logs().map(|log| {
        let recorded = log.displacement.clone().unwrap();
        displaced(&log, |row, _| recorded[row.saturating_sub(20)])
    });
    assert!((3.0..=5.0).contains(&delay(&late)), "{}", delay(&late));
    let later_than_may_be = learnt(&late, "1");
    assert_eq!(number(&later_than_may_be, "/recipe/delay_ticks"), 2.0);
    assert!(doubts(&later_than_may_be).contains(&"delay-at-bound"), "{:?}", doubts(&later_than_may_be));
    // A lag that is said is one beside the sensor's delay.
    let automatic =
        ["--delay", "auto", "--max-delay", "3", "--lag", "0.5", "--model", "generalised-prandtl-ishlinskii"];
    let beside =
        number(&identify(&late, &[&["--evaluations", "4", "--devices", "0"], &automatic]), "/recipe/delay_ticks");
    assert!((3.0..=5.0).contains(&beside), "{beside} beside a lag");
    // One beyond what the model looks for at once: 9 ms, 18 ticks.
    let latest = logs().map(|log| {
        let recorded = log.displacement.clone().unwrap();
        displaced(&log, |row, _| recorded[row.saturating_sub(90)])
    });
    let found = number(&learnt(&latest, "12"), "/recipe/delay_ticks");
    assert!((17.0..=19.0).contains(&found), "{found}");
    // A slow sine does not tell a delay, of 5 ms, from a lag.
    let slow = measured();
    let recorded = slow.displacement.clone().unwrap();
    let single = learnt(&[displaced(&slow, |row, _| recorded[row.saturating_sub(1)])], "10");
    assert_eq!(number(&single, "/recipe/delay_ticks"), 0.0);
    assert!(doubts(&single).contains(&"delay-undetermined"), "{:?}", doubts(&single));
    let spiky = late.map(|log| displaced(&log, |row, y| if row == 3_000 { 9_000.0 } else { y }));
    assert!((3.0..=5.0).contains(&delay(&spiky)), "{} with a spike in each", delay(&spiky));
    assert!(delay(&logs()) <= 1.0, "{}", delay(&logs()));
}
