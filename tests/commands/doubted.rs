//! A table's doubts are said before it goes to a board, and it goes where somebody says so.

use super::{piezo, text};
use assert_cmd::Command;
use emulator::{EmulatedDevice, Emulator};
use protocol::TableSource;

/// A table with doubts, for the emulated board.
pub const DOUBTED: &str = "tests/data/table/models/duhem.toml";
pub const DOUBT: &str = "the training logs have a single amplitude";

fn push(device: &EmulatedDevice, table: &str, more: &[&str]) -> Command {
    let mut command = piezo();
    command.args(["push", table, "--reset", "--port", &format!("tcp:{}", device.address())]).args(more);
    command
}

/// Whether the device has a stored table; it restarts.
pub fn stored(device: &EmulatedDevice) -> bool {
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
        let looked_at = push(&device, table, &["--dry-run"]).assert().code(1).get_output().clone();
        assert!(String::from_utf8(looked_at.stdout).unwrap().contains("but would be refused; nothing was written"));
        let said = String::from_utf8(looked_at.stderr).unwrap();
        assert!(said.contains(DOUBT) && said.contains("nobody can be asked"), "{said}");
    }
    let written = push(&device, DOUBTED, &["--doubted"]).assert().success().get_output().clone();
    assert!(String::from_utf8(written.stderr).unwrap().contains(DOUBT), "they are said all the same");
    assert!(stored(&device));
    // One that has none beside it is as it was pulled from a board.
    let alone = folder.path().join("alone.bin");
    std::fs::copy(&record, &alone).unwrap();
    push(&device, text(&alone), &[]).assert().success();
}
