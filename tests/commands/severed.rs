//! The host is killed, or the line dies, at every step of every verb that talks to a device: the device goes on ticking and
//! estimates again, with the old table or the new one, and the host ends in time and says what is known.

use super::{MEASURED, piezo, root, text};
use device_link::table::to_record;
use device_link::{Client, words};
use emulator::{Direction, EmulatedDevice, Emulator, Fault, FaultyLine};
use protocol::{Mode, Record, TableSource};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use table_files::TableFile;

/// For how long a device keeps a mode that a host has set and left, and some time more.
const LEASE: Duration = Duration::from_millis(5_500);
/// Most steps that are cut of a verb; one that streams or feeds has hundreds of them.
const STEPS: u32 = 8;
/// What a host may take to find out that nobody answers.
const IN_TIME: Duration = Duration::from_secs(20);

const TABLE: &str = "tests/data/table/models/duhem.toml";

/// The verbs, and what each needs beside a port; `FOLDER` is an empty one. Those after [`CHANGING`] leave a device as it is.
const VERBS: [&[&str]; 10] = [
    &["push", TABLE, "--pause"],
    &["push", TABLE, "--reset"],
    &["erase", "--pause"],
    &["zero"],
    &["reset"],
    &["pil", MEASURED, "--limit", "500"],
    &["info"],
    &["pull", "--out", "-"],
    &["monitor", "--seconds", "0.2"],
    &["record", "--seconds", "0.2", "--out", "FOLDER/log.csv"],
];
const CHANGING: usize = 6;

/// Requests that have come from the host so far: a frame that is more than its delimiter.
fn counted(mut then: impl FnMut(u32, Direction, &mut Vec<u8>) + Send + 'static) -> impl Fault {
    let mut requests = 0;
    move |direction, frame: &mut Vec<u8>| {
        requests += u32::from(direction == Direction::ToDevice && frame.len() > 1);
        then(requests, direction, frame);
    }
}

fn command(verb: &[&str], folder: &Path, line: &FaultyLine) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
    command.current_dir(root()).env_remove("PIEZO_PORT");
    command.args(verb.iter().map(|word| word.replace("FOLDER", text(folder))));
    command.args(["--port", &format!("tcp:{}", line.address())]).stdin(Stdio::null()).stdout(Stdio::null());
    command
}

fn pushed() -> Record {
    to_record(&TableFile::load(&root().join(TABLE)).unwrap().1)
}

/// What a device must do when a host has left it, whatever that host had begun.
fn goes_on(what: &str, device: &EmulatedDevice, new: &Record) {
    let old = to_record(&emulator::TABLE.admit().unwrap());
    let (mut client, _) = Client::connect(&device.address().into()).unwrap_or_else(|error| panic!("{what}: {error}"));
    let health = client.health().unwrap();
    assert_eq!((health.mode, health.missed), (Mode::Estimate, 0), "{what}");
    let start = Instant::now();
    while client.health().unwrap().ticks == health.ticks {
        assert!(start.elapsed() < IN_TIME, "{what}: it does not tick");
    }
    let source = client.restart().unwrap().source;
    let record = client.pull().unwrap();
    let expected = if source == TableSource::Stored { new } else { &old };
    assert!(record == *expected, "{what}: another table, {}", words::source(&source));
}

#[test]
fn a_host_that_is_killed_at_any_step_leaves_a_device_that_estimates() {
    let new = pushed();
    std::thread::scope(|scope| {
        for verb in VERBS {
            for step in 1..=STEPS {
                let new = &new;
                scope.spawn(move || killed(verb, step, new));
            }
        }
    });
}

/// The host is killed when it has sent so many requests, if it has not ended before.
fn killed(verb: &[&str], step: u32, new: &Record) {
    let (device, folder) = (Emulator::new().start().unwrap(), tempfile::tempdir().unwrap());
    let (reached, reaches) = channel();
    let line = FaultyLine::to(
        device.address(),
        counted(move |requests, direction, _| {
            if requests == step && direction == Direction::ToDevice {
                // Nobody listens where the host has ended meanwhile.
                let _ = reached.send(());
            }
        }),
    );
    let line = line.unwrap();
    let mut host = command(verb, folder.path(), &line).stderr(Stdio::null()).spawn().unwrap();
    loop {
        if reaches.recv_timeout(Duration::from_millis(5)).is_ok() {
            host.kill().unwrap();
            host.wait().unwrap();
            break;
        }
        if let Some(status) = host.try_wait().unwrap() {
            assert!(status.success(), "{verb:?}");
            break;
        }
    }
    drop(line);
    if verb.iter().any(|word| ["pil", "--pause", "--reset"].contains(word)) {
        std::thread::sleep(LEASE);
    }
    goes_on(&format!("{verb:?}, killed at request {step}"), &device, new);
}

#[test]
fn a_line_that_dies_at_any_step_is_told_in_time_and_whether_the_table_is_stored() {
    let new = pushed();
    std::thread::scope(|scope| {
        for verb in &VERBS[..CHANGING] {
            for step in 1..=STEPS {
                let new = &new;
                scope.spawn(move || severed(verb, step, new));
            }
        }
    });
}

/// From its request of this number on, the host hears nothing more.
fn severed(verb: &[&str], step: u32, new: &Record) {
    let (device, folder) = (Emulator::new().start().unwrap(), tempfile::tempdir().unwrap());
    let dies = counted(move |requests, direction, frame| {
        if requests > step || requests == step && direction == Direction::ToHost {
            frame.clear();
        }
    });
    let line = FaultyLine::to(device.address(), dies).unwrap();
    let start = Instant::now();
    let done = command(verb, folder.path(), &line).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    let what = format!("{verb:?}, the line dies at request {step}, {:?}: {said}", done.status);
    assert!(start.elapsed() < IN_TIME && done.status.code().is_some() && !said.contains("panicked"), "{what}");
    drop(line);
    if verb[0] == "push" && !done.status.success() {
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let stored = client.restart().unwrap().source == TableSource::Stored;
        assert!(!stored || client.pull().unwrap() == *new, "{what}");
        let (unsure, written) = (said.contains("it is not known"), said.contains("is written"));
        assert!(unsure || written == stored, "{what}, stored: {stored}");
    }
}

#[test]
fn a_second_host_waits_and_does_not_disturb_the_first() {
    let device = Emulator::new().start().unwrap();
    let (mut first, _) = Client::connect(&device.address().into()).unwrap();
    first.stream(true).unwrap();
    let port = format!("tcp:{}", device.address());
    let mut second = Command::new(env!("CARGO_BIN_EXE_piezo"));
    let mut second =
        second.args(["info", "--port", &port]).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut next = None;
    let status = loop {
        while let Some(batch) = first.samples(Duration::ZERO).unwrap() {
            assert!(next.is_none_or(|next| next == batch.first), "a gap before {}", batch.first);
            next = Some(batch.first + batch.samples.len() as u32);
        }
        first.health().unwrap();
        if let Some(status) = second.try_wait().unwrap() {
            break status;
        }
    };
    assert_eq!(status.code(), Some(2));
    assert!(next.is_some(), "the stream went on");
    let said = String::from_utf8(second.wait_with_output().unwrap().stderr).unwrap();
    assert!(said.contains("no answer") && said.contains("no other program connected"), "{said}");
    drop(first);
    piezo().args(["info", "--port", &port]).assert().success();
}
