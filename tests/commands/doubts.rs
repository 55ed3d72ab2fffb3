//! What `identify` refuses to learn from, what it doubts, and what it says comes next.

use super::{json, piezo, refused, text};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A log at 200 Hz of this voltage and displacement at a time, s.
fn log(folder: &Path, name: &str, header: &str, rows: u32, of: impl Fn(u32) -> (f64, f64)) -> PathBuf {
    let row = |k: u32| format!("{:.4},{:.5},{:.5}\n", f64::from(k) * 0.005, of(k).0, of(k).1);
    let path = folder.join(name);
    fs::write(&path, format!("{header}\n{}", (0..rows).map(row).collect::<String>())).unwrap();
    path
}

const COLUMNS: &str = "time_s,voltage_V,displacement_um";

/// Noise of a standard deviation of 1, the same in every run.
fn noise(k: u32) -> f64 {
    let draw = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1u32 << 24);
    (0..12).map(|n| draw(12 * k + n + 1)).sum::<f64>() - 6.0
}

/// Sine of 1 Hz, 0 … 40 V.
fn sine(k: u32) -> f64 {
    20.0 - 20.0 * (std::f64::consts::TAU * f64::from(k) * 0.005).cos()
}

#[test]
fn a_log_without_a_reversal_or_of_noise_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let ramp = log(folder.path(), "ramp.csv", COLUMNS, 49, |k| (f64::from(k), 0.3 * f64::from(k) + 0.01 * noise(k)));
    refused(&["identify", text(&ramp), "--out", text(&out)], &["ramp: the voltage never reverses", "several cycles"]);
    let rest = log(folder.path(), "rest.csv", COLUMNS, 2000, |k| (1.0 + 0.005 * noise(k + 9_000), 0.005 * noise(k)));
    refused(
        &["identify", text(&rest), "--out", text(&out)],
        &["rest: the displacement is noise", "did the actuator rest"],
    );
    assert!(!out.join("table.toml").exists(), "nothing may be written");
}

fn identified(log: &Path, options: &[&str]) -> String {
    let out = log.with_extension("out");
    let output = piezo().arg("identify").arg(log).args(["--model", "voigt", "--out"]).arg(out).args(options).assert();
    String::from_utf8(output.success().get_output().stdout.clone()).unwrap()
}

#[test]
fn a_model_that_is_no_better_than_a_straight_line_is_doubted_and_led_to_no_board() {
    let folder = tempfile::tempdir().unwrap();
    let line = log(folder.path(), "line.csv", COLUMNS, 2000, |k| (sine(k), 0.3 * sine(k) + 0.2 * noise(k)));
    let said = identified(&line, &["--devices", "0"]);
    assert!(
        said.contains("When not to trust it:\n- without offset the model is off by")
            && said.contains("no better than a straight line"),
        "{said}"
    );
    assert!(said.contains("Next: mend what the first doubt names") && !said.contains("piezo install"), "{said}");
    assert!(
        said.contains("no simulated device was asked for (--devices 0)") && !said.contains("none could be learnt"),
        "{said}"
    );
}

#[test]
fn a_sensor_that_hums_with_the_mains_is_a_doubt_and_one_that_is_loud_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, hum_um: f64| {
        let hum = move |k: u32| hum_um * (std::f64::consts::TAU * 49.9 * f64::from(k) * 0.005).sin();
        let path = log(folder.path(), name, COLUMNS, 4000, |k| (sine(k), 0.3 * sine(k) + 0.05 * noise(k) + hum(k)));
        identified(&path, &["--devices", "0", "--json"])
    };
    let doubts = |said: &str| -> Value { serde_json::from_str::<Value>(said).unwrap()["doubts"].clone() };
    let hums = |said: &Value| said.as_array().unwrap().iter().find(|of| of["doubt"] == "hums").cloned();
    let said = hums(&doubts(&of("hum.csv", 0.1))).unwrap();
    assert_eq!((&said["log"], &said["hertz"]), (&"hum".into(), &50.into()));
    assert!((said["amplitude_um"].as_f64().unwrap() - 0.1).abs() < 0.01, "{said}");
    assert_eq!(hums(&doubts(&of("loud.csv", 0.0))), None);
}

