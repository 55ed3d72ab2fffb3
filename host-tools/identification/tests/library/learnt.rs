//! What is delivered once what was held out has judged it.

use calibration::CalibrationOptions;
use estimator_core::{Model, Table};
use identification::cost::Feedback;
use identification::{Conditions, Doubt, Job, ModelChoice, Outcome, SearchOptions};
use recordings::log::Log;
use recordings::prepare::{AutoOr, PrepareOptions};
use recordings::rig::{EXCITATIONS, Rig};
use recordings::{LogUse, Role};

/// Judged on the ends of two logs, or learnt from them as a whole.
fn outcome(model: Model, hold_out: f64) -> Outcome {
    of(model, hold_out, false)
}

fn of(model: Model, hold_out: f64, as_judged: bool) -> Outcome {
    job(model, hold_out, as_judged).run(&mut |_, _| ()).unwrap()
}

fn job(model: Model, hold_out: f64, as_judged: bool) -> Job {
    let rig = Rig { duration: 0.6, ..Rig::default() };
    Job {
        training: EXCITATIONS.into_iter().skip(1).take(2).map(|excitation| rig.log(excitation)).collect(),
        held_out: vec![rig.log(EXCITATIONS[4])],
        hold_out,
        as_judged,
        prepare: PrepareOptions { delay: AutoOr::Given(0.0), ..PrepareOptions::default() },
        model: ModelChoice::Is(model),
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Feedback::Simulation.into(),
        search: SearchOptions { evaluations: 40, ..SearchOptions::default() },
    }
}

#[test]
fn a_model_is_learnt_from_the_whole_once_its_half_has_judged_it() {
    for model in [
        Model::GeneralisedPrandtlIshlinskii,
        Model::BoucWen,
        Model::Voigt,
        Model::VoigtChain,
        Model::Narx,
        Model::Preisach,
    ] {
        let (halved, whole) = (outcome(model, 0.5), outcome(model, 0.0));
        let lengths = |of: &Outcome| of.learnt_from().training().map(|log| log.voltage.len()).collect::<Vec<_>>();
        assert_eq!(lengths(&halved), lengths(&whole), "{model}");
        let [as_judged, delivered] = [halved.judged(), &halved.learnt.candidate]
            .map(|of| halved.learnt_from().error_once_settled(&of.table.parameters, Feedback::Simulation.into()));
        assert!(delivered <= 1.1 * as_judged, "{model}: {delivered} µm on the whole, {as_judged} µm as judged");
        // What it is off by on data it has not seen is that of the judged one, on the ends of the two and the third.
        let figures = halved.judged().held_out_figures().unwrap();
        let Table { provenance, .. } = *halved.learnt.candidate.table;
        assert_eq!(provenance.validation_mae_um, Some(figures.mae_um as f32));
        assert_eq!((halved.judged().held_out.len(), halved.learnt.candidate.held_out.len()), (3, 1));
        assert_eq!(provenance.logs, whole.learnt.candidate.table.provenance.logs);
    }
}

