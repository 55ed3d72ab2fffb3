//! A wanted trajectory becomes voltages, and what cannot be is refused.

use super::{json, number, piezo, refused, root, text};
use std::fs;
use std::path::{Path, PathBuf};

/// A slow swing about 15 µm, as a file.
fn wanted(folder: &Path) -> PathBuf {
    let rows = (0..3000).map(|k| {
        let t = f64::from(k) * 1e-3;
        format!("{t:.3},{:.5}\n", 15.0 + 9.0 * (t * 6.0).sin())
    });
    let path = folder.join("wanted.csv");
    fs::write(&path, "time_s,displacement_um\n".to_owned() + &rows.collect::<String>()).unwrap();
    path
}

fn table() -> PathBuf {
    root().join("tests/data/table/table.toml")
}

#[test]
fn the_model_of_the_voltages_is_the_trajectory() {
    let out = tempfile::tempdir().unwrap();
    let voltages = out.path().join("voltages.csv");
    let plan = json(
        piezo()
            .arg("feedforward")
            .args([&table(), &wanted(out.path())])
            .args(["--slew", "200", "--rest", "1.2", "--json", "--out"])
            .arg(&voltages),
    );
    assert!(number(&plan, "/round_trip/max_um") < 0.05, "{plan:#}");
    assert!(number(&plan, "/voltage_v/max") < 3.79 && number(&plan, "/fastest_v_per_s") <= 200.01, "{plan:#}");
    assert_eq!(number(&plan, "/ticks"), 5999.0 + 2000.0 * number(&plan, "/approach_s"));
    // What was written is a log, of which the same table makes the same displacement.
    let report = json(piezo().arg("validate").args([&table(), &voltages]).args(["--json", "--max-mae", "0.02"]));
    assert!(number(&report, "/logs/0/mil/mae_um") < 0.02, "{report:#}");
}

/// Of what a device has followed, the wish is wanted again, and not what came of it.
#[test]
fn a_log_of_what_was_followed_is_asked_for_what_was_wanted() {
    let out = tempfile::tempdir().unwrap();
    let (followed, voltages) = (out.path().join("followed.csv"), out.path().join("voltages.csv"));
    let row = |k: u32| format!("{:.4},1.0,{:.3},15.0,1.0\n", f64::from(k) * 5e-4, 15.0 + f64::from(k % 2));
    let heading = "time_s,voltage_V,estimated_displacement_um,wanted_um,driven_V\n";
    fs::write(&followed, heading.to_owned() + &(0..1000).map(row).collect::<String>()).unwrap();
    let table = table();
    let plan =
        ["feedforward", text(&table), text(&followed), "--slew", "200", "--rest", "1.2", "--out", text(&voltages)];
    let columns = ["--columns", "displacement=wanted_um"];
    refused(&plan, &["followed.csv: its displacement is what a device has estimated", &columns.join(" ")]);
    let said = json(piezo().args(plan).args(columns).arg("--json"));
    assert!(number(&said, "/round_trip/max_um") < 0.05, "{said:#}");
}

