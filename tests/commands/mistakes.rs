//! What a user can get wrong: a message that names it and a remedy, exit code 2, and nothing written.

use super::{MEASURED, data, piezo, refused, text};
use std::fs;

#[test]
fn unusable_logs_name_file_line_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let case = |name: &str, contents: &str, says: &[&str]| {
        let log = folder.path().join(name);
        fs::write(&log, contents).unwrap();
        refused(&["identify", text(&log), "--out", text(&out)], &[&[name], says].concat());
    };
    let rows = |bad: &str| {
        let good =
            |k: u32| format!("{},{},{}\n", f64::from(k) * 0.0005, f64::from(k % 40) - 20.0, f64::from(k % 40) / 4.0);
        let body: String = (0..100).map(|k| if k == 50 { bad.to_owned() } else { good(k) }).collect();
        format!("time_s,voltage_V,displacement_um\n{body}")
    };
    case("nan.csv", &rows("0.025,NaN,1\n"), &[":52", "NaN"]);
    case("word.csv", &rows("0.025,high,1\n"), &[":52", "high"]);
    case("gap.csv", &rows(""), &[":52"]);
    case("back.csv", &rows("0.001,1,1\n"), &[":52"]);
    case("short.csv", "time_s,voltage_V,displacement_um\n0,1,1\n0.0005,2,2\n", &["2"]);
    case(
        "unit.csv",
        &rows("0.025,1,1\n").replace("displacement_um", "displacement_furlong"),
        &["furlong", "displacement=3:<UNIT>"],
    );
    case("plain.dat", "1.0 2.0\n3.0 4.0\n", &["--columns", "--fs"]);
    refused(&["identify", "nowhere.csv", "--out", text(&out)], &["nowhere.csv"]);
    refused(&["identify", "tests/data", "--out", text(&out)], &["tests/data"]);
    assert!(!out.exists(), "nothing may be written");
}

