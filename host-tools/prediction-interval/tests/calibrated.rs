//! An interval that is calibrated on simulated devices, judged on a device that is none of them.

use ::calibration::CalibrationOptions;
use estimator_core::Model;
use identification::cost::{Cost, Feedback};
use identification::validate::{Coverage, Scope, compare_within};
use identification::{Candidate, Conditions, Job, ModelChoice, Prepared, SearchOptions, identify, prepared};
use plants::{Density, Kind, Plant, Waveform};
use prediction_interval::{Calibration, calibrate};
use recordings::prepare::{AutoOr, PrepareOptions};

/// Few, so that the test takes seconds.
const DEVICES: u32 = 6;

fn learnt(plant: &Plant) -> (Prepared, Candidate, SearchOptions) {
    let sine = |hertz| Waveform::Sine { amplitude: plant.full_v, hertz, offset: 0.0 };
    let search = SearchOptions { evaluations: 60, ..SearchOptions::default() };
    let job = Job {
        training: vec![plant.log("slow", &sine(2.0), 2.0, 1), plant.log("fast", &sine(8.0), 2.0, 2)],
        held_out: Vec::new(),
        hold_out: 0.0,
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
    let prepared = job.prepare(&mut |_, _| ()).unwrap();
    let models = [Model::GeneralisedPrandtlIshlinskii];
    let fit = identify(&prepared.problem, &models, job.cost, &search, &mut |_, _| ()).remove(0);
    let candidate = Candidate::new(&prepared.problem, fit, &prepared.context).unwrap();
    (prepared, candidate, search)
}

#[test]
fn it_holds_on_recordings_of_another_kind_and_is_narrower_where_the_training_was() {
    let plant = Plant::drawn(Kind::Relays(Density::Lorentzian), 77);
    let (Prepared { problem, context, .. }, candidate, search) = learnt(&plant);
    let calibrated = |seed: u32| {
        let context = identification::TableContext { seed, ..context.clone() };
        calibrate(&problem, &candidate, &context, &search, DEVICES, || ()).unwrap()
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
