//! What the libraries find wrong, with the option or the verb that helps. The libraries know neither: they say what is
//! so, by type, and here it becomes the sentence that the user reads.

mod bench;
mod bits;
mod device;
mod identification;
mod learnable;
mod log;
mod motion;
mod outcome_json;
mod paste;
mod planned;
mod proof;
mod stages;
mod state;
mod supply;
mod unfinished;
mod verdict;
mod waveform;

pub use bench::{complaint, identify, introduced, learnt, stopped};
pub use bits::{Meaning, faults, status};
pub use device::{board, erased, not_estimating, refusal, rehearsed, would_erase};
pub use findings::{
    DETERMINED, TAUGHT, bring_to, calibrated, determination, doubt, doubt_json, interval, left_out, proven, reason,
    remarked, surveyed, taught,
};
pub use identification::{ENDS, mismatch, of_no_unit};
pub use learnable::{Learnable, all_learnable, learnable};
pub use log::{cut_short, kept, of_an_estimate};
pub use motion::moving;
pub use outcome_json::outcome_json;
pub use paste::{learn_from, quoted};
pub use planned::{at_a_limit, falls_short, no_plan, no_slew};
pub use proof::{follow_interrupted, narrow, other_range, proof, proof_interrupted, proof_kept, zero_lost};
pub use stages::{input_stage, input_stage_json, output_stage, output_stage_json};
pub use state::{Known, state};
pub use supply::supply;
pub use unfinished::{ended, kept_logs, stranded, unfinished};
pub use verdict::{doubts, next, on_the_board, verdict};
pub use waveform::{played, plays};

use ::bench::BenchError;
use std::error::Error;

/// An error and what caused it, each with its remedy, as one sentence. What it quotes of a file changes nothing
/// of a terminal.
pub fn sentence(error: &(dyn Error + 'static)) -> String {
    let chain = std::iter::successors(Some(error), |&error| error.source());
    let mut said: Vec<String> = Vec::new();
    for told in chain.map(told) {
        // Some errors say what caused them.
        if said.last().is_none_or(|before| !before.contains(&told)) {
            said.push(told);
        }
    }
    let sentence = said.join(": ");
    sentence.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { '?' } else { c }).collect()
}

/// One error of a chain. A session's that is another part's is told as that part's.
fn told(error: &(dyn Error + 'static)) -> String {
    let session: Option<&BenchError> = error.downcast_ref();
    if let Some(BenchError::Both(one, other)) = session {
        return format!("{}; and then: {}", told(&**one), told(&**other));
    }
    let error = session.and_then(BenchError::of_another).unwrap_or(error);
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
    use ::bench::NoModel;
    use std::path::Path;
    use table_files::TableFile;

    #[test]
    fn a_cause_that_an_error_tells_itself_is_not_told_twice() {
        #[derive(Debug, thiserror::Error)]
        #[error("{0}")]
        struct Inner(&'static str);
        #[derive(Debug, thiserror::Error)]
        #[error("not admissible: {source}")]
        struct Outer {
            source: Inner,
        }
        assert_eq!(sentence(&Outer { source: Inner("unbounded") }), "not admissible: unbounded");
    }

    #[test]
    fn no_escape_sequence_of_a_file_gets_through() {
        let error = TableFile::parse(Path::new("a.toml"), "a = \u{1b}]0;b\u{7}\u{9b}1m").unwrap_err();
        let said = sentence(&error);
        assert!(said.starts_with("a.toml: is no table.toml: ") && said.contains("]0;b"), "{said}");
        assert!(!said.chars().any(|c| c.is_control() && c != '\n'), "{said:?}");
    }

    #[test]
    fn what_a_session_passes_on_has_its_own_remedy_also_behind_another() {
        let both = BenchError::Both(Box::new(BenchError::NotTaken), Box::new(NoModel.into()));
        assert_eq!(sentence(&both), format!("{}; and then: {}", sentence(&BenchError::NotTaken), sentence(&NoModel)));
        assert!(sentence(&BenchError::from(NoModel)).ends_with("`piezo install` make one"), "{}", sentence(&NoModel));
    }
}
