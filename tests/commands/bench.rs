//! From a board and a sensor to a proven table, on an emulated board, as it is typed.

use super::{json, number, piezo, refused, text};
use std::io::{BufRead, BufReader, Lines};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// `piezo emulate` while it runs, where it listens, and what else it prints.
pub struct Emulated {
    process: Child,
    pub port: String,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Emulated {
    /// Wired as the file says, which is written where there is none.
    pub fn start(board: &Path, more: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_piezo"))
            .args(["emulate", "--device", "bouc-wen", "--tcp-port", "0", "--board", text(board)])
            .args(more)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        // The command that is to be typed next.
        let next = lines.by_ref().map(Result::unwrap).find(|line| line.contains("--port tcp:")).unwrap();
        let port = next.split(' ').find(|word| word.starts_with("tcp:")).unwrap().to_owned();
        Self { process, port, lines }
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
fn learn_ends_with_a_table_that_is_installed_and_proven() {
    let folder = tempfile::tempdir().unwrap();
    let (board, out) = (folder.path().join("board.toml"), folder.path().join("p885"));
    let emulated = Emulated::start(&board, &["--speed", "8"]);
    let (board, port) = (text(&board), &*emulated.port);
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
    let printed = piezo().args(&learn).assert().success().get_output().stdout.clone();
    let printed = String::from_utf8(printed).unwrap();
    for part in ["the device has, as before, no model", "bit-exact", "PASS: the table's ± holds the sensor"] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    // What comes next it types itself, and what identify has said install does not say again.
    for part in ["Next:", "- careful:"] {
        assert!(!printed.contains(part), "{part:?} is said in\n{printed}");
    }
    assert!(out.join("held-out.csv").is_file() && !out.join("proof.csv").exists());
    // Again, it has nothing left to do. A second session does not mix its logs with those of the first.
    refused(&learn, &["proof: is there already", "choose another --out, or prove again: `piezo prove --out`"]);
    let train = ["train", "--minutes", "0.7", "--up-to", "20", "--port", port, "--board", board, "--out", text(&out)];
    let identify = format!("--out {}/model --board {board}", text(&out));
    refused(&train, &["which is whole: choose another --out, or learn from it", &identify]);
    // What was recorded need not be recorded again.
    std::fs::remove_dir_all(out.join("proof")).unwrap();
    let printed = piezo().args(&learn).assert().success().get_output().stdout.clone();
    let printed = String::from_utf8(printed).unwrap();
    assert!(printed.contains("has a whole session, which is learnt from as it is: nothing is recorded"), "{printed}");
    assert!(!printed.contains("$ piezo train") && printed.contains("PASS: "), "{printed}");
    // What it has left is in use: it proves again, on another draw, and is told from a table that is not good enough.
    let again = ["--seconds", "8", "--up-to", "20", "--seed", "9", "--json", "--board", board, "--port", port];
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
