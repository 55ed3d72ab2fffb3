//! How far an estimate is from the sensor: an admitted table run over a session through the very
//! [`Estimator`](estimator_core::Estimator) that the firmware has, and its errors by what the estimator was told and by
//! which part of the log is scored; and which of several models did best by such errors ([`score`]).

mod baseline;
mod compare;
mod coverage;
mod estimates;
mod figures;
mod other_gain;
mod out_of_step;
mod raised;
mod run;
mod scope;
pub mod score;
pub mod statistics;
mod straight_line;
mod suspicion;
mod told;
mod trace;

pub use baseline::Baseline;
pub use compare::{Cold, Comparison, compare, compare_within};
pub use coverage::Coverage;
pub use estimates::{Estimates, Instant, Known, UnmeasuredError, Zero, estimates, unmeasured};
pub use figures::Figures;
pub use other_gain::other_gain;
pub use out_of_step::OutOfStep;
pub use raised::Raised;
pub use run::Run;
pub use scope::{Bound, FEWEST, Scope, ScopeError, ZERO_WINDOW_S, errors_within};
pub use straight_line::{Point, StraightLine};
pub use suspicion::{Evidence, Since, Suspicion};
pub use told::{Told, ToldFigures};
pub use trace::Trace;