#[test]
fn a_threshold_fails_and_impossible_wishes_are_told() {
    let out = tempfile::tempdir().unwrap();
    let (wanted, voltages) = (wanted(out.path()), out.path().join("voltages.csv"));
    let feedforward = |more: &[&str]| {
        let mut command = piezo();
        command.arg("feedforward").args([&table(), &wanted]).arg("--out").arg(&voltages).args(more);
        command.output().unwrap()
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let slow = feedforward(&["--slew", "2", "--max-error", "0.1"]);
    assert_eq!(slow.status.code(), Some(1));
    assert!(text(&slow.stdout).contains("stood at a limit") && text(&slow.stdout).contains("FAILED"));
    // What cannot be had is said, with how far and from when, unless it is allowed.
    let short = feedforward(&["--slew", "2"]);
    assert_eq!(short.status.code(), Some(1));
    assert!(text(&short.stdout).contains("s on it falls short by up to"), "{}", text(&short.stdout));
    assert_eq!(feedforward(&["--slew", "2", "--max-error", "30"]).status.code(), Some(0));
    fs::remove_file(&voltages).unwrap();
    for (more, why) in [
        (&[][..], "--slew '<V/s>'"),
        (&["--slew", "100", "--range", "0:60"], "identified on"),
        (&["--slew", "100", "--range", "0:3", "--rest", "3.5"], "rest_v"),
        (&["--slew", "0"], "slew"),
    ] {
        let refused = feedforward(more);
        assert_eq!(refused.status.code(), Some(2), "{more:?}");
        assert!(text(&refused.stderr).contains(why), "{more:?}: {}", text(&refused.stderr));
        assert!(!voltages.exists());
    }
}

#[test]
fn a_drive_is_calibrated_with_its_slew_rate_and_kept_in_every_face() {
    let out = tempfile::tempdir().unwrap();
    let emit = |more: &[&str]| {
        let mut command = piezo();
        command.arg("emit").arg(table()).arg("--out").arg(out.path()).args(more);
        command.output().unwrap()
    };
    assert_eq!(emit(&["--drive-span", "0:4"]).status.code(), Some(2), "a drive without a slew rate");
    let refused = emit(&["--drive-span", "0:4", "--drive-slew", "100", "--drive-rest", "3.9"]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("rest_v"), "{refused:?}");
    let made = emit(&["--drive-span", "4:-1", "--drive-slew", "100"]);
    assert!(made.status.success(), "{made:?}");
    let toml = fs::read_to_string(out.path().join("table.toml")).unwrap();
    assert!(toml.contains("[table.drive]") && toml.contains("slew_v_per_s = 100"), "{toml}");
    let rust = fs::read_to_string(out.path().join("table.rs")).unwrap();
    assert!(rust.contains("DriveLimits {"), "{rust}");
    let plan = json(
        piezo()
            .arg("feedforward")
            .args([&out.path().join("table.toml"), &wanted(out.path())])
            .args(["--json", "--out"])
            .arg(out.path().join("voltages.csv")),
    );
    assert_eq!(number(&plan, "/limits/slew_v_per_s"), 100.0);
}

#[test]
fn what_is_wanted_may_be_a_hold_of_two_rows_and_is_never_written_over() {
    let out = tempfile::tempdir().unwrap();
    let (hold, voltages) = (out.path().join("hold.csv"), out.path().join("voltages.csv"));
    fs::write(&hold, "0,20\n1,20\n").unwrap();
    let feedforward = |target: &Path| {
        let mut command = piezo();
        command.arg("feedforward").args([&table(), &hold]).arg("--out").arg(target);
        command.args(["--columns", "time=1,displacement=2:um", "--slew", "100", "--json"]);
        command
    };
    let plan = json(&mut feedforward(&voltages));
    // From rest it goes there first, without a limit in the way, and does not go beyond.
    let approach_s = number(&plan, "/approach_s");
    assert!(approach_s > 0.1 && number(&plan, "/out_of_reach") == 0.0, "{plan:#}");
    assert_eq!(number(&plan, "/ticks"), 2001.0 + 2000.0 * approach_s);
    let rows = fs::read_to_string(&voltages).unwrap();
    let displacement = |row: &str| row.split(',').nth(2).unwrap().parse::<f64>().unwrap();
    let highest = rows.lines().skip(1).map(displacement).fold(f64::MIN, f64::max);
    assert!((highest - 20.0).abs() < 0.05, "{highest}");
    assert!(number(&plan, "/reach_um/0") < 1.0 && number(&plan, "/reach_um/1") > 30.0, "{plan:#}");
    for input in [&hold, &table()] {
        let before = fs::read(input).unwrap();
        let refused = feedforward(input).assert().code(2).get_output().stderr.clone();
        assert!(String::from_utf8_lossy(&refused).contains("overwrite"));
        assert_eq!(fs::read(input).unwrap(), before);
    }
    fs::write(&hold, "0,200\n1,200\n").unwrap();
    let never = feedforward(&voltages).assert().code(1).get_output().stdout.clone();
    assert!(serde_json::from_slice::<serde_json::Value>(&never).unwrap()["met_after_s"].is_null());
}
