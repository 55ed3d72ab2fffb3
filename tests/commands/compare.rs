//! Models side by side on the synthetic rig.

use super::{json, number, piezo, refused, text};
use serde_json::Value;
use std::fs;

/// Zeros and delay as the rig has them.
const KNOWN: [&str; 6] = ["--delay", "0", "--voltage-zero", "0", "--displacement-zero", "0"];

/// The generalised Prandtl–Ishlinskii model's error on the held-out triangle is at most 0.12 of Voigt's.
#[test]
fn plays_with_lag_and_creep_beat_voigt_on_what_neither_has_seen() {
    let folder = tempfile::tempdir().unwrap();
    let rig = folder.path().join("rig");
    piezo().args(["simulate", "--duration", "1", "--out"]).arg(&rig).assert().success();
    let log = |name: &str| rig.join(name).with_extension("csv");
    let counts = folder.path().join("instructions.json");
    fs::write(
        &counts,
        r#"{ "generalised-prandtl-ishlinskii": { "max": 1234, "mean": 1200.5 }, "narx": { "max": 9, "mean": 8 } }"#,
    )
    .unwrap();
    let out = folder.path().join("out");
    let result = json(
        piezo()
            .arg("compare")
            .args(["sin1", "sin10", "sin100", "tr1", "tr100"].map(log))
            .arg("--validate-on")
            .arg(log("tr10"))
            .args(KNOWN)
            .args([
                "--models",
                "generalised-prandtl-ishlinskii,voigt,preisach,generalised-prandtl-ishlinskii",
                "--budget",
                "1500",
            ])
            .args(["--json", "--instructions", text(&counts), "--out", text(&out)]),
    );
    let rows = result["rows"].as_array().unwrap();
    let models: Vec<&Value> = rows.iter().map(|row| &row["model"]).collect();
    assert_eq!(models, ["generalised-prandtl-ishlinskii", "voigt", "preisach"]);
    let evaluations: Vec<f64> = (0..3).map(|row| number(&result, &format!("/rows/{row}/evaluations"))).collect();
    // They end where they find nothing better; of Preisach's, only the lateness is searched.
    assert!(evaluations[..2].iter().all(|made| (200.0..=1500.0).contains(made)), "{evaluations:?}");
    assert!((20.0..200.0).contains(&evaluations[2]), "{evaluations:?}");
    let mae = |row: usize| number(&result, &format!("/rows/{row}/held_out/all/mae_um"));
    assert!(mae(0) <= 0.12 * mae(1), "generalised {} against Voigt {}", mae(0), mae(1));
    assert_eq!(mae(0), number(&result, "/rows/0/held_out/logs/0/errors/mae_um"));
    assert_eq!(rows[0]["training"]["logs"].as_array().unwrap().len(), 5);
    assert_eq!((&rows[1]["parameters"], &rows[1]["instructions"]), (&Value::from(5), &Value::Null));
    assert_eq!(number(&result, "/rows/0/instructions/mean"), 1200.5);
    assert!(number(&result, "/rows/0/seconds") > 0.0);
    let line = number(&result, "/straight_line/held_out/all/mae_um");
    assert!(line > mae(1), "a line {line} against Voigt {}", mae(1));
    assert_eq!(line, number(&result, "/straight_line/held_out/logs/0/errors/mae_um"));
    assert_eq!(number(&result, "/straight_line/parameters"), 2.0);

    // Each model's table is kept, and says that it was made to be compared.
    for model in ["generalised-prandtl-ishlinskii", "voigt", "preisach"] {
        let table = out.join(model).with_extension("toml");
        assert!(fs::read_to_string(&table).unwrap().contains(&format!("`piezo identify --model {model}` does both")));
        piezo().args(["validate", text(&table)]).arg(log("tr10")).assert().success();
    }
    let page = fs::read_to_string(out.join("compare.html")).unwrap();
    for words in [
        "generalised Prandtl–Ishlinskii",
        "Voigt (4.8)",
        "1234",
        "tr10.csv 0.00 … 1.00 s",
        "Evaluations",
        "1500",
        "smallest MAE held out, without offset",
        "straight line (2.1)",
    ] {
        assert!(page.contains(words), "{words} is missing");
    }
}

