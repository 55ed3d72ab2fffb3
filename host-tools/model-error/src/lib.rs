//! A model run over a session, by itself or fed with a share of the measurement (Eq. 4.3, 4.4), and its mean error.
//!
//! Errors are taken at the measured instants only. Where a model's memory is the displacement itself, a share of the
//! measurement goes into the memory; else it corrects what the model gives and not where it stands: an offset, 0 at
//! first, of which each measurement leaves 1 − w and adds w times what the model by itself is off. One-step prediction
//! is then the measured displacement and the change that the model gives.

pub mod cost;

use cost::{Cost, Norm};
use estimator_core::Process;
use recordings::session::Session;

/// Mean size of a model's errors over the session in a cost's norm; infinite where it diverges or nothing was measured.
pub fn mean_error(session: &Session, model: impl Process<f64>, cost: Cost) -> f64 {
    if session.displacement.is_empty() {
        return f64::INFINITY;
    }
    let (mut sum, judged) = (0.0, session.lead_in.max(1));
    fed(session, model, cost.weight(), |index, error| {
        if index >= judged {
            sum += cost.norm.size(error);
        }
    });
    let mean = sum / session.instants.len().saturating_sub(judged).max(1) as f64;
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// Runs a model over a session, fed with a share of the measurement, and hands over the index of each measured instant
/// but the first and what the model is off by there, µm.
fn fed(session: &Session, mut model: impl Process<f64>, weight: f64, mut each: impl FnMut(usize, f64)) {
    let Some(&start) = session.displacement.first() else { return };
    let (mut tick, mut estimated, mut offset) = (0, start, 0.0);
    // What a jump begins with is no displacement of the first tick's voltage.
    let known = session.rested_v.is_none().then_some(start);
    if let Some(rest) = session.rested_v {
        model.step(rest, Some(start));
    }
    for (index, (&instant, &measured)) in session.instants.iter().zip(&session.displacement).enumerate().skip(1) {
        while tick < instant as usize {
            estimated = model.step(session.voltage[tick], known);
            tick += 1;
        }
        each(index, estimated + offset - measured);
        if weight > 0.0 && !model.set_displacement(mixed(estimated, measured, weight)) {
            offset = mixed(offset, measured - estimated, weight);
        }
    }
}

/// What a model by itself is off by at a session's measured instants from an index on, µm; it is told
/// the first reading.
pub fn errors_from(first: usize, session: &Session, model: impl Process<f64>) -> Vec<f64> {
    let mut errors = Vec::with_capacity(session.instants.len().saturating_sub(first));
    fed(session, model, 0.0, |index, error| {
        if index >= first {
            errors.push(error);
        }
    });
    errors
}

/// Mean size of errors beside a constant (µm); infinite where it is none, or there are no errors.
pub fn mean_size(errors: &[f64], constant: f64, norm: Norm) -> f64 {
    let sum: f64 = errors.iter().map(|error| norm.size(error - constant)).sum();
    let mean = sum / errors.len() as f64;
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// From the one to the other by a weight; exactly the one at 0, the other at 1.
fn mixed(one: f64, other: f64, weight: f64) -> f64 {
    (1.0 - weight) * one + weight * other
}
