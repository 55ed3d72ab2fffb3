//! On a terminal it is asked whether a table with doubts goes to a board: nothing but yes is yes, and nobody is
//! asked for nothing.

use super::device::for_the_board;
use super::doubted::{DOUBT, DOUBTED, stored};
use super::{root, text};
use emulator::{EmulatedDevice, Emulator};
use parameter_store::RamFlash;
use serialport::{SerialPort, TTYPort};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

const QUESTION: &str = "[y/N] ";
/// How long a verb may take to ask or to end.
const PATIENCE: Duration = Duration::from_secs(60);

/// A verb at a terminal.
struct Typed {
    user: TTYPort,
    /// Held open, so that what is said last can be read after the verb has ended.
    _terminal: TTYPort,
    host: Child,
    said: String,
}

impl Typed {
    /// Begins it with the programs of a folder.
    fn new(verb: &[&str], programs: &Path) -> Self {
        let (mut user, terminal) = TTYPort::pair().unwrap();
        user.set_timeout(Duration::from_millis(50)).unwrap();
        let open = || File::options().read(true).write(true).open(terminal.name().unwrap()).unwrap();
        // Who runs the tests in the background may have them ignore Ctrl-C, and what they start with them.
        let mut command = Command::new("/usr/bin/env");
        command
            .args(["--default-signal=INT", env!("CARGO_BIN_EXE_piezo")])
            .args(verb)
            .env("PATH", programs)
            .env_remove("PIEZO_PORT")
            .current_dir(root());
        let host = command.stdin(open()).stderr(open()).stdout(Stdio::null()).spawn().unwrap();
        Self { user, _terminal: terminal, host, said: String::new() }
    }

    /// Listens until it asks, or has ended; what it says meanwhile must not fill the terminal.
    fn listen(&mut self) -> Option<ExitStatus> {
        let start = Instant::now();
        loop {
            let ended = self.host.try_wait().unwrap();
            let mut bytes = [0; 512];
            let heard = self.user.read(&mut bytes).unwrap_or(0);
            self.said.push_str(&String::from_utf8_lossy(&bytes[..heard]));
            if (ended.is_some() && heard == 0) || self.said.ends_with(QUESTION) {
                return ended;
            }
            assert!(start.elapsed() < PATIENCE, "{}", self.said);
        }
    }

    /// What comes of this answer, with all that was said.
    fn answered(mut self, answer: impl FnOnce(&mut TTYPort, &Child)) -> (ExitStatus, String) {
        assert_eq!(self.listen(), None, "it ends without asking: {}", self.said);
        assert!(self.said.contains(DOUBT), "{}", self.said);
        answer(&mut self.user, &self.host);
        // Another question must not be taken for this one.
        self.said.push('\n');
        (self.listen().expect("it asks once"), self.said.clone())
    }

    /// How it ends without asking.
    fn unasked(mut self) -> String {
        let ended = self.listen().unwrap_or_else(|| panic!("it asks: {}", self.said));
        assert_eq!(ended.code(), Some(2), "{}", self.said);
        assert!(!self.said.contains(QUESTION), "{}", self.said);
        self.said.clone()
    }
}

impl Drop for Typed {
    fn drop(&mut self) {
        // One that has ended is none to be killed.
        let _ = self.host.kill();
        let _ = self.host.wait();
    }
}

/// Asserts that nothing but yes has a verb write.
fn writes_on_yes_alone(verb: &[&str], programs: &Path, written: impl Fn() -> bool) {
    for no in ["\n", "n\n", "why\n"] {
        let (ended, said) = Typed::new(verb, programs).answered(|user, _| user.write_all(no.as_bytes()).unwrap());
        assert!(ended.code() == Some(2) && said.contains("nothing was written"), "{no:?}: {ended} {said}");
        assert!(!written(), "{verb:?} {no:?}");
    }
    let (ended, said) = Typed::new(verb, programs).answered(|_, host| {
        let id = host.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    });
    assert_eq!(ended.signal(), Some(2), "Ctrl-C ends the question: {said}");
    assert!(!written(), "{verb:?} Ctrl-C");
    let (ended, said) = Typed::new(verb, programs).answered(|user, _| user.write_all(b"y\n").unwrap());
    assert!(ended.success() && written(), "{verb:?}: {ended} {said}");
}

/// A board.toml for the emulated board.
fn board(folder: &Path) -> String {
    let board = folder.join("board.toml");
    fs::write(&board, "adc_span = [-0.378, 3.978]\nadc_full_scale = 65520\ndac_full_scale = 4095\n").unwrap();
    text(&board).to_owned()
}

fn port(device: &EmulatedDevice) -> String {
    format!("tcp:{}", device.address())
}

#[test]
fn push_and_install_ask_and_nothing_but_yes_is_yes() {
    let folder = tempfile::tempdir().unwrap();
    let board = board(folder.path());
    for verb in [&["push", DOUBTED, "--reset"][..], &["install", DOUBTED, "--narrow", "--board", &board]] {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let port = port(&device);
        let typed = [verb, &["--port", &port]].concat();
        writes_on_yes_alone(&typed, folder.path(), || stored(&device));
    }
}

#[test]
fn a_full_scale_that_the_board_s_file_has_wrong_is_mended_there() {
    let folder = tempfile::tempdir().unwrap();
    let board = folder.path().join("board.toml");
    fs::write(&board, "adc_span = [-0.378, 3.978]\nadc_full_scale = 4095\ndac_full_scale = 4095\n").unwrap();
    let device = Emulator::new().speed(8.0).start().unwrap();
    let typed = ["install", DOUBTED, "--narrow", "--board", text(&board), "--port", &port(&device)];
    let said = Typed::new(&typed, folder.path()).unasked();
    assert!(
        said.contains("state the device's adc_full_scale and dac_full_scale in board.toml") && !said.contains("emit"),
        "{said}"
    );
}

#[test]
fn flash_asks_and_nothing_but_yes_is_yes() {
    let folder = tempfile::tempdir().unwrap();
    let (table, told) = (for_the_board(folder.path()), folder.path().join("told"));
    let flash = ["flash", "--table", &table];
    // Without the program it could not write, whatever the answer.
    let said = Typed::new(&flash, folder.path()).unasked();
    assert!(said.contains("cargo install probe-rs-tools"), "{said}");
    let program = folder.path().join("probe-rs");
    fs::write(&program, format!("#!/bin/sh\necho \"$@\" >> '{}'\n", told.display())).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    writes_on_yes_alone(&flash, folder.path(), || told.exists());
}

#[test]
fn what_the_device_refuses_is_said_and_not_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let board = board(folder.path());
    let device = Emulator::new().speed(8.0).start().unwrap();
    let said = Typed::new(&["push", DOUBTED, "--port", &port(&device)], folder.path()).unasked();
    assert!(said.contains(DOUBT) && said.contains("writing flash may cost ticks"), "{said}");
    // One whose stored table is damaged does not know its wires.
    let device = Emulator::new().flash(RamFlash::new(vec![0; 4096])).speed(8.0).start().unwrap();
    for verb in [&["push", DOUBTED, "--reset"][..], &["install", DOUBTED, "--narrow", "--board", &board]] {
        let said = Typed::new(&[verb, &["--port", &port(&device)]].concat(), folder.path()).unasked();
        assert!(said.contains("--rewired"), "{said}");
    }
}
