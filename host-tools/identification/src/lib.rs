//! Parameter identification: the model error as a cost (Eq. 4.1), minimised by the genetic algorithm or, of what a
//! model is not linear in, by another method; and what a table found so is good for.

mod baseline;
mod brief;
mod candidate;
mod character;
pub mod cost;
mod cross_validation;
mod delay;
mod division;
mod doubt;
pub mod family;
mod fit;
mod job;
mod model_choice;
mod problem;
mod rounds;
pub mod search;
pub mod simulation;
mod start;
mod structures;
mod suspicion;
mod trial;

pub use baseline::{Baseline, Point, StraightLine};
pub use brief::Brief;
pub use candidate::{Candidate, CandidateError, TableContext};
pub use character::Character;
pub use cross_validation::{CrossValidation, LeftOut, Score};
pub use doubt::{Converter, Doubt, FEW_REVERSALS};
pub use family::BlackBoxInputs;
pub use fit::{Convergence, Fit, Identification, Progress, identify, identify_black_box};
pub use job::{Job, JobError, Outcome, Prepared};
pub use model_choice::{Choice, ModelChoice, Reason, with_contained};
pub use problem::{Conditions, Problem};
pub use search::{SearchOptions, Start};
pub use start::prepared;
pub use structures::{Found, StructureSearch};
pub use suspicion::doubts;
pub use trial::Trial;
pub use validation as validate;
pub use validation::reversals;
