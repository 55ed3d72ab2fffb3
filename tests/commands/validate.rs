//! What `validate` says of a part of a log, of what the estimator is told, and the estimates that it writes: on the
//! measured sessions, against errors that are taken anew from the written rows.

use super::{MEASURED, json, number, piezo, refused, text};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Learnt from the first half of the first session.
const TABLE: &str = "tests/data/table/models/generalised-prandtl-ishlinskii.toml";
const OTHER_DAY: &str = "tests/data/picma-p885-session2.csv";

/// A written row: time, voltage, sensor, estimate, its interval, status, whether it counts, log.
struct Row {
    time: f64,
    voltage: f64,
    sensor: f64,
    estimate: f64,
    half_width: Option<f64>,
    status: String,
    scored: bool,
    log: String,
}

fn validate(logs: &[&str], arguments: &[&str], out: &Path) -> (Value, Vec<Row>) {
    let report = json(piezo().arg("validate").arg(TABLE).args(logs).args(arguments).args(["--json", "--out"]).arg(out));
    let written = fs::read_to_string(out).unwrap();
    let mut lines = written.lines();
    assert_eq!(lines.next(), Some("time_s,voltage_V,displacement_um,estimate_um,half_width_um,status,scored,log"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let at = |cell: usize| cells[cell].parse::<f64>().unwrap();
        Row {
            time: at(0),
            voltage: at(1),
            sensor: at(2),
            estimate: at(3),
            half_width: cells[4].parse().ok(),
            status: cells[5].to_owned(),
            scored: cells[6] == "1",
            log: cells[7].to_owned(),
        }
    };
    (report, lines.map(row).collect())
}

/// Mean absolute error and RMS without the mean of what counts, µm.
fn errors(rows: &[Row]) -> (f64, f64) {
    let errors: Vec<f64> = rows.iter().filter(|row| row.scored).map(|row| row.estimate - row.sensor).collect();
    let mean = |of: &dyn Fn(f64) -> f64| errors.iter().map(|&e| of(e)).sum::<f64>() / errors.len() as f64;
    let offset = mean(&|e| e);
    (mean(&f64::abs), mean(&|e| (e - offset) * (e - offset)).sqrt())
}

fn out(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("estimates.csv")
}

/// The sensor of a log that shows every displacement a row later, 5 ms.
#[test]
fn a_sensor_that_is_later_than_in_the_training_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let (header, rows): (Vec<String>, Vec<Vec<String>>) = {
        let read = fs::read_to_string(super::root().join(OTHER_DAY)).unwrap();
        let (header, rows): (Vec<&str>, Vec<&str>) = read.lines().partition(|line| !line.starts_with(char::is_numeric));
        let cells = |row: &str| row.split(',').map(str::to_owned).collect();
        (header.iter().map(|line| (*line).to_owned()).collect(), rows.into_iter().map(cells).collect())
    };
    let later = rows.windows(2).map(|pair| format!("{},{},{}", pair[1][0], pair[1][1], pair[0][2]));
    let log = folder.path().join("later.csv");
    fs::write(&log, header.into_iter().chain(later).collect::<Vec<_>>().join("\n")).unwrap();
    let mae_um = |log: &str, options: &[&str]| {
        let report =
            json(piezo().arg("validate").arg(TABLE).arg(log).args(options).args(["--told", "offset", "--json"]));
        number(&report, "/judged/mae_um")
    };
    let (sound, stated) = (mae_um(OTHER_DAY, &[]), mae_um(text(&log), &["--delay", "5"]));
    assert!((stated - sound).abs() < 0.002, "{stated}, {sound} µm");
    let unstated = mae_um(text(&log), &[]);
    assert!(unstated > 1.4 * sound, "{unstated}, {sound} µm");
    refused(&["validate", TABLE, text(&log), "--delay", "1000"], &["--delay", "less than a second"]);
}

