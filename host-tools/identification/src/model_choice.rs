//! Which models are identified when one, or none, is asked for.

use crate::search::Start;
use estimator_core::Model;

/// Which model to identify.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModelChoice {
    /// The Voigt family and the generalised Prandtl–Ishlinskii model, which is chosen.
    Auto,
    /// This one.
    Is(Model),
}

impl ModelChoice {
    /// The model, or `None` for the choice to be made from the logs.
    pub fn model(self) -> Option<Model> {
        match self {
            Self::Auto => None,
            Self::Is(model) => Some(model),
        }
    }

    /// The models to identify, simplest first: the wanted one and, where it starts from them, those it contains.
    pub fn models(self, start: Start) -> Vec<Model> {
        match self.model() {
            Some(wanted) => with_contained(wanted, start),
            None => [&Model::VOIGT_FAMILY[..], &[Model::GeneralisedPrandtlIshlinskii]].concat(),
        }
    }
}

/// A model after those that it contains and starts from, simplest first.
pub fn with_contained(wanted: Model, start: Start) -> Vec<Model> {
    if start == Start::Random || !wanted.is_voigt() {
        return vec![wanted];
    }
    let contained = |model: &Model| {
        (wanted.has_voltage_term() || !model.has_voltage_term())
            && (wanted.has_displacement_term() || !model.has_displacement_term())
    };
    Model::VOIGT_FAMILY.into_iter().filter(contained).collect()
}
