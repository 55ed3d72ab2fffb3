//! Models by their names.

use super::choice::{Choice, choice};
use clap::builder::TypedValueParser;
use estimator_core::Model;
use identification::ModelChoice;

const AUTO: Choice<ModelChoice> =
    (ModelChoice::Auto, "auto", "Every model briefly, and the one that cross-validation chooses at length");

/// A parser of a model's name.
pub fn models() -> impl TypedValueParser<Value = Model> {
    choice(Model::ALL.map(|model| (model, model.name(), model.description())))
}

/// The models that were named, each once; all where none was.
pub fn asked(named: &[Model]) -> Vec<Model> {
    let mut models = Vec::new();
    for model in if named.is_empty() { &Model::ALL[..] } else { named } {
        if !models.contains(model) {
            models.push(*model);
        }
    }
    models
}

/// A parser of a model's name, or `auto`.
pub fn model_choice() -> impl TypedValueParser<Value = ModelChoice> {
    let named = Model::ALL.map(|model| (ModelChoice::Is(model), model.name(), model.description()));
    choice([AUTO].into_iter().chain(named))
}
