//! A table's doubts are said before it goes to a board, and it goes where somebody says so.

use super::{piezo, root, text};
use assert_cmd::Command;
use emulator::{EmulatedDevice, Emulator};
use protocol::TableSource;

/// A table with doubts, for the emulated board.
const DOUBTED: &str = "tests/data/table/models/duhem.toml";
const DOUBT: &str = "the training logs have a single amplitude";

fn push(device: &EmulatedDevice, table: &str, more: &[&str]) -> Command {
    let mut command = piezo();
    command.args(["push", table, "--reset", "--port", &format!("tcp:{}", device.address())]).args(more);
    command
}

/// Whether the device has a stored table; it restarts.
fn stored(device: &EmulatedDevice) -> bool {
    let (mut client, _) = device_link::Client::connect(&device.address().into()).unwrap();
    client.restart().unwrap().source == TableSource::Stored
}

#[test]
fn where_nobody_can_be_asked_a_doubted_table_goes_to_no_board_unless_that_is_said() {
    let device = Emulator::new().start().unwrap();
    let folder = tempfile::tempdir().unwrap();
    // The doubts of a table.bin stand in the table.toml beside it.
    let made = ["emit", "tests/data/table/table.toml", "--adc-full-scale", "65520", "--out", text(folder.path())];
    piezo().args(made).assert().success();
    let record = folder.path().join("table.bin");
    for table in [DOUBTED, text(&record)] {
        let refused = push(&device, table, &[]).assert().code(2).get_output().clone();
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(said.contains(DOUBT) && said.find(DOUBT) < said.find("has doubts"), "{said}");
        assert!(said.contains("--doubted") && refused.stdout.is_empty(), "{said}");
        assert!(!stored(&device), "nothing was written");
        let looked_at = push(&device, table, &["--dry-run"]).assert().success().get_output().clone();
        assert!(String::from_utf8(looked_at.stdout).unwrap().contains("but would be refused; nothing was written"));
        assert!(String::from_utf8(looked_at.stderr).unwrap().contains(DOUBT));
    }
    let written = push(&device, DOUBTED, &["--doubted"]).assert().success().get_output().clone();
    assert!(String::from_utf8(written.stderr).unwrap().contains(DOUBT), "they are said all the same");
    assert!(stored(&device));
    // One that has none beside it is as it was pulled from a board.
    let alone = folder.path().join("alone.bin");
    std::fs::copy(&record, &alone).unwrap();
    push(&device, text(&alone), &[]).assert().success();
}

#[cfg(unix)]
#[test]
fn on_a_terminal_it_is_asked_for_and_nothing_but_yes_is_yes() {
    use serialport::{SerialPort, TTYPort};
    use std::fs::File;
    use std::io::{Read, Write};
    use std::process::{Command, Stdio};
    let device = Emulator::new().start().unwrap();
    let asked = |answer: &str| {
        let (mut user, terminal) = TTYPort::pair().unwrap();
        user.set_timeout(std::time::Duration::from_secs(20)).unwrap();
        let open = || File::options().read(true).write(true).open(terminal.name().unwrap()).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
        command.args(["push", DOUBTED, "--reset", "--port", &format!("tcp:{}", device.address())]);
        command.current_dir(root()).stdin(open()).stderr(open()).stdout(Stdio::piped());
        let mut host = command.spawn().unwrap();
        let (mut said, mut byte) = (Vec::new(), [0]);
        while !said.ends_with(b"[y/N] ") {
            user.read_exact(&mut byte).unwrap();
            said.extend(byte);
        }
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains(DOUBT), "{said}");
        user.write_all(answer.as_bytes()).unwrap();
        host.wait().unwrap().code()
    };
    for no in ["\n", "n\n", "why\n"] {
        assert_eq!(asked(no), Some(2), "{no:?}");
        assert!(!stored(&device), "{no:?}");
    }
    assert_eq!(asked("y\n"), Some(0));
    assert!(stored(&device));
}
