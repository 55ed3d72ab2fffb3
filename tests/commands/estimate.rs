//! `piezo estimate`: of a voltage alone, the very estimates that `validate` judges beside the sensor.

use super::{json, number, piezo, refused, root, text};
use std::fs;
use std::path::Path;

/// Learnt from the first half of the first session.
const TABLE: &str = "tests/data/table/models/generalised-prandtl-ishlinskii.toml";
const OTHER_DAY: &str = "tests/data/picma-p885-session2.csv";

/// The cells of the file under a heading, row by row.
fn column(path: &Path, name: &str) -> Vec<String> {
    let written = fs::read_to_string(path).unwrap();
    let mut lines = written.lines();
    let at = lines.next().unwrap().split(',').position(|heading| heading == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().to_owned()).collect()
}

/// Writes time and voltage of the log, the voltage by a monitor 1:20, in mV; the sensor's first reading, µm.
fn write_monitor(path: &Path) -> f64 {
    let log = fs::read_to_string(root().join(OTHER_DAY)).unwrap();
    let rows = log.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let mut first = None;
    let rows: String = rows
        .map(|row| {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            first.get_or_insert(cells[2]);
            format!("{},{}\n", cells[0], cells[1] * 1000.0 / 20.0)
        })
        .collect();
    fs::write(path, format!("time_s,monitor_mV\n{rows}")).unwrap();
    first.unwrap()
}

#[test]
fn a_voltage_alone_gives_what_is_validated_beside_a_sensor() {
    let folder = tempfile::tempdir().unwrap();
    let [monitor, judged, estimated] =
        ["monitor.csv", "judged.csv", "estimated.csv"].map(|name| folder.path().join(name));
    let first_um = write_monitor(&monitor);
    for (told, start) in [("nothing", None), ("first-reading", Some(format!("--start-at={first_um}")))] {
        let validate = ["validate", TABLE, OTHER_DAY, "--told", told, "--force", "--out", text(&judged)];
        piezo().args(validate).assert().success();
        let estimate =
            ["estimate", TABLE, text(&monitor), "--voltage-scale", "20", "--force", "--out", text(&estimated)];
        let report = json(piezo().args(estimate).args(&start).arg("--json"));
        let same = |name: &str, most: f64| {
            let (a, b) = (column(&judged, name), column(&estimated, name));
            assert_eq!(a.len(), b.len());
            assert_eq!(number(&report, "/logs/0/estimates"), b.len() as f64);
            for (a, b) in a.iter().zip(&b) {
                let near = a == b || (a.parse::<f64>().unwrap() - b.parse::<f64>().unwrap()).abs() <= most;
                assert!(near, "{told} {name}: {a} {b}");
            }
        };
        // Volts times 50 and by 20 are rounded otherwise than as they were.
        same("estimate_um", 2e-5);
        same("half_width_um", 2e-5);
        same("time_s", 0.0);
        let widths = column(&estimated, "half_width_um");
        assert!(widths.iter().all(|width| width.is_empty() == start.is_none()), "a \u{b1} since what is known");
    }
    assert_eq!(
        fs::read_to_string(&estimated).unwrap().lines().next(),
        Some("time_s,voltage_V,estimate_um,half_width_um,status,log")
    );
}

/// From the zero on, the rows are those of a validation that is zeroed there by a sensor that reads the same.
#[test]
fn a_zero_of_a_voltage_alone_is_that_of_a_validation() {
    let folder = tempfile::tempdir().unwrap();
    let [judged, estimated] = ["judged.csv", "estimated.csv"].map(|name| folder.path().join(name));
    let told = ["--told", "nothing", "--zero-at", "24", "--out", text(&judged)];
    piezo().args(["validate", TABLE, OTHER_DAY]).args(told).assert().success();
    let from_24_s = |name: &str, path: &Path| column(path, name)[4800..].to_vec();
    let [sensor, judged] = ["displacement_um", "estimate_um"].map(|name| from_24_s(name, &judged));
    let um = |cell: &String| cell.parse::<f64>().unwrap();
    let estimate = ["estimate", TABLE, OTHER_DAY, "--zero-at", "24:-92.5", "--out", text(&estimated)];
    piezo().args(estimate).assert().success();
    let alone = from_24_s("estimate_um", &estimated);
    // Each has its own constant: the one what it was told, the other what the sensor said.
    let apart = |at: usize| um(&alone[at]) - um(&judged[at]);
    let off = (1..alone.len()).map(|at| (apart(at) - apart(1)).abs()).fold(0.0, f64::max);
    assert!(alone.len() == sensor.len() && off < 1e-4, "{off} µm");
    let times = column(&estimated, "time_s");
    let at = times.iter().rposition(|time| um(time) < 24.0 + 1e-9).unwrap();
    assert!((um(&column(&estimated, "estimate_um")[at]) + 92.5).abs() < 1e-4, "it is what was told, there");
    let widths = column(&estimated, "half_width_um");
    assert!(widths[..4790].iter().all(String::is_empty) && widths[4810..].iter().all(|width| !width.is_empty()));
}

