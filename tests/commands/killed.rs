//! Verbs that write files or a device's flash are killed at random moments: what there is afterwards is old or new,
//! never half and never mixed unseen, and the next command finds a device that answers.

use super::logs::{rig, write};
use super::sets::{Moments, said};
use super::severed::{TABLE, goes_on, pushed};
use super::{piezo, root, text};
use device_link::table::to_record;
use emulator::{EmulatedDevice, Emulator};
use link_attacks::LEASE;
use protocol::Record;
use recordings::log::{ReadOptions, read};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use table_files::{TableFile, agree};

/// How long runs are killed, and on a busy machine until enough were.
const SHORT: Duration = Duration::from_secs(4);
const LONG: Duration = Duration::from_secs(60);

pub fn begun(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
    command.args(arguments).current_dir(root()).env_remove("PIEZO_PORT");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// How long a whole run takes.
fn whole(arguments: &[&str]) -> Duration {
    let start = Instant::now();
    assert!(begun(arguments).wait().unwrap().success(), "{arguments:?}");
    start.elapsed()
}

#[test]
fn a_killed_identify_leaves_an_old_or_a_new_set_or_one_that_is_refused() {
    let folders = tempfile::tempdir().unwrap();
    let out = folders.path().join("out");
    let logs = ["sin10", "tr10"].map(|name| write(folders.path(), &rig(name)));
    let identify = logs.each_ref().map(|log| {
        let shortest = ["--model", "voigt", "--devices", "0", "--generations", "2", "--rounds", "1"];
        [&["identify", text(log), "--out", text(&out)], &shortest[..]].concat()
    });
    let tables = identify.each_ref().map(|identify| {
        whole(identify);
        said(&out)[0].clone()
    });
    let (mut moments, mut kills, start) = (Moments::of(whole(&identify[0])), 0, Instant::now());
    while start.elapsed() < SHORT || kills < 6 && start.elapsed() < LONG {
        moments.kill(begun(&identify[kills % 2]));
        kills += 1;
        let faces = said(&out);
        let mixed = faces.iter().any(|face| *face != faces[0]);
        assert!(faces.len() == 3 && faces.iter().all(|face| tables.contains(face)), "{faces:?}");
        let (_, table) = TableFile::load(&out.join("table.toml")).expect("old or new, never half");
        assert_eq!(agree(&out.join("table.toml"), &table).is_err(), mixed, "{faces:?}");
        for (page, end) in [("report.html", "</html>"), ("estimate.svg", "</svg>")] {
            assert!(fs::read_to_string(out.join(page)).unwrap().trim_end().ends_with(end), "{page} is half");
        }
    }
    assert!(kills >= 6, "{kills} kills are too few to say anything");
    whole(&identify[0]);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 5, "leftovers are swept");
}

#[test]
fn a_killed_record_leaves_whole_lines_and_a_device_that_is_recorded_again_at_once() {
    let folder = tempfile::tempdir().unwrap();
    // Slowly, for on a busy machine a recording at eight times the speed may lose ticks, and then ends before its time.
    let device = Emulator::new().speed(2.0).start().unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", device.address()));
    let left = folder.path().join("log.csv.partial");
    let record = ["record", "--out", text(&log), "--seconds", "1", "--port", &port];
    let (mut moments, mut partial, start) = (Moments::of(whole(&record)), 0, Instant::now());
    fs::remove_file(&log).unwrap();
    while start.elapsed() < SHORT || partial < 3 && start.elapsed() < LONG {
        moments.kill(begun(&record));
        let length = |path: &Path| path.metadata().map_or(0, |file| file.len());
        assert!(!(log.exists() && left.exists()));
        if log.exists() {
            assert_eq!(read(&log, &ReadOptions::default()).unwrap().voltage.len(), 2_000, "all of it, or none");
        } else if length(&left) > 2_000 {
            assert!(fs::read_to_string(&left).unwrap().ends_with('\n'));
            assert!(!read(&left, &ReadOptions::default()).unwrap().voltage.is_empty());
            partial += 1;
        }
        let files = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
        files.for_each(|path| {
            assert!(path == log || path == left, "{path:?}");
            fs::remove_file(path).unwrap();
        });
    }
    assert!(partial >= 3, "{partial} were killed while they recorded");
    whole(&record);
}

