//! What is searched, and how a search runs.

mod options;
pub mod space;

pub use minimisation::{
    Budget, Gene, Minimum, Objective, Optimiser, Quadratic, Scale, each, ga, halved, minimise, scaled,
};
pub use options::{SearchOptions, Start};
