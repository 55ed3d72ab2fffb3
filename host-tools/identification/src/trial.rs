//! What a search tries.

use estimator_core::{Discretisation, Engine, Parameters, Process};

/// Parameters whose cost a [`Problem`](crate::Problem) tells.
pub trait Trial {
    /// The model that runs with them.
    type Model: Process<f64>;

    /// The model for ticks of this kind.
    fn model(&self, discretisation: &Discretisation<f64>) -> Self::Model;
}

/// As a table holds them.
impl Trial for Parameters {
    type Model = Engine<f64>;

    fn model(&self, discretisation: &Discretisation<f64>) -> Engine<f64> {
        self.build(discretisation)
    }
}
