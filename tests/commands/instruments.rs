//! Files as instruments and programs write them: each is read as it is, or with what the tool itself prints, and equals
//! the truth to its own resolution. The table of `book/src/files.md` says what is typed.

use super::{data, piezo, root};
use recordings::log::{Log, ReadOptions, read};
use std::fs;

/// The scale of the sensor whose volts are in some of the files, where the tool leaves a place for it.
const PLACE: (&str, &str) = ("<N>", "10");
/// Files whose displacement is a sensor's volts, which some cannot say themselves.
const IN_VOLTS: [&str; 6] =
    ["keysight.csv", "picoscope.csv", "rigol.csv", "saleae.csv", "sensor_in_volts.csv", "tektronix.csv"];
/// Largest differences from the truth, V and µm, where a file has fewer digits than the truth.
const COARSE: [(&str, f64, f64); 5] = [
    ("saleae.csv", 5.1e-6, 1.1e-5),
    ("keysight.csv", 51e-6, 5.1e-3),
    ("rigol.csv", 5.1e-6, 5.1e-4),
    ("tektronix.csv", 5.1e-6, 5.1e-4),
    ("sensor_in_volts.csv", 5.1e-6, 5.1e-5),
];
const FINE: (f64, f64) = (5.1e-6, 5.1e-6);

/// The files, sorted by name, without the truth and what is no recording.
fn files() -> Vec<String> {
    let entries = fs::read_dir(data("instruments")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name != "README.md" && name != "truth.csv").collect();
    names.sort_unstable();
    assert!(names.len() >= 21, "{names:?}");
    names
}

/// What is typed after the file's name: nothing, or the options of a line that the tool prints.
fn typed(name: &str) -> Vec<String> {
    let path = format!("tests/data/instruments/{name}");
    let output = piezo().args(["look", &path]).output().unwrap();
    if output.status.success() {
        return Vec::new();
    }
    let told = String::from_utf8(output.stderr).unwrap();
    let command = format!("    piezo look {path} ");
    let lines: Vec<&str> = told.lines().filter_map(|line| line.strip_prefix(&command)).collect();
    let wanted = |line: &&&str| line.contains(PLACE.0) == IN_VOLTS.contains(&name);
    let line = lines.iter().find(wanted).unwrap_or_else(|| panic!("{name}: nothing to paste in {told}"));
    let options: Vec<String> =
        line.replace(PLACE.0, PLACE.1).split(' ').map(|word| word.trim_matches('\'').to_owned()).collect();
    piezo().args(["look", &path]).args(&options).assert().success();
    assert_eq!(options.len(), 2, "{name}: one option is enough: {line}");
    options
}

