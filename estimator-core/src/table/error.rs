//! Why a parameter table was refused.

use crate::admissible::Inadmissible;
use crate::inverse::NoInverse;
use core::fmt;

/// Why a parameter table was refused; each cause has its own variant.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum TableError {
    /// The record ends before its own length says.
    Truncated {
        /// Bytes the record needs.
        need: usize,
        /// Bytes there are.
        have: usize,
    },
    /// The first four bytes are not a record's: an erased page, or something else.
    NotATable,
    /// A record of another format version. It is refused, never guessed.
    Version {
        /// The record's version.
        found: u16,
        /// The version this software reads.
        read: u16,
    },
    /// The checksum does not match: corrupt.
    Checksum {
        /// What the record says.
        stored: u32,
        /// What its bytes give.
        computed: u32,
    },
    /// The checksum matches, but the payload is no table of this version.
    Payload,
    /// A number is NaN or infinite.
    NonFinite {
        /// Which.
        field: &'static str,
    },
    /// A number breaks a rule.
    OutOfRange {
        /// Which, in words.
        rule: &'static str,
    },
    /// The parameters overflow at the ends of the voltage range or at the displacement limits.
    Overflow,
    /// Unstable or unbounded.
    Inadmissible(Inadmissible),
    /// It is to drive the amplifier, and has no inverse to do so.
    Drive(NoInverse),
}

impl From<Inadmissible> for TableError {
    fn from(error: Inadmissible) -> Self {
        Self::Inadmissible(error)
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { need, have } => write!(f, "truncated: {have} of {need} bytes"),
            Self::NotATable => write!(f, "not a parameter table (the page may be erased)"),
            Self::Version { found, read } => write!(
                f,
                "format version {found}, this software reads version {read}: make the table again with `piezo emit`"
            ),
            Self::Checksum { stored, computed } => {
                write!(f, "corrupt: checksum {stored:08x} stored, {computed:08x} computed")
            }
            Self::Payload => write!(f, "checksum right, but the content is no table of this version"),
            Self::NonFinite { field } => write!(f, "{field} is not a finite number"),
            Self::OutOfRange { rule } => write!(f, "{rule}"),
            Self::Overflow => write!(f, "the parameters overflow within the voltage range or the displacement limits"),
            Self::Inadmissible(cause) => write!(f, "not admissible: {cause}"),
            Self::Drive(cause) => write!(f, "it cannot drive the amplifier: {cause}"),
        }
    }
}

impl core::error::Error for TableError {}