#[test]
fn the_written_estimates_give_the_printed_errors_in_the_units_of_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let (report, rows) = validate(&[OTHER_DAY], &[], &out(&folder));
    let log = fs::read_to_string(super::root().join(OTHER_DAY)).unwrap();
    let recorded: Vec<Vec<f64>> = log
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    // Of the first instant there is no estimate yet.
    assert_eq!(rows.len(), recorded.len() - 1);
    for (row, recorded) in rows.iter().zip(&recorded[1..]) {
        assert!((row.time - recorded[0]).abs() < 1e-6 && (row.voltage - recorded[1]).abs() < 2e-6, "{}", row.time);
        assert!((row.sensor - recorded[2]).abs() < 2e-6 && row.log == "picma-p885-session2");
    }
    let (mae, rms) = errors(&rows);
    assert!((mae - number(&report, "/all/sil/mae_um")).abs() < 1e-5, "{mae}");
    assert!((rms - number(&report, "/all/sil/rmse_without_offset_um")).abs() < 1e-5, "{rms}");
    assert!(rows[0].status.contains("NOT_SETTLED") && !rows.last().unwrap().status.contains("NOT_SETTLED"));
}

#[test]
fn each_of_the_four_ways_of_being_told_is_what_is_written_and_judged() {
    let folder = tempfile::tempdir().unwrap();
    let mae = |told: &str| {
        let (report, rows) = validate(&[OTHER_DAY], &["--told", told], &out(&folder));
        let key = told.replace('-', "_");
        let printed = number(&report, &format!("/logs/0/told/{key}/mae_um"));
        assert!((errors(&rows).0 - printed).abs() < 1e-5, "{told}: {printed}");
        assert_eq!(number(&report, "/judged/mae_um"), printed, "{told}");
        printed
    };
    let [nothing, _, cycle, offset] = ["nothing", "first-reading", "one-cycle", "offset"].map(mae);
    // Between the sessions the sensor's zero moves by about 1 µm, which one cycle beside it tells.
    assert!(nothing > 0.6 && cycle < 0.6 * nothing && offset < cycle, "{nothing} {cycle} {offset}");
}

#[test]
fn a_part_is_scored_with_the_log_before_it_as_its_past() {
    let folder = tempfile::tempdir().unwrap();
    let (report, rows) = validate(&[MEASURED], &["--from", "20", "--to", "30"], &out(&folder));
    let scored: Vec<f64> = rows.iter().filter(|row| row.scored).map(|row| row.time).collect();
    assert_eq!((scored[0], scored[scored.len() - 1], scored.len()), (20.0, 29.995, 2000));
    assert_eq!(number(&report, "/logs/0/scored_s/0"), 20.0);
    // It runs on from the beginning: what is estimated does not depend on what is scored.
    let (_, all) = validate(&[MEASURED], &[], &out(&folder));
    assert!(rows.iter().zip(&all).all(|(a, b)| a.estimate == b.estimate));
    let (mae, _) = errors(&rows);
    assert!((mae - number(&report, "/all/sil/mae_um")).abs() < 1e-5);
}

