//! A log brought to the tick, and the two ways of running a model over it (Eq. 4.3, 4.4).
//!
//! The voltage stands at every tick; the displacement stands at the instants where it was measured, which may be every
//! tick or (in a log slower than the tick) every n-th. Errors are taken at the measured instants only.

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

/// What feeds the recursion.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feedback {
    /// One-step prediction, Eq. (4.3): each step starts from the measured displacement. In a log slower than the tick
    /// one step is one interval of the log.
    Osp,
    /// Simulation, Eq. (4.4): the model's own displacement, from the first measured sample on.
    Simulation,
}

impl Session {
    /// A session from its parts; it starts where its log does.
    pub fn new(name: String, voltage: Vec<f64>, instants: Vec<u32>, displacement: Vec<f64>, tick_s: f64) -> Self {
        debug_assert!(instants.first() == Some(&0) && instants.len() == displacement.len());
        Self { name, voltage, instants, displacement, start_s: 0.0, tick_s }
    }

    /// Runs a model's recursion over the session and hands each measured instant after the first to `at`, as (predicted
    /// displacement, measured displacement). `terms` gives the affine map of a tick, in the direct form or tabulated.
    pub fn run(
        &self,
        model: &Voigt<f64>,
        deadband: f64,
        feedback: Feedback,
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
            if feedback == Feedback::Osp {
                state.displacement = measured;
            }
        }
    }

    /// As [`mean_absolute_error`](Self::mean_absolute_error), of a model beyond the Voigt family. Its memory is its own: one-step
    /// prediction takes the measured displacement and adds the change that the model gives.
    pub fn mean_absolute_error_of(&self, mut model: Running<f64>, feedback: Feedback) -> f64 {
        let Some(&start) = self.displacement.first() else { return f64::INFINITY };
        let (mut tick, mut sum) = (0, 0.0);
        let (mut estimated, mut last_estimated, mut last_measured) = (start, start, start);
        for (&instant, &measured) in self.instants.iter().zip(&self.displacement).skip(1) {
            while tick < instant as usize {
                estimated = model.step(self.voltage[tick], Some(start));
                tick += 1;
            }
            sum += match feedback {
                Feedback::Simulation => (estimated - measured).abs(),
                Feedback::Osp => ((estimated - last_estimated) - (measured - last_measured)).abs(),
            };
            (last_estimated, last_measured) = (estimated, measured);
        }
        let mean = sum / (self.instants.len() - 1).max(1) as f64;
        if mean.is_finite() { mean } else { f64::INFINITY }
    }

    /// Mean absolute error of a model over the session, µm (Eq. 4.1); infinite when it diverges.
    pub fn mean_absolute_error(
        &self,
        model: &Voigt<f64>,
        deadband: f64,
        feedback: Feedback,
        terms: impl Fn(usize) -> Terms<f64>,
    ) -> f64 {
        let mut sum = 0.0;
        self.run(model, deadband, feedback, terms, |predicted, measured| sum += (predicted - measured).abs());
        let mean = sum / (self.instants.len() - 1).max(1) as f64;
        if mean.is_finite() { mean } else { f64::INFINITY }
    }
}
