//! What is solved for, beside the model that is made of it.

use super::*;
use crate::family::Family as _;
use crate::fixtures::recorded;
use crate::search::{Budget, Minimum, Objective, Optimiser, each, minimise};
use crate::{Conditions, Identification, SearchOptions};
use estimator_core::{Discretisation, Process, Scheme};
use plants::{Density, Kind, Plant, Waveform};
use recordings::session::Session;

/// A rest at 10 V, sines of growing amplitude about it and a staircase; every `every`-th tick has a reading,
/// of some µm.
fn session(every: usize) -> Session {
    let voltage: Vec<f64> = (0..4_000)
        .map(|k| {
            let t = f64::from(k) * 5e-4;
            if k < 100 {
                10.0
            } else if t < 1.5 {
                10.0 + 12.0 * t * libm::sin(20.0 * t)
            } else {
                (f64::from(k / 200)) % 7.0
            }
        })
        .collect();
    let instants: Vec<u32> = (0..4_000).step_by(every).collect();
    let displacement = instants.iter().map(|&k| 0.15 * voltage[k as usize]).collect();
    Session::new("log".into(), voltage, instants, displacement, 5e-4)
}

/// The columns of the fit, weighed, are the displacement of the model that is made of it, to what an input that is seen
/// ahead of the voltage and readings apart cost.
#[test]
fn what_is_found_is_what_the_model_runs() {
    let problem = Problem::new(vec![session(1)], vec![], Conditions::default());
    let courses: Arc<[Course]> = Course::of_all(problem.training(), problem.deadband).into();
    let family = Family::new(Extra::Resonance, courses.clone(), &problem);
    let values = family.values(&[3.4, 2.0, 0.5, 0.02, 0.03, 0.4, 1e6, 500.0, 0.1]).unwrap();
    let sessions: Vec<&Session> = problem.training().collect();
    let mut solution = family.solve(&values, &problem).unwrap();
    solution.reversible = vec![0.5, 0.1, 0.4, 0.0, 0.3, 0.2, 0.6, 0.1, 0.3];
    solution.envelope = vec![1.0, 3.0, 0.0, 2.0, 5.0, 0.0, 1.0, 2.0, 1.0];
    let found = family.parameters(&values, (family.law(&values), values.gains), None, &solution).unwrap();
    let discretisation =
        Discretisation { sample_period: 5e-4, scheme: Scheme::ForwardEuler, deadband: problem.deadband };
    let mut model = found.build::<f64>(&discretisation);
    let displaced: Vec<f64> = sessions[0].voltage.iter().map(|&v| model.step(v, None)).collect();
    let weighed = family.weighed(values.law);
    let creep = creep(values.gains);
    let stages = family.stages(&values, &weighed, &creep);
    let coefficients = [&solution.reversible[..], &solution.envelope].concat();
    let stroke = Range::of_values(displaced.iter().copied()).span();
    stages.walk(sessions[0], &courses[0], |index, columns: &[_; 2], input| {
        let sum: f64 = columns.as_flattened().iter().zip(&coefficients).map(|(c, w)| c * w).sum();
        let expected = solution.offset + sum + family.least_slope() * (input - family.span.min);
        // The model gives the displacement of the next tick.
        if let Some(found) = index.checked_sub(1).and_then(|before| displaced.get(before)) {
            assert!((found - expected).abs() < 2e-3 * stroke, "reading {index}: {found} µm, not {expected} µm");
        }
    });
}

/// Of an amplifier's slew limit, V/s.
const LIMIT: f64 = 300.0;

/// A log of 1 kHz at a tick of 2 kHz, of an amplifier that is slower than steps of two lengths.
fn limited() -> Session {
    let mut session = session(2);
    let steps = |k: u32| f64::from(k / if k < 2_000 { 200 } else { 80 } % 2);
    session.voltage = (0..4_000).map(|k| 10.0 * steps(k)).collect();
    let slow = |u: &mut f64, &volts: &f64| {
        *u += (volts - *u).clamp(-LIMIT * 5e-4, LIMIT * 5e-4);
        Some(0.15 * *u)
    };
    session.displacement = session.voltage.iter().scan(0.0, slow).step_by(2).collect();
    session
}

