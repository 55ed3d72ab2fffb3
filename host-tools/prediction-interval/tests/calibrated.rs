//! An interval that is calibrated on simulated devices, judged on a device that is none of them.

use ::calibration::CalibrationOptions;
use estimator_core::{Model, Status};
use identification::cost::{Cost, Feedback};
use identification::validate::{Coverage, Scope, compare_within};
use identification::{
    Candidate, Conditions, Job, ModelChoice, Prepared, Problem, SearchOptions, TableContext, identify, prepared,
};
use plants::{Change, Density, Kind, Plant, STEP_S, Waveform};
use prediction_interval::{Calibration, Judged, calibrate};
use recordings::log::Log;
use recordings::prepare::{AutoOr, PrepareOptions};

/// Few, so that the test takes seconds.
const DEVICES: u32 = 6;

fn learnt(plant: &Plant, model: Model, hertz: &[f64]) -> (Prepared, Candidate, SearchOptions) {
    let sine = |&hertz: &f64| Waveform::Sine { amplitude: plant.full_v, hertz, offset: 0.0 };
    learnt_from(plant, model, &hertz.iter().map(sine).collect::<Vec<_>>())
}

fn learnt_from(plant: &Plant, model: Model, waveforms: &[Waveform]) -> (Prepared, Candidate, SearchOptions) {
    let search = SearchOptions { evaluations: 60, ..SearchOptions::default() };
    let job = Job {
        training: (1..).zip(waveforms).map(|(seed, waveform)| plant.log("log", waveform, 2.0, seed)).collect(),
        held_out: Vec::new(),
        hold_out: 0.0,
        as_judged: false,
        prepare: PrepareOptions {
            voltage_zero: AutoOr::Given(0.0),
            displacement_zero: AutoOr::Given(0.0),
            ..PrepareOptions::default()
        },
        model: ModelChoice::Auto,
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Cost::from(Feedback::Simulation),
        search: search.clone(),
    };
    let prepared = job.prepare().unwrap();
    let fit = identify(&prepared.problem, &[model], job.cost, &search, &mut |_, _| ()).remove(0);
    let candidate = Candidate::new(&prepared.problem, fit, &prepared.context).unwrap();
    (prepared, candidate, search)
}

/// Where nothing was held out.
fn interval(problem: &Problem, candidate: &Candidate, context: &TableContext, search: &SearchOptions) -> Calibration {
    calibrate(problem, candidate, Judged { problem, candidate }, context, search, DEVICES, || ()).unwrap()
}

#[test]
fn it_holds_on_recordings_of_another_kind_and_is_narrower_where_the_training_was() {
    let plant = Plant::drawn(Kind::Relays(Density::Lorentzian), 77);
    let (Prepared { problem, context, .. }, candidate, search) =
        learnt(&plant, Model::GeneralisedPrandtlIshlinskii, &[2.0, 8.0]);
    let calibrated = |seed: u32| {
        let context = TableContext { seed, ..context.clone() };
        interval(&problem, &candidate, &context, &search)
    };
    let Calibration { parameters, own_um } = calibrated(1);
    assert_eq!(calibrated(1).parameters, parameters, "the same seed, the same interval");
    assert!(own_um > 0.0 && f64::from(parameters.misfit_um) > own_um);
    assert!(parameters.memory_um.windows(2).all(|pair| pair[1] <= pair[0]), "{parameters:?}");
    assert!(parameters.memory_um[0] > 0.1, "hysteresis remembers a start: {parameters:?}");
    let table = candidate.with_interval(Some(parameters)).unwrap().table;
    let full = plant.full_v;
    let judged = |waveform: Waveform, duration_s: f64| -> Coverage {
        let log = plant.log("unseen", &waveform, duration_s, 9);
        let session = prepared(&context.recipe, &context.recipe.cut(&log)).unwrap();
        let scope = Scope { zero_at_s: Some(0.5), ..Scope::ALL };
        compare_within(&table, &session, &scope).unwrap().interval.unwrap()
    };
    let as_trained = judged(Waveform::Sine { amplitude: full, hertz: 2.0, offset: 0.0 }, 3.0);
    let swelling = judged(Waveform::AmplitudeModulated { amplitude: full, hertz: 5.0, swell_hz: 0.5 }, 5.0);
    let stairs = judged(Waveform::Staircase { amplitude: 0.8 * full, steps: 6, hold_s: 0.1 }, 5.0);
    let smaller = judged(Waveform::Triangle { amplitude: 0.4 * full, hertz: 5.0, offset: 0.0 }, 3.0);
    for (name, coverage) in [("swelling", swelling), ("stairs", stairs), ("smaller", smaller), ("trained", as_trained)]
    {
        assert!(coverage.covered_percent >= 90.0, "{name}: {coverage:?}");
        assert!(coverage.half_width_um < 0.06 * plant.stroke_um, "{name}: {coverage:?}");
    }
    assert!(as_trained.half_width_um < 0.03 * plant.stroke_um, "{as_trained:?}");
    assert!(as_trained.half_width_um < stairs.half_width_um, "{as_trained:?} {stairs:?}");
}

