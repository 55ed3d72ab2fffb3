//! Why an item cannot be reproduced.

use estimator_core::Model;
use identification::validate::ScopeError;
use identification::{CandidateError, JobError};
use recordings::log::LogError;
use recordings::prepare::PrepareError;

/// Why an item, or none at all, cannot be reproduced.
#[derive(Debug, thiserror::Error)]
pub enum ThesisError {
    /// The logs cannot be used.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A further log cannot be brought to the tick.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// No table can be made of what was found.
    #[error(transparent)]
    Candidate(#[from] CandidateError),
    /// The same, of the model that the item is about.
    #[error("model {model}")]
    Model {
        /// The model without a candidate.
        model: Model,
        /// Why it has none.
        source: CandidateError,
    },
    /// A model that the item needs was not searched for.
    #[error("model {0} was not searched for")]
    NotSearched(Model),
    /// There are no errors on a part of the logs.
    #[error("nothing was {0}")]
    NoFigures(&'static str),
    /// The parameters are another model's.
    #[error("these are not Voigt's parameters")]
    NotVoigt,
    /// Nothing is held out.
    #[error("nothing is held out to compare with")]
    NothingHeldOut,
    /// The logs are a user's.
    #[error("only the rig can be driven; a user's logs say nothing of other voltages")]
    NoRig,
    /// The logs are a user's, and the item brings its own.
    #[error("this is about recordings and devices that come with the tool, not about given logs")]
    OwnRecordings,
    /// A recording that comes with the tool cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A part of a recording cannot be scored.
    #[error(transparent)]
    Scope(#[from] ScopeError),
    /// The model's zeros are not the rig's.
    #[error("the rig is driven from its own zeros")]
    OtherZeros,
    /// The numbers cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// An item could not be reproduced.
    #[error("{item}")]
    Item {
        /// Name of the item.
        item: &'static str,
        /// Why it could not be reproduced.
        source: Box<Self>,
    },
}