#[test]
fn a_slew_limit_shows_in_a_log_that_is_slower_than_the_tick() {
    let session = limited();
    let tried = |every: usize| {
        let mut of = session.clone();
        of.displacement = of.displacement.into_iter().step_by(every).collect();
        of.instants = of.instants.into_iter().step_by(every).collect();
        structures(&Problem::new(vec![of], vec![], Conditions::default())).len()
    };
    // At 5 ms a resonance does not show, and a slew limit does.
    assert_eq!([1, 2, 5].map(tried), [3, 3, 2]);
    let problem = Problem::new(vec![session], vec![], Conditions::default());
    let family = Family::new(Extra::Slew, Course::of_all(problem.training(), problem.deadband).into(), &problem);
    let total = |slew: f64| {
        let values = family.values(&[0.0, 0.1, 0.5, 1e-4, 1e-4, 0.0, slew]).unwrap();
        family.solve(&values, &problem).unwrap().total
    };
    let [with, without] = [LIMIT, family.slews.max].map(total);
    assert!(family.slews.min < LIMIT && with < without - 4.0, "ln µm²: {with} with the limit, {without} without");
}

/// A limit that did not act is in no list of what was found, and a search from there goes on without one.
#[test]
fn coordinates_that_were_found_are_those_that_the_model_has() {
    let limited = Problem::new(vec![limited()], vec![], Conditions::default());
    for (problem, extra, limits) in
        [(devices(), Extra::Slew, false), (devices(), Extra::Resonance, false), (limited, Extra::Slew, true)]
    {
        let courses: Arc<[Course]> = Course::of_all(problem.training(), problem.deadband).into();
        let (options, cost) = (SearchOptions::default(), Cost::from(Feedback::Simulation));
        let search = Identification { problem: &problem, cost, options: &options, budget: None };
        let model = estimator_core::Model::GeneralisedPrandtlIshlinskii;
        let family = Family::new(extra, courses, &problem);
        // From the limit that was applied: a lag explains much of it, too.
        let near = [0.0, 0.1, 0.5, 1e-4, 1e-4, 0.0, LIMIT];
        let structure = |evaluations, from: Option<&crate::Fit>| {
            search.structure(model, &family, Optimiser::Local, evaluations, from, None)
        };
        let mut begun = structure(1, None);
        if limits {
            begun.genes = family.searched().into_iter().zip(near).collect();
        }
        let fit = structure(300, Some(&begun));
        let names = |fit: &crate::Fit| fit.genes.iter().map(|(gene, _)| gene.name).collect::<Vec<_>>();
        let of = generalised(fit.parameters);
        assert_eq!((names(&fit).contains(&SLEW), of.slew_v_per_s > 0.0), (limits, limits), "{extra:?}: {fit:?}");
        let swings = extra == Extra::Resonance;
        assert_eq!(names(&fit).contains(&"resonance"), swings, "{extra:?}");
        let again = search.again(&fit, 300);
        assert_eq!(names(&again).contains(&"resonance"), swings, "{extra:?}");
        // With a limit that limits nothing yet where there is none, as a search begins.
        let objective = |fit: &crate::Fit| {
            let found = |gene: &Gene| fit.genes.iter().find(|(of, _)| of.name == gene.name).map(|(_, value)| *value);
            let values: Vec<f64> =
                family.searched().iter().map(|gene| found(gene).unwrap_or(gene.value(0.5))).collect();
            family.candidate(&values, &problem, cost).unwrap().1
        };
        let [first, then] = [objective(&fit), objective(&again)];
        assert!(then < 1.02 * first, "{extra:?}: {first}, then {then}");
    }
}

/// The ends of the span are rounded one by one, and its half may come out less than the widest play's half-width.
#[test]
fn voltages_are_no_reason_to_find_nothing_whatever_they_are_rounded_to() {
    for step in 0..1_000 {
        let mut session = session(1);
        let (low, factor) = (-30.0 + 0.037 * f64::from(step), 1.0 + 0.009_1 * f64::from(step));
        session.voltage = session.voltage.iter().map(|volts| low + factor * volts).collect();
        let family =
            Family::new(Extra::Nothing, Arc::new([]), &Problem::new(vec![session], vec![], Conditions::default()));
        let values = family.values(&[1.0, 2.0, 0.5, 0.02, 0.03, 0.4]).unwrap();
        let solution =
            Solution { reversible: vec![1.0; FUNCTIONS], envelope: vec![1.0; FUNCTIONS], offset: 0.0, total: 0.0 };
        let found = family.parameters(&values, (family.law(&values), values.gains), None, &solution);
        assert!(found.is_some(), "{:?} V", family.span);
    }
}

