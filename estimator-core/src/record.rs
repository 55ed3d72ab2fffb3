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
//! and must bump [`VERSION`]; the test `record_is_pinned` notices.

use crate::table::{Admitted, Table, TableError};
use crc::{CRC_32_ISO_HDLC, Crc};

/// Format version that this software writes and reads.
pub const VERSION: u16 = 4;
/// No record is longer than this, bytes.
pub const MAX_LENGTH: usize = 384;

const MAGIC: [u8; 4] = *b"PZTB";
const HEADER: usize = 8;
const CHECKSUM: usize = 4;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

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
        let checksum = CRC.checksum(buffer.get(..end)?);
        buffer.get_mut(end..end + CHECKSUM)?.copy_from_slice(&checksum.to_le_bytes());
        Some(end + CHECKSUM)
    }
}

impl Table {
    /// Reads a record from the start of `bytes` and admits it. Never panics.
    pub fn parse(bytes: &[u8]) -> Result<Admitted, TableError> {
        let have = bytes.len();
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(TableError::Truncated { need: HEADER, have })?;
        let [m0, m1, m2, m3, v0, v1, n0, n1] = *header;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(TableError::NotATable);
        }
        let found = u16::from_le_bytes([v0, v1]);
        if found != VERSION {
            return Err(TableError::Version { found, read: VERSION });
        }
        let length = usize::from(u16::from_le_bytes([n0, n1]));
        let truncated = TableError::Truncated { need: HEADER + length + CHECKSUM, have };
        let (payload, rest) = rest.split_at_checked(length).ok_or(truncated)?;
        let stored = u32::from_le_bytes(*rest.first_chunk::<CHECKSUM>().ok_or(truncated)?);
        let mut digest = CRC.digest();
        digest.update(header);
        digest.update(payload);
        let computed = digest.finalize();
        if stored != computed {
            return Err(TableError::Checksum { stored, computed });
        }
        // postcard does not mind trailing bytes; a record of this version has none.
        match postcard::take_from_bytes::<Self>(payload) {
            Ok((table, [])) => table.admit(),
            _ => Err(TableError::Payload),
        }
    }
}