#[test]
fn look_names_a_hum_and_how_a_log_begins_and_estimate_says_where_that_is_in_motion() {
    let folder = tempfile::tempdir().unwrap();
    let hum = |k: u32| 0.05 * (std::f64::consts::TAU * 49.9 * f64::from(k) * 0.005).sin();
    let of = |name: &str, time: fn(u32) -> u32, hums: bool| {
        let read = move |k| 12.0 * sine(time(k)) / 40.0 + 0.005 * noise(k) + if hums { hum(k) } else { 0.0 };
        log(folder.path(), name, COLUMNS, 4000, |k| (3.6 * sine(time(k)) / 40.0, read(k)))
    };
    let (moving, rested) = (of("moving.csv", |k| k + 50, true), of("rested.csv", |k| k.saturating_sub(400), false));
    let said = |words: &[&str]| {
        let output = piezo().args(words).assert().success();
        String::from_utf8(output.get_output().stdout.clone()).unwrap()
    };
    let (moves, rests) = (said(&["look", text(&moving)]), said(&["look", text(&rested)]));
    assert!(moves.contains("with a voltage that moves at once") && moves.contains(" µm at 50 Hz beyond"), "{moves}");
    assert!(rests.contains("with a voltage that stands for 2") && !rests.contains("hum "), "{rests}");
    let estimated = |log: &Path| {
        let out = log.with_extension("estimates");
        said(&[
            "estimate",
            "tests/data/table/models/generalised-prandtl-ishlinskii.toml",
            text(log),
            "--zero-at",
            "5:-90",
            "--out",
            text(&out),
        ])
    };
    let begins = "the voltage moves from the first sample on";
    assert!(estimated(&moving).contains(begins) && !estimated(&rested).contains(begins));
}

#[test]
fn a_sensor_that_drifts_is_a_grave_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, um: f64| {
        let drift = move |k: u32| um * f64::from(k) / 4000.0;
        let path = log(folder.path(), name, COLUMNS, 4000, |k| (sine(k), 0.3 * sine(k) + 0.01 * noise(k) + drift(k)));
        identified(&path, &["--devices", "0"])
    };
    let said = of("drift.csv", 1.5);
    let first = "When not to trust it:\n- on drift, held out, the error goes by -0.7";
    assert!(said.contains(first) && said.contains("µm within 10 s, in one direction"), "{said}");
    assert!(said.contains("Next: mend what the first doubt names"), "{said}");
    assert!(!of("steady.csv", 0.0).contains("in one direction"));
}

/// Both halves are alike but for a constant, which each is judged without.
#[test]
fn a_table_that_was_learnt_over_a_change_between_what_was_judged_and_the_rest_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, shift_um: f64| {
        let lagged = |k: u32| 0.3 * sine(k) + 0.6 * (std::f64::consts::TAU * f64::from(k) * 0.005 - 0.4).cos();
        let shifted = |k: u32| shift_um * f64::from(k.saturating_sub(970).min(60)) / 60.0;
        let log = log(folder.path(), name, COLUMNS, 2000, |k| (sine(k), lagged(k) + shifted(k) + 0.01 * noise(k)));
        identified(&log, &["--devices", "0"])
    };
    let (changed, alike) = (of("changed.csv", 3.0), of("alike.csv", 0.0));
    assert!(changed.contains("something changed within a log") && !changed.contains("piezo install"), "{changed}");
    assert!(!alike.contains("something changed"), "{alike}");
    assert!(alike.contains(" µm stroke), and "), "{alike}");
    let [one, two] = ["alike.csv", "changed.csv"].map(|name| folder.path().join(name));
    let both = identified(&one, &["--devices", "0", text(&two)]);
    assert!(both.contains("% of the stroke in what was held out of each, on average over 2 logs)"), "{both}");
    assert!(both.contains(" without a constant offset of each log's own. With it,"), "{both}");
    assert!(both.contains("\n- on changed, held out, the estimate is off by a constant"), "{both}");
}

#[test]
fn a_wide_interval_is_a_doubt_and_extremum_terms_have_a_determination() {
    let folder = tempfile::tempdir().unwrap();
    let truth = text(&super::data("instruments/truth.csv")).to_owned();
    let of = |model| {
        let out = folder.path().join(model);
        json(piezo().args(["identify", &truth, "--model", model, "--devices", "4", "--json", "--out"]).arg(out))
    };
    let found = of("narx");
    let doubts: Vec<&Value> = found["doubts"].as_array().unwrap().iter().map(|doubt| &doubt["doubt"]).collect();
    assert_eq!(doubts[0], "wide-interval", "{doubts:?}");
    let found = of("enhanced");
    assert_eq!(found["determination"]["found"].as_array().map(Vec::len), Some(6), "{}", found["determination"]);
}

