//! Parameter identification: the model error as a cost (Eq. 4.1), minimised by the genetic algorithm or, of what a
//! model is not linear in, by another method; and what a table found so is good for.
//!
//! A [`Job`] is the whole of it. Here, plays are identified on two logs of a simulated actuator and judged on one
//! that decided nothing:
//!
//! ```
//! use calibration::CalibrationOptions;
//! use estimator_core::Model;
//! use identification::cost::{Cost, Feedback};
//! use identification::{Conditions, Job, ModelChoice, SearchOptions};
//! use recordings::prepare::PrepareOptions;
//! use recordings::rig::{EXCITATIONS, Rig};
//!
//! # fn main() -> Result<(), identification::JobError> {
//! let [sine, faster_sine, _, triangle, ..] = EXCITATIONS.map(|excitation| Rig::default().log(excitation));
//! let job = Job {
//!     training: vec![sine, faster_sine],
//!     held_out: vec![triangle],
//!     hold_out: 0.0,
//!     as_judged: false,
//!     prepare: PrepareOptions::default(),
//!     model: ModelChoice::Is(Model::PrandtlIshlinskii),
//!     conditions: Conditions::default(),
//!     calibration: CalibrationOptions::default(),
//!     cost: Cost::from(Feedback::Simulation),
//!     search: SearchOptions { evaluations: 10, ..SearchOptions::DEFAULT },
//! };
//! let outcome = job.run(&mut |_model, _cost_um| ())?;
//! let errors = outcome.judged().held_out_figures().expect("a log was held out");
//! let straight_line = outcome.straight_line.as_ref().expect("the voltage moves");
//! assert!(errors.mae_um < 0.5 * straight_line.held_out.expect("a log was held out").mae_um);
//! # Ok(())
//! # }
//! ```
//!
//! `examples/identify.rs` does the same with a file of yours, and writes the table; `examples/own_model.rs`
//! adds a model.

mod brief;
mod candidate;
mod cross_validation;
mod delay;
mod division;
mod doubt;
pub mod family;
mod fit;
#[cfg(test)]
mod fixtures;
mod job;
mod job_error;
mod learnt;
mod left_out;
mod model_choice;
mod prepared;
mod problem;
mod rounds;
pub mod search;
mod second_choice;
mod structures;
mod suspicion;
mod trial;

pub use brief::Brief;
pub use candidate::{Candidate, CandidateError, TableContext};
pub use cross_validation::{CrossValidation, Undecided};
pub use doubt::{Converter, Doubt, FEW_REVERSALS};
pub use family::BlackBoxInputs;
pub use fit::{Convergence, Fit, Identification, Progress, identify, identify_black_box};
pub use job::{Job, Outcome};
pub use job_error::JobError;
pub use learnt::Learnt;
pub use left_out::LeftOut;
pub use log_survey::{Character, prepared};
pub use model_choice::{Choice, ModelChoice, Reason, with_contained};
pub use model_error::cost;
pub use prepared::Prepared;
pub use problem::{Conditions, Problem};
pub use search::{SearchOptions, Start};
pub use structures::{Found, StructureSearch};
pub use suspicion::doubts;
pub use trial::Trial;
pub use validation as validate;
pub use validation::{Baseline, Point, StraightLine};
