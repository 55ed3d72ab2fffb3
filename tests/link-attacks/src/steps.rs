//! The host is killed, or the line dies, at each of the first requests of the verbs that talk to a device and
//! are done soon.

use std::{
    process::Stdio,
    sync::mpsc::channel,
    time::{Duration, Instant},
};

use device_link::{Client, table::to_record};
use emulator::{Direction, Fault, FaultyLine};
use protocol::{Deframer, Record, TableSource, ToDevice};
use table_files::TableFile;

use crate::{Attacked, IN_TIME, goes_on, table_of};

/// Most requests of a verb at which it is cut; one that streams or feeds has hundreds of them.
const STEPS: u32 = 8;
/// The request that a device which estimates refuses to `push` and `erase`, behind two that connect and one that asks
/// what it does: where its reply is lost, nobody knows that it was.
const REFUSED: u32 = 4;
/// The request by which they write, once another has paused it.
const WRITES: u32 = 6;

/// The verbs, and what each needs beside a port: first those that write a device's flash, behind them those that change
/// its zero or its mode.
pub const VERBS: [&[&str]; 10] = [
    &["push", "TABLE", "--pause", "--doubted"],
    &["push", "TABLE", "--reset", "--doubted"],
    &["erase", "--pause"],
    &["zero"],
    &["reset"],
    &["pil", "LOG", "--limit", "500"],
    &["info"],
    &["pull", "--out", "-"],
    &["monitor", "--seconds", "0.2"],
    &["record", "--seconds", "0.2", "--out", "FOLDER/log.csv"],
];
/// So many write its flash.
pub const WRITING: usize = 3;
/// So many change anything.
pub const CHANGING: usize = 6;

/// Each of the verbs at each of its requests.
fn steps<'v>(verbs: &'v [&'v [&'v str]]) -> impl Iterator<Item = (&'v [&'v str], u32)> {
    verbs.iter().flat_map(|verb| (1..=STEPS).map(move |step| (*verb, step)))
}

/// A line that dies with the host's request of this number: that one is the last that the device hears, and `reached`
/// is called when it has been sent. A host that waits for a reply asks again, under the same number of its own, which
/// counts as once.
fn dies_with(dies: u32, reached: impl Fn() + Send + 'static) -> impl Fault {
    let (mut requests, mut newest, mut deframer) = (0, None, Deframer::new());
    move |direction, frame: &mut Vec<u8>| {
        let mut again = false;
        if direction == Direction::ToDevice
            && let Some(Ok(ToDevice { sequence, .. })) = frame.iter().find_map(|&byte| deframer.push(byte))
        {
            again = newest.replace(sequence) == Some(sequence);
            requests += u32::from(!again);
            if requests == dies {
                reached();
            }
        }
        if requests > dies || requests == dies && (again || direction == Direction::ToHost) {
            frame.clear();
        }
    }
}

impl Attacked<'_> {
    /// The record of the table that is pushed.
    fn new_table(&self) -> Record {
        let (_, table) = TableFile::load(self.table).unwrap_or_else(|error| panic!("{error}"));
        to_record(&table)
    }

    /// The host is killed at each step of these verbs: the device goes on.
    ///
    /// # Panics
    /// It does not, or fewer than two hosts of a verb were killed before they had ended.
    pub fn hosts_are_killed(&self, verbs: &[&[&str]]) {
        let new = self.new_table();
        let killed = self.each(steps(verbs), |(verb, step)| (verb, self.killed(verb, step, &new)));
        for verb in verbs {
            let killed = killed.iter().filter(|(of, killed)| of == verb && *killed).count();
            println!("{verb:?}: {killed}");
            assert!(killed >= 2, "{verb:?}: {killed} hosts were killed, the others had ended before");
        }
    }

    /// The host is killed when it has sent so many requests, the last of which is never answered; returns whether it
    /// had not ended before.
    fn killed(&self, verb: &[&str], step: u32, new: &Record) -> bool {
        let (device, folder) = ((self.power_on)(), tempfile::tempdir().unwrap());
        let old = table_of(device.address());
        let (reached, reaches) = channel();
        let dies = dies_with(step, move || {
            // Nobody listens where the host has ended meanwhile.
            let _ = reached.send(());
        });
        let line = FaultyLine::to(device.address(), dies).unwrap();
        let mut host = self.host(verb, folder.path(), line.address()).stderr(Stdio::null()).spawn().unwrap();
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
        goes_on(&format!("{verb:?}, killed at request {step}"), device.address(), &old, new);
        killed
    }

    /// The line dies at each step of these verbs: the host ends in time, and says whether the table is stored.
    ///
    /// # Panics
    /// It does not.
    pub fn lines_die(&self, verbs: &[&[&str]]) {
        let new = self.new_table();
        self.each(steps(verbs), |(verb, step)| self.severed(verb, step, &new));
    }

    /// From its request of this number on, the host hears nothing more.
    fn severed(&self, verb: &[&str], step: u32, new: &Record) {
        let (device, folder) = ((self.power_on)(), tempfile::tempdir().unwrap());
        let line = FaultyLine::to(device.address(), dies_with(step, || ())).unwrap();
        let start = Instant::now();
        let done = self.host(verb, folder.path(), line.address()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        let what = format!("{verb:?}, the line dies at request {step}, {:?}: {said}", done.status);
        assert!(start.elapsed() < IN_TIME && done.status.code().is_some() && !said.contains("panicked"), "{what}");
        drop(line);
        if ["push", "erase"].contains(&verb[0]) {
            // One more ends the pause, or restarts the device and asks what it then is.
            let last = WRITES + if verb.contains(&"--reset") { 2 } else { 1 };
            let (unsure, written) = (said.contains("it is not known whether"), said.contains("is written"));
            let restarting = said.contains("whether the device has restarted");
            assert_eq!(
                (unsure, written),
                ([REFUSED, WRITES].contains(&step), (WRITES + 1..=last).contains(&step)),
                "{what}"
            );
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
}
