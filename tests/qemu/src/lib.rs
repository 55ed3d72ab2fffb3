//! The emulated board, and the host tool beside it.
//!
//! `FIRMWARE_IMAGE_MPS2` names the firmware's image and `PIEZO` the host tool; `cargo xtask test emulated` builds both
//! and sets them. Each [`Board`] is a QEMU of its own.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long the emulated UART may take to listen, and a reply to come.
const PATIENCE: Duration = Duration::from_secs(20);

/// A QEMU with the firmware in it, powered on.
pub struct Board {
    qemu: Child,
    /// Open for as long as QEMU may write there.
    _complaints: BufReader<ChildStderr>,
    port: u16,
    /// For files of the test.
    pub folder: TempDir,
}

impl Drop for Board {
    fn drop(&mut self) {
        // Nothing can be done about a process that is already gone.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}

/// The file that an environment variable names.
///
/// # Panics
/// It names none.
pub fn from_environment(name: &str) -> PathBuf {
    let path = std::env::var_os(name).map(PathBuf::from);
    path.filter(|path| path.is_file()).unwrap_or_else(|| {
        panic!("${name} names no file: run these tests with `cargo xtask test emulated`, which builds what they need")
    })
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

impl Board {
    /// Powers a board on.
    pub fn power_on() -> Self {
        let mut qemu = Command::new("qemu-system-arm")
            .args(["-M", "mps2-an386", "-cpu", "cortex-m4", "-nographic", "-monitor", "none"])
            // Time goes by instructions, 64 ns each, while the firmware computes; while it waits, by the machine's
            // clock: one that is busy may wake QEMU later than a tick, which is then late (see `Board::keeps_time`).
            .args(["-icount", "shift=6,sleep=on", "-kernel"])
            .arg(from_environment("FIRMWARE_IMAGE_MPS2"))
            // A free port of QEMU's own choosing, which it says while it waits for the first connection.
            .args(["-serial", "tcp:127.0.0.1:0,server=on,wait=on,nodelay=on"])
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("qemu-system-arm starts: `cargo xtask setup` installs it");
        let mut complaints = BufReader::new(qemu.stderr.take().expect("piped"));
        let mut said = String::new();
        let port = loop {
            let start = said.len();
            assert_ne!(complaints.read_line(&mut said).expect("text"), 0, "QEMU says no port, but: {said}");
            let port =
                said[start..].split_once("disconnected:tcp:127.0.0.1:").and_then(|(_, port)| port.split_once(','));
            if let Some((port, _)) = port {
                break port.parse().expect("a port's number");
            }
        };
        let board = Self { qemu, _complaints: complaints, port, folder: TempDir::new().expect("a temporary folder") };
        drop(board.line());
        board
    }

    /// The serial line, as a stream of bytes.
    pub fn line(&self) -> TcpStream {
        let start = Instant::now();
        loop {
            match TcpStream::connect(("127.0.0.1", self.port)) {
                Ok(line) => {
                    line.set_read_timeout(Some(Duration::from_millis(200))).expect("a timeout");
                    line.set_nodelay(true).expect("no delay");
                    return line;
                }
                Err(error) if start.elapsed() > PATIENCE => panic!("the emulated UART does not listen: {error}"),
                Err(_) => std::thread::sleep(Duration::from_millis(20)),
            }
        }
    }

    /// Where its line is.
    pub fn line_address(&self) -> SocketAddr {
        (Ipv4Addr::LOCALHOST, self.port).into()
    }

    /// What `--port` is told to reach it.
    pub fn address(&self) -> String {
        format!("tcp:127.0.0.1:{}", self.port)
    }

    /// Runs `piezo VERB --port … ARGUMENTS`.
    pub fn piezo(&self, verb: &str, arguments: &[&str]) -> Output {
        Command::new(from_environment("PIEZO"))
            .arg(verb)
            .args(["--port", &self.address()])
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .expect("piezo starts")
    }

    /// As [`Self::piezo`], with success; what it prints.
    pub fn does(&self, verb: &str, arguments: &[&str]) -> String {
        let output = self.piezo(verb, arguments);
        let (said, complained) = (text(&output.stdout), text(&output.stderr));
        assert!(output.status.success(), "piezo {verb} {arguments:?}: {}\n{said}{complained}", output.status);
        said
    }

    /// As [`Self::piezo`], refused with exit code 2; the complaint.
    pub fn refuses(&self, verb: &str, arguments: &[&str]) -> String {
        let output = self.piezo(verb, arguments);
        assert_eq!(output.status.code(), Some(2), "piezo {verb} {arguments:?}: {}", text(&output.stdout));
        text(&output.stderr)
    }

    /// Runs a verb that needs no device, with success; what it prints as JSON.
    pub fn reads(&self, verb: &str, arguments: &[&str]) -> Value {
        let mut piezo = Command::new(from_environment("PIEZO"));
        let output = piezo.arg(verb).args(arguments).current_dir(self.folder.path()).output().expect("piezo starts");
        assert!(output.status.success(), "piezo {verb} {arguments:?}: {}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    }

    /// `piezo info --json`.
    pub fn info(&self) -> Value {
        serde_json::from_str(&self.does("info", &["--json"])).expect("info prints JSON")
    }

    /// Asserts that at most one tick in a hundred was late: a busy machine makes one late now and then, a tick that
    /// takes too long nearly all. Returns `health`.
    pub fn keeps_time(&self) -> Value {
        let health = self.info()["health"].take();
        let count = |name: &str| health[name].as_u64().expect("a count");
        assert!(count("missed") <= count("ticks") / 100, "{health:#}");
        health
    }

    /// The table of tests/data made for this board, with whatever `piezo emit` is to change. Returns its `table.toml`.
    pub fn table(&self, name: &str, changes: &[&str]) -> PathBuf {
        self.table_for("65520", name, changes)
    }

    /// As [`Self::table`], for an ADC with another largest code.
    pub fn table_for(&self, adc_full_scale: &str, name: &str, changes: &[&str]) -> PathBuf {
        let out = self.folder.path().join(name);
        let output = Command::new(from_environment("PIEZO"))
            .arg("emit")
            .arg(repository("tests/data/table/table.toml"))
            .args(["--adc-full-scale", adc_full_scale, "--out"])
            .arg(&out)
            .args(changes)
            .output()
            .expect("piezo starts");
        assert!(output.status.success(), "{}", text(&output.stderr));
        out.join("table.toml")
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Sends all of it, reading meanwhile whatever comes.
pub fn send_through(line: &mut TcpStream, bytes: &[u8]) -> Vec<u8> {
    let mut reader = line.try_clone().expect("a second handle");
    let mut writer = line.try_clone().expect("a third handle");
    std::thread::scope(|scope| {
        let sent = scope.spawn(move || writer.write_all(bytes));
        let mut received = Vec::new();
        let mut buffer = [0; 4096];
        loop {
            match reader.read(&mut buffer) {
                Ok(0) => panic!("the emulator has closed the line"),
                Ok(length) => received.extend(&buffer[..length]),
                Err(_) if sent.is_finished() => break,
                Err(_) => {}
            }
        }
        sent.join().expect("no panic").expect("the line takes bytes");
        received
    })
}
