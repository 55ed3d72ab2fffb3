//! The host is killed, or the line dies, at each of the first requests of the verbs that talk to a device and are done soon: the
//! device goes on ticking and estimates again, with the old table or the new one, and the host ends in time and says what is known.

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
pub const LEASE: Duration = Duration::from_millis(5_500);
/// Most requests of a verb at which it is cut; one that streams or feeds has hundreds of them.
const STEPS: u32 = 8;
/// The request by which `push` and `erase` write: two connect, one asks what the device does, and one pauses.
const WRITES: u32 = 5;
/// What a host may take to find out that nobody answers.
const IN_TIME: Duration = Duration::from_secs(20);

pub const TABLE: &str = "tests/data/table/models/duhem.toml";

/// The verbs, and what each needs beside a port; `FOLDER` is an empty one.
const VERBS: [&[&str]; 10] = [
    &["push", TABLE, "--pause", "--doubted"],
    &["push", TABLE, "--reset", "--doubted"],
    &["erase", "--pause"],
    &["zero"],
    &["reset"],
    &["pil", MEASURED, "--limit", "500"],
    &["info"],
    &["pull", "--out", "-"],
    &["monitor", "--seconds", "0.2"],
    &["record", "--seconds", "0.2", "--out", "FOLDER/log.csv"],
];
/// So many of them, the first, change a device's table, its zero or its mode.
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

pub fn pushed() -> Record {
    to_record(&TableFile::load(&root().join(TABLE)).unwrap().1)
}

/// What a device must do when a host has left it, whatever that host had begun; it is then asked further.
pub fn ticks_on(what: &str, device: &EmulatedDevice) -> Client {
    let (mut client, _) = Client::connect(&device.address().into()).unwrap_or_else(|error| panic!("{what}: {error}"));
    let health = client.health().unwrap();
    assert_eq!((health.mode, health.missed), (Mode::Estimate, 0), "{what}");
    let start = Instant::now();
    while client.health().unwrap().ticks == health.ticks {
        assert!(start.elapsed() < IN_TIME, "{what}: it does not tick");
    }
    client
}

/// The same, and that it has the table of its image or a new one, and which.
pub fn goes_on(what: &str, device: &EmulatedDevice, new: &Record) -> bool {
    let old = to_record(&emulator::TABLE.admit().unwrap());
    let mut client = ticks_on(what, device);
    let source = client.restart().unwrap().source;
    let record = client.pull().unwrap();
    let expected = if source == TableSource::Stored { new } else { &old };
    assert!(record == *expected, "{what}: another table, {}", words::source(&source));
    source == TableSource::Stored
}

#[test]
fn a_host_that_is_killed_at_any_step_leaves_a_device_that_estimates() {
    let new = pushed();
    std::thread::scope(|scope| {
        let new = &new;
        let hosts =
            VERBS.map(|verb| (1..=STEPS).map(|step| scope.spawn(move || killed(verb, step, new))).collect::<Vec<_>>());
        for (verb, hosts) in VERBS.iter().zip(hosts) {
            let killed = hosts.into_iter().map(|host| u32::from(host.join().unwrap())).sum::<u32>();
            println!("{verb:?}: {killed}");
            assert!(killed >= 2, "{verb:?}: {killed} hosts were killed, the others had ended before");
        }
    });
}

/// The host is killed when it has sent so many requests, the last of which is never answered; returns whether it had not ended
/// before.
fn killed(verb: &[&str], step: u32, new: &Record) -> bool {
    let (device, folder) = (Emulator::new().start().unwrap(), tempfile::tempdir().unwrap());
    let (reached, reaches) = channel();
    let line = FaultyLine::to(
        device.address(),
        counted(move |requests, direction, frame| {
            if requests == step && direction == Direction::ToDevice {
                // Nobody listens where the host has ended meanwhile.
                let _ = reached.send(());
            }
            if lost(step, requests, direction) {
                frame.clear();
            }
        }),
    );
    let line = line.unwrap();
    let mut host = command(verb, folder.path(), &line).stderr(Stdio::null()).spawn().unwrap();
    let killed = loop {
        if reaches.recv_timeout(Duration::from_millis(5)).is_ok() {
            let lives = host.try_wait().unwrap().is_none();
            host.kill().unwrap();
            host.wait().unwrap();
            break lives;
        }
        if let Some(status) = host.try_wait().unwrap() {
            // It has made all its requests, or has given up before this machine got round to killing it.
            assert!(status.success() || reaches.try_recv().is_ok(), "{verb:?}");
            break false;
        }
    };
    drop(line);
    if verb.iter().any(|word| ["pil", "--pause", "--reset"].contains(word)) {
        std::thread::sleep(LEASE);
    }
    goes_on(&format!("{verb:?}, killed at request {step}"), &device, new);
    killed
}

/// Whether a frame is lost on a line that dies with its request of this number: that one is the last that the device hears.
fn lost(dies: u32, requests: u32, direction: Direction) -> bool {
    requests > dies || requests == dies && direction == Direction::ToHost
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
        if lost(step, requests, direction) {
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
    if ["push", "erase"].contains(&verb[0]) {
        // One more ends the pause, or restarts the device and asks what it then is.
        let last = WRITES + if verb.contains(&"--reset") { 2 } else { 1 };
        let (unsure, written) = (said.contains("it is not known whether"), said.contains("is written"));
        let restarting = said.contains("whether the device has restarted");
        assert_eq!((unsure, written), (step == WRITES, (WRITES + 1..=last).contains(&step)), "{what}");
        assert_eq!(restarting, written && verb.contains(&"--reset"), "{what}");
        assert!(step > last || !done.status.success(), "{what}");
    }
    if verb[0] == "push" {
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let stored = client.restart().unwrap().source == TableSource::Stored;
        assert_eq!(stored, step >= WRITES, "{what}");
        assert!(!stored || client.pull().unwrap() == *new, "{what}");
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
