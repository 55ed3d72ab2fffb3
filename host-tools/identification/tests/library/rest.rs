//! The memory of an actuator that has rested, which the first swing of its logs shows.

use estimator_core::model::play;
use estimator_core::{Discretisation, Model, Parameters, Process, Scheme};
use identification::cost::Feedback;
use identification::{Conditions, Identification, Problem, SearchOptions};
use recordings::session::Session;

const TICK_S: f64 = 5e-4;

/// Plays alone, alike up to nine tenths of half the range of 0 … 100 V, from where none was moved yet, at `from` V: a
/// rest at 10 V, and sines of three amplitudes.
fn session(from: f64) -> Session {
    let sine = |part: f64, cycles: u32, ticks: u32| {
        (0..cycles * ticks).map(move |k| {
            let turned = core::f64::consts::TAU * f64::from(k) / f64::from(ticks);
            50.0 - 50.0 * part * libm::cos(turned)
        })
    };
    let rest = std::iter::repeat_n(10.0, 400);
    let voltage: Vec<f64> = rest.chain(sine(1.0, 4, 1000)).chain(sine(0.6, 4, 500)).chain(sine(0.25, 8, 200)).collect();
    let mut plays: Vec<(f64, f64)> = (1..=15).map(|number| (3.0 * f64::from(number), from)).collect();
    let displacement = voltage.iter().map(|&volts| {
        let strain = plays.iter_mut().map(|(half_width, at)| {
            *at = play(*at, volts, *half_width);
            *at
        });
        0.06 * volts + 0.004 * strain.sum::<f64>()
    });
    let displacement = displacement.collect();
    let instants = (0..voltage.len() as u32).collect();
    Session::new("plays".to_owned(), voltage, instants, displacement, TICK_S)
}

/// How wide plays weigh shows in the first rise alone: where the weights follow a law, a false memory has to make up
/// for what that misses.
#[test]
fn the_first_rise_is_met_from_either_side_of_a_rest() {
    for (from, memory) in [(0.0, -1.5..=-0.5), (50.0, 0.5..=1.0)] {
        let problem = Problem::new(vec![session(from)], Vec::new(), Conditions::default());
        let options = SearchOptions::default();
        let identification =
            Identification { problem: &problem, cost: Feedback::Simulation.into(), options: &options, budget: None };
        let fit = identification.run(&[Model::GeneralisedPrandtlIshlinskii], &mut |_, _| ()).remove(0);
        let parameters = fit.parameters.unwrap();
        let Parameters::GeneralisedPrandtlIshlinskii(found) = parameters else { panic!("{parameters:?}") };
        assert!(memory.contains(&found.rest_memory), "from {from} V: {}", found.rest_memory);
        let discretisation =
            Discretisation { sample_period: TICK_S, scheme: Scheme::ForwardEuler, deadband: problem.deadband };
        let mut model = parameters.build::<f64>(&discretisation);
        let session = session(from);
        let estimates: Vec<f64> = session.voltage.iter().map(|&volts| model.step(volts, None)).collect();
        // Behind the leap from the rest to the first sine's beginning.
        let first = estimates.iter().zip(&session.displacement[1..]).take(900).skip(420);
        let worst = first.map(|(estimate, sensor)| (estimate - sensor).abs()).fold(0.0, f64::max);
        assert!(worst < 0.05, "from {from} V: {worst} µm of 10");
    }
}
