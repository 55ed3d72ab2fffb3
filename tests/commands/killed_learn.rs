//! `learn` is killed in any of its parts: what it leaves is at rest, has a table that somebody knows, and is gone on
//! with by what the program then says.

use super::killed_driving::{Driven, rows};
use super::severed::TABLE as DUHEM;
use super::{piezo, root, text};
use ::bench::{EMULATED, FORMER, Wiring, emulated, for_board};
use device_link::table::to_record;
use link_attacks::ticks_on;
use plants::{Density, Kind};
use protocol::Record;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Devices whose hosts are killed in a round, each some time later than the one before.
const KILLS: u32 = 6;
/// Rounds at most until every part was killed.
const ROUNDS: u32 = 4;
const PARTS: [&str; 3] = ["a training", "what follows, with the table of before", "what follows, with the learnt one"];

/// What a killed `learn` is found to have been in: the index of one of [`PARTS`]; `None` where it had ended.
fn part(driven: &Driven, board: &Path, [old, line]: [&Record; 2], after: Duration, learn: &[&str]) -> Option<usize> {
    let out = driven.path("out");
    driven.kill(learn, after);
    let mut client = ticks_on("learn", driven.device.address());
    client.restart().unwrap();
    let found = client.pull().unwrap();
    drop(client);
    let logs = fs::read_dir(&out).into_iter().flatten().map(|entry| entry.unwrap().path());
    logs.filter(|path| path.extension().is_some_and(|of| of == "csv")).for_each(|log| _ = rows(&log));
    let whole = ::bench::session(&out).is_ok_and(|session| session.complete);
    let part = if found == *line {
        assert_eq!(fs::read(out.join(FORMER)).unwrap(), old[..], "nobody has the table of before");
        0
    } else if found == *old {
        usize::from(whole)
    } else {
        let (_, learnt, _) = for_board(&out.join("model/table.toml"), board).unwrap();
        assert_eq!(found, to_record(&learnt), "a table that nobody knows");
        2
    };
    // Typed once more it goes on, or says what to type.
    let again = piezo().args(["learn", "--dry-run"]).args(&learn[1..]).assert();
    let (proof, printed) = (out.join("proof"), again.get_output().clone());
    let [said, refused] = [printed.stdout, printed.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    if proof.exists() {
        again.code(2);
        assert!(refused.contains("or prove again: `piezo prove --out"), "{refused}");
        return (!proof.join("proven.csv").exists()).then_some(part);
    }
    if whole {
        again.success();
        assert!(said.contains("has a whole session, which would be learnt from as it is"), "{said}");
    } else if out.join("session.toml").exists() {
        again.code(2);
        assert!(refused.contains("choose another --out"), "{refused}");
    } else {
        again.success();
    }
    Some(part)
}

#[test]
fn a_killed_learn_rests_with_a_table_that_somebody_knows_and_says_how_to_go_on() {
    let boards = tempfile::tempdir().unwrap();
    let board = boards.path().join("board.toml");
    fs::write(&board, EMULATED.to_toml()).unwrap();
    let wiring = Wiring::new(&EMULATED, 500).unwrap();
    let line = to_record(wiring.line());
    let (_, table, _) = for_board(&root().join(DUHEM), &board).unwrap();
    let old = to_record(&table);
    let device =
        || Driven::new(wiring.drive(), &old, emulated(&wiring, Kind::Relays(Density::Gaussian), 2).connected(), 6.0);
    let typed = |driven: &Driven, run: &mut dyn FnMut(&[&str])| {
        let (out, port) = (driven.path("out"), driven.port());
        let learn = ["learn", "--out", text(&out), "--board", text(&board), "--port", &port];
        let short = ["--minutes", "0.7", "--up-to", "20", "--proof-seconds", "10"];
        let search = ["--", "--model", "prandtl-ishlinskii", "--evaluations", "4", "--devices", "2"];
        run(&[&learn[..], &short, &search].concat());
    };
    let (first, start) = (device(), Instant::now());
    typed(&first, &mut |learn| drop(piezo().args(learn).assert().success()));
    let mut whole = start.elapsed();
    let mut killed = [0; PARTS.len()];
    for _ in 0..ROUNDS {
        let found: Vec<Option<usize>> = std::thread::scope(|scope| {
            let hosts: Vec<_> = (1..=KILLS)
                .map(|kill| {
                    let (device, typed, board, records) = (&device, &typed, &board, [&old, &line]);
                    let after = whole.mul_f64(f64::from(kill) / f64::from(KILLS));
                    scope.spawn(move || {
                        let (driven, mut found) = (device(), None);
                        typed(&driven, &mut |learn| found = part(&driven, board, records, after, learn));
                        found
                    })
                })
                .collect();
            hosts.into_iter().map(|host| host.join().unwrap()).collect()
        });
        found.into_iter().flatten().for_each(|part| killed[part] += 1);
        if killed.iter().all(|kills| *kills > 0) {
            return;
        }
        // So many at once take longer than the one that was measured.
        whole = whole.mul_f64(1.3);
    }
    panic!("killed in {PARTS:?}: {killed:?} times");
}
