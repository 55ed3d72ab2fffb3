//! The thesis's tables and figures beside ours, with searches of a moment: what stands where, not how good it is.

use super::logs::{rig, write};
use super::{json, number, piezo, refused, text};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// A search of a moment.
const SHORTEST: [&str; 8] = ["--population", "8", "--generations", "3", "--rounds", "2", "--evaluations", "20"];

fn rows<'a>(result: &'a Value, item: &str) -> &'a [Value] {
    result[item].as_array().unwrap_or_else(|| panic!("{item} is no array in {result}"))
}

#[test]
fn the_seven_sampling_times_and_the_six_loops_with_their_figures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let result =
        json(piezo().args(["reproduce", "loops", "sampling-time", "--json", "--out", text(&out)]).args(SHORTEST));
    let times = rows(&result, "sampling-time");
    let time = |row: &Value| number(row, "/sampling_time_s");
    assert_eq!(times.iter().map(time).collect::<Vec<_>>(), [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2]);
    assert_eq!(number(&times[2], "/thesis_mae_um"), 0.3811);
    assert!(times.iter().all(|row| number(row, "/mae_um") > 0.0), "{times:?}");

    let loops = rows(&result, "loops");
    assert_eq!(
        loops.iter().map(|row| &row["log"]).collect::<Vec<_>>(),
        ["sin1", "sin10", "sin100", "tr1", "tr10", "tr100"]
    );
    for (row, hertz) in loops.iter().zip([1.0, 10.0, 100.0].into_iter().cycle()) {
        assert!((number(row, "/sensor/amplitude_v") - 20.0).abs() < 0.1, "{row}");
        assert!((number(row, "/sensor/frequency_hz") / hertz - 1.0).abs() < 0.01, "{row}");
    }
    let width = |row: usize| number(&loops[row], "/sensor/width_percent");
    assert!(width(0) > 5.0 && width(2) > 2.0 * width(0), "the amplifier's lag widens the loop: {loops:?}");

    let page = fs::read_to_string(out.join("reproduce.html")).unwrap();
    assert_eq!(page.matches("<figure>").count(), 7);
    for words in [
        "Table 4.4, Figure 4.8",
        "as Figures B.13 to B.15",
        "0.3811",
        "Thesis: its own actuator.",
        "tr10 0.00 … 2.00 s",
    ] {
        assert!(page.contains(words), "{words} is missing");
    }
    assert!(!page.contains("http") && !page.contains("<script"));
}

#[test]
fn plays_are_measured_without_rate_dependence_and_voigt_with() {
    let result = json(piezo().args(["reproduce", "features", "--json"]).args(SHORTEST));
    let of = |model: &str| {
        let row = rows(&result, "features").iter().find(|row| row["model"] == model);
        row.unwrap_or_else(|| panic!("{model} is missing"))
    };
    let plays = rows(&result, "features")
        .iter()
        .find(|row| row["model"] == "prandtl-ishlinskii" && row["without_lag"] == true)
        .expect("they have a lag here that they do not have in Table 3.1");
    let voigt = of("voigt");
    assert_eq!((&plays["rate_dependent"], &voigt["rate_dependent"]), (&Value::from(false), &Value::from(true)));
    assert!(number(plays, "/stroke_change_percent").abs() < 1e-6 && number(voigt, "/stroke_change_percent") < -10.0);
    assert_eq!(of("duhem")["thesis"], serde_json::json!(["no", "1–40", "yes"]));
    assert_eq!(plays["reversible"], true);
    assert_eq!(of("voltage-extremum")["reversible"], false);
}

#[test]
fn what_is_printed_stands_beside_and_the_other_items_are_there() {
    let items = ["reproduce", "parameters", "convergence", "black-box", "search"];
    let printed = piezo().args(items).args(SHORTEST).assert().success().get_output().stdout.clone();
    let printed = String::from_utf8(printed).unwrap();
    let line = |start: &[&str]| {
        let starts = |line: &&str| line.split_whitespace().take(start.len()).eq(start.iter().copied());
        printed.lines().find(starts).unwrap_or_else(|| panic!("{start:?} is missing in\n{printed}"))
    };
    for (start, thesis) in [
        (&["OSP", "modelling"][..], &["0.3258", "88"][..]),
        (&["simulation", "validation"], &["0.3357", "360"]),
        (&["2,", "none"], &["8.0331", "0.0339"]),
        (&["enhanced", "(5.3)", "OSP", "thesis"], &["1770", "736.7", "1.222"]),
        (&["64", "×", "10", "thesis"], &["753.7", "0.3561"]),
        (&["β", "V"], &["200.0", "0.78"]),
    ] {
        let words: Vec<&str> = line(start).split_whitespace().collect();
        assert!(thesis.iter().all(|value| words.contains(value)), "{words:?} should have {thesis:?}");
    }
    // Each of the five tables says whose figures it has.
    assert_eq!(printed.matches("Ours: the synthetic rig. Thesis: its own actuator.").count(), 5);
}

#[test]
fn what_section_6_2_recommends_is_tried_on_every_model_and_with_every_method() {
    let result = json(piezo().args(["reproduce", "extremum-terms", "optimisers", "--json"]).args(SHORTEST));
    let terms = rows(&result, "extremum-terms");
    let with_plays = terms.iter().find(|row| row["model"] == "prandtl-ishlinskii").unwrap();
    let without = number(with_plays, "/held_out/without_um");
    for name in ["voltage_extremum_um", "displacement_extremum_um", "both_um"] {
        // Plays remember their extrema already: what their weights leave is the rate.
        assert!((number(with_plays, &format!("/held_out/{name}")) / without - 1.0).abs() < 0.5, "{with_plays}");
        let modelled = |name: &str| number(with_plays, &format!("/modelled/{name}"));
        assert!(modelled(name) < 1.05 * modelled("without_um"), "{with_plays}");
    }
    let optimisers = rows(&result, "optimisers");
    let methods: Vec<&Value> = optimisers.iter().take(5).map(|row| &row["optimiser"]).collect();
    assert_eq!(methods, ["genetic", "differential-evolution", "particle-swarm", "cma-es", "local"]);
    assert!(optimisers.iter().all(|row| number(row, "/best_cost_um") > 0.0), "{optimisers:?}");
}

