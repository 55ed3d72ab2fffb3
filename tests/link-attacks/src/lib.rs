//! Attacks on the link between a host and a device: the host is killed at each of a verb's requests, the line dies
//! there, a host leaves in the middle of a frame, frames come twice or in another order, a second host comes.
//! Afterwards the device ticks on, estimates by the old table or the new one, and the host has said what is known.
//!
//! Whose device it is does not matter: [`Attacked`] says how one is powered on. What is broken panics.

mod frames;
mod second_host;
pub mod steps;

use std::{
    net::SocketAddr,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use device_link::{Client, words};
use emulator::EmulatedDevice;
use protocol::{Mode, Record, TableSource};
use rayon::{
    ThreadPoolBuilder,
    iter::{ParallelBridge, ParallelIterator},
};

/// For how long a device keeps a mode that a host has set and left, and some time more.
pub const LEASE: Duration = Duration::from_millis(5_500);
/// The same in a device's ticks of half a millisecond.
const LENT: u32 = 2 * LEASE.as_millis() as u32;
/// How long it is let alone before it is looked at again, at first: an emulated device's five seconds may be fewer
/// of the wall's.
const FIRST_LOOK: Duration = Duration::from_secs(4);
/// What a host may take to find out that nobody answers, and a device to tick.
const IN_TIME: Duration = Duration::from_secs(20);

/// A device that is powered on, until it is dropped.
pub trait Device {
    /// Where its line is.
    fn address(&self) -> SocketAddr;
}

impl Device for EmulatedDevice {
    fn address(&self) -> SocketAddr {
        self.address()
    }
}

/// Devices of a kind, and the hosts that come to them.
pub struct Attacked<'a> {
    /// Powers one on, with nothing in its store.
    pub power_on: &'a (dyn Fn() -> Box<dyn Device> + Sync),
    /// The host tool.
    pub piezo: &'a Path,
    /// From where it is run.
    pub folder: &'a Path,
    /// A `table.toml` that the devices take, of another table than their image has.
    pub table: &'a Path,
    /// A measured log, for `pil`.
    pub measured: &'a Path,
    /// How many devices are attacked at a time.
    pub at_a_time: usize,
}

impl Attacked<'_> {
    /// The host tool's command with `TABLE`, `LOG` and `FOLDER` in its place.
    fn host(&self, verb: &[&str], folder: &Path, line: SocketAddr) -> Command {
        let placed = |word: &&str| match *word {
            "TABLE" => self.table.display().to_string(),
            "LOG" => self.measured.display().to_string(),
            word => word.replace("FOLDER", &folder.display().to_string()),
        };
        let mut command = Command::new(self.piezo);
        command.current_dir(self.folder).env_remove("PIEZO_PORT");
        command.args(verb.iter().map(placed)).args(["--port", &format!("tcp:{line}")]);
        command.stdin(Stdio::null()).stdout(Stdio::null());
        command
    }

    /// What comes of an attack with each of these, some at a time.
    fn each<T: Send, R: Send>(
        &self,
        cases: impl Iterator<Item = T> + Send,
        attack: impl Fn(T) -> R + Send + Sync,
    ) -> Vec<R> {
        let pool = ThreadPoolBuilder::new().num_threads(self.at_a_time).build().unwrap();
        pool.install(|| cases.par_bridge().map(attack).collect())
    }
}

/// What a device must do when a host has left it, whatever that host had begun; it is then asked further. What is asked
/// of it meanwhile lends it the mode anew, and how long ago that was is counted in its own ticks: an emulated device's
/// time is another than the wall's.
///
/// # Panics
/// It does not answer, keeps a mode for longer than it was lent, has missed a tick, or ticks no more.
pub fn ticks_on(what: &str, device: SocketAddr) -> Client {
    let (mut spoken, mut patience) = (None, FIRST_LOOK);
    let (mut client, health) = loop {
        let (mut client, _) = Client::connect(&device.into()).unwrap_or_else(|error| panic!("{what}: {error}"));
        let health = client.health().unwrap_or_else(|error| panic!("{what}: {error}"));
        if health.mode == Mode::Estimate {
            break (client, health);
        }
        let silent = spoken.map_or(0, |spoken| health.ticks.wrapping_sub(spoken));
        assert!(silent < LENT, "{what}: {:?} after {silent} ticks without a word", health.mode);
        spoken = Some(health.ticks);
        drop(client);
        thread::sleep(patience);
        patience *= 2;
    };
    assert_eq!(health.missed, 0, "{what}");
    let start = Instant::now();
    while client.health().unwrap_or_else(|error| panic!("{what}: {error}")).ticks == health.ticks {
        assert!(start.elapsed() < IN_TIME, "{what}: it does not tick");
    }
    client
}

/// The same, and that it has the old table or the new one. Whether it is the new one.
///
/// # Panics
/// It has another.
pub fn goes_on(what: &str, device: SocketAddr, old: &Record, new: &Record) -> bool {
    let mut client = ticks_on(what, device);
    let source = client.restart().unwrap_or_else(|error| panic!("{what}: {error}")).source;
    let record = client.pull().unwrap_or_else(|error| panic!("{what}: {error}"));
    let expected = if source == TableSource::Stored { new } else { old };
    assert!(record == *expected, "{what}: another table, {}", words::source(&source));
    source == TableSource::Stored
}

/// The table of a device.
fn table_of(device: SocketAddr) -> Record {
    let (mut client, _) = Client::connect(&device.into()).unwrap_or_else(|error| panic!("{error}"));
    client.pull().unwrap_or_else(|error| panic!("{error}"))
}