fn read_with(name: &str, typed: &[String]) -> Log {
    let mut options = ReadOptions::default();
    match typed {
        [] => {}
        [option, value] if option == "--columns" => options.columns = Some(value.parse().unwrap()),
        [option, value] if option == "--sensor" => options.sensor = Some(value.parse().unwrap()),
        other => panic!("{name}: {other:?}"),
    }
    read(&data("instruments").join(name), &options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_file_is_the_same_recording() {
    let truth = read_with("truth.csv", &[]);
    let expected = truth.displacement.unwrap();
    assert_eq!((truth.voltage.len(), truth.sample_period), (2000, 0.005));
    let mut table = String::new();
    for name in files() {
        let typed = typed(&name);
        let log = read_with(&name, &typed);
        assert_eq!(log.sample_period, 0.005, "{name}");
        let (volts, um) = COARSE.iter().find(|(coarse, ..)| *coarse == name).map_or(FINE, |(_, v, y)| (*v, *y));
        near(&name, &log.voltage, &truth.voltage, volts);
        near(&name, &log.displacement.unwrap(), &expected, um);
        let shown = if typed.is_empty() { "nothing".to_owned() } else { format!("`{}`", typed.join(" ")) };
        table += &format!("| `{name}` | {shown} |\n");
    }
    let document = fs::read_to_string(root().join("book/src/files.md")).unwrap();
    assert!(document.contains(&table), "book/src/files.md must have this table:\n{table}");
}

fn near(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= tolerance, "{name}: off by {worst}");
}

#[test]
fn a_rate_that_the_file_contradicts_is_refused() {
    let gcs = "tests/data/instruments/pi_gcs.dat";
    let columns = ["--columns", "voltage=1:V,displacement=2:um"];
    let says = ["pi_gcs.dat:6:", "2000 Hz disagrees", "SAMPLE_TIME", "0.005 s", "leave --fs out"];
    super::refused(&[&["look", gcs][..], &columns, &["--fs", "2000"]].concat(), &says);
    piezo().args(["look", gcs]).args(columns).args(["--fs", "200"]).assert().success();
}

#[test]
fn look_draws_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let (svg, page) = (folder.path().join("log.svg"), folder.path().join("logs.html"));
    let log = "tests/data/picma-p885-1hz.csv";
    let told = piezo().args(["look", log, "--out", super::text(&svg)]).assert().success().get_output().stdout.clone();
    let told = String::from_utf8(told).unwrap();
    for part in
        ["200 Hz, by the time column; 8027 rows", "column 2 \"voltage_V\", in V", "reversals", "half cycles", "noise"]
    {
        assert!(told.contains(part), "{part}: {told}");
    }
    let drawn = fs::read_to_string(&svg).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.contains("8027 rows") && drawn.matches("<polyline").count() >= 3);
    super::refused(&["look", log, "tests/data/picma-p885-session2.csv", "--out", super::text(&svg)], &["html"]);
    piezo().args(["look", log, "tests/data/picma-p885-session2.csv", "--out", super::text(&page)]).assert().success();
    assert_eq!(fs::read_to_string(&page).unwrap().matches("<svg").count(), 2);
    let survey = super::json(piezo().args(["look", log, "--json"]));
    assert_eq!(super::number(&survey, "/0/survey/clock/hz"), 200.0);
    assert!(super::number(&survey, "/0/survey/swings/reversals") > 70.0);
}

#[test]
fn look_hides_no_refusal_and_its_remedy_reads_the_refused_log_alone() {
    let folder = tempfile::tempdir().unwrap();
    let log = |name: &str, header: &str, row: &dyn Fn(f64) -> String| {
        let path = folder.path().join(name);
        let rows: String = (0..40).map(|k| row(f64::from(k)) + "\n").collect();
        fs::write(&path, header.to_owned() + &rows).unwrap();
        super::text(&path).to_owned()
    };
    let row = |k: f64| format!("{},{},{}", k / 100.0, k % 7.0, k % 5.0);
    let named = log("named.csv", "time_s,displacement_um,voltage_V\n", &row);
    let plain = log("plain.csv", "", &row);
    let output = piezo().args(["look", &named, &plain]).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    let line = told.lines().find(|line| line.contains("--columns")).unwrap();
    assert!(line.contains("plain.csv") && !line.contains("named.csv"), "{told}");
    let swapped = "time=1:s,voltage=2:V,displacement=3:um";
    super::refused(
        &["look", &named, "--columns", swapped],
        &["named.csv:1:", "displacement_um", "um is no unit of it"],
    );
    let grouped = |k: f64| format!("{};{};\"1,{}.5\"", k / 100.0, k % 7.0, 100.0 + k);
    let grouped = log("grouped.csv", "time_s;voltage_V;displacement (nm)\n", &grouped);
    super::refused(&["look", &grouped], &["displacement (nm)", "1,100.5", "separators between the thousands"]);
    let target = log("target.csv", "time_s,voltage_V,target position (um)\n", &row);
    let seen = piezo().args(["look", &target]).assert().success().get_output().stdout.clone();
    let seen = String::from_utf8(seen).unwrap();
    assert!(
        seen.contains("no column says that it holds the displacement") && seen.contains("target position"),
        "{seen}"
    );
    let found = super::json(piezo().args(["look", &target, &named, "--json"]));
    let refusal = found[0]["refusal"].as_str().unwrap_or_default();
    assert!(refusal.contains("no column says that it holds the displacement"), "{found}");
    // What repeats every seven rows does not go with what repeats every five.
    let refusal = found[1]["refusal"].as_str().unwrap_or_default();
    assert!(refusal.contains("named: the displacement is noise"), "{found}");
    let still = log("still.csv", "time_s,voltage_V\n", &|k| format!("5,{}", k % 7.0));
    let seen = piezo().args(["look", &still]).output().unwrap();
    let seen = String::from_utf8([seen.stdout, seen.stderr].concat()).unwrap();
    assert!(!seen.contains("inf"), "{seen}");
}