/// Swings that lie between those of the training are no reason for a flag, where what they are off by is no more than
/// the ± has anyway; those of which one amplitude says nothing are.
#[test]
fn what_hardly_widens_the_interval_is_not_called_untrained() {
    let plant = Plant::drawn(Kind::JilesAtherton, 3);
    let sine = |(part, hertz): (f64, f64)| Waveform::Sine { amplitude: part * plant.full_v, hertz, offset: 0.0 };
    let untrained = |training: &[(f64, f64)]| {
        let training: Vec<Waveform> = training.iter().copied().map(sine).collect();
        let (Prepared { problem, context, .. }, candidate, search) =
            learnt_from(&plant, Model::GeneralisedPrandtlIshlinskii, &training);
        let parameters = interval(&problem, &candidate, &context, &search).parameters;
        let table = candidate.with_interval(Some(parameters)).unwrap().table;
        let drive = Waveform::Multisine { amplitude: plant.full_v, from_hz: 1.0, to_hz: 10.0, tones: 6 };
        let log = plant.log("unseen", &drive, 5.0, 9);
        let session = prepared(&context.recipe, &context.recipe.cut(&log)).unwrap();
        let raised = compare_within(&table, &session, &Scope::ALL).unwrap().raised;
        raised.iter().find(|raised| raised.bit == Status::UNTRAINED).map_or(0.0, |raised| raised.percent)
    };
    let [several, one] = [&[(1.0, 2.0), (0.6, 2.0), (0.3, 2.0)][..], &[(1.0, 2.0)]].map(untrained);
    assert!(several < 20.0 && one > 40.0, "{several} % and {one} % of the time");
}

/// One frequency does not tell a lag from hysteresis: what that leaves open at another stands in the interval, until a
/// log has told it.
#[test]
fn a_lag_that_one_frequency_leaves_open_is_in_the_interval_at_another() {
    let plant = Plant { lag_s: 1e-3, ..Plant::drawn(Kind::Relays(Density::Gaussian), 5) };
    let sine = |hertz| Waveform::Sine { amplitude: plant.full_v, hertz, offset: 0.0 };
    let [one, two] = [&[2.0][..], &[2.0, 40.0]].map(|hertz| {
        let (Prepared { problem, context, .. }, candidate, search) =
            learnt(&plant, Model::GeneralisedPrandtlIshlinskii, hertz);
        let calibration = interval(&problem, &candidate, &context, &search);
        let table = candidate.with_interval(Some(calibration.parameters)).unwrap().table;
        [2.0, 40.0].map(|hertz| {
            let log = plant.log("unseen", &sine(hertz), 2.0, 9);
            let session = prepared(&context.recipe, &context.recipe.cut(&log)).unwrap();
            let scope = Scope { zero_at_s: Some(0.5), ..Scope::ALL };
            compare_within(&table, &session, &scope).unwrap().interval.unwrap()
        })
    });
    assert!(one.iter().chain(&two).all(|coverage| coverage.covered_percent >= 80.0), "{one:?} {two:?}");
    assert!(one[1].half_width_um > 1.4 * two[1].half_width_um, "{one:?} {two:?}");
    assert!(one[0].half_width_um < 0.03 * plant.stroke_um, "{one:?}");
}

