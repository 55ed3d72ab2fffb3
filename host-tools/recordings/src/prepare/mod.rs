//! From a log as recorded to a [`Session`](crate::session::Session) at the tick: what is cut off, scaled, zeroed,
//! resampled and shifted, in that order. A [`Recipe`] says all of it in numbers and travels with the parameter table,
//! so that a log is prepared for validation exactly as the training logs were.

mod options;
mod recipe;
mod resample;

pub use options::{AutoOr, PrepareOptions};
pub use recipe::{PrepareError, Recipe, RecipeError};
pub use resample::Decimation;
