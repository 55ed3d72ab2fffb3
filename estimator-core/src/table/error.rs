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
        /// Bytes that the record needs by its own length, header and checksum included.
        need: usize,
        /// Bytes that were given.
        have: usize,
    },
    /// The first four bytes are not a record's: an erased page, or something else.
    #[error("not a parameter table (the page may be erased)")]
    NotATable,
    /// A record of another format version. It is refused, never guessed.
    #[error("format version {found}, this software reads version {read}")]
    Version {
        /// Format version that the record has in its bytes 4 and 5.
        found: u16,
        /// The version this software reads.
        read: u16,
    },
    /// The checksum does not match: corrupt.
    #[error("corrupt: checksum {stored:08x} stored, {computed:08x} computed")]
    Checksum {
        /// CRC-32 at the record's end.
        stored: u32,
        /// CRC-32 of the bytes before it.
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
        /// The rule as the user reads it, with the field that breaks it.
        rule: Rule,
    },
    /// The recursion is unstable in `f32`, or not proven to stay within `displacement_limits_um`.
    #[error("not admissible: {0}")]
    Inadmissible(#[from] Inadmissible),
    /// It is to drive the amplifier, and has no inverse to do so.
    #[error("it cannot drive the amplifier: {0}")]
    Drive(NoInverse),
}
