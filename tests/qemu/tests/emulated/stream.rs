//! The verbs that look at a running device.

use qemu_test::Board;
use serde_json::Value;
use soak::{Soak, signal};
use std::fs;

#[test]
fn what_is_recorded_is_a_log_that_the_other_verbs_read() {
    let board = Board::power_on();
    board.does("record", &["--out", "log.csv", "--samples", "6000"]);
    let log = fs::read_to_string(board.folder.path().join("log.csv")).unwrap();
    let (header, rows) = log.split_once('\n').unwrap();
    assert_eq!(header, "time_s,voltage_V,estimated_displacement_um");
    assert_eq!(rows.lines().count(), 6000);
    // The emulated converter goes up and down once a second, and the estimate with it.
    let table = board.table("same", &["--dac-span", "-8:52"]);
    let report = board.reads("validate", &[table.to_str().unwrap(), "log.csv", "--json"]);
    let figures = report.to_string();
    assert!(figures.contains("mae"), "{figures}");
}

#[test]
fn monitor_and_zero() {
    let board = Board::power_on();
    let lines = board.does("monitor", &["--seconds", "3", "--json"]);
    let seconds: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(!seconds.is_empty(), "a line a second");
    let zeroed = board.does("zero", &["--at", "2"]);
    assert!(zeroed.contains("called 2 µm"), "{zeroed}");
    let info = board.does("info", &["--forget"]);
    assert!(info.contains("ago, bias "), "{info}");
    assert!(info.contains("mps2-an386") && info.contains("Voigt (4.8)"), "{info}");
    assert_eq!(board.keeps_time()["samples_dropped"], 0);
}

#[test]
fn every_sample_of_the_stream_has_the_host_s_bits() {
    let board = Board::power_on();
    let soak = Soak::at(&board.address().parse().unwrap(), signal::triangle, 6_000).unwrap();
    println!("{soak}");
    assert!(soak.sound() && soak.ticks >= 6_000 && soak.missing == 0, "{soak:?}");
}
