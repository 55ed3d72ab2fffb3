//! Parameter identification: the model error as a cost (Eq. 4.1), minimised by the genetic algorithm.

mod candidate;
mod fit;
pub mod ga;
mod problem;
pub mod space;

pub use candidate::Candidate;
pub use fit::{Convergence, Fit, Progress, SearchOptions, Start, identify};
pub use problem::Problem;
