//! What a cost is, against its definition written out.

use estimator_core::{
    BoucWenParameters, Discretisation, Engine, Parameters, Process, Running, Scheme, Voigt, VoigtParameters, VoigtState,
};
use model_error::cost::{Cost, Feedback, Norm, UnusedWeight};
use model_error::mean_error;
use recordings::session::Session;

const TICK: f64 = 5e-4;
const EULER: Discretisation<f64> = Discretisation { sample_period: TICK, scheme: Scheme::ForwardEuler, deadband: 0.01 };
const VOIGT: VoigtParameters<f64> = VoigtParameters {
    alpha_um: 172.0,
    beta_v: 5.2,
    lambda_per_v: 0.051,
    b_ohm: 1416.0,
    p: 1.49,
    g_um_per_s: 0.0,
    h: 0.0,
    e_m_per_s: 0.0,
    f: 0.0,
};

fn multi_step(weight: f64, norm: Norm) -> Cost {
    Cost { feedback: Feedback::MultiStep, norm, feedback_weight: Some(weight) }
}

/// Measured every third tick; the displacement is no model's.
fn session() -> Session {
    let voltage: Vec<f64> = (0..900).map(|k| 15.0 * (f64::from(k) * 0.02).sin()).collect();
    let instants: Vec<u32> = (0..900).step_by(3).collect();
    let measured = |&k: &u32| 3.0 * (f64::from(k) * 0.02 - 0.3).sin() + 1e-3 * f64::from(k);
    let displacement = instants.iter().map(measured).collect();
    Session::new("made".to_owned(), voltage, instants, displacement, TICK)
}

fn bouc_wen() -> Engine<f64> {
    let parameters = Parameters::BoucWen(BoucWenParameters {
        lag_s: 2e-3,
        a: 1.0,
        beta: 0.1,
        gamma: 0.02,
        delta: 0.0,
        n: 1.0,
        offset_um: 0.1,
        d1_um_per_v: 0.2,
        d2_um_per_v2: 0.001,
        c_um_per_v: -0.1,
    });
    parameters.build(&EULER)
}

/// With every retreat by more than 10 mV a reversal.
fn voigt() -> Running<Voigt<f64>, VoigtState<f64>> {
    Running::new(Voigt::build(&VOIGT, &EULER))
}

fn errors(cost: Cost) -> [f64; 2] {
    let session = session();
    [mean_error(&session, voigt(), cost), mean_error(&session, bouc_wen(), cost)]
}

/// What simulation and one-step prediction mean, written out: of the Voigt family the state is replaced, of another
/// model the change since the last measurement counts.
#[test]
fn without_feedback_it_is_simulation_and_with_all_of_it_one_step_prediction() {
    let (session, model) = (session(), Voigt::build(&VOIGT, &EULER));
    for (one_step, weight, feedback) in [(false, 0.0, Feedback::Simulation), (true, 1.0, Feedback::Osp)] {
        let (mut voigt, mut other, mut running) = (0.0, 0.0, bouc_wen());
        let mut y = session.displacement[0];
        let (mut last, mut last_measured) = (y, y);
        for (index, &measured) in session.displacement.iter().enumerate().skip(1) {
            let mut own = 0.0;
            for &voltage in &session.voltage[3 * index - 3..3 * index] {
                y = model.terms(voltage).apply(y, 0.0);
                own = running.step(voltage, Some(session.displacement[0]));
            }
            voigt += (y - measured).abs();
            other += if one_step { (own - last - (measured - last_measured)).abs() } else { (own - measured).abs() };
            y = if one_step { measured } else { y };
            (last, last_measured) = (own, measured);
        }
        let count = (session.displacement.len() - 1) as f64;
        let found = errors(multi_step(weight, Norm::L1));
        assert_eq!(found, errors(feedback.into()));
        assert_eq!(found[0], voigt / count);
        assert!((found[1] - other / count).abs() < 1e-12, "{found:?} {}", other / count);
    }
}

#[test]
fn an_error_is_forgotten_over_a_weight_s_steps() {
    // A model at rest that the measurement leaves by 1 µm at the first instant after the start, and for good.
    let mut session = session();
    let rest = {
        let mut model = bouc_wen();
        session.voltage.fill(3.0);
        (0..9000).fold(0.0, |_, _| model.step(3.0, None))
    };
    session.displacement.fill(rest + 1.0);
    session.displacement[0] = rest;
    let weight = 0.1f64;
    let count = session.displacement.len() as i32 - 1;
    let sum = |norm: Norm| (0..count).map(|k| norm.size((1.0 - weight).powi(k))).sum::<f64>() / f64::from(count);
    for norm in [Norm::L1, Norm::L2] {
        let found = mean_error(&session, bouc_wen(), multi_step(weight, norm));
        assert!((found - sum(norm)).abs() < 1e-3 * sum(norm), "{norm:?}: {found} {}", sum(norm));
    }
}

#[test]
fn errors_lie_between_those_of_the_two_ends() {
    let at = |weight| errors(multi_step(weight, Norm::L2));
    let (simulation, one_step) = (at(0.0), at(1.0));
    for weight in [0.003, 0.03, 0.3] {
        for ((error, high), low) in at(weight).iter().zip(simulation).zip(one_step) {
            assert!((low..high).contains(error), "{weight}: {low} {error} {high}");
        }
    }
}

#[test]
fn norms_of_known_residuals() {
    let mean = |norm: Norm| norm.error([3.0, -4.0, 0.0].map(|error| norm.size(error)).iter().sum::<f64>() / 3.0);
    assert_eq!(mean(Norm::L1), 7.0 / 3.0);
    assert_eq!(mean(Norm::L2), (25.0f64 / 3.0).sqrt());
}

#[test]
fn a_weight_is_of_multi_step_alone() {
    let given = Cost { feedback_weight: Some(0.5), ..Feedback::Osp.into() };
    assert_eq!(given.resolved(), Err(UnusedWeight));
    assert_eq!(Cost::from(Feedback::Osp).resolved().unwrap().feedback_weight, None);
    assert_eq!(Cost::from(Feedback::MultiStep).resolved().unwrap().feedback_weight, Some(0.01));
}
