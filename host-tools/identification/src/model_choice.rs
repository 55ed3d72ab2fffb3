//! Which models are identified when one, or none, is asked for.

use crate::search::Start;
use clap::ValueEnum;
use estimator_core::Model;

/// Which model to identify.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum ModelChoice {
    /// The Voigt family and the champion, which is chosen; for a tabulated table the enhanced model where the logs have
    /// several amplitudes, else Voigt.
    Auto,
    /// Eq. (4.8).
    Voigt,
    /// Eq. (5.4).
    VoltageExtremum,
    /// Eq. (5.5).
    DisplacementExtremum,
    /// Eq. (5.3).
    Enhanced,
    /// Kelvin–Voigt elements in series, Eq. (3.20).
    VoigtChain,
    /// Play operators and dead zones, Eq. (3.9).
    PrandtlIshlinskii,
    /// Elasto-slide elements, Eq. (3.10).
    MaxwellSlip,
    /// Coleman and Hodgdon's form of Eq. (3.11).
    Duhem,
    /// Bouc–Wen with asymmetry.
    BoucWen,
    /// Relays on a grid, Eq. (3.1).
    Preisach,
    /// Black box of Table 5.1.
    Narx,
    /// The champion: lag, functions of play operators, creep.
    Champion,
}

impl ModelChoice {
    /// The model, or `None` for the choice to be made from the logs.
    pub fn model(self) -> Option<Model> {
        match self {
            Self::Auto => None,
            Self::Voigt => Some(Model::Voigt),
            Self::VoltageExtremum => Some(Model::VoltageExtremum),
            Self::DisplacementExtremum => Some(Model::DisplacementExtremum),
            Self::Enhanced => Some(Model::Enhanced),
            Self::VoigtChain => Some(Model::VoigtChain),
            Self::PrandtlIshlinskii => Some(Model::PrandtlIshlinskii),
            Self::MaxwellSlip => Some(Model::MaxwellSlip),
            Self::Duhem => Some(Model::Duhem),
            Self::BoucWen => Some(Model::BoucWen),
            Self::Preisach => Some(Model::Preisach),
            Self::Narx => Some(Model::Narx),
            Self::Champion => Some(Model::Champion),
        }
    }

    /// Whether a table of it may be tabulated.
    pub fn has_tabulated_form(self) -> bool {
        self.model().is_none_or(Model::is_voigt)
    }

    /// The models to identify, simplest first: the wanted one and, where it starts from them, those it contains.
    pub fn models(self, start: Start) -> Vec<Model> {
        match self.model() {
            Some(wanted) => with_contained(wanted, start),
            None => [&Model::VOIGT_FAMILY[..], &[Model::Champion]].concat(),
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
