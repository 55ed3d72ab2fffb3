//! Whether a log that was looked at can be learnt from: tried as `identify` does it, so that both say the same of it.

use super::sentence;
use log_survey::Survey;
use recordings::log::{ReadOptions, read};
use recordings::prepare::PrepareOptions;
use std::path::Path;

/// Why `identify` does not take a log; `None` where it does, and of a log too long to keep, which is not tried.
pub fn refused(path: &Path, options: &ReadOptions, found: &Survey) -> Option<String> {
    // Of one that is too long to keep no flaw was looked for.
    found.flaws.as_ref()?;
    let log = match read(path, options) {
        Ok(log) => log,
        Err(error) => return Some(sentence(&error)),
    };
    let recipe = PrepareOptions::default().resolve(std::slice::from_ref(&log));
    recipe.session(&log).err().map(|error| sentence(&error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::log::open;

    #[test]
    fn of_a_log_that_is_too_long_to_keep_no_time_stamp_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        // The third row is late by half a period.
        std::fs::write(&path, "time_s,voltage_V,displacement_um\n0,0,0\n0.001,1,0.1\n0.0025,2,0.2\n0.003,1,0.1\n")
            .unwrap();
        let options = ReadOptions::default();
        let mut found = log_survey::survey(open(&path, &options).unwrap()).unwrap();
        assert!(refused(&path, &options, &found).is_some());
        found.flaws = None;
        assert_eq!(refused(&path, &options, &found), None);
    }
}
