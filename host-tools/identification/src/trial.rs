//! What a search tries: parameters that run as a model, in the form that is fastest to run.

use crate::search::interpolated::Interpolated;
use estimator_core::{
    Discretisation, Engine, Inadmissible, Parameters, Process, Range, Running, Voigt, VoigtParameters, VoigtState,
};

/// Parameters whose cost a [`Problem`](crate::Problem) tells.
pub trait Trial {
    /// The model that runs with them.
    type Model: Process<f64>;

    /// The model for ticks of this kind and for voltages of this range (V).
    fn model(&self, discretisation: &Discretisation<f64>, voltages: Range<f64>) -> Self::Model;
}

type Fast = Running<Interpolated, VoigtState<f64>>;

/// As the genetic algorithm varies them.
impl Trial for VoigtParameters<f64> {
    type Model = Fast;

    fn model(&self, discretisation: &Discretisation<f64>, voltages: Range<f64>) -> Fast {
        Running::new(Interpolated::new(Voigt::build(self, discretisation), voltages))
    }
}

/// As a table holds them.
impl Trial for Parameters {
    type Model = Accelerated;

    fn model(&self, discretisation: &Discretisation<f64>, voltages: Range<f64>) -> Accelerated {
        match self.voigt() {
            Some(of) => Accelerated::Interpolated(of.map(f64::from).model(discretisation, voltages)),
            None => Accelerated::Plain(Box::new(self.build(discretisation))),
        }
    }
}

/// Any model as the search runs it: the Voigt family's interpolated, every other as it is.
#[derive(Clone, Debug)]
pub enum Accelerated {
    /// Of the Voigt family.
    Interpolated(Fast),
    /// Any other.
    Plain(Box<Engine<f64>>),
}

impl Process<f64> for Accelerated {
    #[inline]
    fn step(&mut self, voltage: f64, known: Option<f64>) -> f64 {
        match self {
            Self::Interpolated(model) => model.step(voltage, known),
            Self::Plain(model) => model.step(voltage, known),
        }
    }

    fn bound(&self, voltage: Range<f64>, limits: Range<f64>) -> Result<Range<f64>, Inadmissible<f64>> {
        match self {
            Self::Interpolated(model) => model.bound(voltage, limits),
            Self::Plain(model) => model.bound(voltage, limits),
        }
    }

    fn set_displacement(&mut self, displacement: f64) -> bool {
        match self {
            Self::Interpolated(model) => model.set_displacement(displacement),
            Self::Plain(model) => model.set_displacement(displacement),
        }
    }
}