/// What the end of a log alone has is in what is kept of it and in what is held out.
#[test]
fn of_a_log_whose_end_goes_beyond_its_beginning_stretches_are_held_out() {
    let rig = Rig { duration: 0.6, ..Rig::default() };
    let [small, mut large] = [rig.log(EXCITATIONS[1]), rig.log(EXCITATIONS[1])];
    large.voltage.iter_mut().for_each(|volts| *volts *= 2.0);
    let twice = large.displacement.unwrap().into_iter().map(|um| 2.0 * um);
    let log = Log {
        voltage: [small.voltage, large.voltage].concat(),
        displacement: Some(small.displacement.unwrap().into_iter().chain(twice).collect()),
        ..rig.log(EXCITATIONS[1])
    };
    let outcome = |as_judged| {
        let job = Job { training: vec![log.clone()], held_out: Vec::new(), ..job(Model::Voigt, 0.5, as_judged) };
        job.run(&mut |_, _| ()).unwrap()
    };
    for (as_judged, role) in [(true, Role::HeldOut), (false, Role::JudgedThenLearnt)] {
        let of = outcome(as_judged);
        let uses: Vec<_> = of.learnt.logs.iter().map(|log| (log.role, log.to_s - log.from_s, log.stretches)).collect();
        let seconds = log.duration();
        let of_training = as_judged.then_some(16);
        assert_eq!(uses, [(Role::Training, seconds, of_training), (role, seconds, Some(16))]);
        let [training, held_out] = [of.judged().training_off_um(), of.judged().held_out_off_um()].map(Option::unwrap);
        assert!((held_out / training - 1.0).abs() < 0.5, "{held_out} µm held out, {training} µm in training");
        let beyond = |doubt: &Doubt| {
            matches!(doubt, Doubt::BeyondTraining { .. } | Doubt::NoBetterThanLine { .. } | Doubt::HeldOutFar { .. })
        };
        assert!(!of.doubts.iter().any(beyond), "{:?}", of.doubts);
    }
}

#[test]
fn a_model_is_delivered_as_it_was_judged_where_that_is_asked_for() {
    let outcome = of(Model::Voigt, 0.5, true);
    assert_eq!(outcome.learnt.candidate.table, outcome.judged().table);
    let roles: Vec<Role> = outcome.learnt.logs.iter().map(|log| log.role).collect();
    assert_eq!(roles, [Role::Training, Role::Training, Role::HeldOut, Role::HeldOut, Role::HeldOut]);
}

#[test]
fn the_generalised_model_is_delivered_as_if_nothing_had_been_held_out() {
    let parameters =
        |hold_out| outcome(Model::GeneralisedPrandtlIshlinskii, hold_out).learnt.candidate.table.parameters;
    assert_eq!(parameters(0.5), parameters(0.0));
}

#[test]
fn what_each_log_was_used_for_says_which_part_has_judged() {
    let told = |of: &Outcome| -> Vec<(Role, f64, f64)> {
        let rounded = |s: f64| (s * 1e3).round() / 1e3;
        let use_of = |log: &LogUse| (log.role, rounded(log.from_s), rounded(log.to_s));
        of.learnt.logs.iter().map(use_of).collect()
    };
    let whole = [(Role::Training, 0.0, 0.6), (Role::Training, 0.0, 0.6), (Role::HeldOut, 0.0, 0.6)];
    assert_eq!(told(&outcome(Model::Voigt, 0.0)), whole);
    let judged = [(Role::JudgedThenLearnt, 0.3, 0.6); 2];
    assert_eq!(told(&outcome(Model::Voigt, 0.5)), [&whole[..], &judged].concat());
}

/// A first reading that the model takes for a memory, and that the first swing wipes out, is no error of the model's.
#[test]
fn a_sensor_whose_zero_is_another_on_what_is_held_out_makes_no_model_worse() {
    let off = |by_um: f64| {
        let mut job = job(Model::GeneralisedPrandtlIshlinskii, 0.0, true);
        let moved =
            |log: Log| Log { displacement: log.displacement.map(|um| um.iter().map(|y| y + by_um).collect()), ..log };
        job.held_out = job.held_out.into_iter().map(moved).collect();
        let outcome = job.run(&mut |_, _| ()).unwrap();
        let far = outcome.doubts.iter().any(|doubt| matches!(doubt, Doubt::HeldOutFar { .. }));
        let held_out = &outcome.judged().held_out;
        let told = held_out.iter().map(|log| log.mil.mae_without_offset_um).sum::<f64>() / held_out.len() as f64;
        let off_um = outcome.judged().held_out_off_um().unwrap();
        (told, off_um, far)
    };
    let (_, right, _) = off(0.0);
    for by_um in [-1.0, 1.0] {
        let (told, off_um, far) = off(by_um);
        assert!(
            off_um < 1.2 * right && told > 1.5 * right && !far,
            "{by_um} µm: {off_um} of {told} µm, {right} µm else"
        );
    }
}