#[test]
fn a_unit_that_is_wrong_by_a_thousand_is_the_first_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let loop_of = |k: u32| (sine(k), 0.3 * sine(k.saturating_sub(8)) + 0.01 * noise(k));
    let wrong = log(folder.path(), "mv.csv", "time_s,voltage_mV,displacement_um", 2000, loop_of);
    let said = identified(&wrong, &["--devices", "0"]);
    let first = said.split("When not to trust it:\n- ").nth(1).unwrap_or_else(|| panic!("no doubts in {said}"));
    assert!(
        first.starts_with("the displacement goes over") && first.contains("which is no piezo actuator's"),
        "{first}"
    );
    assert!(!said.contains("piezo install"), "{said}");
    let right = log(folder.path(), "v.csv", COLUMNS, 2000, loop_of);
    let good = identified(&right, &["--devices", "0"]);
    assert!(good.contains("/table.toml LOG`; put it on a board with `piezo install "), "{good}");
}

#[test]
fn exchanged_columns_are_the_first_doubt_and_look_asks_for_them() {
    let folder = tempfile::tempdir().unwrap();
    // A late displacement, as hysteresis makes it.
    let of = |k: u32| (sine(k), 3.0 + 0.3 * sine((k + 200).saturating_sub(8)) + 0.01 * noise(k));
    let right = log(folder.path(), "right.csv", COLUMNS, 2000, of);
    let exchanged = log(folder.path(), "exchanged.csv", COLUMNS, 2000, |k| (of(k).1, of(k).0));
    let looked = |log: &Path| String::from_utf8(piezo().arg("look").arg(log).output().unwrap().stdout).unwrap();
    let asked = "are the two columns exchanged?";
    assert!(looked(&exchanged).contains(asked) && !looked(&right).contains(asked), "{}", looked(&exchanged));
    let settled = "\nNext, once what is doubtful is settled:\n";
    assert!(looked(&exchanged).contains(settled) && looked(&right).contains("\nNext:\n"), "{}", looked(&right));
    let said = identified(&exchanged, &["--devices", "0"]);
    let first = said.split("When not to trust it:\n- ").nth(1).unwrap_or_else(|| panic!("no doubts in {said}"));
    assert!(first.starts_with("in exchanged the displacement runs ahead of the voltage"), "{first}");
    assert!(first.contains(asked) && first.contains("--columns") && !said.contains("piezo install"), "{said}");
    assert!(!identified(&right, &["--devices", "0"]).contains(asked));
}

#[test]
fn a_sensor_that_goes_farther_in_one_of_several_logs_is_named() {
    let folder = tempfile::tempdir().unwrap();
    // A displacement that is late by 0.1 s.
    let of = |name: &str, gain: f64| {
        let um = |k: u32| 0.3 * gain * sine((k + 180) % 200) + 0.01 * noise(k + (100.0 * gain) as u32);
        log(folder.path(), name, COLUMNS, 2000, |k| (sine(k), um(k)))
    };
    let (first, second, other) = (of("first.csv", 1.0), of("second.csv", 1.01), of("other.csv", 1.1));
    let said = |more: &Path| identified(&first, &["--devices", "0", text(&second), text(more)]);
    let (alike, named) = (said(&of("third.csv", 0.99)), said(&other));
    assert!(named.contains("\n- the sensor of other goes 9 % farther than the others'"), "{named}");
    assert!(!alike.contains("- the sensor of"), "{alike}");
}

#[test]
fn a_voltage_that_is_read_late_and_another_clock_are_doubts() {
    let folder = tempfile::tempdir().unwrap();
    let at = |seconds: f64| 20.0 - 20.0 * (3.0 * std::f64::consts::TAU * seconds).cos();
    let of = |name: &str, late_s: fn(f64) -> f64| {
        let read = move |seconds: f64| 0.3 * at(seconds - late_s(seconds));
        let path = log(folder.path(), name, COLUMNS, 4000, |k| {
            let seconds = f64::from(k) * 0.005;
            (at(seconds), read(seconds) + 0.01 * noise(k))
        });
        identified(&path, &["--devices", "0"])
    };
    let (early, other, sound) =
        (of("early.csv", |_| -0.012), of("clock.csv", |seconds| 0.002 * seconds), of("sound.csv", |_| 0.002));
    assert!(early.contains("\n- in early the displacement comes before the voltage, by 1"), "{early}");
    let later = other.contains("\n- in clock the displacement is ") && other.contains(" ms later at the end than");
    assert!(later, "{other}");
    assert!(!sound.contains("before the voltage") && !sound.contains("at the end than"), "{sound}");
    assert!(early.contains("Next: mend what the first doubt names"), "{early}");
}

