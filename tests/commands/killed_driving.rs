//! Verbs that drive an actuator are killed at random moments: the output goes to rest at the drive's slew rate within
//! the lease, the device ticks on and is of use at once, and what was recorded by then is kept in whole lines.

use super::follow::DRIVE;
use super::killed::begun;
use super::severed::{TABLE as DUHEM, goes_on};
use super::{piezo, root, text};
use ::bench::{EMULATED, FORMER, Wiring, emulated, for_board};
use device_link::pages;
use device_link::table::to_record;
use emulator::{EmulatedDevice, Emulator, Plant, TABLE, amplifier};
use estimator_core::{DacCode, DriveCalibration, Table};
use link_attacks::{LEASE, ticks_on};
use parameter_store::RamFlash;
use plants::Kind;
use protocol::Record;
use recordings::log::{ReadOptions, read};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering::SeqCst};
use std::time::{Duration, Instant};

/// Devices whose hosts are killed, each some time later than the one before; and again where too few were in motion.
const KILLS: u32 = 5;
const ROUNDS: u32 = 5;
/// From one look at what a host has done to the next.
const LOOK: Duration = Duration::from_millis(2);
/// A step of the slew rate, rounded at both ends.
const ROUNDING: f32 = 2.0;

/// What a device's DAC has put out.
struct Output {
    last: AtomicU16,
    largest_step: AtomicU16,
}

impl Output {
    fn at(rest: DacCode) -> Arc<Self> {
        Arc::new(Self { last: AtomicU16::new(rest.0), largest_step: AtomicU16::new(0) })
    }

    /// A plant whose input is looked at.
    fn before(self: &Arc<Self>, mut plant: impl Plant) -> impl Plant {
        let output = self.clone();
        move |dac: DacCode| {
            let step = output.last.swap(dac.0, SeqCst).abs_diff(dac.0);
            output.largest_step.fetch_max(step, SeqCst);
            plant.sample(dac)
        }
    }
}

/// A device whose output is looked at, the folder that its host writes into, and what its DAC puts out at rest.
pub struct Driven {
    pub device: EmulatedDevice,
    output: Arc<Output>,
    folder: tempfile::TempDir,
    drive: DriveCalibration,
}

impl Driven {
    pub fn new(drive: DriveCalibration, stored: &Record, plant: impl Plant, speed: f64) -> Self {
        let output = Output::at(drive.code(drive.limits.rest_v, 4095));
        let flash = RamFlash::new(pages::with(stored, 4096).unwrap());
        let device = Emulator::new().flash(flash).plant(output.before(plant)).speed(speed).start().unwrap();
        Self { device, output, folder: tempfile::tempdir().unwrap(), drive }
    }

    pub fn port(&self) -> String {
        format!("tcp:{}", self.device.address())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn rests(&self) -> bool {
        self.output.last.load(SeqCst) == self.drive.code(self.drive.limits.rest_v, 4095).0
    }

    /// Kills its host some time after it has begun; whether the device was in motion.
    fn kill(&self, arguments: &[&str], after: Duration) -> bool {
        let begun = Instant::now();
        self.kill_once(arguments, || begun.elapsed() >= after)
    }

    /// The same once something is so, if its host has not ended before.
    pub fn kill_once(&self, arguments: &[&str], is_so: impl Fn() -> bool) -> bool {
        let mut host = begun(arguments);
        while !is_so() && host.try_wait().unwrap().is_none() {
            std::thread::sleep(LOOK);
        }
        // One that has ended is none to be killed.
        let _ = host.kill();
        let killed = !host.wait().unwrap().success();
        let moved = killed && !self.rests();
        piezo().args(["info", "--port", &self.port()]).assert().success();
        std::thread::sleep(LEASE);
        let what = arguments[0];
        assert!(self.rests(), "{what}: the output is at {}", self.output.last.load(SeqCst));
        let DriveCalibration { gain_codes_per_v, limits, .. } = self.drive;
        let most = gain_codes_per_v.abs() * limits.slew_v_per_s * 0.0005 + ROUNDING;
        let step = self.output.largest_step.load(SeqCst);
        assert!(f32::from(step) <= most, "{what}: the output has jumped by {step} codes, {most} are the slew limit");
        moved
    }
}

/// What there is before a session: the board's file, its wires, the line that it measures with, and a table in use.
pub struct Before {
    pub board: PathBuf,
    pub wiring: Wiring,
    pub line: Record,
    pub old: Record,
    _folder: tempfile::TempDir,
}

impl Before {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let board = folder.path().join("board.toml");
        fs::write(&board, EMULATED.to_toml()).unwrap();
        let wiring = Wiring::new(&EMULATED, 500).unwrap();
        let (_, table, _) = for_board(&root().join(DUHEM), &board).unwrap();
        Self { board, line: to_record(wiring.line()), wiring, old: to_record(&table), _folder: folder }
    }
}

