//! A disk that is full, at every file that a verb writes: what was there stays, nothing half-written is left, and the
//! file is named.
//!
//! The operating system's limit on the length of a file stands for it, below what each verb writes: a write beyond it
//! fails as one to a full disk does, in the middle of a file where the limit is not 0.
#![cfg(unix)]

use super::logs::{rig, write};
use super::{data, root, text};
use emulator::Emulator;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs `piezo` where no file may become longer than so many blocks of 512 bytes.
pub fn limited(blocks: u32, arguments: &[&str]) -> Output {
    // The signal that comes with the error would end the program; a full disk sends none.
    let limit = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limit, env!("CARGO_BIN_EXE_piezo")]).args(arguments);
    command.current_dir(root()).env_remove("PIEZO_PORT").output().unwrap()
}

/// Every file of a folder, with what it holds; none where there is no folder.
pub fn held(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    if !folder.exists() {
        return BTreeMap::new();
    }
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(path).unwrap())).collect()
}

/// Runs it with room for nothing, and for the beginning of a file: it fails, names one of the files, and leaves the
/// folder as it was.
fn leaves_all_as_it_was(folder: &Path, names: &[&str], arguments: &[&str]) {
    let before = held(folder);
    for blocks in [0, 1] {
        let done = limited(blocks, arguments);
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
        let named = names.iter().any(|name| said.contains(&format!("{name}: cannot be written")));
        assert!(
            named && said.contains("File too large") && !said.contains("panicked") && !said.contains(".piezo-"),
            "{arguments:?}: {said}"
        );
        assert!(held(folder) == before, "{arguments:?}: {:?}", held(folder).keys());
    }
}

#[test]
fn whatever_cannot_be_written_whole_is_not_there_and_named() {
    let folders = tempfile::tempdir().unwrap();
    let made = |name: &str| {
        let folder = folders.path().join(name);
        fs::create_dir(&folder).unwrap();
        folder
    };
    let does = |arguments: &[&str]| super::piezo().args(arguments).assert().success();
    let table = data("table/table.toml");
    let log = write(&made("logs"), &rig("sin10"));
    let (table, log) = (text(&table), text(&log));
    let faces = ["table.toml", "table.rs", "table.bin"];

    let emitted = made("emitted");
    does(&["emit", table, "--dac-span", "-9:53", "--out", text(&emitted)]);
    leaves_all_as_it_was(&emitted, &faces, &["emit", table, "--out", text(&emitted)]);

    let learnt = made("learnt");
    let shortest = ["--model", "voigt", "--devices", "0", "--generations", "5", "--rounds", "1"];
    let identify = [&["identify", log, "--out", text(&learnt)], &shortest[..]].concat();
    does(&[&identify[..], &["--seed", "2"]].concat());
    leaves_all_as_it_was(&learnt, &[&faces[..], &["report.html", "estimate.svg"]].concat(), &identify);

    let compared = made("compared");
    let compare = ["compare", log, "--models", "voigt", "--budget", "10", "--out", text(&compared)];
    does(&compare);
    leaves_all_as_it_was(&compared, &["compare.html", "voigt.toml"], &compare);

    let files = made("files");
    let at = |name: &str| text(&files.join(name)).to_owned();
    let wanted = at("wanted.csv");
    let row = |k: u32| format!("{:.3},{:.5}\n", f64::from(k) * 1e-3, 15.0 + 9.0 * (f64::from(k) * 6e-3).sin());
    fs::write(&wanted, format!("time_s,displacement_um\n{}", (0..3000).map(row).collect::<String>())).unwrap();
    for (name, verb) in [
        ("estimates.csv", &["validate", table, "tests/data/picma-p885-1hz.csv"][..]),
        ("voltages.csv", &["feedforward", table, &wanted, "--slew", "200", "--rest", "1.2"]),
        ("picture.svg", &["look", log]),
        ("page.html", &["look", log]),
    ] {
        let (out, verb) = (at(name), verb.to_vec());
        let verb = [&verb[..], &["--out", &out]].concat();
        leaves_all_as_it_was(&files, &[name], &verb);
        does(&verb);
        leaves_all_as_it_was(&files, &[name], &verb);
    }

    let simulated = made("simulated");
    let simulate = ["simulate", "--duration", "0.5", "--out", text(&simulated)];
    does(&simulate);
    leaves_all_as_it_was(&simulated, &["sin1.csv"], &simulate);

    let pages = made("pages");
    does(&["man", "--out", text(&pages)]);
    leaves_all_as_it_was(&pages, &["piezo.1", "piezo-look.1"], &["man", "--out", text(&pages)]);
}

#[test]
fn a_reproduction_that_cannot_be_written_whole_is_not_there_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let reproduce = ["reproduce", "loops", "--generations", "2", "--rounds", "1", "--out", text(folder.path())];
    super::piezo().args(reproduce).assert().success();
    leaves_all_as_it_was(folder.path(), &["reproduce.html"], &reproduce);
}

#[test]
fn what_a_device_says_is_written_whole_or_kept_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let port = format!("tcp:{}", device.address());
    let at = |name: &str| text(&folder.path().join(name)).to_owned();
    let pull = ["pull", "--out", &at("table.bin"), "--port", &port].map(str::to_owned);
    let pull = pull.each_ref().map(String::as_str);
    let done = limited(0, &pull);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.code() == Some(2) && said.contains("table.bin: cannot be written"), "{said}");
    assert!(held(folder.path()).is_empty());

    // A recording cannot be made again: what there is of it stays, and the log of before.
    let log = at("log.csv");
    fs::write(&log, "of before").unwrap();
    let record = ["record", "--out", &log, "--seconds", "2", "--force", "--port", &port];
    let done = limited(0, &record);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.code() == Some(2) && said.contains("log.csv: cannot be written: File too large"), "{said}");
    assert_eq!(held(folder.path()).keys().collect::<Vec<_>>(), ["log.csv"]);
    let done = limited(20, &record);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.code() == Some(2) && said.contains("log.csv.partial holds the samples before"), "{said}");
    let held = held(folder.path());
    let kept = String::from_utf8(held["log.csv.partial"].clone()).unwrap();
    assert!(kept.ends_with('\n') && kept.lines().all(|line| line.matches(',').count() == 2), "whole lines");
    assert!(held.len() == 2 && held["log.csv"] == b"of before" && kept.lines().count() > 100);
    let health = super::json(super::piezo().args(["info", "--json", "--port", &port]));
    assert_eq!(health["health"]["mode"], "Estimate", "the device goes on");
}
