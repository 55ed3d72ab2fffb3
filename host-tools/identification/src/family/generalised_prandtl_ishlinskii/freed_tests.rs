//! Weights and gains that the logs free from their laws.

use super::candidate::Extra;
use super::*;
use crate::family::Family as _;
use crate::fixtures::recorded;
use crate::{Conditions, Problem};
use estimator_core::{Discretisation, Model, Parameters, Process, Scheme};
use plants::{Density, Kind, Plant, Waveform};

/// Near what a search finds for this device: delay, lag (ticks), ρ, creep, memory at rest.
const SEARCHED: [f64; 6] = [0.33, 0.6, 0.4, 0.008, 0.0127, 0.1];

fn plant() -> Plant {
    Plant::drawn(Kind::Relays(Density::Gaussian), 1)
}

fn sine(part: f64) -> Waveform {
    Waveform::Sine { amplitude: part * plant().full_v, hertz: 5.0, offset: 0.0 }
}

fn session(waveform: &Waveform, duration_s: f64, seed: u64) -> Session {
    recorded(plant().log("log", waveform, duration_s, seed))
}

/// Mean error without offset of a model on a session, µm; it gives the displacement of the next tick.
fn error(parameters: &Parameters, session: &Session) -> f64 {
    let discretisation = Discretisation { sample_period: session.tick_s, scheme: Scheme::ForwardEuler, deadband: 0.0 };
    let mut model = parameters.build::<f64>(&discretisation);
    let estimates = session.voltage.iter().map(|&v| model.step(v, None));
    let errors: Vec<f64> = estimates.zip(&session.displacement[1..]).map(|(y, truth)| y - truth).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    errors.iter().map(|error| (error - mean).abs()).sum::<f64>() / errors.len() as f64
}

/// Errors of the law's weights and of freed ones on a swelling sine, learnt from sines of some amplitudes, parts of
/// the full voltage.
fn errors(amplitudes: &[f64]) -> [f64; 2] {
    let learnt = amplitudes.iter().enumerate().map(|(seed, &part)| session(&sine(part), 1.0, seed as u64));
    let problem = Problem::new(learnt.collect(), vec![], Conditions::default());
    let courses = Course::of_all(problem.training(), problem.deadband);
    let family = Family::new(Extra::Nothing, courses.into(), &problem);
    let swelling = Waveform::AmplitudeModulated { amplitude: plant().full_v, hertz: 4.0, swell_hz: 0.5 };
    let unseen = session(&swelling, 4.0, 7);
    [family.project(&SEARCHED, &problem), family.finish(&SEARCHED, &problem)].map(|found| found.unwrap()).map(|found| {
        assert_eq!(found.model(), Model::GeneralisedPrandtlIshlinskii);
        error(&found, &unseen)
    })
}

/// A staircase of seven levels, of which the slopes between the levels are no part.
#[test]
fn a_staircase_teaches_what_lies_between_its_levels() {
    let stairs = Waveform::Staircase { amplitude: plant().full_v, steps: 3, hold_s: 0.2 };
    let problem = Problem::new(vec![session(&stairs, 8.0, 1)], vec![], Conditions::default());
    let courses = Course::of_all(problem.training(), problem.deadband);
    let family = Family::new(Extra::Nothing, courses.into(), &problem);
    let found = family.finish(&SEARCHED, &problem).unwrap();
    let unseen = session(&sine(1.0), 2.0, 7);
    let error = error(&found, &unseen) / plant().stroke_um;
    assert!(error < 0.005, "{error} of the stroke");
}

/// It does not say how a slope is shared between the reversible part and the plays that all move; half
/// the amplitude does.
#[test]
fn a_single_loop_teaches_half_its_amplitude() {
    let plant = Plant::drawn(Kind::JilesAtherton, 1);
    let sine = |part: f64| {
        let waveform = Waveform::Sine { amplitude: part * plant.full_v, hertz: 5.0, offset: 0.0 };
        recorded(plant.log("log", &waveform, 2.0, 1))
    };
    let problem = Problem::new(vec![sine(1.0)], vec![], Conditions::default());
    let courses = Course::of_all(problem.training(), problem.deadband);
    let family = Family::new(Extra::Nothing, courses.into(), &problem);
    let found = family.finish(&SEARCHED, &problem).unwrap();
    let error = error(&found, &sine(0.5)) / plant.stroke_um;
    assert!(error < 0.003, "{error} of the stroke");
}

