//! `learn` is killed in any of its parts: what it leaves is at rest, has a table that somebody knows, and is gone on
//! with by what the program then says.

use super::killed_driving::{Before, Driven, rows};
use super::{piezo, text};
use ::bench::{FORMER, emulated, for_board, session};
use device_link::table::to_record;
use link_attacks::ticks_on;
use plants::{Density, Kind};
use protocol::Record;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// What is seen in the folder of a `learn` once it has come to a part.
type Seen = fn(&Path) -> bool;
const PARTS: [(&str, Seen); 4] = [
    ("its training", |out| out.join("02-shrinking.csv").exists() || out.join("03-reversals.csv").exists()),
    ("its identification", |out| session(out).is_ok_and(|session| session.complete)),
    ("its installation", |out| out.join("model/table.bin").exists()),
    ("its proof", |out| out.join("proof").exists()),
];
/// So long after that it is killed.
const AFTER: Duration = Duration::from_millis(200);
/// Devices for each part: on a busy machine a session may end before its time.
const DEVICES: u32 = 4;

/// What a device has in use whose `learn` was killed: the table of before, the line of a training whose folder has
/// that table, or the one that was learnt.
fn known(driven: &Driven, out: &Path, board: &Path, [old, line]: [&Record; 2]) {
    let mut client = ticks_on("learn", driven.device.address());
    client.restart().unwrap();
    let found = client.pull().unwrap();
    if found == *line {
        assert_eq!(fs::read(out.join(FORMER)).unwrap(), old[..], "nobody has the table of before");
    } else if found != *old {
        let (_, learnt, _) = for_board(&out.join("model/table.toml"), board).unwrap();
        assert_eq!(found, to_record(&learnt), "a table that nobody knows");
    }
}

/// Typed once more it says that it would go on, or what to type instead.
fn says_how_to_go_on(out: &Path, learn: &[&str]) {
    let again = piezo().args(["learn", "--dry-run"]).args(&learn[1..]).assert();
    let printed = again.get_output().clone();
    let [said, refused] = [printed.stdout, printed.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    if out.join("proof").exists() {
        again.code(2);
        assert!(refused.contains("or prove again: `piezo prove --out"), "{refused}");
    } else if session(out).is_ok_and(|session| session.complete) {
        again.success();
        assert!(said.contains("has a whole session, which would be learnt from as it is"), "{said}");
    } else {
        again.code(2);
        assert!(refused.contains("choose another --out"), "{refused}");
    }
}

#[test]
fn a_killed_learn_rests_with_a_table_that_somebody_knows_and_says_how_to_go_on() {
    let Before { board, wiring, line, old, .. } = &Before::new();
    // Whether it was killed in the part.
    let killed = |seen: Seen| {
        let plant = emulated(wiring, Kind::Relays(Density::Gaussian), 2).connected();
        let driven = Driven::new(wiring.drive(), old, plant, 4.0);
        let (out, port) = (driven.path("out"), driven.port());
        let learn = ["learn", "--out", text(&out), "--board", text(board), "--port", &port];
        let short = ["--minutes", "0.7", "--up-to", "20", "--proof-seconds", "20"];
        let search = ["--", "--model", "prandtl-ishlinskii", "--evaluations", "4", "--devices", "2"];
        let learn = [&learn[..], &short, &search].concat();
        let since = std::cell::OnceCell::new();
        driven.kill_once(&learn, || seen(&out) && since.get_or_init(Instant::now).elapsed() >= AFTER);
        let logs = fs::read_dir(&out).into_iter().flatten().map(|entry| entry.unwrap().path());
        logs.filter(|path| path.extension().is_some_and(|of| of == "csv")).for_each(|log| _ = rows(&log));
        known(&driven, &out, board, [old, line]);
        says_how_to_go_on(&out, &learn);
        since.get().is_some()
    };
    std::thread::scope(|scope| {
        for (part, seen) in PARTS {
            let killed = &killed;
            scope.spawn(move || assert!((0..DEVICES).any(|_| killed(seen)), "it has never come to {part}"));
        }
    });
}
