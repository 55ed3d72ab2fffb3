//! Processor in the loop: the measured log through the emulated firmware gives the host's bits.

use qemu_test::{Board, repository};
use serde_json::Value;

#[test]
fn the_measured_log_gives_the_host_s_bits() {
    let board = Board::power_on();
    let table = board.table("same", &[]);
    let table = table.to_str().unwrap();
    board.does("push", &[table, "--pause", "--reset", "--doubted"]);
    let log = repository("tests/data/picma-p885-1hz.csv");
    let said = board.does("pil", &[table, log.to_str().unwrap(), "--json"]);
    let report: Value = serde_json::from_str(&said).unwrap();
    assert!(report["ticks"].as_u64().unwrap() > 70_000, "{report:#}");
    assert_eq!(report["identical"], report["ticks"], "{report:#}");
    assert_eq!(board.info()["health"]["mode"], "Estimate", "the device estimates again");
}

#[test]
fn another_table_than_the_device_s_is_refused() {
    let board = Board::power_on();
    let table = board.table("other", &["--dac-span", "-10:60"]);
    let log = repository("tests/data/picma-p885-1hz.csv");
    let complaint = board.refuses("pil", &[table.to_str().unwrap(), log.to_str().unwrap()]);
    assert!(complaint.contains("piezo push"), "{complaint}");
}