#[test]
fn a_zero_in_the_rest_holds_from_then_on() {
    let folder = tempfile::tempdir().unwrap();
    let (report, rows) = validate(&[OTHER_DAY], &["--zero-at", "22"], &out(&folder));
    let (_, plain) = validate(&[OTHER_DAY], &["--told", "nothing"], &out(&folder));
    // 50 ms are ten readings.
    let at = rows.iter().position(|row| row.time == 22.0).unwrap();
    let before: f64 = plain[at - 9..=at].iter().map(|row| row.estimate - row.sensor).sum::<f64>() / 10.0;
    assert!((before - number(&report, "/logs/0/zeroed_um")).abs() < 1e-5, "{before}");
    for (index, (row, plain)) in rows.iter().zip(&plain).enumerate() {
        let less = if index < at { 0.0 } else { before };
        assert!((plain.estimate - row.estimate - less).abs() < 1e-5, "{}", row.time);
        assert_eq!(row.scored, index > at);
    }
    let whole = json(piezo().args(["validate", TABLE, OTHER_DAY, "--from", "22.005", "--json"]));
    let (zeroed, not) = (number(&report, "/judged/mae_um"), number(&whole, "/all/sil/mae_um"));
    assert!(zeroed < 0.5 * not, "{zeroed} {not}");
    assert_eq!(zeroed, number(&report, "/logs/0/told/nothing/mae_um"), "before the zero a device is told nothing");
    // The interval is relative to the zero, and holds on this other day.
    let beside = rows.iter().filter(|row| row.scored).map(|row| (row.estimate - row.sensor, row.half_width.unwrap()));
    let (count, held) = beside.fold((0, 0), |(count, held), (e, half)| (count + 1, held + u32::from(e.abs() <= half)));
    let percent = 100.0 * f64::from(held) / f64::from(count);
    assert!((percent - number(&report, "/logs/0/interval/covered_percent")).abs() < 1e-9, "{percent}");
    assert!(percent >= 90.0, "{percent}");
    assert!(number(&report, "/logs/0/interval/half_width_um") < 2.0, "{report}");
}

#[test]
fn several_logs_stand_in_one_file_each_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let (report, rows) = validate(&[MEASURED, OTHER_DAY], &["--told", "nothing"], &out(&folder));
    for (index, name) in ["picma-p885-1hz", "picma-p885-session2"].into_iter().enumerate() {
        let own: Vec<Row> = validate(&[[MEASURED, OTHER_DAY][index]], &["--told", "nothing"], &out(&folder)).1;
        assert_eq!(rows.iter().filter(|row| row.log == name).count(), own.len());
        assert_eq!(report["logs"][index]["log"], name);
    }
    let people = piezo().args(["validate", TABLE, MEASURED, OTHER_DAY]).assert().success().get_output().stdout.clone();
    let people = String::from_utf8(people).unwrap();
    let mut printed = people.lines();
    for line in ["picma-p885-1hz", "  f32, one cycle", "picma-p885-session2", "  f32, cold", "all", "  f32, no offset"]
    {
        assert!(
            printed.any(|printed| printed.starts_with(line)),
            "{line} is missing, or in its wrong place, in {people}"
        );
    }
    let zeroed = piezo().args(["validate", TABLE, OTHER_DAY, "--zero-at", "24"]).assert().success();
    let zeroed = String::from_utf8(zeroed.get_output().stdout.clone()).unwrap();
    assert!(zeroed.contains("\n  f32, cold ") && zeroed.contains("told nothing, since the zero"), "{zeroed}");
    assert!(!zeroed.contains("(SIL) ") && !zeroed.contains("told the sensor's first reading"), "{zeroed}");
}

#[test]
fn what_cannot_be_scored_or_written_is_refused_by_name_and_value() {
    let folder = tempfile::tempdir().unwrap();
    let path = out(&folder);
    let refuse = |arguments: &[&str], says: &[&str]| {
        let all = [&["validate", TABLE, MEASURED][..], arguments, &["--out", text(&path)]].concat();
        refused(&all, says);
        assert!(!path.exists(), "nothing may be written");
    };
    refuse(&["--from", "41"], &["picma-p885-1hz.csv", "41 s", "40.130", "--from"]);
    refuse(&["--to", "99"], &["picma-p885-1hz.csv", "99 s", "--to"]);
    refuse(&["--zero-at", "50"], &["picma-p885-1hz.csv", "50 s", "--zero-at"]);
    refuse(&["--from", "20", "--to", "10"], &["10 s", "20 s", "--to"]);
    refuse(&["--to", "10", "--zero-at", "12"], &["10 s", "12 s", "--zero-at"]);
    refuse(&["--from", "40.1"], &["only 7", "16"]);
    refuse(&["--told", "one-cycle", "--to", "1.2"], &["no full cycle", "--told"]);
    refuse(&["--from", "-1"], &["--from"]);
    refuse(&["--told", "everything"], &["--told", "first-reading"]);
    for input in [MEASURED, TABLE] {
        refused(&["validate", TABLE, MEASURED, "--out", input], &["would overwrite", input]);
    }
    refused(&["validate", TABLE, MEASURED, "--out", text(folder.path())], &["--out names a file"]);
}

