//! What every function returns.

use estimator_core::{NoInverse, TableError};

/// How a call went. As wide as a `uint32_t`, whatever a compiler makes of an enum.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PiezoResult {
    /// All went as asked, and the results are written.
    Ok = 0,
    /// A pointer is null.
    Null = 1,
    /// The value was not begun.
    NotBegun = 2,
    /// A number is NaN or infinite; nothing has changed.
    NotFinite = 3,
    /// The record ends before its own length says.
    Truncated = 4,
    /// The bytes are no parameter table: an erased page, or something else.
    NotATable = 5,
    /// A record of another format version.
    Version = 6,
    /// The record's checksum does not match.
    Checksum = 7,
    /// The checksum matches, but the content is no table of this version, or a number in it breaks a rule.
    Content = 8,
    /// The model is not stable, or not bounded by the table's limits.
    Inadmissible = 9,
    /// The table has no inverse: its model has none, or it states no drive limits and none were given.
    NoInverse = 10,
    /// The drive limits break a rule.
    Limits = 11,
    /// The displacement may not be told yet: before the first tick, or while an actuator that moved then is on its way.
    TooSoon = 12,
}

impl From<TableError> for PiezoResult {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Truncated { .. } => Self::Truncated,
            TableError::NotATable => Self::NotATable,
            TableError::Version { .. } => Self::Version,
            TableError::Checksum { .. } => Self::Checksum,
            TableError::Payload | TableError::NonFinite { .. } | TableError::OutOfRange { .. } => Self::Content,
            TableError::Inadmissible(_) => Self::Inadmissible,
            TableError::Drive(error) => error.into(),
        }
    }
}

impl From<NoInverse> for PiezoResult {
    fn from(error: NoInverse) -> Self {
        match error {
            NoInverse::Model | NoInverse::Falling => Self::NoInverse,
            NoInverse::Limits(_) => Self::Limits,
        }
    }
}

/// The result of what may stop early with one.
pub(crate) fn result(run: impl FnOnce() -> Result<(), PiezoResult>) -> PiezoResult {
    run().err().unwrap_or(PiezoResult::Ok)
}
