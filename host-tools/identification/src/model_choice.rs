//! Which models are identified when one, or none, is asked for, and which of them is chosen.

use crate::cross_validation::{CrossValidation, Undecided, eligible};
use crate::fit::{Fit, Identification, Progress};
use crate::search::Start;
use estimator_core::Model;

/// Which model to identify.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModelChoice {
    /// Whichever does best on parts of the training data that it was not fitted to.
    Auto,
    /// This one, whatever another would do.
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
}

/// Why a model was chosen.
#[derive(Clone, PartialEq, Debug)]
pub enum Reason {
    /// It was asked for.
    AskedFor,
    /// Cross-validation's rule chose it, by parts of the training data that it was not fitted to.
    CrossValidated(CrossValidation),
    /// Cross-validation's rule chose it by parts of the whole training logs, after another model had been chosen
    /// without what was held out and was far off there.
    OnceMore {
        /// Among the models that were nearest there, each learnt from the whole logs; `None` where one is off by far
        /// less in them.
        validated: Option<CrossValidation>,
        /// The model that had been chosen.
        first: Model,
    },
    /// Its error in training, once each log's start has settled, is the least, and cross-validation decides nothing.
    Least(Undecided),
}

impl Reason {
    /// What cross-validation has found, where it chose.
    pub fn cross_validation(&self) -> Option<&CrossValidation> {
        match self {
            Self::CrossValidated(of) => Some(of),
            Self::OnceMore { validated, .. } => validated.as_ref(),
            Self::AskedFor | Self::Least(_) => None,
        }
    }
}

/// What was identified when a model, or none, was asked for.
#[derive(Clone, PartialEq, Debug)]
pub struct Choice {
    /// Every fit, simplest first.
    pub fits: Vec<Fit>,
    /// The chosen model, and why it was chosen; `None` where none has an admissible candidate.
    pub chosen: Option<(Model, Reason)>,
}

impl Identification<'_> {
    /// Identifies the wanted model and those that it starts from; or every model briefly and the one that
    /// cross-validation chooses at length.
    pub fn choose(&self, wanted: ModelChoice, progress: Progress<'_>) -> Choice {
        if let Some(model) = wanted.model() {
            let fits = self.run(&with_contained(model, self.options.start), progress);
            return Choice { fits, chosen: Some((model, Reason::AskedFor)) };
        }
        let mut fits = self.brief(&Model::ALL, progress);
        let tried = eligible(self.problem, self.cost, &fits);
        let least = tried.iter().min_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some(least) = least.map(|(fit, _)| (fit.model, fit.cost)) else {
            return Choice { fits, chosen: None };
        };
        let validated = CrossValidation::of(self, &tried, || progress(least.0, least.1));
        let model = validated.as_ref().map_or(least.0, |of| of.score().model);
        let searched: &[Model] = if self.smooth(model) { &[] } else { &[model] };
        for longer in self.run(searched, progress) {
            if let Some(brief) = fits.iter_mut().find(|fit| fit.model == model && self.off(&longer) <= self.off(fit)) {
                *brief = longer;
            }
        }
        let reason = validated.map_or_else(Reason::Least, Reason::CrossValidated);
        Choice { fits, chosen: Some((model, reason)) }
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
