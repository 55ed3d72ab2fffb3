//! The synthetic rig, from its logs to the figures of the thesis.

use super::{json, number, piezo};
use std::path::{Path, PathBuf};

fn logs(folder: &Path, names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| folder.join(name).with_extension("csv")).collect()
}

const MODELLING: [&str; 5] = ["sin1", "sin10", "sin100", "tr1", "tr100"];

#[test]
fn simulated_logs_are_identified_and_validated_on_the_held_out_triangle() {
    let out = tempfile::tempdir().unwrap();
    let rig = out.path().join("rig");
    let written = json(piezo().args(["simulate", "--json", "--out"]).arg(&rig));
    assert_eq!(written.as_array().unwrap().len(), 6);
    let table = out.path().join("fit");
    let short = ["--model", "enhanced", "--generations", "40", "--rounds", "4", "--devices", "0"];
    let result = json(
        piezo()
            .arg("identify")
            .args(logs(&rig, &MODELLING))
            .arg("--validate-on")
            .args(logs(&rig, &["tr10"]))
            .args(short)
            .args(["--json", "--out"])
            .arg(&table),
    );
    let mae = |index: usize| number(&result, &format!("/candidates/{index}/held_out/mae_um"));
    assert!(mae(3) < 0.6 * mae(0), "enhanced {} against Voigt {}", mae(3), mae(0));
    assert_eq!(result["model"], "enhanced");

    // The table alone gives the same figure: what identify printed is what validate finds.
    let again = json(piezo().arg("validate").arg(table.join("table.toml")).args(logs(&rig, &["tr10"])).args([
        "--json",
        "--max-mae",
        "0.2",
    ]));
    assert!((number(&again, "/logs/0/mil/mae_um") - mae(3)).abs() < 1e-6);
    assert!(number(&again, "/logs/0/mil_sil_um") < 1e-4);
}