/// A model that cannot be admitted is a row; the others are there all the same.
#[test]
fn a_model_without_an_admissible_candidate_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let rig = folder.path().join("rig");
    piezo().args(["simulate", "--duration", "0.5", "--out"]).arg(&rig).assert().success();
    // Ten candidates and hardly any room: of nine numbers nothing is found.
    let search = ["--budget", "10", "--limit", "1.2", "--start", "random"];
    let out = folder.path().join("out");
    let result = json(
        piezo()
            .arg("compare")
            .arg(rig.join("tr10.csv"))
            .args(KNOWN)
            .args(["--models", "enhanced,preisach", "--json", "--out", text(&out)])
            .args(search),
    );
    let why = result.pointer("/rows/0/failed").and_then(Value::as_str).expect("enhanced fails");
    assert!(why.contains("no admissible candidate"), "{why}");
    assert!(number(&result, "/rows/1/held_out/all/mae_um") > 0.0);
    assert!(fs::read_to_string(out.join("compare.html")).unwrap().contains("no admissible candidate"));

    // The table of a former run, in which the model did not fail, is not taken for one of this.
    fs::copy(out.join("preisach.toml"), out.join("enhanced.toml")).unwrap();
    fs::copy(out.join("preisach.toml"), out.join("duhem.toml")).unwrap();
    let again = piezo()
        .arg("compare")
        .arg(rig.join("tr10.csv"))
        .args(KNOWN)
        .args(["--models", "enhanced,preisach", "--out", text(&out)])
        .args(search)
        .output()
        .unwrap();
    let said = String::from_utf8(again.stdout).unwrap();
    let line = said.lines().find(|line| line.starts_with("Written to ")).expect("where it was written");
    assert!(line.ends_with(": compare.html, preisach.toml; still there from before, and not of this comparison: enhanced.toml, duhem.toml"), "{line}");
}

/// A session's folder stands for its logs, as it does for identify.
#[test]
fn the_folder_of_a_session_is_compared_on_what_it_holds_out() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("p885");
    piezo().args(["simulate", "--duration", "0.5", "--out"]).arg(&session).assert().success();
    let logs = [("sin10", false), ("tr10", true)]
        .map(|(name, held_out)| format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {held_out}\n"));
    fs::write(session.join("session.toml"), format!("complete = true\nseed = 1\n{}", logs.concat())).unwrap();
    let compare = ["compare", text(&session), "--models", "preisach", "--json"];
    let found = json(piezo().args(compare).args(KNOWN));
    let roles: Vec<String> =
        found["logs"].as_array().unwrap().iter().map(|log| format!("{} {}", log["file"], log["role"])).collect();
    assert_eq!(roles, [r#""sin10.csv" "training""#, r#""tr10.csv" "held-out""#]);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let log = super::MEASURED;
    refused(
        &["compare", log, "--models", "voigt,fancy", "--out", text(&out)],
        &["fancy", "generalised-prandtl-ishlinskii"],
    );
    refused(&["compare", log, "--models", "auto", "--out", text(&out)], &["auto"]);
    refused(
        &["compare", log, "--hold-out", "0", "--models", "preisach", "--out", text(&out)],
        &["nothing is held out"],
    );
    refused(&["compare", log, "--budget", "0", "--out", text(&out)], &["--budget"]);
    refused(
        &["compare", log, "--feedback-weight", "0.5", "--out", text(&out)],
        &["--feedback-weight", "--cost multi-step"],
    );
    let counts = folder.path().join("counts.json");
    fs::write(&counts, r#"{ "fancy": { "max": 1, "mean": 1 } }"#).unwrap();
    refused(&["compare", log, "--instructions", text(&counts), "--out", text(&out)], &["counts.json", "fancy"]);
    assert!(!out.exists(), "nothing may be written");
}
