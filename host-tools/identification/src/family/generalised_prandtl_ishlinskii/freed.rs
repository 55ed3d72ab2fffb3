//! The weights of the plays, freed from their law over the half-widths as far as the logs say otherwise.
//!
//! ```text
//! minimise Σ_b c_b⁻¹·mse_b(a, e) + d·Σ_i ((a_i − a⁰_i)/s_i)²,   a_i ≥ 0        a weights, e coefficients of the envelope
//! a⁰_i = exp(−r_i/(ρR))·Δr_i/R,   s_i = max(a⁰_i, 0.3·mean a⁰)
//! ```
//!
//! by turns: a for the last e, then e and the reversible part for that a; c_b are the noises of the blocks (see
//! [`Blocks`]). The law says how an actuator answers amplitudes that were not recorded; the draw d towards it is weak
//! where several were, and strong where there was one. On five of eight kinds of simulated devices of other classes
//! that leaves 28 to 42 % less error on recordings unlike the training where it has several amplitudes, on the others
//! as much as before; where it has one, 4 to 20 % less on the five that were tried.

use super::candidate::{Family, PLAYS, Values};
use play_columns::{Balanced, Blocks, Course, FUNCTIONS, Prior, Solution};
use recordings::session::Session;

/// Turns between weights and functions.
const TURNS: usize = 3;
/// d, where the training has several amplitudes, and where it has one.
const SEVERAL: f64 = 0.05;
const ONE: f64 = 0.5;
/// A weight may be off by at least this part of the mean.
const LEAST: f64 = 0.3;
/// The reversible part and each play.
const PARTS: usize = 1 + PLAYS;

/// What the weights are freed to.
pub struct Freed {
    /// Of each play.
    pub weights: [f64; PLAYS],
    /// What belongs to them.
    pub solution: Solution,
}

/// The readings of a session, each play on its own.
struct Readings {
    columns: Vec<[[f64; FUNCTIONS]; PARTS]>,
    /// What the sensor read, µm.
    targets: Vec<f64>,
}

/// Frees the weights of the best candidate's solution; `None` where the least squares have no solution.
pub fn freed(
    family: &Family,
    values: &Values,
    law: &Solution,
    sessions: &[(&Session, &Course)],
    several_amplitudes: bool,
) -> Option<Freed> {
    let readings: Vec<Readings> =
        sessions.iter().map(|(session, course)| read(family, values, session, course)).collect();
    let by_law = family.law(values);
    let least = LEAST * by_law.iter().sum::<f64>() / PLAYS as f64;
    let weight = if several_amplitudes { SEVERAL } else { ONE };
    let prior = |(play, &towards): (usize, &f64)| Prior {
        column: FUNCTIONS + play,
        towards,
        within: towards.max(least),
        weight,
    };
    let priors: Vec<Prior> = by_law.iter().enumerate().map(prior).collect();
    let (mut weights, mut solution) = (by_law, None);
    for _ in 0..TURNS {
        let Solution { envelope, .. } = solution.as_ref().unwrap_or(law);
        let of_plays = solve(&readings, sessions, family.stroke, &priors, [1, PLAYS], |plays, play| {
            plays[play].iter().zip(envelope).map(|(column, weight)| column * weight).sum()
        })?;
        weights.copy_from_slice(of_plays.common().get(FUNCTIONS..)?);
        let of_functions = solve(&readings, sessions, family.stroke, &[], [2, 0], |plays, function| {
            weights.iter().zip(plays).map(|(weight, play)| weight * play[function]).sum()
        })?;
        solution = Some(Solution::of(&of_functions));
    }
    Some(Freed { weights, solution: solution? })
}

/// The least squares of so many functions, the reversible part first, and of so many other columns; all but that part
/// are made of the columns of the plays.
fn solve(
    readings: &[Readings],
    sessions: &[(&Session, &Course)],
    stroke: f64,
    priors: &[Prior],
    [functions, others]: [usize; 2],
    column: impl Fn(&[[f64; FUNCTIONS]], usize) -> f64,
) -> Option<Balanced> {
    let mut blocks = Blocks::new(functions, others, sessions, stroke);
    let count = (functions - 1) * FUNCTIONS + others;
    for (number, (read, (session, course))) in readings.iter().zip(sessions).enumerate() {
        let mut rows = blocks.of(number);
        let mut row = Vec::new();
        for (([reversible, plays @ ..], &target), &index) in
            read.columns.iter().zip(&read.targets).zip(&course.readings)
        {
            row.clear();
            row.extend_from_slice(reversible);
            row.extend((0..count).map(|number| column(plays, number)));
            rows.add(session.instants[index], index < course.settled, &row, target);
        }
        rows.finish();
    }
    blocks.balanced(priors)
}

/// Each play a part of its own, of the weight 1.
fn read(family: &Family, values: &Values, session: &Session, course: &Course) -> Readings {
    let (plays, creep) = (family.plays.map(|(half_width, _)| (half_width, 1.0)), family.creep(values.creep));
    let count = course.readings.len();
    let mut readings = Readings { columns: Vec::with_capacity(count), targets: Vec::with_capacity(count) };
    family.stages(values, &plays, &creep).walk(session, course, |index, columns, input| {
        readings.columns.push(*columns);
        readings.targets.push(session.displacement[index] - family.least_slope() * (input - family.span.min));
    });
    readings
}

#[cfg(test)]
mod tests {
    use super::super::candidate::Extra;
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
        let discretisation =
            Discretisation { sample_period: session.tick_s, scheme: Scheme::ForwardEuler, deadband: 0.0 };
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
        [family.project(&SEARCHED, &problem), family.finish(&SEARCHED, &problem)].map(|found| found.unwrap()).map(
            |found| {
                assert_eq!(found.model(), Model::GeneralisedPrandtlIshlinskii);
                error(&found, &unseen)
            },
        )
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
    fn several_amplitudes_free_the_weights_for_the_better() {
        let [law, freed] = errors(&[1.0, 0.6, 0.3]);
        assert!(freed < 0.8 * law, "{freed} µm after {law} µm");
    }

    #[test]
    fn one_amplitude_frees_them_a_little_and_not_for_the_worse() {
        let [law, freed] = errors(&[1.0, 1.0]);
        assert!(freed < law && freed > 0.6 * law, "{freed} µm after {law} µm");
    }
}
