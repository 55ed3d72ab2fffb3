//! What of a table is doubted.

use calibration::CalibrationOptions;
use estimator_core::{DuhemCondition, DuhemParameters, Model, Parameters, Range, Table};
use identification::cost::Feedback;
use identification::{Candidate, Character, Conditions, Doubt, Job, ModelChoice, SearchOptions, doubts};
use recordings::log::Log;
use recordings::prepare::{AutoOr, PrepareOptions};
use recordings::rig::{EXCITATIONS, Rig};

fn job(training: Vec<Log>, hold_out: f64) -> Job {
    Job {
        training,
        held_out: Vec::new(),
        hold_out,
        as_judged: false,
        prepare: PrepareOptions { delay: AutoOr::Given(0.0), ..PrepareOptions::default() },
        model: ModelChoice::Is(Model::Duhem),
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Feedback::Simulation.into(),
        search: SearchOptions { evaluations: 40, ..SearchOptions::default() },
    }
}

/// The rig's slow sine, 10 s of it.
fn slow() -> Log {
    Rig { duration: 10.0, ..Rig::default() }.log(EXCITATIONS[0])
}

#[test]
fn exchanged_columns_are_a_grave_doubt_and_no_others_are() {
    let ahead = |log: Log| -> Vec<Doubt> {
        let mut doubts = job(vec![log], 0.5).run(&mut |_, _| ()).unwrap().doubts;
        doubts.retain(|doubt| matches!(doubt, Doubt::RunsAhead { .. }));
        doubts
    };
    assert_eq!(ahead(slow()), []);
    let Log { voltage, displacement, .. } = slow();
    let exchanged = Log { voltage: displacement.unwrap(), displacement: Some(voltage), ..slow() };
    let found = ahead(exchanged);
    assert!(found.len() == 1 && found[0].grave(), "{found:?}");
}

/// As one in the actuator's volts among those of a monitor; what is held out of a log has that log's scale.
#[test]
fn a_log_in_other_volts_is_a_grave_doubt_and_a_smaller_swing_is_none() {
    let rig = Rig { duration: 5.0, ..Rig::default() };
    let other = rig.log(EXCITATIONS[4]);
    let named = |log: Log, held_out: bool| {
        let mut job = job(vec![slow(), rig.log(EXCITATIONS[1])], 0.5);
        if held_out { &mut job.held_out } else { &mut job.training }.push(log);
        let doubts = job.run(&mut |_, _| ()).unwrap().doubts;
        let named = doubts.iter().position(|doubt| matches!(doubt, Doubt::OtherScale(of) if of.log == "odd"));
        assert!(named.is_none_or(|at| at == 0 && doubts[0].grave()), "{doubts:?}");
        named.is_some()
    };
    let scaled = |volts: f64, um: f64| {
        let Log { voltage, displacement, .. } = other.clone();
        let times = |values: Vec<f64>, by: f64| values.into_iter().map(|value| by * value).collect();
        Log {
            name: "odd".into(),
            voltage: times(voltage, volts),
            displacement: displacement.map(|values| times(values, um)),
            ..other.clone()
        }
    };
    for held_out in [false, true] {
        assert!(named(scaled(20.0, 1.0), held_out) && named(scaled(0.1, 1.0), held_out));
        assert!(!named(scaled(0.3, 0.18), held_out), "a small swing moves less a volt");
    }
}

#[test]
fn a_single_frequency_is_that_of_what_is_delivered() {
    let Log { mut voltage, displacement: Some(mut displacement), .. } = slow() else {
        panic!("a log without displacement")
    };
    let fast = Rig { duration: 5.0, ..Rig::default() }.log(EXCITATIONS[1]);
    let doubted = |log: Log| {
        let doubts = job(vec![log], 0.4).run(&mut |_, _| ()).unwrap().doubts;
        doubts.iter().any(|doubt| matches!(doubt, Doubt::SingleFrequency { .. }))
    };
    assert!(doubted(slow()));
    voltage.extend(&fast.voltage);
    displacement.extend(fast.displacement.unwrap());
    assert!(!doubted(Log { voltage, displacement: Some(displacement), ..slow() }), "its other half has another");
}

