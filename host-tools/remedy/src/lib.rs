//! What the libraries find wrong, with the option or the verb that helps. The libraries know neither: they say what is so,
//! by type, and here it becomes the sentence that the user reads.

mod bench;
mod bits;
mod device;
mod identification;
mod log;
mod paste;
mod proof;
mod state;
mod supply;
mod verdict;
mod waveform;

pub use bench::{complaint, identify, introduced, stopped};
pub use bits::{Meaning, faults, remarks, status};
pub use device::{board, not_estimating, refusal, rehearsed};
pub use findings::{
    DETERMINED, calibrated, determination, doubt, doubt_json, interval, left_out, proven, reason, remarked, surveyed,
};
pub use identification::{ENDS, mismatch};
pub use log::kept;
pub use paste::{learn_from, quoted};
pub use proof::{narrow, other_range, unproven, zeroed};
pub use state::{Known, state};
pub use supply::supply;
pub use verdict::{doubts, next, verdict, zeros};
pub use waveform::{played, plays};

use std::error::Error;

/// An error and what caused it, each with its remedy, as one sentence. What it quotes of a file changes nothing of a terminal.
pub fn sentence(error: &(dyn Error + 'static)) -> String {
    let chain = std::iter::successors(Some(error), |&error| error.source());
    let sentence = chain.map(told).collect::<Vec<_>>().join(": ");
    sentence.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { '?' } else { c }).collect()
}

/// One error of a chain.
fn told(error: &(dyn Error + 'static)) -> String {
    let found = log::told(error)
        .or_else(|| identification::told(error))
        .or_else(|| device::told(error))
        .or_else(|| bench::told(error))
        .or_else(|| waveform::told(error));
    found.unwrap_or_else(|| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use table_files::TableFile;

    #[test]
    fn no_escape_sequence_of_a_file_gets_through() {
        let error = TableFile::parse(Path::new("a.toml"), "a = \u{1b}]0;b\u{7}\u{9b}1m").unwrap_err();
        let said = sentence(&error);
        assert!(said.starts_with("a.toml: is no table.toml: ") && said.contains("]0;b"), "{said}");
        assert!(!said.chars().any(|c| c.is_control() && c != '\n'), "{said:?}");
    }
}
