//! The options that several verbs share. Each converts into what its library takes.

/// A library's options from the arguments that say them, field by field.
macro_rules! options {
    ($arguments:ident => $options:ident { $($field:ident),+ $(,)? }) => {
        impl From<&$arguments> for $options {
            fn from(arguments: &$arguments) -> Self {
                let &$arguments { $($field),+ } = arguments;
                Self { $($field),+ }
            }
        }
    };
}

mod board;
mod calibration;
mod choice;
mod cost;
mod drive;
mod excitation;
mod fitting;
pub mod link;
mod logs;
mod model;
mod number;
mod overwrite;
mod prepare;
mod rig;
mod scope;
mod search;

pub use board::BoardOption;
pub use calibration::CalibrationArgs;
pub use choice::choice;
pub use cost::CostArgs;
pub use excitation::ExcitationArgs;
pub use fitting::Fitting;
pub use logs::LogOptions;
pub use model::{asked, model_choice, models};
pub use number::{count, delay, factor, finite, limit, not_negative, positive, span, zero};
pub use overwrite::Overwrite;
pub use prepare::{PrepareAgain, PrepareArgs};
pub use rig::RigArgs;
pub use scope::{ScopeArgs, TOLD};
pub use search::{OPTIMISERS, STARTS, SearchArgs};
