//! A log brought to the tick, and a model run over it: by itself, or fed with a share of the measurement (Eq. 4.3,
//! 4.4).
//!
//! The voltage stands at every tick; the displacement stands at the instants where it was measured, which may be every
//! tick or (in a log slower than the tick) every n-th. Errors are taken at the measured instants only.

use crate::cost::Cost;
use estimator_core::{Running, State, Terms, Voigt};

/// One log at the tick, in the model's units: V and µm relative to the model's zeros.
#[derive(Clone, PartialEq, Debug)]
pub struct Session {
    /// Name of the log it comes from.
    pub name: String,
    /// Voltage at each tick, V.
    pub voltage: Vec<f64>,
    /// Ticks at which the displacement was measured; increasing, the first is 0, the last below `voltage.len()`.
    pub instants: Vec<u32>,
    /// Measured displacement at the instants, µm.
    pub displacement: Vec<f64>,
    /// Time of the first tick within the log, s.
    pub start_s: f64,
    /// Tick, s.
    pub tick_s: f64,
}

impl Session {
    /// A session from its parts; it starts where its log does.
    pub fn new(name: String, voltage: Vec<f64>, instants: Vec<u32>, displacement: Vec<f64>, tick_s: f64) -> Self {
        debug_assert!(instants.first() == Some(&0) && instants.len() == displacement.len());
        Self { name, voltage, instants, displacement, start_s: 0.0, tick_s }
    }

    /// Runs a model's recursion over the session and hands each measured instant after the first to `at`, as (predicted
    /// displacement, measured displacement). `terms` gives the affine map of a tick, in the direct form or tabulated;
    /// `weight`, 0 … 1, is the share of each measurement in what the recursion goes on from.
    pub fn run(
        &self,
        model: &Voigt<f64>,
        deadband: f64,
        weight: f64,
        terms: impl Fn(usize) -> Terms<f64>,
        mut at: impl FnMut(f64, f64),
    ) {
        let Some(&start) = self.displacement.first() else { return };
        let mut state = State::new(start, deadband);
        let mut tick = 0;
        for (&instant, &measured) in self.instants.iter().zip(&self.displacement).skip(1) {
            while tick < instant as usize {
                model.step_with(&mut state, self.voltage[tick], terms(tick));
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
        &self,
        model: &Voigt<f64>,
        deadband: f64,
        cost: Cost,
        terms: impl Fn(usize) -> Terms<f64>,
    ) -> f64 {
        let mut sum = 0.0;
        let at = |predicted: f64, measured: f64| sum += cost.norm.size(predicted - measured);
        self.run(model, deadband, cost.weight(), terms, at);
        self.mean(sum)
    }

    /// As [`mean_error`](Self::mean_error), of a model beyond the Voigt family. Its memory is its own, so that feedback
    /// corrects what it gives and not where it stands: an offset, 0 at first, of which each measurement leaves 1 − w
    /// and adds w times what the model by itself is off. One-step prediction is the measured displacement and the
    /// change that the model gives.
    pub fn mean_error_of(&self, mut model: Running<f64>, cost: Cost) -> f64 {
        let Some(&start) = self.displacement.first() else { return f64::INFINITY };
        let (mut tick, mut sum, mut estimated, mut offset) = (0, 0.0, start, 0.0);
        for (&instant, &measured) in self.instants.iter().zip(&self.displacement).skip(1) {
            while tick < instant as usize {
                estimated = model.step(self.voltage[tick], Some(start));
                tick += 1;
            }
            sum += cost.norm.size(estimated + offset - measured);
            offset = mixed(offset, measured - estimated, cost.weight());
        }
        self.mean(sum)
    }

    fn mean(&self, sum: f64) -> f64 {
        let mean = sum / (self.instants.len() - 1).max(1) as f64;
        if mean.is_finite() { mean } else { f64::INFINITY }
    }
}

/// From the one to the other by a weight; exactly the one at 0, the other at 1.
fn mixed(one: f64, other: f64, weight: f64) -> f64 {
    (1.0 - weight) * one + weight * other
}
