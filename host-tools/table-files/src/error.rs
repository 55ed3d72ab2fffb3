//! Why a file is no table, a table becomes no file, or two files are of two tables.

use crate::line::Line;
use estimator_core::TableError;
use recordings::LogUse;
use recordings::prepare::RecipeError;
use std::path::PathBuf;

/// Why a file is no table, or a table becomes no file.
#[derive(Debug, thiserror::Error)]
pub enum TableFileError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({error})", path.display())]
    Unreadable {
        /// The file that was to be read.
        path: PathBuf,
        /// What the operating system says, or that it is no regular file, or too large.
        error: std::io::Error,
    },
    /// The file holds something else.
    #[error("{}: is no table.toml: {}", path.display(), error.to_string().trim_end())]
    NoTable {
        /// The file that was to be read.
        path: PathBuf,
        /// The place in the file, and why it cannot be read.
        error: Box<toml::de::Error>,
    },
    /// The table in a file is of an earlier version, which had not yet every number that is needed.
    #[error("{}: an earlier version of this software made the table, which lacks `{field}`", path.display())]
    Earlier {
        /// The file that was to be read.
        path: PathBuf,
        /// The number that the table lacks.
        field: &'static str,
        /// The logs that it was made from and judged on; empty where the file names none that can be read.
        logs: Vec<LogUse>,
    },
    /// The table in a file is refused.
    #[error("{}: is refused{}", path.display(), line.as_ref().map(|line| format!(", for {line}")).unwrap_or_default())]
    Refused {
        /// The file that was to be read.
        path: PathBuf,
        /// The line that sets what breaks a rule; `None` where no single one does.
        line: Option<Line>,
        /// What is wrong with the table.
        source: Refused,
    },
    /// A table is refused before it is written.
    #[error(transparent)]
    Inadmissible(#[from] Refused),
    /// A number that the format cannot hold.
    #[error(transparent)]
    Toml(#[from] toml::ser::Error),
    /// A number of the file is none.
    #[error("{}: {field} is not a finite number", path.display())]
    NotFinite {
        /// The file that was to be read.
        path: PathBuf,
        /// The number's place in the file, as `logs.0.from_s`.
        field: String,
    },
    /// The table.toml beside a table.bin cannot be read, which alone says the doubts.
    #[error("{}: whether it has doubts is not known: {source}", named.display())]
    Doubts {
        /// Path of the table.bin.
        named: PathBuf,
        /// Why the other cannot be read.
        source: Box<TableFileError>,
    },
    /// Another face beside it is of another table.
    #[error(transparent)]
    OtherFace(#[from] OtherFace),
}

/// Why a table is refused.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum Refused {
    /// The table is refused by its own rules.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The recipe breaks a rule.
    #[error("[recipe] {0}")]
    Recipe(RecipeError),
    /// Recipe and table are not of one identification.
    #[error("[recipe] and [table] differ in the tick or a zero: change both, or neither")]
    Differ,
}

impl Refused {
    /// The field of the table that it is refused for; `None` where that is no single one.
    pub(crate) fn field(&self) -> Option<&'static str> {
        match self {
            // A rule begins with its field.
            Self::Table(TableError::OutOfRange { rule: said } | TableError::NonFinite { field: said }) => {
                said.split(' ').next()
            }
            _ => None,
        }
    }
}

/// A face lies beside one of another table.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{}: is the table of checksum {own}, and {} beside it {}", named.display(), beside.display(), words(its.as_deref()))]
pub struct OtherFace {
    /// The face that was named.
    pub named: PathBuf,
    /// The checksum of its table's record, in words.
    pub own: String,
    /// The other face of the table, beside it.
    pub beside: PathBuf,
    /// The checksum of its table's record, in words; `None` where that is refused.
    pub its: Option<String>,
}

fn words(its: Option<&str>) -> String {
    its.map_or_else(|| "is refused".to_owned(), |its| format!("that of {its}"))
}
