//! A file whose table an earlier version wrote: its format had not yet every field of today's.

use recordings::LogUse;
use serde::Deserialize;

/// Fields that `[table]` once had not, and cannot be without.
const LATER: [&str; 1] = ["memory_at_ends"];

/// The field that a file lacks since its format had it not, by what is wrong with the file, and the logs that
/// the file names.
pub fn earlier(error: &toml::de::Error, text: &str) -> Option<(&'static str, Vec<LogUse>)> {
    #[derive(Deserialize)]
    struct Logs {
        #[serde(default)]
        logs: Vec<LogUse>,
    }

    let missing = LATER.into_iter().find(|field| error.message() == format!("missing field `{field}`"))?;
    Some((missing, toml::from_str(text).map(|Logs { logs }| logs).unwrap_or_default()))
}
