//! What is searched, and how a search runs.

pub(crate) mod interpolated;
mod options;
pub mod space;

pub use minimisation::{Budget, Gene, Minimum, Optimiser, Scale, ga, minimise};
pub use options::{SearchOptions, Start};