#[test]
fn what_is_said_names_the_start_and_where_it_is_not_to_be_believed() {
    let folder = tempfile::tempdir().unwrap();
    let (monitor, out) = (folder.path().join("monitor.csv"), folder.path().join("estimates.csv"));
    write_monitor(&monitor);
    let said = |more: &[&str]| {
        let estimate = ["estimate", TABLE, text(&monitor), "--voltage-scale", "20", "--out", text(&out)];
        String::from_utf8(piezo().args(estimate).args(more).assert().success().get_output().stdout.clone()).unwrap()
    };
    let cold = said(&[]);
    for part in
        ["6999 estimates from the voltage alone", "rested at the first voltage", "--start-at <UM>", "(NOT_SETTLED)"]
    {
        assert!(cold.contains(part), "{part:?} is missing in\n{cold}");
    }
    let cut = said(&["--skip-start", "0.5"]);
    assert!(cut.contains(" typed: the first 0.5 s; --skip-start 0 takes all.\n"), "{cut}");
    assert!(cut.contains("6899 estimates") && !cold.contains("Left out of each log"), "{cold}");
    // The same command again finds its own file.
    assert!(said(&["--start-at", "-92"]).contains("since the first sample, 95 % of the time"));
    let (told, in_nanometres) = (said(&["--zero-at", "24:-92"]), said(&["--zero-at", "24:-92000"]));
    let asked = "that is further off than the log moves in all: is it in µm";
    assert!(
        told.contains(" µm from what was estimated before, and from then on ± 0.") && !told.contains(asked),
        "{told}"
    );
    // Instants of which the double is above the decimal number are found as well.
    assert!(said(&["--zero-at", "2.8:-92000"]).contains(asked));
    assert!(in_nanometres.contains("-92000 µm at 24 s, -91") && in_nanometres.contains(asked), "{in_nanometres}");
    assert!(said(&["--zero-at", "0.005:-92"]).contains("is too soon after the start for a zero"));
    refused(&["estimate", TABLE, text(&monitor), "--out", text(&monitor)], &["monitor.csv"]);
    // Within the limits, and by no memory at that voltage.
    assert!(said(&["--start-at", "-68"]).contains("at the first sample the model is at -70.3"));
    assert!(!said(&["--start-at", "-92"]).contains("at the first sample the model is at"));
    let estimate = ["estimate", TABLE, text(&monitor), "--voltage-scale", "20", "--out", text(&out)];
    let of = |more: &[&str], parts: &[&str]| refused(&[&estimate[..], more].concat(), parts);
    of(&["--start-at", "0"], &["a start at 0 µm is none of this table's", " to -6"]);
    of(&["--zero-at", "99:-92"], &["the zero, 99 s, must lie after 0.000 s", "34.995 s"]);
    of(&["--zero-at", "24"], &["as 24:-91.5"]);
    let beyond =
        ["estimate", TABLE, text(&monitor), "--voltage-scale", "60", "--zero-at", "24:-92", "--out", text(&out)];
    refused(
        &beyond,
        &["no zero can be told at 24 s: the voltage is 0.09", "beyond the table's -0.003 … 0.063 V", "another time"],
    );
    of(&["--zero-at", "24:-92", "--start-at", "-92"], &["cannot be used with"]);
    // A validation says which verb takes a log without a sensor.
    refused(&["validate", TABLE, text(&monitor)], &["holds the displacement", "\n    piezo estimate '<TABLE>' "]);
    let scale = ["estimate", TABLE, text(&monitor), "--voltage-scale"];
    refused(&[&scale[..], &["1:20"]].concat(), &["for 1:20 it is 20"]);
    refused(&[&scale[..], &["2,5"]].concat(), &["a decimal point is a point"]);
}

