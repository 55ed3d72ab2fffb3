//! From a board that knows nothing to a proven table, as it is typed: `piezo` at the unmodified image's serial line,
//! and an amplifier, an actuator and a displacement sensor at its pins.

use crate::common::{Bench, PERIOD, shown, triangle};
use anyhow::{Context, Result, bail, ensure};
use bench::{BoardFacts, EMULATED, Wiring, emulated};
use board_emulator_test::{Reset, Stop};
use emulator::{Conversion, Plant};
use estimator_core::{AdcCode, DacCode};
use firmware::rate::TICK_US;
use plants::Kind;
use protocol::Faults;
use std::cell::Cell;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Output, Stdio};
use std::rc::Rc;
use std::time::Duration;
use std::{fs, thread};
use tempfile::TempDir;

/// The emulated bench, whose amplifier is as quick as may be: what the monitor reads leaps where that is plugged in.
const FACTS: BoardFacts = BoardFacts { amplifier_slew: None, ..EMULATED };
/// What 500 V/s are in a tick: 0.25 V, in parts of a code of 160 V/4095, to the next.
const STRIDE: u16 = 103;
/// A session as short as the slew limit lets it be, at no more than so many Hz.
const SHORT: [&str; 6] = ["--board", "board.toml", "--minutes", "0.7", "--up-to", "20"];
/// From one look at the host's socket to the next, s of the board's.
const LOOK: f64 = 1e-3;

/// A board whose serial line is a socket. Its time stands still while nobody is on the line.
struct Desk {
    bench: Bench,
    socket: TcpListener,
    host: Option<TcpStream>,
    folder: TempDir,
    /// The first code at the DAC's pin since the amplifier was plugged in.
    plugged: usize,
}