#[test]
fn several_amplitudes_and_one_free_the_weights_for_the_better() {
    for (amplitudes, most) in [(&[1.0, 0.6, 0.3][..], 0.8), (&[1.0, 1.0], 0.7)] {
        let [law, freed] = errors(amplitudes);
        assert!(freed < most * law, "{freed} µm after {law} µm");
    }
}

/// A swing that grows, then steps and holds, at ticks of 5 ms; the first 0.5 s at rest.
fn voltage() -> Vec<f64> {
    let of = |tick: u32| match tick {
        0..100 => 0.0,
        100..2_000 => 0.008 * f64::from(tick - 100) * libm::sin(0.02 * f64::from(tick - 100)),
        _ => [14.0, -6.0, 10.0, -14.0][tick as usize / 500 % 4],
    };
    (0..4_000).map(of).collect()
}

/// A log of that voltage, of a displacement at each tick.
fn log(displacement: Vec<f64>) -> Session {
    Session::new("log".into(), voltage(), (0..4_000).collect(), displacement, 5e-3)
}

/// A model of such gains and envelopes, and what is freed on its log.
fn freed_of(gains: [f64; CREEPS], own: Option<&Envelopes>) -> (Family, Values, Session, Freed) {
    let problem = Problem::new(vec![log(voltage().iter().map(|v| 0.2 * v).collect())], vec![], Conditions::default());
    let courses: Arc<[Course]> = Course::of_all(problem.training(), problem.deadband).into();
    let family = Family::new(Extra::Nothing, courses.clone(), &problem);
    let values = family.values(&[1.0, 1.0, 0.4, 0.02, 0.02, 0.0]).unwrap();
    let functions = |um: f64| vec![um; FUNCTIONS];
    let solution = Solution { reversible: functions(0.4), envelope: functions(0.3), offset: 0.0, total: 0.0 };
    let parameters = family.parameters(&values, (family.law(&values), gains), own, &solution).unwrap();
    let discretisation = Discretisation { sample_period: 5e-3, scheme: Scheme::ForwardEuler, deadband: 0.0 };
    let mut model = parameters.build::<f64>(&discretisation);
    let ahead: Vec<f64> = voltage().iter().map(|&v| model.step(v, None)).collect();
    let session = log([&ahead[..1], &ahead[..3_999]].concat());
    let found = family.freed(&values, family.law(&values), &[(&session, &courses[0])], true).unwrap();
    (family, values, session, found)
}

/// Narrow plays that move at low voltages, wide ones at high voltages: no common envelope times weights.
#[test]
fn plays_whose_envelopes_differ_get_their_own() {
    let hat = |play: usize, knot: usize| (0.1 - 0.03 * (knot as f64 - 0.5 * play as f64).abs()).max(0.0);
    let envelopes: Envelopes = std::array::from_fn(|play| std::array::from_fn(|knot| hat(play, knot)));
    let (family, values, session, Freed { weights, gains, own, solution, .. }) =
        freed_of([0.01; CREEPS], Some(&envelopes));
    let found = family.parameters(&values, (weights, gains), Some(&own.unwrap()), &solution).unwrap();
    let off = error(&found, &session) / Range::of_values(session.displacement.iter().copied()).span();
    assert!(off < 5e-4, "{off} of the stroke");
}

#[test]
fn creep_that_is_not_even_over_log_time_is_found() {
    let (.., found) = freed_of([0.01, 0.01, 0.06, 0.01, 0.01], None);
    // Holds of 2.5 s do not tell the slower ones apart, which are drawn to the third.
    let [first, second, third, ..] = found.gains;
    assert!((0.045..0.066).contains(&third) && first < 0.4 * third && second < 0.5 * third, "{:?}", found.gains);
}
