//! Processor in the loop for the models beyond the Voigt family: each one's table, made from the measured log and pushed to the
//! emulated firmware, gives the host's bits tick for tick.

use qemu_test::{Board, repository};
use serde_json::Value;

/// Enough for rest, rise, both reversals and more than two periods.
const TICKS: &str = "5000";

fn pil(models: &[&str]) {
    let board = Board::power_on();
    let log = repository("tests/data/picma-p885-1hz.csv");
    let log = log.to_str().unwrap();
    for model in models {
        let table = board.identified(model, log);
        let table = table.to_str().unwrap();
        board.does("push", &[table, "--pause", "--reset"]);
        let said = board.does("pil", &[table, log, "--limit", TICKS, "--json"]);
        let report: Value = serde_json::from_str(&said).unwrap();
        assert_eq!(report["ticks"].as_u64().unwrap().to_string(), TICKS, "{model}: {report:#}");
        assert_eq!(report["identical"], report["ticks"], "{model}: {report:#}");
    }
}

#[test]
fn models_of_hysteresis_give_the_host_s_bits() {
    pil(&["prandtl-ishlinskii", "maxwell-slip", "preisach", "generalised-prandtl-ishlinskii"]);
}

#[test]
fn models_of_differential_and_difference_equations_give_the_host_s_bits() {
    pil(&["voigt-chain", "duhem", "bouc-wen", "narx", "enhanced"]);
}
