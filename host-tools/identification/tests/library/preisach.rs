//! Preisach models from first-order reversal curves.

use estimator_core::model::CELLS;
use estimator_core::{List, Model, Preisach, PreisachParameters, Recursion};
use identification::cost::Feedback;
use identification::family::{self, AnyFamily};
use identification::{Conditions, Problem};
use recordings::session::Session;

/// What a model gives along corners of voltage, a volt a tick, from long at rest at 0 V.
fn session(truth: &PreisachParameters, corners: &[f64]) -> Session {
    let mut voltage = vec![0.0];
    for &corner in corners {
        let from = voltage.last().copied().unwrap_or(0.0);
        let ticks = (corner - from).abs().round().max(1.0);
        voltage.extend((1..=ticks as u32).map(|tick| from + (corner - from) * f64::from(tick) / ticks));
    }
    let model = Preisach::<f64>::build(truth);
    // From negative saturation, as a rise to the top and a fall leave it.
    let mut state = model.begin(truth.lower_v.into(), None);
    model.step(&mut state, truth.lower_v.into());
    let mut displacement = vec![model.step(&mut state, 0.0)];
    displacement.extend(voltage.iter().map(|&volts| model.step(&mut state, volts)));
    displacement.pop();
    let instants = (0..voltage.len() as u32).collect();
    Session::new("curves".to_owned(), voltage, instants, displacement, 5e-4)
}

/// The structure that takes all samples, which is the last.
fn least_squares(problem: &Problem) -> AnyFamily {
    family::of(Model::Preisach, problem).pop().unwrap()
}

/// Eq. (3.17–3.19): a log of them is a log like any other.
#[test]
fn a_log_of_first_order_reversal_curves_gives_the_model() {
    let truth = PreisachParameters {
        lag_s: 0.0,
        lower_v: -5.0,
        upper_v: 105.0,
        densities_um: List::collect((0..CELLS).map(|cell| 0.1 + 0.05 * (cell % 7) as f32)).unwrap(),
        offset_um: -2.0,
    };
    let curves: Vec<f64> = (1..=20).flat_map(|k| [5.0 * f64::from(k), 0.0]).collect();
    let nested = [90.0, 20.0, 70.0, 35.0, 60.0, 10.0, 95.0, 0.0];
    let problem = Problem::new(vec![session(&truth, &curves)], vec![session(&truth, &nested)], Conditions::default());
    let found = least_squares(&problem).project(&[1.0], &problem).unwrap();
    let stroke = problem.stroke().span();
    let error = problem.held_out(&found, Feedback::Simulation.into()).unwrap();
    assert!(stroke > 5.0 && error < 0.01 * stroke, "{error} of {stroke} µm on loops within loops");
    // The densities from the curves alone, before any least squares.
    let structures = family::of(Model::Preisach, &problem);
    assert_eq!(structures.len(), 2, "the curves are recognised");
    let found = structures[0].project(&[], &problem).unwrap();
    let error = problem.held_out(&found, Feedback::Simulation.into()).unwrap();
    assert!(error < 0.02 * stroke, "{error} of {stroke} µm from the curves alone, on a grid that is not the truth's");
}

#[test]
fn a_sine_is_no_reversal_curve() {
    let voltage: Vec<f64> = (0..4000).map(|k| 50.0 - 50.0 * (f64::from(k) * 0.01).cos()).collect();
    let displacement = voltage.clone();
    let session = Session::new("sine".to_owned(), voltage, (0..4000).collect(), displacement, 5e-4);
    let problem = Problem::new(vec![session], Vec::new(), Conditions::default());
    assert_eq!(family::of(Model::Preisach, &problem).len(), 1);
}
