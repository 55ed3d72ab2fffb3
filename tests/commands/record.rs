//! `piezo record` on a line on which things go wrong.

use super::{piezo, refused, text};
use emulator::faults::{lose_replies, lose_samples_at, silent_from};
use emulator::{Emulator, Fault, FaultyLine};
use recordings::log::{ReadOptions, read};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Records a second in a folder; whether that was all, and what is in the folder.
fn recorded(fault: impl Fault, folder: &tempfile::TempDir) -> (Option<i32>, Vec<PathBuf>) {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let line = FaultyLine::to(device.address(), fault).unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", line.address()));
    let done =
        piezo().args(["record", "--out", text(&log), "--seconds", "1", "--json", "--port", &port]).output().unwrap();
    let files = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    (done.status.code(), files)
}

#[test]
fn what_was_recorded_before_a_gap_is_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let (done, files) = recorded(lose_samples_at(600), &folder);
    assert_eq!(done, Some(1));
    assert_eq!(files, [folder.path().join("log.csv")]);
    let log = read(&files[0], &ReadOptions::default()).unwrap();
    assert!((500..=600).contains(&log.voltage.len()), "{}", log.voltage.len());
}

#[test]
fn what_was_recorded_before_a_device_died_is_a_log() {
    let folder = tempfile::tempdir().unwrap();
    // Five requests start a recording; none is answered from then on.
    let (mut unanswered, mut silent) = (lose_replies(5..100), silent_from(100));
    let dies = move |direction, frame: &mut Vec<u8>| {
        unanswered(direction, frame);
        silent(direction, frame);
    };
    let (done, files) = recorded(dies, &folder);
    assert_eq!(done, Some(1));
    // A machine that is busy has the host ask later.
    let count = read(&files[0], &ReadOptions::default()).unwrap().voltage.len();
    assert!((1..=99).contains(&count), "{count}");
}

#[test]
fn a_recording_is_written_over_only_where_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (log, port) = (folder.path().join("keep.csv"), format!("tcp:{}", device.address()));
    let record = ["record", "--out", text(&log), "--seconds", "0.1", "--port", &port];
    let wanted = folder.path().join("wanted.csv");
    std::fs::write(&wanted, "time_s,displacement_um\n0,0\n0.1,0.1\n").unwrap();
    piezo().args(record).assert().success();
    let kept = std::fs::read(&log).unwrap();
    let follow = ["follow", text(&wanted), "--out", text(&log), "--port", &port];
    for verb in [&record[..], &follow] {
        refused(verb, &["keep.csv", "no measurement is written over", "--force"]);
        assert_eq!(std::fs::read(&log).unwrap(), kept);
    }
    piezo().args(record).arg("--force").assert().success();
}

#[test]
fn a_recording_of_nothing_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (done, files) = recorded(silent_from(0), &folder);
    assert!(done == Some(1) && files.is_empty(), "{done:?} {files:?}");
}

