//! Bytes that end with the CRC-32 (ISO-HDLC) of all before, little-endian: a table's record, and a frame on the line.

use crc::{CRC_32_ISO_HDLC, Crc};

/// Length of the checksum, bytes.
pub const CHECKSUM: usize = 4;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why bytes are not sealed: they are shorter than a checksum, or were changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Unsealed {
    /// The checksum at their end; 0 where they are too short for one.
    pub stored: u32,
    /// The checksum that the bytes before it give.
    pub computed: u32,
}

/// The CRC-32 of some bytes.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// The CRC-32 of some words, each as little-endian bytes.
pub fn checksum_of_words(words: impl Iterator<Item = u32>) -> u32 {
    let mut digest = CRC.digest();
    words.for_each(|word| digest.update(&word.to_le_bytes()));
    digest.finalize()
}

/// Writes the checksum of the first `length` bytes behind them; returns the length with it, or `None` when the buffer
/// is too small.
pub fn seal(buffer: &mut [u8], length: usize) -> Option<usize> {
    let (content, rest) = buffer.split_at_mut_checked(length)?;
    *rest.first_chunk_mut::<CHECKSUM>()? = checksum(content).to_le_bytes();
    Some(length + CHECKSUM)
}

/// The bytes before the checksum, if that is theirs.
///
/// # Errors
/// The bytes were changed since they were sealed, or never were.
pub fn unseal(bytes: &[u8]) -> Result<&[u8], Unsealed> {
    let (content, stored) = bytes.split_last_chunk::<CHECKSUM>().ok_or(Unsealed { stored: 0, computed: 0 })?;
    let (stored, computed) = (u32::from_le_bytes(*stored), checksum(content));
    if stored == computed { Ok(content) } else { Err(Unsealed { stored, computed }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sealed_is_unsealed_and_a_change_is_noticed() {
        let mut buffer = *b"123456789\0\0\0\0";
        assert_eq!(seal(&mut buffer, 9), Some(13));
        assert_eq!(buffer[9..], 0xCBF4_3926u32.to_le_bytes(), "the check value of CRC-32/ISO-HDLC");
        assert_eq!(unseal(&buffer), Ok(&b"123456789"[..]));
        assert_eq!(seal(&mut buffer, 10), None);
        buffer[3] ^= 1;
        assert!(unseal(&buffer).is_err_and(|broken| broken.stored == 0xCBF4_3926));
        assert!(unseal(&buffer[..3]).is_err());
        let words = [*b"1234", *b"5678"].map(u32::from_le_bytes);
        assert_eq!(checksum_of_words(words.into_iter()), checksum(b"12345678"));
    }
}
