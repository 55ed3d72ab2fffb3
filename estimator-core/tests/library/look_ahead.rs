//! A lag below 0: the displacement ahead of a tick after its voltage.

use crate::common::models;
use estimator_core::{Discretisation, Model, Parameters, Process, Scheme};

const TICK_S: f64 = 5e-4;

/// Of the test tables, with another lag (s).
fn with_lag(model: Model, lag_s: f32) -> Parameters {
    match models::parameters(model) {
        Parameters::BoucWen(of) => Parameters::BoucWen(estimator_core::BoucWenParameters { lag_s, ..of }),
        Parameters::Duhem(of) => Parameters::Duhem(estimator_core::DuhemParameters { lag_s, ..of }),
        other => other,
    }
}

/// Displacements (µm) for the voltages 40 + 30·sin of 10 Hz, and of the same model for a voltage that stands
/// for a tick.
fn runs(parameters: &Parameters) -> [Vec<f64>; 2] {
    let discretisation = Discretisation { sample_period: TICK_S, scheme: Scheme::ForwardEuler, deadband: 0.0 };
    let engine = parameters.build::<f64>(&discretisation);
    [engine.of_held_voltage(), engine].map(|mut engine| {
        let voltage = |k: u32| 40.0 + 30.0 * (f64::from(k) * TICK_S * 62.83).sin();
        (0..400).map(|k| engine.step(voltage(k), None)).collect()
    })
}

#[test]
fn a_whole_tick_ahead_is_what_comes_a_tick_later() {
    for model in [Model::BoucWen, Model::Duhem] {
        let [plain, none] = runs(&with_lag(model, 0.0));
        assert_eq!(plain, none, "{model}");
        let [held, ahead] = runs(&with_lag(model, -TICK_S as f32));
        assert_eq!(plain, held, "{model}: a voltage that stands for a tick");
        let [_, half] = runs(&with_lag(model, -0.5 * TICK_S as f32));
        let largest = |seen: &[f64], later: usize| {
            seen.iter().zip(&plain[later..]).skip(20).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let (late, off) = (largest(&plain, 1), largest(&ahead, 1));
        assert!(late > 0.1 && off < 0.07 * late, "{model}: {off} instead of {late} µm");
        // Half-way between the two.
        for (at, half) in half.iter().enumerate() {
            assert!((half - 0.5 * (plain[at] + ahead[at])).abs() < 1e-6, "{model} at {at}");
        }
    }
}

#[test]
fn no_more_than_a_tick_counts() {
    for model in [Model::BoucWen, Model::Duhem] {
        assert_eq!(runs(&with_lag(model, -TICK_S as f32)), runs(&with_lag(model, -1.0)), "{model}");
    }
}
