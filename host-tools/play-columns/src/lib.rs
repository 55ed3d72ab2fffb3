//! What the displacement of a generalised Prandtl–Ishlinskii model is a sum of along a session, and the least squares
//! of it: the linear part of its identification. What is searched, delay, lag, law, creep, slew limit and resonance, is
//! given here as [`Stages`].

mod basis;
mod blocks;
mod columns;
mod course;
mod freed;
mod freeing;
mod own;
mod priors;
mod solution;

pub use basis::{Basis, FUNCTIONS, KNOTS};
pub use blocks::{Balanced, Blocks, Rows};
pub use columns::Stages;
pub use course::Course;
pub use freed::freed;
pub use freeing::{Envelopes, Freed};
pub use priors::{Prior, Scale};
pub use solution::{Solution, solve};

/// Time constants of creep, s, a decade apart.
pub const CREEP_TIMES: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];

/// Elements of creep.
pub const CREEPS: usize = CREEP_TIMES.len();

/// Time constant, s, and gain of each element of creep.
pub fn creep(gains: [f64; CREEPS]) -> [(f64, f64); CREEPS] {
    std::array::from_fn(|k| (CREEP_TIMES[k], gains[k]))
}

/// Play operators beside the reversible part, where their weights are freed.
pub const PLAYS: usize = 15;

/// Periods that a recording is worth, for what weighs a prior against it.
pub const WORTH: f64 = 20.0;
