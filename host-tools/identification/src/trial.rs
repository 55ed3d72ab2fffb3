//! What a search tries: parameters that run as a model, in the form that is fastest to run.

use crate::problem::Problem;
use crate::search::interpolated::Interpolated;
use estimator_core::{Engine, Inadmissible, Parameters, Process, Range, Running, Voigt, VoigtParameters, VoigtState};

/// Parameters whose cost a [`Problem`] tells.
pub trait Trial {
    /// The model that runs with them.
    type Model: Process<f64>;

    /// The model, for the problem's tick, scheme and deadband.
    fn model(&self, problem: &Problem) -> Self::Model;
}

type Fast = Running<Interpolated, VoigtState<f64>>;

/// As the genetic algorithm varies them.
impl Trial for VoigtParameters<f64> {
    type Model = Fast;

    fn model(&self, problem: &Problem) -> Fast {
        let model = Voigt::build(self, &problem.discretisation());
        Running::new(Interpolated::new(model, problem.voltage_range()))
    }
}

/// As a table holds them.
impl Trial for Parameters {
    type Model = Accelerated;

    fn model(&self, problem: &Problem) -> Accelerated {
        match self.voigt() {
            Some(of) => Accelerated::Interpolated(of.map(f64::from).model(problem)),
            None => Accelerated::Plain(Box::new(self.build(&problem.discretisation()))),
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