#[test]
fn a_voltage_that_may_not_be_the_actuator_s_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let [monitor, estimated] = ["monitor.csv", "estimated.csv"].map(|name| folder.path().join(name));
    write_monitor(&monitor);
    for (scale, asked) in [("1", true), ("20", false), ("400", true)] {
        let estimate =
            ["estimate", TABLE, text(&monitor), "--voltage-scale", scale, "--force", "--out", text(&estimated)];
        let printed = piezo().args(estimate).assert().success().get_output().stdout.clone();
        let printed = String::from_utf8(printed).unwrap();
        assert_eq!(printed.contains("is it a monitor's"), asked, "{scale}: {printed}");
        let of = &json(piezo().args(estimate).arg("--json"))["logs"][0]["asked"];
        assert_eq!(of.as_str().is_some_and(|said| said.contains("is it a monitor's")), asked, "{scale}: {of}");
    }
}

#[test]
fn what_stands_in_the_sensor_s_column_spoils_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [log, estimated] = ["dead.csv", "estimated.csv"].map(|name| folder.path().join(name));
    let rows: String = (0..500).map(|k| format!("{:.4},{},nan\n", f64::from(k) * 5e-4, k % 100)).collect();
    fs::write(&log, format!("time_s,voltage_V,displacement_um\n{rows}")).unwrap();
    piezo().args(["estimate", TABLE, text(&log), "--out", text(&estimated)]).assert().success();
    assert_eq!(column(&estimated, "estimate_um").len(), 499);
}

/// Where the voltage is unknown there is no estimate; before it all is as if nothing were missing, and behind it, after
/// a swing, again.
#[test]
fn a_log_with_holes_is_estimated_where_it_has_a_voltage() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, holed, of_whole, of_holed] =
        ["whole.csv", "holed.csv", "of-whole.csv", "of-holed.csv"].map(|name| folder.path().join(name));
    write_monitor(&whole);
    let text_of_whole = fs::read_to_string(&whole).unwrap();
    let (missing, none) = (1000..1020, 2000..2003);
    let row = |(number, line): (usize, &str)| match number {
        number if missing.contains(&number) => None,
        number if none.contains(&number) => Some(format!("{},NaN\n", line.split(',').next().unwrap())),
        _ => Some(format!("{line}\n")),
    };
    fs::write(&holed, text_of_whole.lines().enumerate().filter_map(row).collect::<String>()).unwrap();
    let estimate = |log: &Path, out: &Path, more: &[&str]| {
        let arguments = ["estimate", TABLE, text(log), "--voltage-scale", "20", "--out", text(out), "--json"];
        json(piezo().args(arguments).args(more))
    };
    refused(
        &["estimate", TABLE, text(&holed), "--voltage-scale", "20", "--out", text(&of_holed)],
        &["the voltage is not finite (NaN)", "--repair"],
    );
    estimate(&whole, &of_whole, &[]);
    let report = estimate(&holed, &of_holed, &["--repair"]);
    assert_eq!(number(&report, "/logs/0/left_out"), 23.0);
    let rows = |path: &Path| -> Vec<(String, f64)> {
        let estimates = column(path, "estimate_um").into_iter().map(|cell| cell.parse().unwrap());
        column(path, "time_s").into_iter().zip(estimates).collect()
    };
    let (whole, holed) = (rows(&of_whole), rows(&of_holed));
    assert_eq!(whole.len(), holed.len() + 23);
    // The first line is the heading, and of the first sample there is no estimate.
    let kept =
        whole.iter().enumerate().filter(|(at, _)| ![&missing, &none].iter().any(|rows| rows.contains(&(at + 2))));
    for ((at, whole), holed) in kept.zip(&holed) {
        assert_eq!(whole.0, holed.0);
        let most = if at + 2 < missing.start { 0.0 } else { 0.2 };
        assert!((whole.1 - holed.1).abs() <= most, "{at}: {whole:?} {holed:?}");
    }
}
