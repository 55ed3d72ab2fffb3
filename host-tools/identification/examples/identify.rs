//! A log in, a parameter table out: `identify log.csv table.bin`.
//!
//! What is learnt from half of the log, the first where the second is like it, is judged on the other, and learnt
//! again from all of it. `piezo identify` does more: it calibrates the ± beside the estimate, says what the log did
//! not determine, puts the doubts in words, and draws it all.
//!
//!     cargo run --release --package identification --example identify -- tests/data/picma-p885-1hz.csv table.bin

use calibration::CalibrationOptions;
use estimator_core::record::MAX_LENGTH;
use identification::cost::{Cost, Feedback};
use identification::{Conditions, Job, ModelChoice, SearchOptions};
use recordings::log::{self, ReadOptions};
use recordings::prepare::PrepareOptions;
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = env::args_os().skip(1).map(PathBuf::from);
    let (Some(log), Some(out)) = (paths.next(), paths.next()) else { return Err("identify log.csv table.bin".into()) };
    let job = Job {
        training: vec![log::read(&log, &ReadOptions::default())?],
        held_out: Vec::new(),
        hold_out: 0.5,
        as_judged: false,
        prepare: PrepareOptions::default(),
        model: ModelChoice::Auto,
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Cost::from(Feedback::Simulation),
        search: SearchOptions::DEFAULT,
    };
    let outcome = job.run(&mut |_model, _cost_um| ())?;
    let chosen = &outcome.learnt.candidate;
    for candidate in &outcome.candidates {
        if let Some(errors) = candidate.held_out_figures() {
            let mark = if candidate.table.model() == chosen.table.model() { "chosen" } else { "" };
            println!("{:<32} {:7.3} µm {mark}", candidate.table.model().to_string(), errors.mae_um);
        }
    }
    for doubt in &outcome.doubts {
        println!("doubt: {doubt:?}");
    }
    let mut record = [0; MAX_LENGTH];
    let length = chosen.table.encode(&mut record).ok_or("the table does not fit into a record")?;
    fs::write(out, &record[..length])?;
    Ok(())
}
