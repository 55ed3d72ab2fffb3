//! A wanted trajectory over the emulated UART to a firmware whose DAC drives the amplifier.

use qemu_test::Board;
use serde_json::Value;
use std::fs;

/// What `piezo follow` says of `wanted.csv`; it fails just where references came too late.
fn followed(board: &Board) -> Value {
    let output = board.piezo("follow", &["wanted.csv", "--out", "followed.csv", "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code() == Some(0), report["starved"] == 0, "{report:#}");
    report
}

#[test]
fn a_trajectory_is_followed_at_the_device_s_pace() {
    let board = Board::power_on();
    // Little longer than the device's queue of references lasts: QEMU puts out a sample's every byte by itself, and on two slow
    // cores its host cannot send references as fast as they are used up. Whole trajectories are the native device's and the board's.
    let wanted: String = (0..250)
        .map(|k| {
            let t = f64::from(k) * 1e-3;
            format!("{t:.3},{:.4}\n", 15.0 + 8.0 * (t * 9.0).sin())
        })
        .collect();
    fs::write(board.folder.path().join("wanted.csv"), format!("time_s,displacement_um\n{wanted}")).unwrap();
    let complaint = board.refuses("follow", &["wanted.csv"]);
    assert!(complaint.contains("--drive-span"), "{complaint}");

    // As the ADC's, which the emulated board wires the DAC to.
    let drive = ["--drive-span", "-0.378:3.978", "--drive-slew", "100", "--drive-rest", "0.5"];
    let table = board.table("driving", &drive);
    let push = [table.to_str().unwrap(), "--pause", "--reset"];
    let complaint = board.refuses("push", &push);
    assert!(complaint.contains("--rewired"), "{complaint}");
    board.does("push", &[&push[..], &["--rewired"]].concat());
    // The emulated clock does not wait for a host that is busy with something else; the verb says so and fails then.
    let report =
        (0..40).map(|_| followed(&board)).find(|report| report["starved"] == 0).expect("not busy all the time");
    assert_eq!((&report["ticks"], &report["stopped"]), (&Value::from(501), &Value::Array(Vec::new())), "{report:#}");
    let log = fs::read_to_string(board.folder.path().join("followed.csv")).unwrap();
    assert_eq!(log.lines().count(), 501);
    // The planned voltages are those that the device put out, to half a code of 4.4 V/4095.
    let plan = ["feedforward", "wanted.csv", "--out", "planned.csv"];
    let planned = board.reads("feedforward", &[table.to_str().unwrap(), plan[1], plan[2], plan[3], "--json"]);
    // The plan goes to where the trajectory begins first; the device went there as fast as it may.
    let approach = (planned["approach_s"].as_f64().unwrap() / 5e-4).round() as usize;
    let column = |name: &str, index: usize| -> Vec<f64> {
        let text = fs::read_to_string(board.folder.path().join(name)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').nth(index).unwrap().parse().unwrap()).collect()
    };
    let (planned, driven) = (column("planned.csv", 1), column("followed.csv", 4));
    // Once on the way. A row's DAC stands for the reference two ticks before it; a plan is a tick ahead of what is wanted.
    let worst = planned[approach + 299..approach + 480]
        .iter()
        .zip(&driven[300..])
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst} V");
    let health = &board.info()["health"];
    assert_eq!((&health["missed"], &health["mode"]), (&Value::from(0), &Value::from("Estimate")), "{health:#}");
}