/// Readings that are passed over change the displacement by little more than a straight line in place of an arc does.
#[test]
fn a_course_of_few_readings_gives_the_columns_of_the_whole() {
    let session = session(1);
    let problem = Problem::new(vec![session.clone()], vec![], Conditions::default());
    let [whole, few] = [4_000, 500].map(|most| Course::within(most, &session, problem.deadband));
    assert!(whole.corners.is_empty(), "every reading is stepped at");
    assert!(few.readings.len() < 1_000 && few.corners.len() > 5, "{} and {}", few.readings.len(), few.corners.len());
    for (extra, most) in [(Extra::Nothing, 5e-3), (Extra::Resonance, 1e-2)] {
        let family = Family::new(extra, Arc::new([]), &problem);
        let values = family.values(&[3.4, 2.0, 0.5, 0.02, 0.03, 0.4, 1e6, 60.0, 0.05]).unwrap();
        let (plays, creep) = (family.weighed(values.law), creep(values.gains));
        let stages = family.stages(&values, &plays, &creep);
        let mut sums = vec![0.0; session.instants.len()];
        let sum = |columns: &[[f64; FUNCTIONS]; 2]| columns.as_flattened().iter().sum::<f64>();
        stages.walk(&session, &whole, |index, columns, _| sums[index] = sum(columns));
        let stroke = Range::of_values(sums.iter().copied()).span();
        let mut worst = 0.0;
        stages.walk(&session, &few, |index, columns, _| {
            worst = f64::max(worst, (sum(columns) - sums[index]).abs() / stroke);
        });
        println!("{worst} of the stroke");
        assert!((1e-9..most).contains(&worst), "{worst} of the stroke");
    }
}

/// What the search minimises at a point, and what the family says of it there.
fn at(family: &Family, problem: &Problem, at: &[f64]) -> f64 {
    let values: Vec<f64> = family.searched().iter().zip(at).map(|(gene, &x)| gene.value(x)).collect();
    family.candidate(&values, problem, Cost::from(Feedback::Simulation)).unwrap().1
}

/// The family without slew limit and resonance.
fn family(problem: &Problem) -> Family {
    let courses = Course::of_all(problem.training(), problem.deadband).into();
    Family::new(Extra::Nothing, courses, problem)
}

fn generalised(found: Option<Parameters>) -> GeneralisedPrandtlIshlinskiiParameters {
    match found {
        Some(Parameters::GeneralisedPrandtlIshlinskii(of)) => of,
        found => panic!("{found:?}"),
    }
}

/// Sessions of a device that no model is made of, one from rest and one that begins amid a swing.
fn devices() -> Problem {
    let plant = Plant::drawn(Kind::Relays(Density::Gaussian), 3);
    let sine = |amplitude: f64, hertz| Waveform::Sine { amplitude: amplitude * plant.full_v, hertz, offset: 0.0 };
    let mut sessions = [(sine(1.0, 5.0), 1), (sine(0.5, 20.0), 2)]
        .map(|(waveform, seed)| recorded(plant.log("log", &waveform, 2.0, seed)));
    let cut = 950;
    let second = &mut sessions[1];
    second.voltage.drain(..cut);
    second.displacement.drain(..cut);
    second.instants.truncate(second.voltage.len());
    Problem::new(sessions.to_vec(), vec![], Conditions::default())
}

/// What a search of 100 candidates by slopes, and one of 250 by costs alone, find.
fn searched(family: &Family, problem: &Problem) -> [Minimum; 2] {
    let costs = each(|point| at(family, problem, point));
    let slopes = |point: &[f64]| family.quadratic(point, problem);
    let search = |quadratic, evaluations| {
        let (objective, budget) = (Objective { costs: &costs, quadratic }, Budget { evaluations, seed: 1 });
        minimise(Optimiser::Local, family.searched().len(), budget, &family.starts(), objective, &mut |_, _| ())
    };
    [search(&slopes, 100), search(&|_| None, 250)]
}

#[test]
fn slopes_take_a_fraction_of_the_candidates_that_costs_alone_take() {
    let problem = devices();
    let family = family(&problem);
    let [by_slopes, by_costs] = searched(&family, &problem);
    assert!(by_slopes.cost < 1.002 * by_costs.cost, "{by_slopes:?} {by_costs:?}");
}

