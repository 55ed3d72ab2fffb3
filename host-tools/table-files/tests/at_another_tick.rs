//! A table that is brought to another tick gives the displacements that it gave, on the measured log at its own speed
//! and twenty times as fast; one that is bound to its tick says so.

use estimator_core::{Estimator, Model, Parameters};
use recordings::log::{Log, ReadOptions, read};
use std::path::{Path, PathBuf};
use table_files::TableFile;

/// Ticks of the images that there are, µs.
const TICKS_US: [u32; 4] = [1_000, 500, 200, 100];
/// How many times as fast the log is.
const FASTER: f64 = 20.0;
/// Furthest that the displacements may be apart, of the table's span: of the log, and of the faster one.
const SLOW: f64 = 3e-4;
const FAST: f64 = 4e-3;

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(path)
}

fn table(model: Model) -> TableFile {
    TableFile::load(&data(&format!("table/models/{}.toml", model.name()))).unwrap().0
}

fn log(faster: f64) -> Log {
    let log = read(&data("picma-p885-1hz.csv"), &ReadOptions::default()).unwrap();
    Log { sample_period: log.sample_period / faster, ..log }
}

/// The displacements at the log's own instants but the first, µm.
fn displacements(file: &TableFile, log: &Log) -> Vec<f64> {
    let mut estimator = Estimator::<f64>::new(&file.admit().unwrap());
    let session = file.recipe.session(log).unwrap();
    let zero = file.recipe.voltage_zero_v;
    let estimates: Vec<f64> =
        session.voltage.iter().map(|volts| estimator.tick_volts(volts + zero).displacement).collect();
    // Each is that of the next tick.
    session.instants[1..].iter().map(|tick| estimates[*tick as usize - 1]).collect()
}

/// How far the displacements of the table at another tick are from its own at most, of its span.
fn off(file: &TableFile, tick_us: u32, faster: f64) -> f64 {
    // Instants at whole ticks of every rate.
    let coarse = |log: Log| {
        let step = (2e-3 / log.sample_period).round().max(1.0) as usize;
        let every = |samples: &[f64]| samples.iter().step_by(step).copied().collect::<Vec<_>>();
        let displacement = log.displacement.as_deref().map(every);
        Log { voltage: every(&log.voltage), displacement, sample_period: log.sample_period * step as f64, ..log }
    };
    let log = coarse(log(faster));
    let mut other = file.clone();
    other.bring_to(tick_us).unwrap();
    let (own, other) = (displacements(file, &log), displacements(&other, &log));
    let pairs = own.iter().zip(&other);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / f64::from(file.table.displacement_limits_um.span())
}

#[test]
fn the_voigt_family_and_the_generalised_operator_give_what_they_gave() {
    for model in Model::ALL.into_iter().filter(|model| model.is_voigt()) {
        for tick_us in TICKS_US {
            let (slow, fast) = (off(&table(model), tick_us, 1.0), off(&table(model), tick_us, FASTER));
            println!("{} at {tick_us} µs: {slow:.2e}, {fast:.2e} of the span", model.name());
            assert!(slow < SLOW && fast < FAST, "{} at {tick_us} µs: {slow}, {fast}", model.name());
        }
    }
    let mut operator = table(Model::GeneralisedPrandtlIshlinskii);
    let Parameters::GeneralisedPrandtlIshlinskii(of) = &mut operator.table.parameters else { panic!("the operator") };
    // As short as an amplifier's; that of the log's own table is its sensor's, too.
    of.delay_ticks = 1.2;
    for tick_us in TICKS_US {
        let (slow, fast) = (off(&operator, tick_us, 1.0), off(&operator, tick_us, FASTER));
        println!("operator at {tick_us} µs: {slow:.2e}, {fast:.2e} of the span");
        assert!(slow < SLOW && fast < FAST, "{tick_us} µs: {slow}, {fast}");
    }
}

#[test]
fn a_delay_that_is_too_long_for_the_shorter_tick_is_refused_and_the_tick_of_its_own_changes_nothing() {
    let operator = table(Model::GeneralisedPrandtlIshlinskii);
    let mut brought = operator.clone();
    brought.bring_to(100).unwrap();
    assert!(brought.admit().unwrap_err().to_string().contains("delay_ticks"));
    let mut same = operator.clone();
    same.bring_to(500).unwrap();
    assert_eq!(same, operator);
    // What is a length of time stays one.
    let rate = |file: &TableFile| file.table.interval.unwrap().rate_ticks * file.table.sample_period_us as f32;
    assert!((rate(&brought) / rate(&operator) - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_bound_to_its_tick_says_so() {
    for model in Model::ALL {
        if model.is_voigt() || model == Model::GeneralisedPrandtlIshlinskii {
            continue;
        }
        let said = table(model).bring_to(100).unwrap_err().to_string();
        assert!(said.contains(model.name()) && said.contains("500 µs"), "{said}");
    }
}