/// What is said to people of the measured other day, each row of which is changed.
fn said_of(
    folder: &tempfile::TempDir,
    header: &str,
    changed: impl Fn([f64; 3]) -> [f64; 3],
    options: &[&str],
) -> String {
    let log = fs::read_to_string(super::root().join(OTHER_DAY)).unwrap();
    let rows = log.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [time, voltage, displacement] = changed([cells[0], cells[1], cells[2]]);
        format!("{time:.4},{voltage:.6},{displacement:.6}\n")
    });
    let path = folder.path().join("day2.csv");
    fs::write(&path, format!("{header}\n{}", rows.collect::<String>())).unwrap();
    let output = piezo().args(["validate", TABLE]).arg(&path).args(options).assert().get_output().clone();
    String::from_utf8(output.stdout).unwrap()
}

const COLUMNS: &str = "time_s,voltage_V,displacement_um";

#[test]
fn a_log_of_another_actuator_unit_or_column_is_suspected_and_says_by_what() {
    let folder = tempfile::tempdir().unwrap();
    let suspects = |said: &str, evidence: &[&str]| {
        for part in [&["day2: is it the actuator that the table was learnt from, and are unit"], evidence].concat() {
            assert!(said.contains(part), "{part:?} is missing in {said}");
        }
    };
    let larger = said_of(&folder, COLUMNS, |[t, v, y]| [t, v, 2.2 * y], &[]);
    suspects(&larger, &["goes over 85.0", "the error is 12.", "the ± holds the sensor 2"]);
    let swapped = said_of(&folder, COLUMNS, |[t, v, y]| [t, y, v], &[]);
    suspects(&swapped, &["the voltage is beyond what the table was learnt on 100 % of the time"]);
    suspects(&said_of(&folder, "time_s,voltage_mV,displacement_um", |row| row, &[]), &["the sensor goes over 38."]);
    let inverted = said_of(&folder, COLUMNS, |[t, v, y]| [t, v, -y], &["--rezero"]);
    suspects(
        &inverted,
        &["the sensor falls where the table says that it rises", "without any constant the error is 44."],
    );
    let turned = said_of(&folder, COLUMNS, |[t, v, y]| [t, v, -y], &["--rezero", "--displacement-scale", "-1"]);
    assert!(!turned.contains("day2: is it the actuator"), "{turned}");
}

#[test]
fn a_sensor_that_was_zeroed_anew_is_told_from_an_estimate_that_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let said = |options: &[&str]| said_of(&folder, COLUMNS, |[t, v, y]| [t, v, y + 10.0], options);
    let failed = said(&["--max-percent", "2"]);
    let constant = failed.find("day2: a constant -8.").unwrap_or_else(|| panic!("no constant in {failed}"));
    assert!(
        failed[constant..].contains("FAILED") && failed.contains("`--told one-cycle` or `--zero-at <S>`"),
        "{failed}"
    );
    for told in [&["--told", "one-cycle"][..], &["--zero-at", "22"], &["--rezero"]] {
        assert!(!said(told).contains("is most of the error"), "{told:?}");
    }
}

/// An actuator that goes some per cent farther than it did, as a warmer or an unloaded one.
#[test]
fn a_pm_that_holds_the_sensor_too_rarely_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let said = |gain: f64| said_of(&folder, COLUMNS, |[t, v, y]| [t, v, gain * y], &["--told", "one-cycle"]);
    let asked = said(1.06);
    assert!(
        asked.contains("day2: the ±, told one cycle, holds the sensor 7") && asked.contains("learn from this log, too"),
        "{asked}"
    );
    assert!(asked.contains("the voltage moves from the first sample on"), "{asked}");
    assert!(!said(1.0).contains("learn from this log, too"), "as it was measured");
}

