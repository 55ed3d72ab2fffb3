//! A full disk while a verb drives an actuator: the file is named, what was measured stays in whole lines, and the
//! device is at rest, in its own table, and of use.

use super::bench::Emulated;
use super::full::{held, limited};
use super::{json, piezo, text};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// An emulated board with a folder.
struct Bench {
    folder: tempfile::TempDir,
    emulated: Emulated,
}

impl Bench {
    fn new(speed: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let emulated = Emulated::start(&folder.path().join("board.toml"), &["--speed", speed]);
        Self { folder, emulated }
    }

    fn path(&self, name: &str) -> String {
        text(&self.folder.path().join(name)).to_owned()
    }

    fn info(&self) -> serde_json::Value {
        json(piezo().args(["info", "--json", "--port", &self.emulated.port]))
    }

    /// Runs a verb of this bench where files may be so long, in blocks of 512 bytes; it fails, and names one of these
    /// files. Says what it said.
    fn fails(&self, blocks: u32, verb: &[&str], names: &[&str]) -> String {
        let before = self.info()["identity"]["table"].clone();
        let board = self.path("board.toml");
        let link = ["--port", &*self.emulated.port, "--board", &board];
        let link = if verb[0] == "follow" { &link[..2] } else { &link[..] };
        let done = limited(blocks, &[verb, link].concat());
        let said = [done.stdout, done.stderr].concat();
        let said = String::from_utf8_lossy(&said).into_owned();
        assert!(matches!(done.status.code(), Some(1 | 2)), "{verb:?} with {blocks}: {said}");
        assert!(names.iter().any(|name| said.contains(name)), "{verb:?} with {blocks}: {said}");
        assert!(said.contains("File too large") && !said.contains("panicked") && !said.contains(".piezo-"), "{said}");
        let info = self.info();
        assert_eq!(info["health"]["mode"], "Estimate", "{verb:?} with {blocks}: {info}");
        assert_eq!(info["health"]["faults"], serde_json::json!(["SAFE_OUTPUT"]), "{verb:?} with {blocks}: {info}");
        assert_eq!(info["identity"]["table"], before, "{verb:?} with {blocks}");
        said
    }
}

/// Rows of the logs in a folder; each ends as a line does and has as many fields as the first.
fn rows(files: &BTreeMap<String, Vec<u8>>) -> BTreeMap<&str, usize> {
    let logs = files.iter().filter(|(name, _)| name.contains(".csv"));
    logs.map(|(name, bytes)| {
        let text = String::from_utf8(bytes.clone()).unwrap();
        let commas = |line: &str| line.matches(',').count();
        let of = text.lines().next().map_or(0, commas);
        assert!(text.ends_with('\n') && of >= 2 && text.lines().all(|line| commas(line) == of), "{name}: {text}");
        (&**name, text.lines().count() - 1)
    })
    .collect()
}

#[test]
fn a_session_that_cannot_be_written_rests_and_keeps_its_whole_lines() {
    let bench = Bench::new("8");
    for (number, blocks) in [0, 1, 20, 300].into_iter().enumerate() {
        let out = bench.path(&format!("out{number}"));
        let said = bench.fails(
            blocks,
            &["train", "--minutes", "0.7", "--up-to", "20", "--out", &out],
            &["01-first-branch.csv: cannot be", "session.toml: cannot be", "02-"],
        );
        let files = held(Path::new(&out));
        assert_eq!(rows(&files).values().any(|&rows| rows > 50), blocks > 1, "{blocks}: {said}");
        assert!(!files.contains_key("former-table.bin"), "{blocks}: {:?}", files.keys());
    }
}

#[test]
fn a_proof_and_what_is_followed_that_cannot_be_written_rest_and_keep_their_whole_lines() {
    let bench = Bench::new("4");
    let table = super::data("table/table.toml");
    let board = bench.path("board.toml");
    let install = ["install", text(&table), "--doubted", "--narrow", "--board", &board, "--port", &bench.emulated.port];
    piezo().args(install).assert().success();
    let wanted = bench.path("wanted.csv");
    let row = |k: u32| format!("{:.3},{:.5}\n", f64::from(k) * 1e-3, 2.0 + (f64::from(k) * 6e-3).sin());
    fs::write(&wanted, format!("time_s,displacement_um\n{}", (0..2000).map(row).collect::<String>())).unwrap();
    for blocks in [0, 1, 20] {
        let out = bench.path(&format!("proof{blocks}"));
        let prove = ["prove", "--seconds", "9", "--up-to", "20", "--max-percent", "5", "--out", &out];
        bench.fails(blocks, &prove, &["proven.csv: cannot be"]);
        // With room for nothing there is not even the folder.
        let kept = held(Path::new(&out));
        assert_eq!(rows(&kept).values().any(|&rows| rows > 10), blocks > 0, "{blocks}: {:?}", kept.keys());

        fs::create_dir(bench.path("followed")).unwrap();
        let log = bench.path("followed/log.csv");
        fs::write(&log, "of before").unwrap();
        let said = bench.fails(blocks, &["follow", &wanted, "--force", "--out", &log], &["log.csv: cannot be written"]);
        let mut kept = held(Path::new(&bench.path("followed")));
        assert_eq!(kept.remove("log.csv").unwrap(), b"of before");
        assert_eq!(said.contains("log.csv.partial holds the samples before"), blocks > 0, "{said}");
        assert_eq!(rows(&kept).values().any(|&rows| rows > 5), blocks > 0, "{blocks}: {:?}", kept.keys());
        fs::remove_dir_all(bench.path("followed")).unwrap();
    }
}

#[test]
fn a_board_file_that_cannot_be_written_is_as_it_was() {
    let bench = Bench::new("3");
    let before = held(bench.folder.path());
    let calibrate = ["calibrate", "--drive-to", "10:90", "--low", "11", "--high", "91"];
    for blocks in [0, 1] {
        bench.fails(blocks, &calibrate, &["board.toml: cannot be written"]);
        assert!(held(bench.folder.path()) == before, "{blocks}");
    }
}