#[test]
fn what_was_learnt_is_judged_on_what_was_not() {
    let run = || {
        let mut command = piezo();
        command.args(["reproduce", "elsewhere", "--models", "voigt,enhanced,voigt"]).args(SHORTEST);
        command
    };
    let result = json(run().arg("--json"));
    let rows = rows(&result, "elsewhere");
    let subjects = ["measured PICMA stack", "the thesis's rig", "plants outside the models' class"];
    for subject in subjects {
        assert!(rows.iter().any(|row| row["subject"] == subject), "{subject} is missing");
    }
    for condition in rows.chunk_by(|a, b| (&a["subject"], &a["condition"]) == (&b["subject"], &b["condition"])) {
        // Those that were named, each once, and the straight line.
        assert_eq!(condition.len(), 3, "{condition:?}");
        // A recording of each of the catalogue's devices.
        assert!(condition[0]["subject"] != subjects[2] || number(&condition[0], "/recordings") == 8.0, "{condition:?}");
    }
    let stack = |condition: &str| {
        let row = rows.iter().find(|row| {
            row["subject"] == subjects[0] && row["condition"].as_str().is_some_and(|of| of.starts_with(condition))
        });
        row.unwrap_or_else(|| panic!("{condition} is missing"))
    };
    // The sensor's noise at rest is some 0.07 µm, and its zero another on the other day.
    assert!((number(stack("same"), "/noise_floor_um") - 0.07).abs() < 0.01);
    let (other, zeroed) = (stack("other session"), stack("other session, zeroed"));
    assert!(number(other, "/recordings") == 1.0 && zeroed["condition"].as_str().unwrap().contains("22 s"));
    for row in rows {
        let median = |name: &str| row[name]["median"].as_f64();
        assert_eq!(row["found"] == 0, median("told_nothing_um").is_none(), "{row}");
        assert!(row["searched"].as_u64() > Some(0), "{row}");
    }
    refused(&["reproduce", "elsewhere", "--logs", super::MEASURED], &["--logs"]);
    refused(&["reproduce", "elsewhere", "--seeds", "0"], &["--seeds"]);
    refused(&["reproduce", "errors", "--models", "voigt"], &["--models is for `elsewhere`"]);
}

#[test]
fn own_logs_take_the_rig_s_place() {
    let folder = tempfile::tempdir().unwrap();
    let logs: Vec<PathBuf> = ["sin10", "tr100", "tr10"].iter().map(|name| write(folder.path(), &rig(name))).collect();
    let run = |arguments: &[&str]| {
        let mut command = piezo();
        command.args(["reproduce", "errors", "loops", "--logs"]).args(&logs[..2]).args(arguments).args(SHORTEST);
        command
    };
    let validated = ["--validate-on", text(&logs[2])];
    let result = json(run(&validated).arg("--json"));
    let errors = rows(&result, "errors");
    assert_eq!(errors.len(), 9);
    assert!(errors.iter().all(|row| row["mae_um"].is_f64() || row["failed"].is_string()), "{errors:?}");
    let roles = |result: &Value| -> Vec<(String, String)> {
        let word = |row: &Value, name: &str| row[name].as_str().unwrap().to_owned();
        rows(result, "loops").iter().map(|row| (word(row, "log"), word(row, "role"))).collect()
    };
    let expected = [("sin10", "training"), ("tr100", "training"), ("tr10", "held out")];
    assert_eq!(roles(&result), expected.map(|(log, role)| (log.to_owned(), role.to_owned())));
    let printed = String::from_utf8(run(&validated).assert().success().get_output().stdout.clone()).unwrap();
    for words in
        ["Validation on tr10, held out", "Ours: the given logs. Thesis: its own actuator.", "tr10.csv 0.00 … 0.50 s"]
    {
        assert!(printed.contains(words), "{words} is missing in\n{printed}");
    }
    // Without a log to validate on each is halved.
    assert_eq!(roles(&json(run(&[]).arg("--json"))).len(), 4);
}

#[test]
fn what_cannot_be_reproduced_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (log, missing, file) = (super::MEASURED, folder.path().join("missing.csv"), folder.path().join("file"));
    fs::write(&file, "").unwrap();
    let out = text(&out);
    refused(&["reproduce", "table", "--out", out], &["table", "sampling-time", "features"]);
    refused(&["reproduce", "--validate-on", log, "--out", out], &["--logs"]);
    refused(&["reproduce", "--logs", log, "--rig-seed", "2", "--out", out], &["--rig-seed", "--logs"]);
    refused(&["reproduce", "loops", "--logs", text(&missing), "--out", out], &["missing.csv"]);
    refused(&["reproduce", "--logs", log, "--hold-out", "0", "--out", out], &["nothing is held out", "--validate-on"]);
    refused(&["reproduce", "--logs", log, "--hold-out", "1.5", "--out", out], &["--hold-out", "1.5"]);
    refused(&["reproduce", "--logs", log, log, "--out", out], &["same bytes"]);
    refused(&["reproduce", "--out", text(&file)], &["file", "--out names a folder"]);
    assert!(!folder.path().join("out").exists(), "nothing may be written");
}