#[test]
fn a_log_that_goes_farther_than_the_training_and_waves_without_a_held_step_are_doubted() {
    let rig = Rig { duration: 2.0, ..Rig::default() };
    let [slow, fast] = [1, 2].map(|which| rig.log(EXCITATIONS[which]));
    let double = |log: &Log| {
        let twice = |values: &[f64]| values.iter().map(|of| 2.0 * of).collect::<Vec<_>>();
        let displacement = log.displacement.as_deref().map(twice);
        Log { voltage: twice(&log.voltage), displacement, sha256: "double".into(), ..log.clone() }
    };
    let doubted = |training: Vec<Log>, held_out: Vec<Log>| {
        let doubts = Job { held_out, ..job(training, 0.0) }.run(&mut |_, _| ()).unwrap().doubts;
        [
            doubts.iter().any(|doubt| matches!(doubt, Doubt::BeyondTraining { .. })),
            doubts.iter().any(|doubt| matches!(doubt, Doubt::NoFastMove)),
        ]
    };
    assert_eq!(doubted(vec![slow.clone(), fast.clone()], vec![double(&slow)]), [true, true]);
    let mut steps = slow.clone();
    steps.sha256 = "steps".into();
    for (row, volts) in steps.voltage.iter_mut().enumerate() {
        *volts = if row / 400 % 2 == 0 { 5.0 } else { -5.0 };
    }
    steps.displacement = Some(steps.voltage.iter().map(|volts| 0.1 * volts).collect());
    assert_eq!(
        doubted(vec![slow.clone(), fast, steps], vec![Rig { seed: 7, ..rig }.log(EXCITATIONS[1])]),
        [false, false]
    );
}

#[test]
fn a_duhem_set_that_breaks_a_condition_is_doubted_and_one_that_meets_them_is_not() {
    let rig = Rig { duration: 0.5, ..Rig::default() };
    let outcome =
        job(EXCITATIONS.into_iter().map(|excitation| rig.log(excitation)).collect(), 0.0).run(&mut |_, _| ()).unwrap();
    let candidate = outcome.judged();
    let Parameters::Duhem(found) = candidate.table.parameters else { panic!("another model") };
    let character = Character::of(outcome.problem.training(), outcome.problem.deadband);
    let doubted = |set: DuhemParameters| -> Vec<DuhemCondition> {
        let parameters = Parameters::Duhem(set);
        let wide = Range { min: -1e3, max: 1e3 };
        let table = Table { parameters, displacement_limits_um: wide, ..*candidate.table }.admit().unwrap();
        let doubts =
            doubts(&Candidate { table, ..candidate.clone() }, candidate, &character, Feedback::Simulation.into(), None);
        let condition = |doubt: Doubt| match doubt {
            Doubt::UnmetCondition { condition } => Some(condition),
            _ => None,
        };
        doubts.into_iter().filter_map(condition).collect()
    };
    // Without hysteresis nothing is taken from the slope, but it does not lag either; a little of it is right.
    let little = 0.9 * found.f1_um_per_v;
    let good = DuhemParameters { f3_um_per_v3: 0.0, g0_um_per_v: little, g2_um_per_v3: 0.0, ..found };
    assert_eq!(doubted(good), []);
    assert_eq!(doubted(DuhemParameters { g0_um_per_v: 1.1 * found.f1_um_per_v, ..good }), [DuhemCondition::Lagging]);
    // The slope of f grows so fast towards saturation that a reversal there would turn the displacement back.
    let steep = found.f1_um_per_v / (found.saturation_v * found.saturation_v);
    assert_eq!(doubted(DuhemParameters { f3_um_per_v3: steep, ..good }), [DuhemCondition::Rising]);
}
