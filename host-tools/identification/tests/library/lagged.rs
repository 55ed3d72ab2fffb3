//! What is projected behind a lag, or ahead of its tick, is what the model then runs as.

use estimator_core::{Model, Parameters, Process};
use identification::cost::Feedback;
use identification::family::{self, AnyFamily};
use identification::{Conditions, Problem};
use recordings::session::Session;

const TICK_S: f64 = 5e-4;
/// The models with a lag, and values of their other genes.
const MODELS: [(Model, &[f64]); 5] = [
    (Model::PrandtlIshlinskii, &[0.1, -0.1, 0.05, 0.0]),
    (Model::MaxwellSlip, &[0.3, 1.5]),
    (Model::Duhem, &[3.0]),
    (Model::BoucWen, &[5.0, 0.2, 0.1]),
    (Model::Preisach, &[]),
];

/// Loops of 100 V at 10 Hz that shrink and grow.
fn voltage() -> Vec<f64> {
    let at = |k: u32| f64::from(k) * TICK_S;
    (0..4_000).map(|k| 50.0 - 50.0 * (62.83 * at(k)).cos() * (0.6 + 0.4 * (6.1 * at(k)).cos())).collect()
}

/// Read at every third tick only.
fn problem(displacement: &[f64]) -> Problem {
    let instants: Vec<u32> = (0..displacement.len() as u32).step_by(3).collect();
    let read = instants.iter().map(|&tick| displacement[tick as usize]).collect();
    let session = Session::new("log".to_owned(), voltage(), instants, read, TICK_S);
    Problem::new(vec![session], Vec::new(), Conditions::default())
}

/// The family that takes the lateness, which is the last.
fn of(model: Model, problem: &Problem) -> AnyFamily {
    family::of(model, problem).pop().expect("one at least")
}

fn displacement(parameters: &Parameters, problem: &Problem) -> Vec<f64> {
    let mut engine = parameters.build::<f64>(&problem.discretisation());
    // Of a tick, for the next.
    let mut displacement: Vec<f64> = voltage().into_iter().map(|volts| engine.step(volts, None)).collect();
    displacement.insert(0, displacement[0]);
    displacement.pop();
    displacement
}

#[test]
fn a_model_is_found_again_whatever_its_lateness() {
    // A loop of another class, for a first set of parameters.
    let mut slow = 0.0;
    let rough: Vec<f64> = voltage()
        .iter()
        .map(|v| {
            (0.12 * v + 1e-4 * v * v) - {
                slow += 0.1 * (v - slow);
                0.03 * (v - slow)
            }
        })
        .collect();
    for (model, others) in MODELS {
        for late in [0.05, 0.5, 1.0, 3.0, 11.0] {
            let genes = [&[late], others].concat();
            let first = problem(&rough);
            let truth = of(model, &first).project(&genes, &first).unwrap_or_else(|| panic!("{model}: no parameters"));
            assert!((f64::from(truth.lag_s()) - (late - 1.0) * TICK_S).abs() < 1e-9, "{model}");
            let again = problem(&displacement(&truth, &first));
            let found = of(model, &again).project(&genes, &again).unwrap_or_else(|| panic!("{model}: not again"));
            let stroke = again.stroke().span();
            let off = again.error_once_settled(&found, Feedback::Simulation.into());
            // Its dead zones end at parts of the stroke, which is not the rough loop's.
            let near = if model == Model::PrandtlIshlinskii { 1e-3 } else { 2e-4 };
            assert!(stroke > 5.0 && off < near * stroke, "{model} at {late} ticks: {off} of {stroke} µm");
            let of_another = truth.with_lag((0.5 * TICK_S) as f32 + truth.lag_s());
            let worse = again.error_once_settled(&of_another, Feedback::Simulation.into());
            assert!(worse > 2.0 * off, "{model} at {late} ticks: {off} µm, half a tick later {worse} µm");
        }
    }
}