#[test]
fn what_was_recorded_before_the_program_was_killed_is_a_log_that_is_named_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", device.address()));
    let left = folder.path().join("log.csv.partial");
    let record = ["record", "--out", text(&log), "--port", &port];
    let mut host = Command::new(env!("CARGO_BIN_EXE_piezo")).args(record).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while left.metadata().map_or(0, |left| left.len()) < 200_000 {
        assert!(start.elapsed() < Duration::from_secs(20) && host.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    refused(&record, &["log.csv.partial: another program is recording into it", "--out"]);
    host.kill().unwrap();
    host.wait().unwrap();
    let kept = std::fs::read_to_string(&left).unwrap();
    assert!(kept.len() >= 200_000 && kept.ends_with('\n'), "whole lines");
    assert!(!log.exists());
    // Neither another recording nor the same one again sweeps it or is written over it.
    let other = folder.path().join("other.csv");
    piezo().args(["record", "--out", text(&other), "--seconds", "0.1", "--port", &port]).assert().success();
    // Nor is it lost with a log in its place that may be.
    std::fs::write(folder.path().join("log-1.csv"), "of before").unwrap();
    let [left_name, free] = [&left, &folder.path().join("log-2.csv")].map(|path| text(path).to_owned());
    for more in [&[][..], &["--force"]] {
        let said = ["log.csv.partial: holds what an earlier recording has left", &format!("mv {left_name} {free}")];
        refused(&[&record[..], more].concat(), &said);
        assert_eq!(std::fs::read_to_string(&left).unwrap(), kept);
        std::fs::write(&log, "of before").unwrap();
    }
    // It is a log as any other, also where a machine that lost its power has cut it in the middle of a number.
    let rows = kept.lines().count() - 1;
    for cut in [kept.len(), kept.len() - 3] {
        std::fs::write(&left, &kept[..cut]).unwrap();
        let read = read(&left, &ReadOptions::default()).unwrap().voltage.len();
        assert!(read == rows || read == rows - 1, "{read} of {rows}");
        piezo().args(["look", text(&left)]).assert().success();
    }
    let learnt = ["identify", text(&left), "--model", "voigt", "--devices", "0", "--evaluations", "4", "--out"];
    let model = folder.path().join("model");
    let said = piezo().args(learnt).arg(&model).assert().success().get_output().stdout.clone();
    assert!(String::from_utf8(said).unwrap().contains("is a device's estimate"));
    std::fs::rename(&left, free).unwrap();
    piezo().args(record).args(["--seconds", "0.1", "--force"]).assert().success();
    assert!(log.metadata().unwrap().len() > 1_000 && !left.exists());
}

#[test]
fn what_was_recorded_is_kept_and_named_where_something_took_its_place_meanwhile() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", device.address()));
    let left = folder.path().join("log.csv.partial");
    for (force, is_folder) in [(false, true), (true, true), (false, false)] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
        command.args(["record", "--out", text(&log), "--seconds", "4", "--port", &port]);
        command.args(force.then_some("--force")).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut host = command.spawn().unwrap();
        let start = Instant::now();
        while left.metadata().map_or(0, |left| left.len()) == 0 {
            assert!(start.elapsed() < Duration::from_secs(20) && host.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        if is_folder {
            std::fs::create_dir(&log).unwrap();
        } else {
            std::fs::write(&log, "another's").unwrap();
        }
        let done = host.wait_with_output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(done.status.code() == Some(2) && said.contains("log.csv: cannot be written: "), "{said}");
        assert!(said.contains(&format!("what was written is kept in {}", left.display())), "{said}");
        assert_eq!(read(&left, &ReadOptions::default()).unwrap().voltage.len(), 8_000);
        if is_folder {
            std::fs::remove_dir(&log).unwrap();
        } else {
            assert_eq!(std::fs::read_to_string(&log).unwrap(), "another's");
        }
        std::fs::remove_file(&left).unwrap();
    }
}

#[test]
fn a_recording_that_is_interrupted_before_its_time_is_kept_and_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", device.address()));
    let left = folder.path().join("log.csv.partial");
    for (length, code) in [(&["--seconds", "10000"][..], 1), (&[], 0)] {
        let mut host = Command::new(env!("CARGO_BIN_EXE_piezo"))
            .args(["record", "--force", "--json", "--out", text(&log), "--port", &port])
            .args(length)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while left.metadata().map_or(0, |left| left.len()) < 50_000 {
            assert!(start.elapsed() < Duration::from_secs(20) && host.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(Command::new("kill").args(["-INT", &host.id().to_string()]).status().unwrap().success());
        let ended = host.wait_with_output().unwrap();
        let said: serde_json::Value = serde_json::from_slice(&ended.stdout).unwrap();
        assert_eq!((ended.status.code(), &said["complete"]), (Some(code), &(code == 0).into()), "{length:?}");
        assert!(log.metadata().unwrap().len() >= 50_000 && !left.exists(), "{length:?}");
    }
}