#[test]
fn no_log_is_trained_on_and_held_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(folder.path());
    refused(&["identify", MEASURED, "--validate-on", MEASURED, "--out", out], &["same bytes"]);
    refused(&["identify", MEASURED, MEASURED, "--out", out], &["same bytes"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn tables_that_were_tampered_with_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.toml");
    let original = fs::read_to_string(data("table/table.toml")).unwrap();
    let case = |line: &str, replacement: &str, says: &[&str]| {
        let from = original.lines().find(|l| l.starts_with(line)).unwrap_or_else(|| panic!("no line {line}"));
        fs::write(&table, original.replacen(from, replacement, 1)).unwrap();
        refused(&["validate", text(&table), MEASURED], &[&["table.toml"], says].concat());
    };
    case("b_ohm", "b_ohm = -1.0", &["for line ", "`b_ohm = -1.0`: b_ohm must be positive and finite"]);
    case("b_ohm", "b_ohm = 1.0", &["not admissible"]);
    case("min = ", "min = 90.0", &["`[table.voltage_range_v]`: voltage_range_v must be ordered"]);
    case("alpha_um", "alpha_um = nan", &["alpha_um must be positive and finite"]);
    case("sample_period_us", "sample_period_us = 0", &["sample_period_us"]);
    case("[table.parameters", "[table.parameters.everett]", &["everett", "line"]);
    case("[table.parameters", "[table.parameters.preisach]", &["alpha_um", "line"]);
    case("g_um_per_s", "g_um_per_s = 1.0", &["without the voltage-extremum term"]);
    case("deadband_v", "deadband = 1.0", &["deadband", "line"]);
    case("shrink", "shrink = nan", &["search.shrink is not a finite number"]);
    case("to_s", "to_s = inf", &["logs.0.to_s is not a finite number"]);
    case("train_mae_um", "train_mae_um = nan", &["train_mae_um is not a finite number"]);
    fs::write(&table, "[table").unwrap();
    refused(&["emit", text(&table), "--face", "rust"], &["table.toml", "line 1"]);
    refused(&["emit", "nowhere.toml", "--face", "rust"], &["nowhere.toml", "no such file", "`identify`"]);
}

#[test]
fn what_stands_in_the_place_of_a_table_is_named() {
    let [rust, record, folder] = ["table/table.rs", "table/table.bin", "table"].map(data);
    refused(&["validate", MEASURED, text(&data("table/table.toml"))], &["is no table.toml", "logs after it"]);
    refused(&["validate", text(&rust), MEASURED], &["table.rs", "is no table.toml"]);
    let output = piezo().args(["push", MEASURED]).assert().code(2).get_output().stderr.clone();
    let said = String::from_utf8(output).unwrap();
    assert!(said.contains("is no table.toml") && !said.contains("logs after it"), "{said}");
    refused(&["validate", text(&record), MEASURED], &["table.bin", "is not text", "table.toml"]);
    refused(&["validate", text(folder.parent().unwrap()), MEASURED], &["is a directory", "table.toml"]);
    // A folder that has one stands for it, with the faces beside it.
    piezo().args(["validate", text(&folder), MEASURED]).assert().success();
}

#[test]
fn options_out_of_range_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = text(folder.path());
    let case = |arguments: &[&str], says: &str| {
        refused(&[&["identify", MEASURED, "--out", out], arguments].concat(), &[says]);
    };
    case(&["--population", "3"], "even number");
    case(&["--hold-out", "1.5"], "between 0 and 1");
    case(&["--limit", "1"], "--limit");
    case(&["--deadband", "-1"], "--deadband");
    case(&["--adc-span", "3:3"], "differ");
    case(&["--skip-start", "50"], "--skip-start");
    case(&["--tick-us", "1"], "--tick-us");
    refused(&["simulate", "--fs", "0", "--out", out], &["--fs"]);
    refused(&["simulate", "--duration", "1e9", "--out", out], &["--duration"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// The superuser's rename would put a file in the place of a device.
#[cfg(unix)]
#[test]
fn a_device_or_a_locked_file_is_not_written_over() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt};
    let table = "tests/data/table/table.toml";
    refused(&["validate", table, MEASURED, "--out", "/dev/full"], &["/dev/full", "no regular file"]);
    assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
    let folder = tempfile::tempdir().unwrap();
    let locked = folder.path().join("locked.csv");
    fs::write(&locked, "kept").unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o444)).unwrap();
    refused(&["validate", table, MEASURED, "--out", text(&locked), "--force"], &["locked.csv", "read-only"]);
    assert_eq!(fs::read_to_string(&locked).unwrap(), "kept");
    refused(&["identify", MEASURED, "--out", "/dev/null/out"], &["/dev/null/out"]);
}

#[test]
fn a_table_of_an_earlier_version_is_made_anew_from_the_logs_that_it_names() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("table.toml");
    let whole = fs::read_to_string(data("table/generalised-prandtl-ishlinskii/table.toml")).unwrap();
    let earlier = whole.replace("memory_at_ends = 0.0\n", "");
    fs::write(&table, &earlier).unwrap();
    let anew = "piezo identify picma-p885-1hz.csv --out '<FOLDER>'";
    let says = ["table.toml: an earlier version of this software made the table, which lacks `memory_at_ends`", anew];
    refused(&["emit", text(&table), "--face", "toml"], &says);
    refused(&["validate", text(&table), MEASURED], &says);
    // The second of the two is what was held out.
    let (first, second) = earlier.rsplit_once("picma-p885-1hz.csv").unwrap();
    let other = second.replacen("sha256 = \"", "sha256 = \"0", 1);
    fs::write(&table, [first, "picma-p885-1hz.csv", &other].concat()).unwrap();
    refused(
        &["emit", text(&table), "--face", "toml"],
        &["piezo identify '<LOG>' --validate-on '<LOG>' --out '<FOLDER>'"],
    );
    fs::write(&table, [first, "day 2.csv", &other].concat()).unwrap();
    let anew = "piezo identify picma-p885-1hz.csv --validate-on 'day 2.csv' --out '<FOLDER>'";
    refused(&["emit", text(&table), "--face", "toml"], &[anew]);
    // A line that no format was ever without is a slip.
    fs::write(&table, whole.replace("misfit_um = ", "misfits_um = ")).unwrap();
    assert!(!refused(&["emit", text(&table), "--face", "toml"], &["misfit"]).contains("earlier version"));
}
