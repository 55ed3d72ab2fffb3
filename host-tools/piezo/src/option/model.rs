//! Models by the names that the options have for them.

use super::choice::{Choice, choice};
use clap::builder::TypedValueParser;
use estimator_core::Model;
use identification::ModelChoice;

/// Every model.
pub const MODELS: [Choice<Model>; 12] = [
    (Model::Voigt, "voigt", "Eq. (4.8)"),
    (Model::VoltageExtremum, "voltage-extremum", "Eq. (5.4)"),
    (Model::DisplacementExtremum, "displacement-extremum", "Eq. (5.5)"),
    (Model::Enhanced, "enhanced", "Eq. (5.3)"),
    (Model::VoigtChain, "voigt-chain", "Kelvin–Voigt elements in series, Eq. (3.20)"),
    (Model::PrandtlIshlinskii, "prandtl-ishlinskii", "Play operators and dead zones, Eq. (3.9)"),
    (Model::MaxwellSlip, "maxwell-slip", "Elasto-slide elements, Eq. (3.10)"),
    (Model::Duhem, "duhem", "Coleman and Hodgdon's form of Eq. (3.11)"),
    (Model::BoucWen, "bouc-wen", "Bouc–Wen with asymmetry"),
    (Model::Preisach, "preisach", "Relays on a grid, Eq. (3.1)"),
    (Model::Narx, "narx", "Black box of Table 5.1"),
    (Model::Champion, "champion", "The champion: lag, functions of play operators, creep"),
];

const AUTO: Choice<ModelChoice> = (
    ModelChoice::Auto,
    "auto",
    "The Voigt family and the champion, which is chosen; for a tabulated table the enhanced model where the logs have \
     several amplitudes, else Voigt",
);

/// A parser of a model's name.
pub fn models() -> impl TypedValueParser<Value = Model> {
    choice(MODELS)
}

/// A parser of a model's name, or `auto`.
pub fn model_choice() -> impl TypedValueParser<Value = ModelChoice> {
    choice([AUTO].into_iter().chain(MODELS.map(|(model, name, what)| (ModelChoice::Is(model), name, what))))
}