impl Desk {
    /// A new board whose DAC drives the amplifier, by a straight line.
    fn prepared() -> Result<Self> {
        let socket = TcpListener::bind(("127.0.0.1", 0))?;
        socket.set_nonblocking(true)?;
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("board.toml"), FACTS.to_toml())?;
        // Before, its amplifier is not plugged in.
        let mut bench = Bench::erased()?;
        bench.board.feed(triangle);
        let mut desk = Self { bench, socket, host: None, folder, plugged: 0 };
        let installed = desk.does(&["install", "--line", "--rewired", "--board", "board.toml"])?;
        assert!(installed.contains("bit-exact"), "{installed}");
        desk.plug_in(emulated(&Wiring::new(&FACTS, TICK_US)?, Kind::RateDependent, 5).connected());
        desk.plugged = desk.bench.board.record().outputs.len();
        Ok(desk)
    }

    /// Puts what a plant makes of the DAC's pin on the inputs.
    fn plug_in(&mut self, mut plant: impl Plant) {
        let sensor = Rc::new(Cell::new(0));
        let shows = sensor.clone();
        let mut command = DacCode(0);
        self.bench.board.connect(move |_, pin| {
            // What holds the pin while nobody drives it keeps the command.
            command = pin.map_or(command, DacCode);
            let Conversion { monitor: AdcCode(monitor), sensor, .. } = plant.sample(command);
            shows.set(sensor.map_or(0, |AdcCode(code)| code));
            monitor
        });
        self.bench.board.feed_sensor(move |_| sensor.get());
    }

    /// Starts a command of the host tool.
    fn begins(&self, command: &[&str]) -> Result<Child> {
        let piezo = std::env::var_os("PIEZO").context("$PIEZO is no host tool: `cargo xtask test board` builds one")?;
        let port = format!("tcp:{}", self.socket.local_addr()?);
        let mut piezo = Command::new(piezo);
        piezo.arg(command[0]).args(["--port", &port]).args(&command[1..]);
        piezo.current_dir(self.folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
        Ok(piezo.spawn()?)
    }

    /// Carries out a command of the host tool, which is to succeed; what it prints.
    fn does(&mut self, command: &[&str]) -> Result<String> {
        let mut child = self.begins(command)?;
        while child.try_wait()?.is_none() {
            self.look()?;
        }
        let Output { status, stdout, stderr } = child.wait_with_output()?;
        let (printed, complained) = (String::from_utf8(stdout)?, String::from_utf8(stderr)?);
        ensure!(status.success(), "{command:?}: {status}\n{printed}{complained}");
        Ok(printed)
    }

    /// Carries what is waiting on the line and, while a host is there, lets the board run.
    fn look(&mut self) -> Result<()> {
        let Some(host) = &mut self.host else {
            match self.socket.accept() {
                Ok((host, _)) => {
                    host.set_nonblocking(true)?;
                    host.set_nodelay(true)?;
                    self.host = Some(host);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => thread::sleep(Duration::from_millis(1)),
                Err(error) => return Err(error.into()),
            }
            return Ok(());
        };
        let mut buffer = [0; 4096];
        let sent = host.write_all(&self.bench.board.take_received());
        match host.read(&mut buffer) {
            Ok(length) if length > 0 => self.bench.board.send(&buffer[..length]),
            Err(error) if error.kind() == ErrorKind::WouldBlock && sent.is_ok() => {}
            // It has left.
            _ => self.host = None,
        }
        match self.bench.board.run(LOOK)? {
            Stop::Time => Ok(()),
            Stop::Reset(Reset::Software) => self.bench.reboot(Reset::Software),
            stop => bail!("the board stops: {stop:?}"),
        }
    }

    /// Since the amplifier was plugged in no byte and no trigger was lost, and the DAC has never moved faster than
    /// the slew limit.
    fn never_jumped(&self) {
        let record = self.bench.board.record();
        assert_eq!((record.overruns, record.lost_triggers), (0, 0));
        for pair in shown(record, self.plugged).windows(2) {
            let step = pair[0].code.abs_diff(pair[1].code);
            // To the nearest: a reset does not keep the triggers' phase.
            let ticks = (pair[1].clock - pair[0].clock + PERIOD / 2) / PERIOD;
            assert!(u64::from(step) <= u64::from(STRIDE) * ticks, "{pair:?}");
        }
    }
}

#[test]
fn learn_ends_with_a_table_that_is_installed_and_proven() -> Result<()> {
    let mut desk = Desk::prepared()?;
    let search = ["--", "--model", "generalised-prandtl-ishlinskii", "--evaluations", "6", "--devices", "4"];
    let printed = desk.does(&[&["learn", "--out", "p885", "--proof-seconds", "10"], &SHORT[..], &search].concat())?;
    for part in ["No doubt was found", "bit-exact", "PASS: the table's ± holds the sensor"] {
        assert!(printed.contains(part), "{part:?} is missing in\n{printed}");
    }
    println!("{}", printed.lines().find(|line| line.starts_with("PASS")).unwrap_or_default());
    desk.never_jumped();
    let proven = desk.bench.identity()?.model;
    assert_eq!(proven, "generalised Prandtl–Ishlinskii");
    assert_eq!(desk.bench.health()?.faults, Faults::SAFE_OUTPUT);
    Ok(())
}

#[test]
fn a_host_that_is_killed_in_a_training_leaves_the_amplifier_at_rest() -> Result<()> {
    let mut desk = Desk::prepared()?;
    let rest = desk.bench.board.output().context("the DAC drives")?;
    let mut train = desk.begins(&[&["train", "--out", "p885"], &SHORT[..]].concat())?;
    while desk.bench.board.output() < Some(rest + 1_000) {
        ensure!(train.try_wait()?.is_none(), "it ends before the voltage has come to 39 V");
        desk.look()?;
    }
    train.kill()?;
    train.wait()?;
    // It waits a second for more. What it has sent meanwhile, part of a frame at first, nobody reads.
    desk.bench.board.run(1.5)?;
    desk.bench.board.take_received();
    // A rest between two codes is both by turns.
    let output = desk.bench.board.output().context("it drives still")?;
    assert!(output.abs_diff(rest) <= 1, "{output} for {rest}");
    desk.never_jumped();
    let info: serde_json::Value = serde_json::from_str(&desk.does(&["info", "--json"])?)?;
    assert_eq!(info["health"]["faults"], serde_json::json!(["SAFE_OUTPUT"]), "{info:#}");
    Ok(())
}
