//! From a board and a sensor to a proven table, on an emulated board, as it is typed.

use super::{json, number, piezo, refused, text};
use std::io::{BufRead, BufReader, Lines};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// `piezo emulate` while it runs, where it listens, and what else it prints.
pub struct Emulated {
    process: Child,
    pub port: String,
    pub next: String,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Emulated {
    /// Wired as the file says, which is written where there is none.
    pub fn start(board: &Path, more: &[&str]) -> Self {
        Self::device("bouc-wen", board, more)
    }

    /// The same with another kind of actuator.
    fn device(kind: &str, board: &Path, more: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_piezo"))
            .args(["emulate", "--device", kind, "--tcp-port", "0", "--board", text(board)])
            .args(more)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        // The command that is to be typed next.
        let next = lines.by_ref().map(Result::unwrap).find(|line| line.contains("--port tcp:")).unwrap();
        let port = next.split(' ').find(|word| word.starts_with("tcp:")).unwrap().to_owned();
        Self { process, port, next, lines }
    }

    /// The next line that it prints.
    pub fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

#[test]
fn learn_ends_with_a_proven_table_on_other_devices_too() {
    let learn = |(kind, seed)| {
        let folder = tempfile::tempdir().unwrap();
        let (board, out) = (folder.path().join("board.toml"), folder.path().join("learnt"));
        let emulated = Emulated::device(kind, &board, &["--speed", "8", "--seed", seed]);
        let learn = ["learn", "--port", &emulated.port, "--board", text(&board), "--out", text(&out)];
        let short = ["--minutes", "0.8", "--up-to", "20", "--proof-seconds", "20"];
        let search = ["--", "--model", "generalised-prandtl-ishlinskii", "--evaluations", "6", "--devices", "4"];
        let learnt = piezo().args([&learn[..], &short, &search].concat()).assert().success().get_output().clone();
        let printed = String::from_utf8(learnt.stdout).unwrap();
        assert!(printed.contains("PASS: the table's ± holds the sensor"), "{kind} {seed}: {printed}");
        let info = json(piezo().args(["info", "--json", "--port", &emulated.port]));
        let in_use = format!("checksum {}) is stored, and in use", info["checksum"].as_str().unwrap());
        assert!(printed.contains(&in_use), "{kind} {seed}: {in_use:?} is missing in\n{printed}");
    };
    std::thread::scope(|scope| {
        for device in [("relays", "2"), ("rate-dependent", "3")] {
            scope.spawn(move || learn(device));
        }
    });
}

#[test]
fn learn_ends_with_a_table_that_is_installed_and_proven() {
    let folder = tempfile::tempdir().unwrap();
    let (board, out) = (folder.path().join("board.toml"), folder.path().join("p885"));
    let flash = folder.path().join("flash.bin");
    let fast = ["--speed", "8", "--flash", text(&flash)];
    let emulated = Emulated::start(&board, &fast);
    let (path, port) = (&board, &*emulated.port);
    let board = text(path);
    let short = ["--minutes", "0.7", "--up-to", "20", "--proof-seconds", "20"];
    let search = ["--", "--model", "prandtl-ishlinskii", "--evaluations", "4", "--devices", "4"];
    // Until it has learnt, it says so and neither zeroes nor follows.
    let info = piezo().args(["info", "--port", port]).assert().success().get_output().stdout.clone();
    assert!(String::from_utf8(info).unwrap().contains("no model: a straight line for measuring"));
    refused(&["zero", "--port", port], &["no model", "piezo train"]);
    let learn = [&["learn", "--port", port, "--board", board, "--out", text(&out)], &short[..], &search[..]].concat();
    // What identify would not understand is refused before anything moves.
    refused(&[&learn[..], &["--modle", "voigt"]].concat(), &["unexpected argument '--modle'"]);
    assert!(!out.exists());
    let would = |learn: &[&str]| {
        let output = piezo().args(["learn", "--dry-run"]).args(&learn[1..]).assert().success().get_output().clone();
        String::from_utf8(output.stdout).unwrap()
    };
    let said = would(&learn);
    for part in ["$ piezo train --port", " reversal curves", "\n    piezo identify ", "--devices 4\n    piezo install "]
    {
        assert!(said.contains(part), "{part:?} is missing in\n{said}");
    }
    assert!(said.trim_end().lines().last().unwrap().starts_with("    piezo prove --out ") && said.lines().count() < 24);
    assert!(!out.exists(), "nothing is driven and nothing written");
    let learnt = piezo().args(&learn).assert().success().get_output().clone();
    let (printed, warned) = (String::from_utf8(learnt.stdout).unwrap(), String::from_utf8(learnt.stderr).unwrap());
    assert!(!warned.contains("the board's range"), "it was learnt on all of it: {warned}");
    for part in ["the device has, as before, no model", "bit-exact", "PASS: the table's ± holds the sensor"] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    // What comes next it types itself, and what identify has said install does not say again.
    assert!(!printed.contains("Next:") && !warned.contains("table.toml: "), "{printed}\n{warned}");
    assert!(out.join("held-out.csv").is_file() && !out.join("proof.csv").exists());
    // Again, it has nothing left to do. A second session does not mix its logs with those of the first.
    refused(&learn, &["proof: is there already", "choose another --out, or prove again: `piezo prove --out`"]);
    let train = ["train", "--minutes", "0.7", "--up-to", "20", "--port", port, "--board", board, "--out", text(&out)];
    let identify = format!("--out {}/model --board {board}", text(&out));
    refused(&train, &["which is whole: choose another --out, or learn from it", &identify]);
    // A proof says what it would do, and leaves the zero and everything else.
    let before = json(piezo().args(["info", "--port", port, "--json"]));
    let elsewhere = folder.path().join("elsewhere");
    let prove = ["prove", "--dry-run", "--seconds", "9", "--board", board, "--port", port, "--out", text(&elsewhere)];
    let said = String::from_utf8(piezo().args(prove).assert().success().get_output().stdout.clone()).unwrap();
    for part in ["over 0 … 100 V", "the board forgets the one", "up to 20 Hz, by seed 2", "proven.csv", "PASS where"]
    {
        assert!(said.contains(part), "{part:?} is missing in\n{said}");
    }
    // Limits are said as they are typed.
    let less = folder.path().join("less.toml");
    let facts =
        std::fs::read_to_string(board).unwrap().replace("drive_range = [0.0, 100.0]", "drive_range = [0.0, 99.9]");
    std::fs::write(&less, facts).unwrap();
    let dry = |board| ["prove", "--dry-run", "--json", "--board", board, "--port", port, "--out", text(&elsewhere)];
    let said = json(piezo().args(dry(text(&less))));
    let list = said["would"].as_array().unwrap();
    assert!(list[0].as_str().unwrap().contains("from rest at 0 V over 0 … 99.9 V, at "), "{said}");
    assert!(list.len() == 5 && said["refused"].as_array().unwrap().is_empty(), "{said}");
    let after = json(piezo().args(["info", "--port", port, "--json"]));
    assert_eq!(number(&after, "/health/bias_um"), number(&before, "/health/bias_um"));
    assert!(number(&after, "/health/bias_age_ticks") > number(&before, "/health/bias_age_ticks"));
    assert!(!elsewhere.exists());
    // Without --out it is a folder of that name beside where the command is typed.
    let here = piezo().args(&prove[..8]).current_dir(folder.path()).assert().success().get_output().stdout.clone();
    let here = String::from_utf8(here).unwrap();
    assert!(here.contains("- proof/proven.csv: "), "{here}");
    // What was recorded need not be recorded again, and a range that is typed is meant.
    std::fs::remove_dir_all(out.join("proof")).unwrap();
    assert!(would(&learn).contains("has a whole session, which would be learnt from as it is"));
    let (range, wide) = ("drive_range = [0.0, 100.0]", folder.path().join("wide.toml"));
    let facts = std::fs::read_to_string(board).unwrap().replace(range, "drive_range = [0.0, 115.0]");
    std::fs::write(&wide, facts).unwrap();
    let link = ["learn", "--port", port, "--board", text(&wide), "--out", text(&out)];
    // One that is not typed is the board's. A table without a ± is not proven without more.
    let brief = ["--", "--model", "prandtl-ishlinskii", "--evaluations", "4", "--devices", "0"];
    let only_part = "the table knows only part of the board's range: it was learnt on";
    refused(&[&link[..], &short, &brief].concat(), &[only_part, "0 … 115 V", "states no ±"]);
    let range = ["--range", "0:100"];
    let learnt = piezo().args([&link[..], &range, &short, &search].concat()).assert().success().get_output().clone();
    let (printed, warned) = (String::from_utf8(learnt.stdout).unwrap(), String::from_utf8(learnt.stderr).unwrap());
    assert!(!warned.contains("the board's range"), "{warned}");
    assert!(printed.contains("has a whole session, which is learnt from as it is: nothing is recorded"), "{printed}");
    assert!(!printed.contains("$ piezo train") && printed.contains("PASS: "), "{printed}");
    // A model that is no better than a straight line is not installed over it.
    std::fs::remove_dir_all(out.join("proof")).unwrap();
    let poor = ["--", "--model", "voigt", "--generations", "2", "--population", "8", "--devices", "0"];
    let ended = piezo().args([&link[..], &range, &short, &poor].concat()).assert().code(1).get_output().clone();
    let printed = String::from_utf8(ended.stdout).unwrap();
    assert!(printed.contains("belongs on no board") && !printed.contains("$ piezo install"), "{printed}");
    assert!(printed.contains("\nFAILED: identify ends so, and this was not begun: piezo install "), "{printed}");
    // What it has left is in use: it proves again, on another draw, and is told from a table that is not good enough.
    let again = ["--minutes", "0.14", "--up-to", "20Hz", "--seed", "9", "--json", "--board", board, "--port", port];
    let proof = out.join("again");
    let prove = [&["prove", "--out", text(&proof)], &again[..]].concat();
    let figures = json(piezo().args(&prove));
    assert!(figures["passed"] == true && number(&figures, "/figures/mae_percent") < 3.0, "{figures}");
    refused(&prove, &["proven.csv: is there already", "choose another --out"]);
    let other = out.join("other");
    let fails = [&["prove", "--out", text(&other), "--max-percent", "0.001", "--range", "0:80"], &again[..]].concat();
    piezo().args(&fails).assert().code(1);
    let log = recordings::log::read(&proof.join("proven.csv"), &Default::default()).unwrap();
    assert!(log.displacement.is_some() && !log.displacement_estimated);
    // 8.4 s, and what the device has waited for a busy host, at a held voltage.
    assert!((5.0..30.0).contains(&log.duration()), "{} s", log.duration());
    // With the same table against a spring, a proof sees that it is no longer true.
    let before = json(piezo().args(["info", "--port", port, "--json"]));
    drop(emulated);
    let loaded = Emulated::start(path, &[&fast[..], &["--load", "0.2"]].concat());
    let info = json(piezo().args(["info", "--port", &loaded.port, "--json"]));
    assert_eq!(info["identity"]["table_crc"], before["identity"]["table_crc"], "{info}");
    let against = out.join("loaded");
    let prove = ["prove", "--out", text(&against), "--seconds", "8", "--up-to", "20", "--board", board];
    let ends = piezo().args(prove).args(["--port", &loaded.port]).assert().code(1).get_output().clone();
    let printed = String::from_utf8(ends.stdout).unwrap();
    assert!(printed.contains("FAIL: ") && printed.contains("is its load the same"), "{printed}");
}

#[test]
fn a_flash_in_a_file_outlives_its_board() {
    let folder = tempfile::tempdir().unwrap();
    let (board, flash) = (folder.path().join("board.toml"), folder.path().join("flash.bin"));
    let run = |more: &[&str]| {
        let emulated = Emulated::start(&board, &["--speed", "8", "--flash", text(&flash)]);
        let source = json(piezo().args(["info", "--json", "--port", &emulated.port]))["identity"]["source"].clone();
        if !more.is_empty() {
            piezo().args([more, &["--port", &emulated.port]].concat()).assert().success();
        }
        source
    };
    assert_eq!(run(&["erase", "--reset", "--rewired"]), "Stored");
    assert!(run(&[]).get("Compiled").is_some(), "what was erased came back");
    std::fs::write(&flash, "no flash").unwrap();
    let other = ["emulate", "--tcp-port", "0", "--board", text(&board), "--flash", text(&flash)];
    refused(&other, &["flash.bin", "it has 8 bytes"]);
}

#[test]
fn a_session_that_was_killed_is_learnt_from_as_far_as_it_went() {
    let folder = tempfile::tempdir().unwrap();
    let (out, board) = (folder.path().join("p885"), folder.path().join("board.toml"));
    let emulated = Emulated::start(&board, &["--speed", "8"]);
    let link = ["--port", &*emulated.port, "--board", text(&board), "--out", text(&out)];
    let train = [&["train", "--minutes", "0.7", "--up-to", "20"], &link[..]].concat();
    let mut killed = Command::new(env!("CARGO_BIN_EXE_piezo")).args(&train).stdout(Stdio::null()).spawn().unwrap();
    let under_way = out.join("03-reversals.csv");
    let length = || std::fs::metadata(&under_way).map_or(0, |log| log.len());
    let start = Instant::now();
    while length() < 100_000 {
        assert!(start.elapsed() < Duration::from_secs(60) && killed.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    // While it is learnt from it stands still, so that a slow machine learns from no more logs than a fast one.
    let stopped = Command::new("kill").args(["-STOP", &killed.id().to_string()]).status().unwrap();
    assert!(stopped.success());
    let model = folder.path().join("model");
    let short = ["--model", "voigt", "--generations", "5", "--rounds", "1", "--devices", "0"];
    let identify = ["identify", text(&out), "--board", text(&board), "--out", text(&model)];
    let learnt = || {
        let learnt = piezo().args(identify).args(short).assert().success().get_output().stderr.clone();
        String::from_utf8(learnt).unwrap()
    };
    let while_recorded = learnt();
    let begun = "the session is still being recorded: 3 of 8 logs are there so far, 03-reversals.csv cut short";
    assert!(while_recorded.contains(begun) && while_recorded.contains("wait until it has ended"), "{while_recorded}");
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(std::fs::read_to_string(&under_way).unwrap().ends_with('\n'), "a row is cut in the middle");
    let learnt = learnt();
    let ended =
        "the session ended before its time: 3 of 8 logs are there, 03-reversals.csv cut short, none to prove with";
    assert!(learnt.contains(ended), "{learnt}");
    // The table carries that, and the device says where a model may be that it had before.
    let table = std::fs::read_to_string(model.join("table.toml")).unwrap();
    assert!(table.contains(ended) && table.contains("or record another"), "{table}");
    let info = piezo().args(["info", "--port", &emulated.port]).assert().success().get_output().stdout.clone();
    let info = String::from_utf8(info).unwrap();
    assert!(info.contains("its folder keeps the table of before as former-table.bin"), "{info}");
    refused(&train, &[ended, "choose another --out, or learn from what is there"]);
}

#[test]
fn a_session_that_is_unfinished_is_said_to_be_and_not_planned_anew() {
    let folder = tempfile::tempdir().unwrap();
    let (out, board) = (folder.path().join("p885"), folder.path().join("board.toml"));
    std::fs::create_dir(&out).unwrap();
    let log = "[[logs]]\nlog = \"01-steps.csv\"\nheld_out = false\ncomplete = true\n";
    std::fs::write(out.join("01-steps.csv"), "time_s,voltage_V,displacement_um\n").unwrap();
    for verb in ["learn", "train"] {
        let dry = [verb, "--dry-run", "--port", "tcp:127.0.0.1:1", "--board", text(&board), "--out", text(&out)];
        // A device is not looked for, either.
        for typed in [&dry[..], &[&dry[..1], &dry[2..]].concat()] {
            std::fs::write(out.join("session.toml"), format!("complete = false\nseed = 1\nplanned = 7\n{log}"))
                .unwrap();
            let learn =
                format!("learn from what is there:\n    piezo identify {0} --out {0}/model --board ", text(&out));
            let said =
                refused(typed, &["from a session before", "1 of 7 logs are there", "choose another --out", &learn]);
            assert!(!said.contains("prove again"), "{said}");
            std::fs::write(out.join("session.toml"), "complete = false\nseed = 1\nplanned = 7\nlogs = []\n").unwrap();
            let said = refused(typed, &["0 of 7 logs are there", "choose another --out"]);
            assert!(!said.contains("piezo identify"), "{said}");
        }
    }
}

#[test]
fn a_table_of_another_range_is_said_to_be_one_and_what_a_proof_fails_for() {
    let folder = tempfile::tempdir().unwrap();
    let board = folder.path().join("board.toml");
    let emulated = Emulated::start(&board, &["--speed", "8"]);
    let (board, port) = (text(&board), &*emulated.port);
    let link = ["--board", board, "--port", port];
    let narrow = [&["install", "tests/data/table/table.toml"], &link[..]].concat();
    refused(&narrow, &["2.1 % of what the board's ADC reads", "--voltage-scale", "--narrow"]);
    let looked_at = piezo().args(&narrow).arg("--dry-run").assert().code(1).get_output().stdout.clone();
    let looked_at = String::from_utf8(looked_at).unwrap();
    assert!(looked_at.contains("but would be refused; nothing was written"), "{looked_at}");
    assert!(looked_at.contains(" as calibrated for this board; made from f4462648)"), "{looked_at}");
    let doubted = [&narrow[..], &["--narrow"]].concat();
    refused(&doubted, &["table.toml: the training logs have a single amplitude", "has doubts", "--doubted"]);
    let install = [&doubted[..], &["--doubted"]].concat();
    // That it knows none of the board's voltages is one of the doubts that are asked about.
    let range = ("drive_range = [0.0, 100.0]", "drive_range = [-20.0, 0.0]");
    let elsewhere = folder.path().join("elsewhere.toml");
    std::fs::write(&elsewhere, std::fs::read_to_string(board).unwrap().replace(range.0, range.1)).unwrap();
    let none = ["install", "tests/data/table/table.toml", "--narrow", "--dry-run", "--json", "--board"];
    let none = piezo().args(none).arg(&elsewhere).args(["--port", port]).assert().code(1).get_output().stdout.clone();
    let none: serde_json::Value = serde_json::from_slice(&none).unwrap();
    let of_this =
        |doubt: &serde_json::Value| doubt.as_str().is_some_and(|said| said.contains("is it this actuator's?"));
    assert!(none["doubts"].as_array().unwrap().iter().any(of_this), "{none}");
    let line = [&["install", "--line", "--dry-run"], &link[..]].concat();
    let line = piezo().args(&line).assert().success().get_output().stdout.clone();
    let line = String::from_utf8(line).unwrap();
    assert!(line.contains("a straight line (checksum ") && !line.contains("Prandtl"), "{line}");
    let dry = piezo().args(&install).arg("--dry-run").assert().success().get_output().clone();
    let printed = String::from_utf8(dry.stdout).unwrap();
    assert!(printed.contains("fits") && printed.contains("nothing was written"), "{printed}");
    let info = piezo().args(["info", "--port", port]).assert().success().get_output().stdout.clone();
    assert!(String::from_utf8(info).unwrap().contains("no model: a straight line for measuring"));
    // A divider that inverts is possible, and most often a slip.
    let turned = folder.path().join("turned.toml");
    let file =
        std::fs::read_to_string(board).unwrap().replace("adc_span = [-35.0, 135.0]", "adc_span = [135.0, -35.0]");
    std::fs::write(&turned, file).unwrap();
    let turned = ["install", "tests/data/table/table.toml", "--dry-run", "--board", text(&turned), "--port", port];
    let said = String::from_utf8(piezo().args(turned).assert().code(1).get_output().stderr.clone()).unwrap();
    assert!(said.contains("adc_span falls from 135 V at code 0 to -35 V"), "{said}");
    let installed = piezo().args(&install).arg("--json").assert().success().get_output().clone();
    let printed = String::from_utf8(installed.stdout.clone()).unwrap();
    assert!(!printed.contains("calibration is assumed") && printed.contains("\"written\": true"), "{printed}");
    let said = String::from_utf8(installed.stderr).unwrap();
    for part in [
        "knows only part of the board's range",
        "0 … 3.6 V",
        "0 … 100 V",
        "--range 0:3.6",
        "--range 0:100 --out '<FOLDER>' --board",
    ] {
        assert!(said.contains(part), "{part:?} is missing in\n{said}");
    }
    let proof = folder.path().join("proof");
    let prove = ["prove", "--out", text(&proof), "--seconds", "8", "--max-percent", "2"];
    let failed = piezo().args([&prove[..], &link].concat()).assert().code(1).get_output().stdout.clone();
    let printed = String::from_utf8(failed).unwrap();
    assert!(printed.contains("FAIL") && !printed.contains("Train again, longer"), "{printed}");
    assert!(printed.contains("is it this actuator's table"), "{printed}");
    // Who has seen enough stops it: nothing is proven, and the voltage is at rest.
    let proof = folder.path().join("stopped");
    let prove = ["prove", "--json", "--out", text(&proof), "--seconds", "600", "--max-percent", "2"];
    let mut host = Command::new(env!("CARGO_BIN_EXE_piezo"))
        .args([&prove[..], &link].concat())
        .current_dir(super::root())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (log, start) = (proof.join("proven.csv"), Instant::now());
    while log.metadata().map_or(0, |log| log.len()) < 20_000 {
        assert!(start.elapsed() < Duration::from_secs(60) && host.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &host.id().to_string()]).status().unwrap().success());
    let ended = host.wait_with_output().unwrap();
    let (printed, said) = [ended.stdout, ended.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).into();
    assert!(ended.status.code() == Some(1) && printed.contains("\"complete\": false"), "{printed}{said}");
    assert!(said.contains("nothing is proven, and the voltage has gone back to rest; "), "{said}");
    let info = json(piezo().args(["info", "--json", "--port", port]));
    assert_eq!(info["health"]["mode"], "Estimate", "{info}");
}
