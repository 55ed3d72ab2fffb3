//! A model run over a session, by itself or fed with a share of the measurement (Eq. 4.3, 4.4), and its mean error.
//! Errors are taken at the measured instants only.

use crate::cost::Cost;
use estimator_core::{Running, State, Terms, Voigt};
use recordings::session::Session;

/// Runs a model's recursion over the session and hands each measured instant after the first to `at`, as (predicted
/// displacement, measured displacement). `terms` gives the affine map of a tick, in the direct form or tabulated;
/// `weight`, 0 … 1, is the share of each measurement in what the recursion goes on from.
pub fn run(
    session: &Session,
    model: &Voigt<f64>,
    deadband: f64,
    weight: f64,
    terms: impl Fn(usize) -> Terms<f64>,
    mut at: impl FnMut(f64, f64),
) {
    let Some(&start) = session.displacement.first() else { return };
    let mut state = State::new(start, deadband);
    let mut tick = 0;
    for (&instant, &measured) in session.instants.iter().zip(&session.displacement).skip(1) {
        while tick < instant as usize {
            model.step_with(&mut state, session.voltage[tick], terms(tick));
            tick += 1;
        }
        at(state.displacement, measured);
        if weight > 0.0 {
            state.displacement = mixed(state.displacement, measured, weight);
        }
    }
}

/// Mean size of a model's errors over the session in a cost's norm; infinite when it diverges.
pub fn mean_error(
    session: &Session,
    model: &Voigt<f64>,
    deadband: f64,
    cost: Cost,
    terms: impl Fn(usize) -> Terms<f64>,
) -> f64 {
    let mut sum = 0.0;
    let at = |predicted: f64, measured: f64| sum += cost.norm.size(predicted - measured);
    run(session, model, deadband, cost.weight(), terms, at);
    mean(session, sum)
}

/// As [`mean_error`], of a model beyond the Voigt family. Its memory is its own, so that feedback
/// corrects what it gives and not where it stands: an offset, 0 at first, of which each measurement leaves 1 − w
/// and adds w times what the model by itself is off. One-step prediction is the measured displacement and the
/// change that the model gives.
pub fn mean_error_of(session: &Session, mut model: Running<f64>, cost: Cost) -> f64 {
    let Some(&start) = session.displacement.first() else { return f64::INFINITY };
    let (mut tick, mut sum, mut estimated, mut offset) = (0, 0.0, start, 0.0);
    for (&instant, &measured) in session.instants.iter().zip(&session.displacement).skip(1) {
        while tick < instant as usize {
            estimated = model.step(session.voltage[tick], Some(start));
            tick += 1;
        }
        sum += cost.norm.size(estimated + offset - measured);
        offset = mixed(offset, measured - estimated, cost.weight());
    }
    mean(session, sum)
}

fn mean(session: &Session, sum: f64) -> f64 {
    let mean = sum / (session.instants.len() - 1).max(1) as f64;
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// From the one to the other by a weight; exactly the one at 0, the other at 1.
fn mixed(one: f64, other: f64, weight: f64) -> f64 {
    (1.0 - weight) * one + weight * other
}
