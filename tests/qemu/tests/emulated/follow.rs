//! A wanted trajectory over the emulated UART to a firmware whose DAC drives the amplifier.

use qemu_test::Board;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// What `piezo follow` says of `wanted.csv`, where every reference came in time; it fails just where some did not.
fn followed(board: &Board) -> Option<Value> {
    let output = board.piezo("follow", &["wanted.csv", "--out", "followed.csv", "--json"]);
    if output.status.code() == Some(2) {
        println!("on a machine this busy: {}", String::from_utf8_lossy(&output.stderr));
        return None;
    }
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    // The ADC reads a voltage of its own: that is not what fails it.
    assert_eq!(
        output.status.code() == Some(0),
        report["starved"] == 0 && !report["met_after_s"].is_null(),
        "{report:#}"
    );
    (report["starved"] == 0).then_some(report)
}

/// A trajectory a little longer than the device's queue of references lasts: QEMU puts out a sample's every byte by
/// itself, and on two slow cores its host cannot send references as fast as they are used up. Whole trajectories are
/// the native device's and the board's.
fn write_wanted(board: &Board) {
    let wanted: String = (0..200)
        .map(|k| {
            let t = f64::from(k) * 1e-3;
            format!("{t:.3},{:.4}\n", 15.0 + 8.0 * (t * 9.0).sin())
        })
        .collect();
    fs::write(board.folder.path().join("wanted.csv"), format!("time_s,displacement_um\n{wanted}")).unwrap();
}

/// A device with a table that drives, and the table: as the ADC's, which the emulated board wires the DAC to.
fn driving() -> (Board, PathBuf) {
    let board = Board::power_on();
    write_wanted(&board);
    let drive = ["--drive-span", "-0.378:3.978", "--drive-slew", "100", "--drive-rest", "0.5"];
    let table = board.table("driving", &drive);
    board.does("push", &[table.to_str().unwrap(), "--pause", "--reset", "--rewired", "--doubted"]);
    (board, table)
}

#[test]
fn a_device_that_is_not_wired_to_drive_follows_nothing_and_is_not_made_to_unasked() {
    let board = Board::power_on();
    write_wanted(&board);
    let complaint = board.refuses("follow", &["wanted.csv"]);
    assert!(complaint.contains("--drive-span"), "{complaint}");
    let table = board.table("driving", &["--drive-span", "-0.378:3.978", "--drive-slew", "100", "--drive-rest", "0.5"]);
    let complaint = board.refuses("push", &[table.to_str().unwrap(), "--pause", "--reset", "--doubted"]);
    assert!(complaint.contains("--rewired"), "{complaint}");
}

#[test]
fn a_trajectory_is_followed_at_the_device_s_pace() {
    // The emulated clock does not wait for a host that is busy with something else; the verb says so and fails then.
    // Another device each time: what one has followed halfway stays in its model's memory.
    let (report, board, table) = (0..40)
        .find_map(|_| {
            let (board, table) = driving();
            followed(&board).map(|report| (report, board, table))
        })
        .expect("not busy all the time");
    let approach = report["approach_ticks"].as_u64().unwrap() as usize;
    let ticks = approach + 401;
    assert_eq!((&report["ticks"], &report["stopped"]), (&Value::from(ticks), &Value::Array(Vec::new())), "{report:#}");
    let log = fs::read_to_string(board.folder.path().join("followed.csv")).unwrap();
    assert_eq!(log.lines().count(), ticks);
    // The planned voltages are those that the device put out, to half a code of 4.4 V/4095.
    let plan = ["feedforward", "wanted.csv", "--out", "planned.csv"];
    let planned = board.reads("feedforward", &[table.to_str().unwrap(), plan[1], plan[2], plan[3], "--json"]);
    assert_eq!((planned["approach_s"].as_f64().unwrap() / 5e-4).round() as usize, approach, "they go there alike");
    let column = |name: &str, index: usize| -> Vec<f64> {
        let text = fs::read_to_string(board.folder.path().join(name)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(index).unwrap().parse().unwrap()).collect()
    };
    let (planned, driven) = (column("planned.csv", 1), column("followed.csv", 4));
    // A row's DAC stands for the reference two ticks before it; a plan is a tick ahead of what is wanted.
    let worst = planned.iter().zip(&driven[1..]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst} V");
    assert_eq!(board.keeps_time()["mode"], "Estimate");
}
