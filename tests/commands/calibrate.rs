//! Two readings into board.toml, on an emulated board that is wired otherwise than its file says.

use super::bench::Emulated;
use super::{json, number, piezo, refused, text};
use bench::{BoardFacts, EMULATED};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// What the file of the emulated board does not say: every span is off by some per cent.
const TRUTH: BoardFacts = BoardFacts {
    adc_span: Some((-33.8, 136.1)),
    drive_span: Some((-28.9, 131.7)),
    sensor_span: Some((-5.6, 25.2)),
    ..EMULATED
};

/// A folder's board.toml with a comment that is to be kept, and an emulated board that is wired by `TRUTH`.
fn wired_otherwise(folder: &Path, seed: &str) -> (String, Emulated) {
    let (board, wired) = (folder.join("board.toml"), folder.join("wired.toml"));
    if !board.exists() {
        std::fs::write(&board, format!("# room 4\n{}", EMULATED.to_toml())).unwrap();
    }
    std::fs::write(&wired, TRUTH.to_toml()).unwrap();
    let emulated = Emulated::start(&board, &["--wired", text(&wired), "--seed", seed, "--speed", "3"]);
    (text(&board).to_owned(), emulated)
}

/// The number behind a word of a line.
fn behind(line: &str, words: &str) -> f64 {
    let rest = line.split(words).nth(1).unwrap_or_else(|| panic!("{line}"));
    rest.trim().split(' ').next().unwrap().parse().unwrap_or_else(|_| panic!("{line}"))
}

/// Runs `calibrate` and types into it what the emulated instruments show; what it prints.
fn typed(arguments: &[&str], instrument: &str, emulated: &mut Emulated) -> String {
    let mut process = Command::new(env!("CARGO_BIN_EXE_piezo"))
        .args([&["calibrate", "--port", &*emulated.port.clone()], arguments].concat())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut stdin, stderr) = (process.stdin.take().unwrap(), process.stderr.take().unwrap());
    let mut asked = BufReader::new(stderr).lines().map(Result::unwrap);
    let mut question = asked.next();
    for volts in [10.0, 90.0] {
        let asks = question.unwrap();
        assert!(asks.contains(&format!("holds the amplifier at {volts} V")), "{asks}");
        // Where it has come to stand: by the file it is another voltage.
        let read = loop {
            let line = emulated.line();
            if (behind(&line, "output:") - volts).abs() < 5.0 {
                break behind(&line, instrument);
            }
        };
        // Mistyped first: that is asked for again.
        if instrument == "output:" {
            writeln!(stdin, "{}", read + 100.0).unwrap();
            let again = asked.next().unwrap();
            assert!(again.contains("was driven to") && again.contains("once more"), "{again}");
        }
        writeln!(stdin, "{read}").unwrap();
        question = asked.next();
        // It may still creep.
        while question.as_ref().is_some_and(|question| question.contains("does not stand still")) {
            writeln!(stdin, "{read}").unwrap();
            question = asked.next();
        }
    }
    let output = process.wait_with_output().unwrap();
    assert!(output.status.success(), "{question:?} {:?}", asked.collect::<Vec<_>>());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn two_readings_make_a_file_that_says_how_the_board_is_wired() {
    let folder = tempfile::tempdir().unwrap();
    let (board, mut emulated) = wired_otherwise(folder.path(), "1");
    assert!(emulated.next.ends_with(&format!("--board {board} --drive-to 10:90")), "{}", emulated.next);
    let before = std::fs::read_to_string(&board).unwrap();
    let driven = ["--board", &*board, "--drive-to", "10:90"];
    // Known before, and nothing is written.
    let dry = [
        &["calibrate", "--port", &*emulated.port, "--dry-run", "--json"],
        &driven[..],
        &["--low", "11", "--high", "91"],
    ];
    let found = json(piezo().args(dry.concat()));
    assert!(found["written"] == false && std::fs::read_to_string(&board).unwrap() == before);
    let noise = number(&found, "/points/0/noise_codes");
    assert!((0.5..20.0).contains(&noise), "{found}");

    let printed = typed(&driven, "output:", &mut emulated);
    for part in [
        "says now:",
        "drive_span = [",
        "(it was: drive_span = [-30.0, 130.0])",
        "board_uid = \"656d756c61746564",
        "noise",
    ] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    typed(&[&driven[..], &["--channel", "sensor"]].concat(), "display:", &mut emulated);
    let facts = BoardFacts::read(board.as_ref()).unwrap();
    let near = |found: Option<(f64, f64)>, truth: Option<(f64, f64)>, within: f64| {
        let (found, truth) = (found.unwrap(), truth.unwrap());
        assert!((found.0 - truth.0).abs() < within && (found.1 - truth.1).abs() < within, "{found:?}, not {truth:?}");
    };
    // The ADC bends by up to two codes of twelve bits, 0.083 V, and the DAC by up to four, 0.16 V, and the line through
    // two points is as much off again at the ends. The instruments show four places, and a stack creeps meanwhile.
    near(facts.adc_span, TRUTH.adc_span, 0.17);
    near(facts.drive_span, TRUTH.drive_span, 0.32);
    near(facts.sensor_span, TRUTH.sensor_span, 0.05);
    let after = std::fs::read_to_string(&board).unwrap();
    assert!(after.starts_with("# room 4\n") && after.contains("# V that it may be driven to"), "{after}");
    // It is at rest again, and nothing was amiss on the way but that it was there.
    let info = json(piezo().args(["info", "--json", "--port", &emulated.port]));
    assert_eq!(info["health"]["faults"], serde_json::json!(["SAFE_OUTPUT"]), "{info}");
    assert_eq!(info["identity"]["uid"], "656d756c6174656400000001");
}

