//! Parameter identification: the model error as a cost (Eq. 4.1), minimised by the genetic algorithm.

mod candidate;
mod character;
mod delay;
mod doubt;
mod family;
mod fit;
pub mod ga;
mod job;
mod log_use;
mod problem;
pub mod space;
mod suspicion;

pub use candidate::{Candidate, Setting};
pub use character::Character;
pub use doubt::Doubt;
pub use family::BlackBoxInputs;
pub use fit::{Convergence, Fit, Progress, SearchOptions, Start, identify, identify_black_box};
pub use job::{Job, ModelChoice, Outcome, Prepared, with_contained};
pub use log_use::{LogUse, Role};
pub use problem::{Conditions, Problem};
pub use suspicion::doubts;
