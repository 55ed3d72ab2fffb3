//! Standard errors are small where the readings say something, and large where they do not.

use estimator_core::{Admitted, Table};
use identifiability::{Determination, Experiment, Told, Unknown, determination};
use recordings::session::Session;
use std::f64::consts::TAU;
use std::path::Path;
use validation::Run;

const TICK_S: f64 = 5e-4;
/// Every tenth tick is measured.
const EVERY: u32 = 10;
const LOW: f64 = 0.0;
const HIGH: f64 = 3.6;

fn table() -> Admitted {
    table_of("generalised-prandtl-ishlinskii")
}

fn table_of(model: &str) -> Admitted {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/table/models");
    let (_, table) = table_files::TableFile::load(&models.join(format!("{model}.toml"))).unwrap();
    Table { interval: None, ..*table }.admit().unwrap()
}

/// Sines from the lower end to a part of the range.
fn sines(part: f64, hz: f64, cycles: u32) -> Vec<f64> {
    let period = (1.0 / hz / TICK_S).round();
    let ticks = (0..(period as u32) * cycles).map(|tick| (f64::from(tick) / period).fract());
    ticks.map(|phase| LOW + part * (HIGH - LOW) * 0.5 * (1.0 - (TAU * phase).cos())).collect()
}

fn hold(seconds: f64) -> Vec<f64> {
    vec![HIGH; (seconds / TICK_S) as usize]
}

/// What a sensor with noise of this deviation (µm) sees of the table's own actuator; the noise is one of steps, so that
/// every reading is independent.
fn session(voltage: &[f64], noise_um: f64) -> Session {
    seen(&table(), voltage, EVERY, noise_um)
}

fn seen(table: &Admitted, voltage: &[f64], every: u32, noise_um: f64) -> Session {
    let instants: Vec<u32> = (0..voltage.len() as u32).step_by(every as usize).collect();
    let blank = Session::new("made".into(), voltage.to_vec(), instants.clone(), vec![0.0; instants.len()], TICK_S);
    let run = Run::of::<f64>(table, &blank, None, None);
    let noise = (0u32..).map(|n| if n.wrapping_mul(2_654_435_761) >> 31 == 0 { noise_um } else { -noise_um });
    let first = run.estimated[0];
    let seen = std::iter::once(first).chain(run.estimated).zip(noise).map(|(displacement, noise)| displacement + noise);
    Session { displacement: seen.collect(), ..blank }
}

fn of(voltage: &[f64], noise_um: f64) -> Determination {
    determination(&table(), &[&session(voltage, noise_um)]).expect("there is something to tell")
}

fn error(determination: &Determination, experiment: Experiment) -> f64 {
    let found = determination.found.iter().find(|found| found.experiment == experiment);
    found.expect("every experiment is made").standard_error_um
}

const HALF: Experiment = Experiment::Width { part: 0.5, hz: 1.0 };
const FULL: Experiment = Experiment::Width { part: 1.0, hz: 1.0 };
const FAST: Experiment = Experiment::Width { part: 1.0, hz: 10.0 };

#[test]
fn what_was_recorded_is_known_and_what_was_not_is_not() {
    let major = sines(1.0, 1.0, 6);
    let alone = of(&major, 0.02);
    let with = |more: Vec<f64>| of(&[major.clone(), more].concat(), 0.02);
    for (experiment, more) in
        [(HALF, sines(0.5, 1.0, 6)), (FAST, sines(1.0, 10.0, 20)), (Experiment::Creep, hold(15.0))]
    {
        let (before, after) = (error(&alone, experiment), error(&with(more), experiment));
        assert!(after < 0.6 * before, "{experiment:?}: {before:.4} µm without, {after:.4} µm with");
        assert!(before > 2.0 * error(&alone, FULL), "{experiment:?} was not in {before:.4} µm");
    }
    let told_of_creep = |log: &[f64]| {
        let of = of(log, 0.02);
        of.found.iter().find(|found| found.experiment == Experiment::Creep).unwrap().told
    };
    let still = vec![LOW; (15.0 / TICK_S) as usize];
    assert_eq!(told_of_creep(&[still, major.clone()].concat()), Told::Restless, "nothing moved before it rested");
    let short = (5.0 / TICK_S) as usize;
    assert_eq!(told_of_creep(&[major.clone(), hold(15.0)[..short].to_vec()].concat()), Told::Restless, "half as long");
    assert_ne!(told_of_creep(&[major.clone(), hold(9.5)].concat()), Told::Restless);
    let loops = [major.clone(), sines(0.5, 1.0, 2)].concat();
    let loud = of(&loops, 1.0);
    let told =
        |experiment, of: &Determination| of.found.iter().find(|found| found.experiment == experiment).unwrap().told;
    assert_eq!((told(FULL, &alone), told(HALF, &loud)), (Told::Well, Told::Partly), "{loud:#?}");
    assert_eq!(told(FAST, &loud), Told::Slower, "{loud:#?}");
    let fast = of(&[major.clone(), sines(0.5, 10.0, 20)].concat(), 0.02);
    assert!(fast.found.iter().all(|found| found.told != Told::Slower), "half the range is fast enough: {fast:#?}");
    assert_eq!(told(HALF, &alone), Told::OtherSwings, "a law alone says what smaller loops do");
    assert_eq!(told(HALF, &with(sines(0.25, 1.0, 2))), Told::OtherSwings, "half as far");
    assert_eq!(told(HALF, &with(sines(0.4, 1.0, 2))), Told::Well, "about as far");
    let from_middle = of(&major[500..], 0.02);
    assert_eq!(told(HALF, &from_middle), Told::OtherSwings, "half as far at first, from a sine's middle");
    let once = determination(&table(), &[&session(&major, 0.02), &session(&sines(0.5, 1.0, 1), 0.02)]).unwrap();
    assert_ne!(told(HALF, &once), Told::OtherSwings, "up and back once, from where a log begins to where it ends");
    let slow = of(&sines(1.0, 0.2, 2), 0.02);
    let of_loops = slow.found.iter().filter(|found| matches!(found.experiment, Experiment::Width { part: 1.0, .. }));
    assert!(of_loops.clone().count() == 2 && of_loops.clone().all(|found| found.told == Told::Slower), "{slow:#?}");
    let hardly = of(&loops, 3.0);
    assert!(hardly.found.iter().any(|found| found.experiment == HALF && found.told == Told::Not), "{hardly:#?}");
}

