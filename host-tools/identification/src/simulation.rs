//! A model run over a session, by itself or fed with a share of the measurement (Eq. 4.3, 4.4), and its mean error.
//!
//! Errors are taken at the measured instants only. Where a model's memory is the displacement itself, a share of the
//! measurement goes into the memory; else it corrects what the model gives and not where it stands: an offset, 0 at
//! first, of which each measurement leaves 1 − w and adds w times what the model by itself is off. One-step prediction is
//! then the measured displacement and the change that the model gives.

use crate::cost::Cost;
use estimator_core::Process;
use recordings::session::Session;

/// Mean size of a model's errors over the session in a cost's norm; infinite where it diverges or nothing was measured.
pub fn mean_error(session: &Session, model: impl Process<f64>, cost: Cost) -> f64 {
    mean_error_from(session.lead_in, session, model, cost)
}

/// As [`mean_error`], of the measured instants from this index on.
pub fn mean_error_from(first: usize, session: &Session, mut model: impl Process<f64>, cost: Cost) -> f64 {
    let Some(&start) = session.displacement.first() else { return f64::INFINITY };
    let weight = cost.weight();
    let (mut tick, mut sum, mut estimated, mut offset) = (0, 0.0, start, 0.0);
    // What a jump begins with is no displacement of the first tick's voltage.
    let known = session.rested_v.is_none().then_some(start);
    if let Some(rest) = session.rested_v {
        model.step(rest, Some(start));
    }
    let judged = first.max(1);
    for (index, (&instant, &measured)) in session.instants.iter().zip(&session.displacement).enumerate().skip(1) {
        while tick < instant as usize {
            estimated = model.step(session.voltage[tick], known);
            tick += 1;
        }
        if index >= judged {
            sum += cost.norm.size(estimated + offset - measured);
        }
        if weight > 0.0 && !model.set_displacement(mixed(estimated, measured, weight)) {
            offset = mixed(offset, measured - estimated, weight);
        }
    }
    let mean = sum / session.instants.len().saturating_sub(judged).max(1) as f64;
    if mean.is_finite() { mean } else { f64::INFINITY }
}

/// From the one to the other by a weight; exactly the one at 0, the other at 1.
fn mixed(one: f64, other: f64, weight: f64) -> f64 {
    (1.0 - weight) * one + weight * other
}