#[test]
fn a_host_that_is_killed_while_it_waits_for_a_reading_leaves_the_amplifier_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let (board, mut emulated) = wired_otherwise(folder.path(), "1");
    let before = std::fs::read_to_string(&board).unwrap();
    let mut process = Command::new(env!("CARGO_BIN_EXE_piezo"))
        .args(["calibrate", "--board", &*board, "--drive-to", "60:90", "--port", &*emulated.port])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let question = BufReader::new(process.stderr.take().unwrap()).lines().next().unwrap().unwrap();
    assert!(question.contains("holds the amplifier at 60 V"), "{question}");
    while (behind(&emulated.line(), "output:") - 60.0).abs() > 5.0 {}
    process.kill().unwrap();
    process.wait().unwrap();
    // The next voltage at which it stands still. By the file, the rest is 0 V.
    let rest = behind(&emulated.line(), "output:");
    assert!(rest.abs() < 3.0, "{rest} V");
    assert_eq!(std::fs::read_to_string(&board).unwrap(), before);
}

#[test]
fn what_says_nothing_is_refused_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (board, emulated) = wired_otherwise(folder.path(), "1");
    let before = std::fs::read_to_string(&board).unwrap();
    let of = |more: &[&str], says: &[&str]| {
        let all = [&["calibrate", "--board", &*board, "--port", &*emulated.port], more].concat();
        refused(&all, says);
        assert_eq!(std::fs::read_to_string(&board).unwrap(), before);
    };
    of(&["--drive-to", "50:55", "--low", "50", "--high", "55"], &["codes apart", "a tenth and at nine tenths"]);
    of(&["--drive-to", "30:50", "--low", "40", "--high", "40"], &["40 and 40 do not differ"]);
    of(&["--drive-to", "10:90", "--low", "11", "--high", "900"], &["900 V", "the 90 V that", "mistyped"]);
    of(&["--drive-to", "90:10", "--low", "11", "--high", "91"], &["--drive-to 90:10", "stands first"]);
    of(&["--drive-to", "-20:90", "--low", "0", "--high", "90"], &["-20 V", "--drive-to 0:100 at most"]);
    of(&["--low", "5"], &["--high"]);
    let new = folder.path().join("new.toml");
    let driven = ["calibrate", "--board", text(&new), "--drive-to", "10:90", "--port", &*emulated.port];
    refused(&driven, &["does not say how far", "drive_range", "without --drive-to"]);
    assert!(!new.exists());
    of(&["--sensor", "2.5um/V"], &["--sensor is of --channel sensor"]);
    // Nobody types.
    of(&[], &["standard input ended", "--low and --high"]);
}

#[test]
fn a_calibration_belongs_to_its_board() {
    let folder = tempfile::tempdir().unwrap();
    let (board, emulated) = wired_otherwise(folder.path(), "1");
    let calibrate = ["--board", &*board, "--drive-to", "10:90", "--low", "11", "--high", "91"];
    piezo().args([&["calibrate", "--port", &*emulated.port], &calibrate[..]].concat()).assert().success();
    drop(emulated);
    let (_, other) = wired_otherwise(folder.path(), "2");
    let out = folder.path().join("out");
    let says = ["was measured on the board 656d756c6174656400000001", "--another-board"];
    for verb in [
        &["train", "--out", text(&out)][..],
        &["prove", "--out", text(&out)],
        &["install", "--line"],
        &["learn", "--out", text(&out)],
    ] {
        refused(&[verb, &["--board", &board, "--port", &other.port]].concat(), &says);
    }
    // One file is of one board, whatever the options say.
    let mixed = ["calibrate", "--low", "1", "--high", "2", "--another-board", "--board", &board, "--port", &other.port];
    refused(&mixed, &[says[0], "name a new file for this one with --board"]);
    let takes = ["install", "--line", "--rewired", "--another-board", "--board", &board, "--port", &other.port];
    piezo().args(takes).assert().success();
}
