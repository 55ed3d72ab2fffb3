//! Whether a log that was looked at can be learnt from: tried as `identify` does it, so that both say the same of it.

use super::sentence;
use log_survey::Survey;
use recordings::log::{ReadOptions, read};
use recordings::prepare::PrepareOptions;
use std::path::Path;

/// What is said of a log that is not tried.
const NOT_TRIED: &str =
    "a long log whose time stamps are uneven: whether they can be learnt from is seen by identify alone";

/// Why `identify` does not take a log; `None` where it does. A log too long to keep is not tried, and taken where its time stamps
/// are even.
pub fn refused(path: &Path, options: &ReadOptions, found: &Survey) -> Option<String> {
    if found.flaws.is_none() {
        return (!found.clock.even()).then(|| NOT_TRIED.to_owned());
    }
    let log = match read(path, options) {
        Ok(log) => log,
        Err(error) => return Some(sentence(&error)),
    };
    let recipe = PrepareOptions::default().resolve(std::slice::from_ref(&log));
    recipe.session(&log).err().map(|error| sentence(&error))
}
