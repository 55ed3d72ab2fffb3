//! What the libraries find wrong, with the option or the verb that helps. The libraries know neither: they say what is so,
//! by type, and here it becomes the sentence that the user reads.

mod bench;
mod bits;
mod determination;
mod device;
mod doubt;
mod identification;
mod log;
mod paste;
mod proven;
mod supply;

pub use bench::{complaint, identify, stopped};
pub use bits::{Meaning, faults, remarks, status};
pub use determination::{DETERMINED, determination};
pub use device::{board, refusal};
pub use doubt::{doubt, doubt_json};
pub use identification::{mismatch, reason};
pub use paste::quoted;
pub use proven::proven;
pub use supply::supply;

use std::error::Error;

/// An error and what caused it, each with its remedy, as one sentence.
pub fn sentence(error: &(dyn Error + 'static)) -> String {
    let chain = std::iter::successors(Some(error), |&error| error.source());
    chain.map(told).collect::<Vec<_>>().join(": ")
}

/// One error of a chain.
fn told(error: &(dyn Error + 'static)) -> String {
    let found = log::told(error)
        .or_else(|| identification::told(error))
        .or_else(|| device::told(error))
        .or_else(|| bench::told(error));
    found.unwrap_or_else(|| error.to_string())
}
