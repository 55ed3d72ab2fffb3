//! The main job: the measured log, its second half held out.

use super::{MEASURED, json, number, piezo};
use estimator_core::Table;
use serde_json::Value;
use std::fs;
use table_files::TableFile;

/// The documents' figures are printed by the same command with an interval from more devices.
#[test]
fn identifies_the_measured_log_and_says_how_good_it_is() {
    let out = tempfile::tempdir().unwrap();
    let result = json(piezo().args(["identify", MEASURED, "--json", "--devices", "2", "--out"]).arg(out.path()));
    assert_eq!(result["model"], "generalised-prandtl-ishlinskii");
    let candidates = result["candidates"].as_array().unwrap();
    let held_out: Vec<f64> = candidates.iter().map(|candidate| number(candidate, "/held_out/mae_um")).collect();
    let percent = |mae: f64| 100.0 * mae / number(&candidates[0], "/held_out/stroke_um");
    assert!(held_out.iter().all(|&mae| percent(mae) < 1.0), "{held_out:?}");
    assert!(held_out[3] < 0.8 * held_out[0], "the extremum terms fit this loop better: {held_out:?}");
    let line = number(&result, "/straight_line/held_out/mae_um");
    assert!(held_out.iter().all(|&mae| mae < 0.5 * line), "{held_out:?} beside a straight line's {line}");
    let chosen = &candidates[11];
    let scores = result["cross_validation"]["scores"].as_array().unwrap();
    assert_eq!((&scores[0]["model"], scores[0]["parts_um"].as_array().unwrap().len()), (&result["model"], 6));
    assert!(scores.len() > 1 && number(&scores[0], "/error_um") < 0.8 * number(&scores[1], "/error_um"), "{scores:?}");
    assert!(number(chosen, "/held_out/rmse_percent") <= 0.7, "{chosen}");

    let doubts: Vec<&str> = result["doubts"].as_array().unwrap().iter().filter_map(|d| d["doubt"].as_str()).collect();
    for doubt in ["single-amplitude", "single-frequency", "calibration-assumed"] {
        assert!(doubts.contains(&doubt), "{doubt} is missing in {doubts:?}");
    }
    let found = result["determination"]["found"].as_array().unwrap();
    assert_eq!(found.len(), 6);
    let known = |index: usize| (number(&found[index], "/standard_error_um"), found[index]["told"] == "well");
    let (stroke, half) = (known(0), known(2));
    assert!(stroke.1 && stroke.0 < 0.2, "the stroke was recorded: {stroke:?}");
    assert!(!half.1 && half.0 > 2.0 * known(1).0, "a smaller loop was not: {half:?}");
    assert_eq!(result["logs"][0]["role"], "training");
    assert_eq!(result["logs"][1]["role"], "judged-then-learnt");
    let ends = [0, 1].map(|index| number(&result["logs"][index], "/to_s"));
    assert!((ends[0] - ends[1]).abs() < 1e-9 && number(&result["logs"][1], "/from_s") > 20.0, "the second half");

    let (file, admitted) = TableFile::load(&out.path().join("table.toml")).unwrap();
    assert!(file.determined[3].contains("record swings of 50 % of the range"), "{:?}", file.determined);
    let record = fs::read(out.path().join("table.bin")).unwrap();
    assert_eq!(Table::parse(&record).unwrap(), admitted);
    let interval = admitted.interval.expect("an interval was calibrated");
    assert!((0.1..3.0).contains(&interval.misfit_um), "{interval:?}");
    let verdict = result["verdict"].to_string();
    assert!(verdict.contains(&format!("±{:.3} µm", interval.misfit_um)), "{verdict}");
    assert!((f64::from(file.table.provenance.validation_mae_um.unwrap()) - held_out[11]).abs() < 1e-6);
    let report = fs::read_to_string(out.path().join("report.html")).unwrap();
    for words in ["picma-p885-1hz", "single amplitude", "straight line (2.1)"] {
        assert!(report.contains(words), "{words} is missing");
    }
    assert!(fs::read_to_string(out.path().join("estimate.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn the_seed_decides_and_the_number_of_threads_does_not() {
    let run = |threads: &str, seed: &str| {
        let out = tempfile::tempdir().unwrap();
        let short = [
            "--generations",
            "5",
            "--rounds",
            "2",
            "--model",
            "displacement-extremum",
            "--seed",
            seed,
            "--devices",
            "2",
        ];
        let mut command = piezo();
        command.env("RAYON_NUM_THREADS", threads);
        command.args(["identify", MEASURED]).args(short).arg("--out").arg(out.path()).assert().success();
        fs::read(out.path().join("table.toml")).unwrap()
    };
    let first = run("1", "5");
    assert_eq!(first, run("4", "5"));
    assert_ne!(first, run("1", "6"));
}

#[test]
fn validate_shows_both_precisions_and_judges_by_the_threshold() {
    let table = "tests/data/table/table.toml";
    let report = json(piezo().args(["validate", table, MEASURED, "--json"]));
    let log = &report["logs"][0];
    assert!(number(log, "/mil/mae_um") > 0.1);
    assert!(number(log, "/mil_sil_um") < 1e-3, "f32 must follow f64");
    assert_eq!(report["passed"], Value::Bool(true));
    let exit = |arguments: &[&str]| piezo().args(["validate", table, MEASURED]).args(arguments).assert();
    exit(&["--max-percent", "2"]).code(0);
    exit(&["--max-percent", "0.1"]).code(1);
    exit(&["--max-mae", "0.01"]).code(1);
}