/// Kills a verb that writes a device's flash, on several devices at once, each some time later than the one before; of
/// those that had not ended some must have been killed before they had written, and some after it.
fn writes(verb: &[&str], new: &Record, device: impl Fn() -> EmulatedDevice + Sync) {
    const KILLS: u32 = 12;
    const ROUNDS: u32 = 6;
    let typed = |device: &EmulatedDevice| format!("tcp:{}", device.address());
    let run = |port: &str| begun(&[verb, &["--port", port]].concat());
    let start = Instant::now();
    assert!(run(&typed(&device())).wait().unwrap().success(), "{verb:?}");
    let mut whole = start.elapsed();
    // Killed with the old table there, and with the new one.
    let mut ended = [0; 2];
    for _ in 0..ROUNDS {
        std::thread::scope(|scope| {
            let hosts: Vec<_> = (0..KILLS)
                .map(|kill| {
                    let (device, typed, run) = (&device, &typed, &run);
                    scope.spawn(move || {
                        let device = device();
                        let mut host = run(&typed(&device));
                        std::thread::sleep(whole.mul_f64(f64::from(kill) / f64::from(KILLS)));
                        // One that has ended is none to be killed.
                        let _ = host.kill();
                        let killed = !host.wait().unwrap().success();
                        // The next command need not wait for the lease.
                        piezo().args(["info", "--port", &typed(&device)]).assert().success();
                        std::thread::sleep(LEASE);
                        let what = format!("{verb:?}, killed after {kill} of {KILLS} parts of {whole:?}");
                        (killed, goes_on(&what, &device, new))
                    })
                })
                .collect();
            for (killed, is_new) in hosts.into_iter().map(|host| host.join().unwrap()) {
                ended[usize::from(is_new)] += u32::from(killed);
            }
        });
        if ended[0] > 0 && ended[1] > 0 {
            break;
        }
        // So many at once take longer than the one that was measured.
        whole = whole.mul_f64(if ended[1] == 0 { 1.5 } else { 0.7 });
    }
    println!("{verb:?}: {ended:?}");
    assert!(ended[0] > 0 && ended[1] > 0, "{verb:?}: {ended:?} were killed with the old and with the new table");
}

#[test]
fn a_killed_push_leaves_the_old_table_or_the_new_one() {
    writes(&["push", TABLE, "--pause", "--reset", "--doubted"], &pushed(), || Emulator::new().start().unwrap());
}

#[test]
fn a_killed_install_leaves_the_old_table_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let board = folder.path().join("board.toml");
    fs::write(&board, "adc_span = [-0.378, 3.978]\nadc_full_scale = 65520\ndac_full_scale = 4095\n").unwrap();
    let install = ["install", TABLE, "--doubted", "--narrow", "--board", text(&board)];
    let (_, table, _) = ::bench::for_board(&root().join(TABLE), &board).unwrap();
    writes(&install, &to_record(&table), || Emulator::new().speed(4.0).start().unwrap());
}

#[test]
fn a_killed_simulate_leaves_logs_of_one_rig_and_never_of_two() {
    let folders = tempfile::tempdir().unwrap();
    let out = folders.path().join("rig");
    let simulate =
        ["1", "2"].map(|seed| ["simulate", "--duration", "5", "--noise-nm", "20", "--seed", seed, "--out", text(&out)]);
    let held = || -> BTreeMap<String, Vec<u8>> {
        let files = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path());
        let logs = files.filter(|path| path.extension().is_some_and(|of| of == "csv"));
        logs.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap())).collect()
    };
    let rigs = simulate.each_ref().map(|simulate| {
        whole(simulate);
        held()
    });
    assert!(rigs.iter().all(|rig| rig.len() == 6) && rigs[0].iter().all(|(name, log)| rigs[1][name] != *log));
    let (mut moments, mut kills, start) = (Moments::of(whole(&simulate[0])), 0, Instant::now());
    while start.elapsed() < SHORT || kills < 12 && start.elapsed() < LONG {
        moments.kill(begun(&simulate[kills % 2]));
        kills += 1;
        let logs = held();
        let of = |rig: &BTreeMap<String, Vec<u8>>| logs.iter().all(|(name, log)| rig[name] == *log);
        assert!(rigs.iter().any(of), "logs of both, after {kills} kills: {:?}", logs.keys());
    }
    assert!(kills >= 12, "{kills} kills are too few to say anything");
    whole(&simulate[0]);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 6, "leftovers are swept");
}
