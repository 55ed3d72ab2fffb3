//! Processor in the loop: a table of every model, identified on the measured log and pushed to the emulated firmware,
//! gives the host's bits tick for tick.

use estimator_core::Model;
use qemu_test::{Board, repository};
use serde_json::Value;

/// Enough for rest, rise, both reversals and more than two periods.
const TICKS: &str = "5000";

fn pil(models: &[Model]) {
    let board = Board::power_on();
    let log = repository("tests/data/picma-p885-1hz.csv");
    let log = log.to_str().unwrap();
    for model in models {
        let table = repository(&format!("tests/data/table/models/{}.toml", model.name()));
        let table = table.to_str().unwrap();
        board.does("push", &[table, "--pause", "--reset", "--doubted"]);
        let said = board.does("pil", &[table, log, "--limit", TICKS, "--json"]);
        let report: Value = serde_json::from_str(&said).unwrap();
        assert_eq!(report["ticks"].as_u64().unwrap().to_string(), TICKS, "{model}: {report:#}");
        assert_eq!(report["identical"], report["ticks"], "{model}: {report:#}");
    }
}

#[test]
fn the_first_half_of_the_models_gives_the_host_s_bits() {
    pil(&Model::ALL[..Model::ALL.len() / 2]);
}

#[test]
fn the_second_half_of_the_models_gives_the_host_s_bits() {
    pil(&Model::ALL[Model::ALL.len() / 2..]);
}
