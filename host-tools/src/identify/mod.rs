//! Parameter identification: the model error as a cost (Eq. 4.1), minimised by the genetic algorithm or, of what a
//! model is not linear in, by another method.

mod candidate;
mod character;
mod delay;
mod doubt;
mod family;
mod fit;
pub mod ga;
mod job;
mod log_use;
mod model_choice;
mod problem;
mod rounds;
mod search_options;
pub mod space;
mod structures;
mod suspicion;

pub use candidate::{Candidate, Setting};
pub use character::Character;
pub use doubt::Doubt;
pub use family::BlackBoxInputs;
pub use fit::{Convergence, Fit, Identification, Progress, identify, identify_black_box};
pub use job::{Job, Outcome, Prepared};
pub use log_use::{LogUse, Role};
pub use model_choice::{ModelChoice, with_contained};
pub use problem::{Conditions, Problem};
pub use search_options::{SearchOptions, Start};
pub use suspicion::doubts;