#[test]
fn nothing_is_asked_for_that_the_amplifier_is_too_slow_for() {
    let major = [session(&sines(1.0, 1.0, 6), 0.02)];
    let asked = |slew: Option<f32>| {
        let table = Table { amplifier_slew_v_per_s: slew, ..*table() }.admit().unwrap();
        let found = determination(&table, &[&major[0]]).unwrap().found;
        [FAST, FULL, HALF].map(|experiment| found.iter().any(|found| found.experiment == experiment))
    };
    // A sine of 10 Hz over 3.6 V is 113 V/s steep.
    assert_eq!(asked(Some(120.0)), asked(None));
    assert_eq!(asked(Some(100.0)), [false, true, true]);
    let stroke = determination(&Table { amplifier_slew_v_per_s: Some(1.0), ..*table() }.admit().unwrap(), &[&major[0]]);
    assert_eq!(
        stroke.unwrap().found.iter().map(|found| found.experiment).collect::<Vec<_>>(),
        [Experiment::Stroke, Experiment::Creep]
    );
}

/// How far apart the branches of the last sine of a session's displacement are at its middle voltage, µm.
fn width_in_log(session: &Session, period: usize) -> f64 {
    let last = &session.displacement[session.displacement.len() - period..];
    last[3 * period / 4] - last[period / 4]
}

#[test]
fn a_loop_is_as_wide_as_in_a_log_of_the_table_where_a_row_has_voltage_and_displacement_of_one_instant() {
    for model in ["generalised-prandtl-ishlinskii", "bouc-wen", "prandtl-ishlinskii", "voigt-chain"] {
        let table = table_of(model);
        for (experiment, hz) in [(FULL, 1.0), (FAST, 10.0)] {
            let log = seen(&table, &sines(1.0, hz, 2), 1, 1e-4);
            let found = determination(&table, &[&log]).expect("there is something to tell").found;
            let read = found.iter().find(|found| found.experiment == experiment).expect("every experiment is made");
            let (read, logged) = (read.value_um, width_in_log(&log, (1.0 / hz / TICK_S).round() as usize));
            assert!((read - logged).abs() < 0.005, "{model} at {hz} Hz: {read:.3} µm read, {logged:.3} µm in the log");
        }
    }
}

#[test]
fn noise_and_repetition_count() {
    let major = sines(1.0, 1.0, 4);
    let (quiet, loud) = (of(&major, 0.01), of(&major, 0.04));
    let long = of(&sines(1.0, 1.0, 16), 0.04);
    let stroke = |of: &Determination| error(of, Experiment::Stroke);
    assert!((2.5..=4.1).contains(&(stroke(&loud) / stroke(&quiet))), "{} {}", stroke(&loud), stroke(&quiet));
    assert!((1.6..=2.5).contains(&(stroke(&loud) / stroke(&long))), "{} {}", stroke(&loud), stroke(&long));
    assert!((loud.mae_um - 0.04).abs() < 0.002 && loud.effective_readings > 0.3 * loud.readings as f64, "{loud:#?}");
}

#[test]
fn a_start_that_the_model_does_not_fit_says_little_and_takes_nothing_from_what_follows() {
    let known = session(&sines(1.0, 1.0, 6), 0.02);
    // Until the voltage has gone down from the top once the displacement is lower, as that of an actuator that
    // nothing had marked.
    let reading = known.instants.len() / 12;
    let mut unmarked = known.clone();
    unmarked.displacement[..reading].iter_mut().for_each(|displacement| *displacement -= 2.0);
    let of = |session: &Session| determination(&table(), &[session]).expect("there is something to tell");
    let (unmarked, known) = (of(&unmarked), of(&known));
    assert_eq!((unmarked.readings, unmarked.mae_um), (known.readings, known.mae_um));
    for experiment in [Experiment::Stroke, FULL] {
        let (with, without) = (error(&known, experiment), error(&unmarked, experiment));
        assert!((1.0..1.3).contains(&(without / with)), "{experiment:?}: {with:.4} and {without:.4} µm");
    }
    // The first rise is half a swing's.
    assert!(error(&unmarked, HALF) > 2.0 * error(&known, HALF), "{unmarked:#?}");
}

#[test]
fn nothing_is_said_of_what_has_no_errors() {
    let still = session(&vec![1.0; 4000], 0.0);
    assert_eq!(determination(&table(), &[&still]), Err(Unknown::NothingRead));
    assert_eq!(determination(&table(), &[]), Err(Unknown::NothingRead));
}
