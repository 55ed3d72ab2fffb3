//! Whether a log that was looked at can be learnt from: tried as `identify` does it, so that both say the same of it.

use super::sentence;
use calibration::CalibrationOptions;
use identification::cost::{Cost, Feedback};
use identification::{Conditions, Job, JobError, ModelChoice, SearchOptions};
use log_survey::Survey;
use recordings::log::{Log, ReadOptions, read};
use recordings::prepare::PrepareOptions;
use std::path::Path;

/// What is said of a log that is not tried.
const TOO_LONG: &str =
    "a log too long to be held here: whether it can be learnt from, identify says, which reads it whole";

/// Whether `identify` takes a log, with nothing but its reading stated.
#[derive(Debug, PartialEq)]
pub enum Learnable {
    /// It takes the log as it is.
    Yes,
    /// It takes the log when it leaves out what has no number, or was not recorded.
    Repaired(String),
    /// The log is too long to be held.
    NotTried,
    /// No option of `identify` helps.
    No(String),
    /// It does with another option, which the sentence names.
    NotAsItIs(String),
    /// Nothing moves in it as it must, which is no hindrance beside a log in which it does.
    NotAlone(String),
}

impl Learnable {
    /// Why `identify` does not take the log, where it was tried and does not.
    pub fn refusal(&self) -> Option<&str> {
        match self {
            Self::Yes | Self::NotTried => None,
            Self::No(why) | Self::NotAsItIs(why) | Self::NotAlone(why) | Self::Repaired(why) => Some(why),
        }
    }

    /// The name and the words of the line that says it; `None` where nothing hinders.
    pub fn line(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Yes => None,
            Self::Repaired(why) => Some(("not as it is", why)),
            Self::NotTried => Some(("not tried", TOO_LONG)),
            Self::No(why) => Some(("not learnable", why)),
            Self::NotAsItIs(why) => Some(("not as it is", why)),
            Self::NotAlone(why) => Some(("not alone", why)),
        }
    }
}

/// Whether `identify` takes these logs together.
pub fn all_learnable(logs: &[Learnable]) -> bool {
    let hinders = |log: &Learnable| matches!(log, Learnable::No(_) | Learnable::NotAsItIs(_));
    !logs.iter().any(hinders) && logs.iter().any(|log| !matches!(log, Learnable::NotAlone(_)))
}

/// Tries a log that was surveyed.
pub fn learnable(path: &Path, options: &ReadOptions, found: &Survey) -> Learnable {
    // Those are looked for in every log that can be held.
    if found.flaws.is_none() {
        return Learnable::NotTried;
    }
    let (log, repaired) = match read(path, options) {
        Ok(log) => (log, None),
        Err(error) => match read(path, &ReadOptions { holes: true, ..options.clone() }) {
            Ok(log) => (log, Some(sentence(&error))),
            Err(error) => return Learnable::No(sentence(&error)),
        },
    };
    match tried(vec![log]) {
        Ok(()) => repaired.map_or(Learnable::Yes, Learnable::Repaired),
        Err(error @ (JobError::NoReversal { .. } | JobError::Noise { .. })) => Learnable::NotAlone(sentence(&error)),
        Err(error) => Learnable::NotAsItIs(sentence(&error)),
    }
}

/// What `identify` does with logs before it searches.
pub(crate) fn tried(training: Vec<Log>) -> Result<(), JobError> {
    let job = Job {
        training,
        held_out: Vec::new(),
        hold_out: findings::hold_out(None, false),
        as_judged: false,
        prepare: PrepareOptions::default(),
        model: ModelChoice::Auto,
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Cost::from(Feedback::Simulation),
        search: SearchOptions::default(),
    };
    job.prepare()?.teaches()
}

#[cfg(test)]
mod tests {
    use super::*;
    use log_survey::survey;
    use recordings::log::open;
    use std::fmt::Write;

    /// Rows of a clock of 2 kHz, printed with three decimals.
    fn rounded(rows: u32) -> tempfile::NamedTempFile {
        let mut text = "time_s,voltage_V,displacement_um\n".to_owned();
        for row in 0..rows {
            let volts = 50.0 - 50.0 * (f64::from(row) * 0.02).cos();
            writeln!(text, "{:.3},{volts:.3},{:.4}", f64::from(row) * 5e-4, 0.1 * volts).expect("a string takes all");
        }
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    }

    #[test]
    fn a_long_log_with_rounded_stamps_is_taken_or_not_tried_and_never_refused() {
        let log = rounded((1 << 18) + 1_000);
        let options = ReadOptions::default();
        let found = survey(open(log.path(), &options).unwrap()).unwrap();
        assert_eq!(learnable(log.path(), &options, &found), Learnable::Yes);
        // As it would be found if it were too long to be held.
        let longer = learnable(log.path(), &options, &Survey { flaws: None, ..found.clone() });
        assert_eq!((longer.refusal(), longer.line().map(|(name, _)| name)), (None, Some("not tried")));
        assert!(all_learnable(&[longer]));
        let said = findings::surveyed(&found, None, Learnable::NotTried.line()).join("\n");
        assert!(said.contains("\n  not tried     a log too long to be held here"), "{said}");
    }

    #[test]
    fn of_a_log_that_is_too_long_to_keep_no_time_stamp_is_refused() {
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        // The third row is late by half a period.
        let rows = "time_s,voltage_V,displacement_um\n0,0,0\n0.001,1,0.1\n0.0025,2,0.2\n0.003,1,0.1\n";
        std::fs::write(file.path(), rows).unwrap();
        let options = ReadOptions::default();
        let mut found = survey(open(file.path(), &options).unwrap()).unwrap();
        assert!(matches!(learnable(file.path(), &options, &found), Learnable::No(_)));
        found.flaws = None;
        assert_eq!(learnable(file.path(), &options, &found), Learnable::NotTried);
    }

    #[test]
    fn a_log_that_alone_shows_nothing_is_no_hindrance_beside_another() {
        let of = |of: fn(String) -> Learnable| of("why".to_owned());
        assert!(!all_learnable(&[of(Learnable::NotAlone)]) && !all_learnable(&[]));
        assert!(all_learnable(&[of(Learnable::NotAlone), Learnable::Yes]));
        assert!(!all_learnable(&[of(Learnable::No), Learnable::Yes]));
        assert!(!all_learnable(&[of(Learnable::NotAsItIs), Learnable::NotTried]));
    }
}
