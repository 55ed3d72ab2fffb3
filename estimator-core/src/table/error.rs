//! Why a parameter table was refused.

use crate::admissible::Inadmissible;
use crate::inverse::NoInverse;
use crate::rule::Rule;

/// Why a parameter table was refused; each cause has its own variant.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum TableError {
    /// The record ends before its own length says.
    #[error("truncated: {have} of {need} bytes")]
    Truncated {
        /// Bytes the record needs.
        need: usize,
        /// Bytes there are.
        have: usize,
    },
    /// The first four bytes are not a record's: an erased page, or something else.
    #[error("not a parameter table (the page may be erased)")]
    NotATable,
    /// A record of another format version. It is refused, never guessed.
    #[error("format version {found}, this software reads version {read}: make the table again with `piezo emit`")]
    Version {
        /// The record's version.
        found: u16,
        /// The version this software reads.
        read: u16,
    },
    /// The checksum does not match: corrupt.
    #[error("corrupt: checksum {stored:08x} stored, {computed:08x} computed")]
    Checksum {
        /// What the record says.
        stored: u32,
        /// What its bytes give.
        computed: u32,
    },
    /// The checksum matches, but the payload is no table of this version.
    #[error("checksum right, but the content is no table of this version")]
    Payload,
    /// A number is NaN or infinite.
    #[error("{field} is not a finite number")]
    NonFinite {
        /// Name of its field in the table.
        field: &'static str,
    },
    /// A number breaks a rule.
    #[error("{rule}")]
    OutOfRange {
        /// Which, in words.
        rule: Rule,
    },
    /// Unstable or unbounded.
    #[error("not admissible: {0}")]
    Inadmissible(#[from] Inadmissible),
    /// It is to drive the amplifier, and has no inverse to do so.
    #[error("it cannot drive the amplifier: {0}")]
    Drive(NoInverse),
}