#[test]
fn a_held_out_voltage_that_goes_as_it_never_went_in_the_training_is_a_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let of = |volts: f64, before: f64, k: u32| (volts, 0.3 * before + 0.01 * noise(k));
    let slow = log(folder.path(), "slow.csv", COLUMNS, 2000, |k| of(sine(k), sine((k + 200).saturating_sub(4)), k));
    // Small swings about the middle, where the training only passed.
    let small = |k: u32| 20.0 + 0.2 * (sine(5 * k) - 20.0);
    let other = log(folder.path(), "other.csv", COLUMNS, 2000, |k| of(small(k), small((k + 200).saturating_sub(4)), k));
    let again =
        log(folder.path(), "again.csv", COLUMNS, 2000, |k| of(sine(k), sine((k + 200).saturating_sub(4)), k + 9));
    let said = |held_out: &Path| identified(&slow, &["--devices", "4", "--validate-on", text(held_out)]);
    let words = "the voltage went as it never did in the training";
    let doubted = said(&other);
    let doubts = doubted.split("When not to trust it:").nth(1).unwrap_or_else(|| panic!("no doubts in {doubted}"));
    assert!(doubts.contains("- on other ") && doubts.contains(words), "{doubts}");
    let table = slow.with_extension("out").join("table.toml");
    let validated = piezo().arg("validate").arg(&table).arg(&other).output().unwrap();
    let validated = String::from_utf8(validated.stdout).unwrap();
    let sentence = validated.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{validated}"));
    let percent = sentence.trim().split(" %").next().unwrap();
    assert!(doubts.contains(&format!("on other {percent} % of the time")), "{percent} in {doubts}");
    assert!(!said(&again).contains(words), "{}", said(&again));
}

#[test]
fn a_training_log_that_another_program_has_written_is_not_held_out() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, point] = ["instruments/truth.csv", "instruments/german_point.csv"].map(super::data);
    let says = ["german_point.csv: holds the samples of the training log", "truth.csv", "--hold-out"];
    let out = text(folder.path());
    refused(&["identify", text(&truth), "--validate-on", text(&point), "--out", out], &says);
    refused(&["identify", text(&truth), text(&point), "--out", out], &says);
    // A sixth of it, whichever of the two is named first.
    let part = folder.path().join("part.csv");
    let whole = fs::read_to_string(&truth).unwrap();
    let rows: Vec<&str> = whole.lines().collect();
    let sixth = rows.len() / 6;
    fs::write(&part, [&rows[..1], &rows[2 * sixth..3 * sixth]].concat().join("\n") + "\n").unwrap();
    let holds = ["holds the samples of the training log"];
    refused(&["identify", text(&truth), "--validate-on", text(&part), "--out", out], &holds);
    refused(&["identify", text(&part), "--validate-on", text(&truth), "--out", out], &holds);
    // Every third of its rows.
    let thirds: Vec<&str> = rows[1..].iter().step_by(3).copied().collect();
    fs::write(&part, [&rows[..1], &thirds].concat().join("\n") + "\n").unwrap();
    refused(&["identify", text(&truth), "--validate-on", text(&part), "--out", out], &holds);
}

#[test]
fn a_picture_of_a_log_is_not_named_after_another_format() {
    let folder = tempfile::tempdir().unwrap();
    let png = folder.path().join("log.png");
    refused(&["look", super::MEASURED, "--out", text(&png)], &["log.png: the picture is SVG", ".svg"]);
    assert!(!png.exists());
}

#[test]
fn a_sensor_s_scale_is_for_the_logs_in_volts_among_others() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, volts] = ["instruments/truth.csv", "instruments/sensor_in_volts.csv"].map(super::data);
    let out = text(folder.path());
    // They are one recording, which is found once both are read.
    let both = ["identify", text(&truth), "--validate-on", text(&volts), "--sensor", "10um/V", "--out", out];
    let holds = ["sensor_in_volts.csv: holds the samples of the training log"];
    refused(&both, &holds);
    let columns = ["--columns", "time=1,voltage=2,displacement=3:10um/V"];
    refused(&[&both[..4], &columns, &both[6..]].concat(), &holds);
    refused(&["identify", text(&truth), "--sensor", "10um/V", "--out", out], &["is in um", "leave the scale out"]);
}

#[test]
fn a_channel_without_a_unit_may_be_the_sensor_s_volts_first() {
    let saleae = super::data("instruments/saleae.csv");
    let said = refused(&["look", text(&saleae)], &["displacement=3:<N>um/V", "displacement=3:um"]);
    assert!(said.find("<N>um/V") < said.find("displacement=3:um"), "{said}");
}