/// Kills hosts of several devices at moments of a whole run, until enough devices were in motion and `enough`
/// says so, too.
fn killed(device: impl Fn() -> Driven + Sync, run: impl Fn(&Driven, Duration) -> (bool, bool) + Sync, whole: Duration) {
    let (mut whole, mut moved, mut kept) = (whole, 0, 0);
    for _ in 0..ROUNDS {
        let found: Vec<(bool, bool)> = std::thread::scope(|scope| {
            let hosts: Vec<_> = (1..=KILLS)
                .map(|kill| {
                    let (device, run) = (&device, &run);
                    scope.spawn(move || run(&device(), whole.mul_f64(f64::from(kill) / f64::from(KILLS))))
                })
                .collect();
            hosts.into_iter().map(|host| host.join().unwrap()).collect()
        });
        moved += found.iter().filter(|(moved, _)| *moved).count();
        kept += found.iter().filter(|(_, kept)| *kept).count();
        if moved >= 3 && kept >= 3 {
            return;
        }
        // So many at once take longer than the one that was measured.
        whole = whole.mul_f64(1.3);
    }
    panic!("{moved} hosts were killed while the device moved, and {kept} with something recorded");
}

/// How many rows a log has that may be cut short; each is whole.
pub fn rows(log: &Path) -> usize {
    let text = fs::read_to_string(log).unwrap();
    let commas = text.lines().next().unwrap_or_default().matches(',').count();
    assert!(text.is_empty() || text.ends_with('\n') && commas >= 2, "{log:?} ends amid a line");
    assert!(text.lines().all(|line| line.matches(',').count() == commas), "{log:?}");
    // A few rows are no log yet, for who reads it.
    if text.lines().count() > 50 {
        read(log, &ReadOptions::default()).unwrap();
    }
    text.lines().count().saturating_sub(1)
}

#[test]
fn a_killed_follow_lets_the_output_rest_and_keeps_what_it_has_recorded() {
    let table = Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap();
    let stored = to_record(&table);
    let device = || {
        let driven = Driven::new(DRIVE, &stored, amplifier(DRIVE, TABLE.adc), 0.5);
        let wave =
            (0..1000).map(|k| format!("{:.3},{}\n", f64::from(k) * 1e-3, 20.0 + 5.0 * (f64::from(k) * 0.02).sin()));
        fs::write(driven.path("wanted.csv"), "time_s,displacement_um\n".to_owned() + &wave.collect::<String>())
            .unwrap();
        fs::write(driven.path("log.csv"), "of before").unwrap();
        driven
    };
    let begins = |driven: &Driven, run: &mut dyn FnMut(&[&str])| {
        let (wanted, log) = (driven.path("wanted.csv"), driven.path("log.csv"));
        run(&["follow", text(&wanted), "--out", text(&log), "--force", "--port", &driven.port()]);
    };
    let (first, start) = (device(), Instant::now());
    begins(&first, &mut |follow| drop(piezo().args(follow).assert().success()));
    let (whole, all) = (start.elapsed(), rows(&first.path("log.csv")));
    let run = |driven: &Driven, after| {
        let mut moved = false;
        begins(driven, &mut |follow| moved = driven.kill(follow, after));
        assert!(goes_on("follow", &driven.device, &stored), "the table is another");
        let (log, left) = (driven.path("log.csv"), driven.path("log.csv.partial"));
        let before = fs::read_to_string(&log).unwrap() == "of before";
        assert!(before || !left.exists() && rows(&log) == all, "the log of before, or all of the new one");
        let kept = if left.exists() { rows(&left) } else { 0 };
        assert!(!moved || kept > 0, "the device moved, and nothing is known of it");
        (moved, kept > 100)
    };
    killed(device, run, whole);
}

#[test]
fn a_killed_train_lets_the_output_rest_and_keeps_the_table_of_before_and_its_logs() {
    let Before { board, wiring, line, old, .. } = &Before::new();
    let device = || Driven::new(wiring.drive(), old, emulated(wiring, Kind::BoucWen, 1).connected(), 4.0);
    let begins = |driven: &Driven, run: &mut dyn FnMut(&[&str])| {
        let (out, short) = (driven.path("out"), ["--minutes", "0.7", "--up-to", "20"]);
        run(&[&["train", "--out", text(&out), "--board", text(board), "--port", &driven.port()], &short[..]].concat());
    };
    let (first, start) = (device(), Instant::now());
    begins(&first, &mut |train| drop(piezo().args(train).assert().success()));
    let whole = start.elapsed();
    let run = |driven: &Driven, after| {
        let mut moved = false;
        begins(driven, &mut |train| moved = driven.kill(train, after));
        let (out, former) = (driven.path("out"), driven.path("out").join(FORMER));
        let mut client = ticks_on("train", driven.device.address());
        client.restart().unwrap();
        let found = client.pull().unwrap();
        drop(client);
        assert!(found == *old || found == *line, "another table");
        if found == *line {
            assert_eq!(fs::read(&former).unwrap(), old[..], "nobody has the table of before");
            let push = ["push", text(&former), "--reset", "--port", &driven.port()];
            piezo().args(push).assert().success();
            assert_eq!(ticks_on("push", driven.device.address()).pull().unwrap(), *old);
        }
        let files = fs::read_dir(&out).into_iter().flatten().map(|entry| entry.unwrap().path());
        let logs = files.filter(|path| path.extension().is_some_and(|of| of == "csv"));
        (moved, logs.map(|log| rows(&log)).sum::<usize>() > 100)
    };
    killed(device, run, whole);
}