/// Where the error is small, what holds it rarely is too narrow; nobody looks for another unit.
#[test]
fn a_pm_that_holds_a_small_error_rarely_is_called_narrow() {
    let folder = tempfile::tempdir().unwrap();
    let table = fs::read_to_string(super::root().join(TABLE)).unwrap();
    let mut within = false;
    let narrow = table.lines().map(|line| {
        within = matches!(line, "memory_um = [" | "spread_um = [") || (within && line != "]");
        match line.split_once(" = ") {
            Some((name @ ("misfit_um" | "gain" | "drift_um" | "rate_ticks"), _)) => format!("{name} = 0.001\n"),
            None if within => "    0.0,\n".to_owned(),
            _ => format!("{line}\n"),
        }
    });
    let path = folder.path().join("narrow.toml");
    fs::write(&path, narrow.collect::<String>()).unwrap();
    let output =
        piezo().args(["validate", text(&path), OTHER_DAY, "--told", "one-cycle"]).assert().get_output().clone();
    let said = String::from_utf8(output.stdout).unwrap();
    let held = said.lines().find(|line| line.contains("the ±, told one cycle, holds the sensor")).unwrap_or(&said);
    assert!(held.contains("learn from this log, too") && !said.contains("is it the actuator"), "{said}");
    let percent = held.split("holds the sensor ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!(percent.parse::<f64>().unwrap() < 50.0, "{held}");
}

/// A sensor that gave no number and leapt, in 12 of 7,000 readings.
#[test]
fn what_is_no_measurement_is_left_out_of_the_errors_where_that_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let broken = |[t, v, y]: [f64; 3]| match t {
        _ if (20.0..20.029).contains(&t) => [t, v, f64::NAN],
        _ if (25.0..25.009).contains(&t) => [t, v, y + 500.0],
        _ => [t, v, y],
    };
    let of = |options: &[&str]| said_of(&folder, COLUMNS, broken, options);
    assert_eq!(of(&["--told", "one-cycle"]), "", "a number that is none is refused");
    let path = folder.path().join("day2.csv");
    refused(&["validate", TABLE, text(&path)], &["is not finite", "day2.csv --repair"]);
    let errors = |options: &[&str]| {
        let judged =
            json(piezo().args(["validate", TABLE, text(&path), "--told", "one-cycle", "--json"]).args(options));
        (number(&judged, "/judged/mae_um"), judged["logs"][0]["left_out"].as_u64())
    };
    let (repaired, left_out) = errors(&["--repair"]);
    assert!((8..20).contains(&left_out.unwrap()), "{left_out:?}");
    let said = of(&["--told", "one-cycle", "--repair"]);
    assert!(said.contains("measured instants are not scored (--repair)") && said.contains("leave it out"), "{said}");
    said_of(&folder, COLUMNS, |row| row, &[]);
    let (clean, none) = errors(&[]);
    assert!((repaired - clean).abs() < 0.02 * clean, "{repaired} µm, of what is sound {clean} µm");
    assert_eq!(none, None);
}

#[test]
fn the_measured_days_raise_no_suspicion_of_another_actuator() {
    for table in fs::read_dir(super::data("table/models")).unwrap() {
        let path = table.unwrap().path();
        let told = ["--told", "one-cycle"];
        let output = piezo().arg("validate").arg(&path).args([MEASURED, OTHER_DAY]).args(told).assert().success();
        let said = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        assert!(
            !said.contains("is it the actuator") && !said.contains("is most of the error"),
            "{}: {said}",
            path.display()
        );
    }
}

#[test]
fn a_status_bit_is_said_with_how_often_and_when_first() {
    let output = piezo().args(["validate", TABLE, OTHER_DAY]).assert().success();
    let said = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(said.contains("31.29 % of the time, first at 0.020 s, the voltage went as it never did"), "{said}");
}
