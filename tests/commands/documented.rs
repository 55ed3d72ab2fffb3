//! Every command of the documents is run as a reader types it, one after the other, with an emulated board for his.

#[path = "../documents/lines.rs"]
mod lines;

use super::bench::Emulated;
use super::{data, piezo};
use lines::{called, code, documents, words};
use std::collections::HashSet;
use std::fs;
use tempfile::TempDir;

/// How lines begin that are not run, and why.
const NOT_RUN: [(&str, &str); 14] = [
    ("flash ", "needs a probe and a chip"),
    ("calibrate ", "asks what instruments show: tests/commands/calibrate.rs"),
    ("emulate --wired ", "what instruments show belongs to it: tests/commands/calibrate.rs"),
    ("emulate --speed 6 --flash ", "goes on with what was learnt: tests/commands/bench.rs"),
    ("follow ", "the demonstration's amplifier is one of 4 V, the emulated one of 100 V: tests/commands/follow.rs"),
    ("linearise ", "the emulated board has no set-point: tests/board/tests/image/linearise.rs"),
    ("waveform line.csv --on-trigger ", "the emulated board has no trigger: tests/board/tests/image/waveform.rs"),
    ("waveform --stop ", "the one before was not begun: tests/commands/waveform.rs"),
    ("zero --over-cycle ", "the emulated voltage rests: tests/commands/zero.rs"),
    ("identify logs/$1.csv ", "is a line of a script: tests/commands/fleet.rs"),
    ("collect $(sed ", "is a line of a script: tests/commands/fleet.rs"),
    ("reproduce elsewhere", "takes minutes: tests/commands/reproduce.rs"),
    ("reproduce all", "takes minutes: tests/commands/reproduce.rs"),
    ("reproduce --ranges", "takes minutes: tests/commands/reproduce.rs"),
];

/// What is typed behind lines that begin so: a reader waits for minutes, ends it, or is asked and says yes.
const MORE: [(&str, &str); 10] = [
    ("identify ", "--evaluations 4 --devices 2"),
    ("identify my-stack ", "--model prandtl-ishlinskii"),
    ("compare ", "--budget 12"),
    ("train ", "--minutes 0.7"),
    ("reproduce", "--population 8 --generations 3 --rounds 2 --evaluations 20"),
    ("learn ", "--minutes 0.7 --proof-seconds 20 -- --model prandtl-ishlinskii --evaluations 4 --devices 4"),
    ("monitor ", "--seconds 1"),
    ("push ", "--doubted"),
    // The emulated board drives, which the chapter's does not.
    ("push out/board/", "--rewired"),
    ("install ", "--doubted"),
];

/// A folder of a reader's, and the board in front of him.
struct Reader {
    folder: TempDir,
    board: Option<Emulated>,
}

impl Reader {
    /// With the files that the documents take for granted, and those that this one shows.
    fn of(document: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] =
            ["picma-p885-1hz.csv", "picma-p885-session2.csv"].map(|name| fs::read_to_string(data(name)).unwrap());
        for (names, text) in [
            ("tests/data/picma-p885-1hz.csv recording.csv your-log.csv logs/SN042.csv", first.clone()),
            ("tests/data/picma-p885-session2.csv day2.csv later.csv voltage.csv", second),
            ("day1/a.csv day1.csv", rows(&first, 0, 4_000)),
            ("day1/b.csv day3.csv", rows(&first, 4_000, 8_000)),
            ("other.csv", rows(&first, 2_000, 6_000)),
        ] {
            for name in names.split(' ') {
                let path = folder.path().join(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, &text).unwrap();
            }
        }
        let wanted = document.split("```text\n").find(|block| block.starts_with("time_s,displacement_um\n"));
        for name in ["wanted.csv", "line.csv"] {
            if let Some(wanted) = wanted {
                fs::write(folder.path().join(name), wanted.split("```").next().unwrap()).unwrap();
            }
        }
        Self { folder, board: None }
    }

    /// Types a line; what it says where it fails.
    fn types(&mut self, mut line: Vec<String>) -> Option<String> {
        let board = self.folder.path().join("board.toml");
        if line[0] == "emulate" {
            let more: Vec<&str> = line[1..].iter().map(String::as_str).collect();
            self.board = Some(Emulated::start(&board, &more));
            return None;
        }
        let mut command = piezo();
        if line.iter().any(|word| word == "--port" || word == "--board") {
            let board = self.board.get_or_insert_with(|| Emulated::start(&board, &["--speed", "6"]));
            for word in line.iter_mut().filter(|word| word.starts_with("/dev/") || word.starts_with("tcp:")) {
                board.port.clone_into(word);
            }
            command.env("PIEZO_PORT", &board.port);
        }
        // `MORE` has fewer.
        if let Some(minutes) = line.iter().position(|word| word == "--minutes") {
            line.drain(minutes..minutes + 2);
        }
        let typed = line.join(" ");
        let more = MORE.iter().filter(|(start, _)| typed.starts_with(start)).flat_map(|(_, more)| more.split(' '));
        let output = command.current_dir(self.folder.path()).args(&line).args(more).output().unwrap();
        (!output.status.success()).then(|| format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

/// A log of some rows of another.
fn rows(log: &str, from: usize, to: usize) -> String {
    let head = log.lines().take_while(|line| !line.starts_with(|first: char| first.is_ascii_digit())).count();
    let kept = |row: &usize| *row < head || (head + from..head + to).contains(row);
    log.lines().enumerate().filter(|(row, _)| kept(row)).map(|(_, line)| format!("{line}\n")).collect()
}

#[test]
fn every_command_of_the_documents_succeeds() {
    let (mut unused, mut failed) = (NOT_RUN.map(|(start, _)| start).to_vec(), Vec::new());
    let mut before: Option<Reader> = None;
    let mut identified = HashSet::new();
    for (path, text) in documents() {
        let mut reader = Reader::of(&text);
        // Later chapters take the tables of earlier ones.
        if let Some(tables) = before.as_ref().map(|before| before.folder.path().join("out")).filter(|it| it.exists()) {
            fs::rename(tables, reader.folder.path().join("out")).unwrap();
        }
        for line in code(&text).0.iter().filter_map(|line| called(line)) {
            let typed = words(line);
            let joined = typed.join(" ");
            if let Some((start, _)) = NOT_RUN.iter().find(|(start, _)| joined.starts_with(start)) {
                unused.retain(|unused| unused != start);
                continue;
            }
            // What an earlier chapter has identified in the same words is there.
            if joined.starts_with("identify ") && joined.contains(" --out out/") && !identified.insert(joined) {
                continue;
            }
            failed.extend(reader.types(typed).map(|why| format!("{}: {line}\n{why}", path.display())));
        }
        before = Some(reader);
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    assert_eq!(unused, Vec::<&str>::new(), "no document has such lines");
}
