//! The binary record of a parameter table, as it lies in a flash page and travels over the link.
//!
//! | offset | bytes | content |
//! |---|---|---|
//! | 0 | 4 | magic `PZTB` |
//! | 4 | 2 | format version, little-endian |
//! | 6 | 2 | payload length, little-endian |
//! | 8 | n | payload: [`Table`] in postcard's wire format |
//! | 8 + n | 4 | CRC-32 (ISO-HDLC) of all bytes before, little-endian |
//!
//! What follows the record (the rest of an erased page) is not looked at. Any change of [`Table`] changes the payload
//! and must bump [`VERSION`]; the test `record_is_pinned` notices, but for a model at the end of the catalogue.

use crate::sealed::{self, CHECKSUM, Unsealed};
use crate::table::{Admitted, Table, TableError};

/// Format version that this software writes and reads.
pub const VERSION: u16 = 13;
/// No record is longer than this, bytes.
pub const MAX_LENGTH: usize = 1248;

const MAGIC: [u8; 4] = *b"PZTB";
const HEADER: usize = 8;

/// The checksum at the end of a record, by which two tables are told apart. (A CRC over the whole record, its own
/// checksum included, is one and the same for all.)
pub fn checksum(record: &[u8]) -> Option<u32> {
    record.last_chunk::<CHECKSUM>().map(|bytes| u32::from_le_bytes(*bytes))
}

impl Admitted {
    /// Writes the record into the start of `buffer`; returns its length, or `None` when the buffer is too small
    /// ([`MAX_LENGTH`] always suffices).
    pub fn encode(&self, buffer: &mut [u8]) -> Option<usize> {
        let payload = postcard::to_slice(&**self, buffer.get_mut(HEADER..)?).ok()?.len();
        let end = HEADER + payload;
        buffer.get_mut(..4)?.copy_from_slice(&MAGIC);
        buffer.get_mut(4..6)?.copy_from_slice(&VERSION.to_le_bytes());
        buffer.get_mut(6..8)?.copy_from_slice(&u16::try_from(payload).ok()?.to_le_bytes());
        sealed::seal(buffer, end)
    }
}

impl Table {
    /// Reads a record from the start of `bytes` and admits it. Never panics.
    ///
    /// # Errors
    /// It is cut short, damaged, no table or of another version; or the table is not admitted.
    pub fn parse(bytes: &[u8]) -> Result<Admitted, TableError> {
        let have = bytes.len();
        let header = bytes.first_chunk::<HEADER>().ok_or(TableError::Truncated { need: HEADER, have })?;
        let [m0, m1, m2, m3, v0, v1, n0, n1] = *header;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(TableError::NotATable);
        }
        let found = u16::from_le_bytes([v0, v1]);
        if found != VERSION {
            return Err(TableError::Version { found, read: VERSION });
        }
        let length = usize::from(u16::from_le_bytes([n0, n1]));
        let need = HEADER + length + CHECKSUM;
        let record = bytes.get(..need).ok_or(TableError::Truncated { need, have })?;
        let content = sealed::unseal(record)
            .map_err(|Unsealed { stored, computed }| TableError::Checksum { stored, computed })?;
        // postcard does not mind trailing bytes; a record of this version has none.
        match content.get(HEADER..).map(postcard::take_from_bytes::<Self>) {
            Some(Ok((table, []))) => table.admit(),
            _ => Err(TableError::Payload),
        }
    }
}
