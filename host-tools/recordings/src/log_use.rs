//! Which part of which log was used for what, as the table and the report tell it.

use crate::content::Content;
use crate::log::Log;
use serde::{Deserialize, Serialize};

/// A log, or a part of one, and what it was used for.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogUse {
    /// The log's file name.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// What it was used for.
    pub role: Role,
    /// First second used.
    pub from_s: f64,
    /// End of what was used, s.
    pub to_s: f64,
    /// Stretches between these that were used, where it is not all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretches: Option<usize>,
    /// Samples of what was trained on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Content>,
}

/// What a log was used for.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Parameters, zeros, delay and limits come from it.
    Training,
    /// It decided nothing; the errors stated are those on it.
    HeldOut,
    /// A part of what was trained on that had been held out until the model was judged: the errors stated are those on
    /// it, by the model as it was learnt without it.
    JudgedThenLearnt,
}

impl LogUse {
    /// What a log, or a part of one, was used for.
    pub fn new(log: &Log, role: Role) -> Self {
        let file = log.path.file_name().unwrap_or(log.path.as_os_str());
        Self {
            file: file.to_string_lossy().into_owned(),
            sha256: log.sha256.clone(),
            role,
            from_s: log.start_s,
            to_s: log.start_s + log.duration(),
            stretches: None,
            content: Some(role).filter(|&role| role == Role::Training).and_then(|_| Content::of(log)),
        }
    }

    /// The seconds of a log that were used: of the same file, or of one that holds the same samples.
    pub fn within(&self, log: &Log) -> Option<(f64, f64)> {
        if self.sha256 == log.sha256 {
            return Some((self.from_s, self.to_s));
        }
        let from = self.content.as_ref()?.begins_in(log)?;
        Some((from.max(0.0), (from + self.to_s - self.from_s).min(log.duration())))
    }
}