/// The prior of a stated lag is concave along some directions; a descent goes on there.
#[test]
fn a_lag_that_is_stated_is_kept_to() {
    let mut problem = devices();
    problem.lag_s = Some(5e-3);
    let family = family(&problem);
    let point = [0.1, 0.55, 0.45, 0.65, 0.65, 0.2];
    let Quadratic { curvature, .. } = family.quadratic(&point, &problem).unwrap();
    let (least, largest) = (curvature.symmetric_eigenvalues().min(), curvature.amax());
    assert!(least > -1e-9 * largest, "{least} of {largest}");
    let [by_slopes, by_costs] = searched(&family, &problem);
    assert!(by_slopes.cost < 1.01 * by_costs.cost, "{by_slopes:?} {by_costs:?}");
}

/// Near the minimum, where the coefficients do not tear at each other: elsewhere they follow the blocks' noises, which
/// the slope leaves out.
#[test]
fn the_slope_is_that_of_the_cost() {
    let problem = devices();
    let family = family(&problem);
    let [Minimum { at: least, .. }, _] = searched(&family, &problem);
    let near: Vec<f64> = least.iter().map(|x| if *x < 0.5 { x + 0.02 } else { x - 0.02 }).collect();
    let Quadratic { slope, curvature } = family.quadratic(&near, &problem).unwrap();
    for i in 0..near.len() {
        let moved = |by: f64| {
            let mut to = near.clone();
            to[i] += by;
            at(&family, &problem, &to)
        };
        let expected = (moved(1e-3) - moved(-1e-3)) / 2e-3;
        // A slope beyond which the minimum would be far, by the curvature.
        let scale = (curvature[(i, i)] * at(&family, &problem, &near)).sqrt();
        assert!((slope[i] - expected).abs() < 0.02 * scale, "number {i}: {}, not {expected}; of {scale}", slope[i]);
    }
}

/// Of a log that begins amid a swing nobody knows what was before.
#[test]
fn the_memory_at_rest_is_learnt_from_logs_that_begin_at_rest() {
    let plant = Plant::drawn(Kind::Relays(Density::Gaussian), 3);
    let memory = |waveform, cut| {
        let mut session = recorded(plant.log("log", &waveform, 9.0, 1));
        session.voltage.drain(..cut);
        session.displacement.drain(..cut);
        session.instants.truncate(session.voltage.len());
        let problem = Problem::new(vec![session], vec![], Conditions::default());
        generalised(family(&problem).finish(&[0.1, 2.0, 0.5, 0.02, 0.03, 0.4], &problem)).rest_memory
    };
    // It begins in the first hold on the way up.
    let rest = memory(Waveform::Staircase { amplitude: plant.full_v, steps: 2, hold_s: 0.3 }, 700);
    let amid = memory(Waveform::Sine { amplitude: plant.full_v, hertz: 2.0, offset: 0.0 }, 1_900);
    assert!(rest.abs() > 0.5 && amid == 0.0, "{rest}, amid a swing {amid}");
}

/// Sines of three amplitudes, the smallest the fastest, of a device without any lag: what the law misses of the small
/// loop's width looks like one.
#[test]
fn a_lag_that_makes_up_for_the_law_is_halved_where_the_weights_are_freed() {
    let plant = Plant { lag_s: 0.0, ..Plant::drawn(Kind::Relays(Density::TwoHumped), 2) };
    let sine = |part: f64, hertz| Waveform::Sine { amplitude: part * plant.full_v, hertz, offset: 0.0 };
    let sessions =
        [sine(1.0, 1.0), sine(0.6, 2.0), sine(0.25, 8.0)].map(|waveform| recorded(plant.log("log", &waveform, 4.0, 1)));
    let problem = Problem::new(sessions.to_vec(), vec![], Conditions::default());
    let family = family(&problem);
    let [Minimum { at, .. }, _] = searched(&family, &problem);
    let values: Vec<f64> = family.searched().iter().zip(&at).map(|(gene, &x)| gene.value(x)).collect();
    let late_s = |found| {
        let of = generalised(found);
        5e-4 * (of.delay_ticks + 1.0) + of.lag_s
    };
    let [by_law, freed] = [family.project(&values, &problem), family.finish(&values, &problem)].map(late_s);
    assert!(freed < 0.6 * by_law && by_law > 5e-4, "{by_law} s by the law, {freed} s");
}