/// The simulated devices stay as they were learnt. What was held out shows that the actuator does not.
#[test]
fn what_was_held_out_widens_it() {
    let plant = Plant::drawn(Kind::Relays(Density::Gaussian), 8);
    let (Prepared { problem, context, .. }, candidate, search) =
        learnt(&plant, Model::GeneralisedPrandtlIshlinskii, &[2.0, 8.0]);
    let session = |seed| {
        let swelling = Waveform::AmplitudeModulated { amplitude: plant.full_v, hertz: 5.0, swell_hz: 0.5 };
        let log = plant.after(Change::ageing(0.1)).log("aged", &swelling, 5.0, seed);
        prepared(&context.recipe, &context.recipe.cut(&log)).unwrap()
    };
    let judged = problem.of(problem.training().cloned().collect(), vec![session(7)]);
    let [unseen, seen] = [&problem, &judged].map(|of| {
        let judged = Judged { problem: of, candidate: &candidate };
        let calibration = calibrate(&problem, &candidate, judged, &context, &search, DEVICES, || ()).unwrap();
        let table = candidate.clone().with_interval(Some(calibration.parameters)).unwrap().table;
        let scope = Scope { zero_at_s: Some(0.5), ..Scope::ALL };
        compare_within(&table, &session(9), &scope).unwrap().interval.unwrap()
    });
    assert!(unseen.covered_percent < 80.0 && seen.covered_percent > 93.0, "{unseen:?} {seen:?}");
    assert!(seen.half_width_um < 1.5 * seen.best_constant_um, "{seen:?}");
}

/// What `piezo zero` does where the board has been running: the actuator rests at an end, and
/// works elsewhere afterwards.
#[test]
fn it_holds_what_creeps_from_a_rest_where_the_model_has_no_creep() {
    let covered = [1, 2, 3, 4].map(|device| {
        let plant = Plant::drawn(Kind::Relays(Density::Gaussian), device);
        let (Prepared { problem, context, .. }, candidate, search) =
            learnt(&plant, Model::PrandtlIshlinskii, &[2.0, 8.0]);
        let calibration = interval(&problem, &candidate, &context, &search);
        let table = candidate.with_interval(Some(calibration.parameters)).unwrap().table;
        let log = after_a_rest(&plant);
        let session = prepared(&context.recipe, &context.recipe.cut(&log)).unwrap();
        let scope = Scope { zero_at_s: Some(RESTED_S), ..Scope::ALL };
        let coverage = compare_within(&table, &session, &scope).unwrap().interval.unwrap();
        // (What the simulated devices differ by in their lag, which is searched, is a quarter of it.)
        assert!(coverage.half_width_um < 0.05 * plant.stroke_um, "device {device}: {coverage:?}");
        coverage.covered_percent
    });
    assert!(covered.iter().sum::<f64>() / 4.0 >= 85.0, "{covered:?}");
}

/// When the actuator has gone over its range and rested at its lower end, s.
const RESTED_S: f64 = 4.0;

fn after_a_rest(plant: &Plant) -> Log {
    let elsewhere = Waveform::Sine { amplitude: 0.4 * plant.full_v, hertz: 3.0, offset: 0.5 * plant.full_v };
    let ends = [0.0, plant.full_v, -plant.full_v];
    let steps = |s: f64| (s / STEP_S) as usize;
    let mut command: Vec<f64> = Vec::new();
    for pair in ends.windows(2) {
        command.extend((0..steps(0.5)).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / steps(0.5) as f64));
    }
    command.resize(steps(RESTED_S), -plant.full_v);
    command.extend((0..steps(0.5)).map(|k| -plant.full_v * (1.0 - k as f64 / steps(0.5) as f64)));
    command.extend(elsewhere.command(3.0, 1));
    // The rate of the plant's logs.
    let like = plant.log("after a rest", &elsewhere, 1.0, 1);
    let every =
        |values: &[f64]| values.iter().step_by((like.sample_period / STEP_S).round() as usize).copied().collect();
    Log { voltage: every(&command), displacement: Some(every(&plant.respond(&command))), ..like }
}
