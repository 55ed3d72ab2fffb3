//! One message a frame.
//!
//! ```text
//! COBS( version u8 · message in postcard's wire format · CRC-32 (ISO-HDLC) of all before, little-endian ) · 0x00
//! ```
//!
//! Byte stuffing (COBS) keeps the byte 0 out of a frame, so a receiver that joins late or lost bytes is in step again
//! after the next 0. A frame that is damaged, too long, or of another version costs itself and nothing else.

use estimator_core::sealed::{CHECKSUM, seal, unseal};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Version of everything in this crate. It is the first byte of every frame; frames of another are refused by name.
pub const VERSION: u8 = 12;

/// No frame is longer than this on the wire, delimiter included, bytes.
pub const MAX_FRAME: usize = 1344;

const DELIMITER: u8 = 0;
/// Longest content before the delimiter and stuffing, which adds one byte and one more for every 254.
const MAX_CONTENT: usize = MAX_FRAME - 2 - MAX_FRAME.div_ceil(254);

/// Why a frame was refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum FrameError {
    /// More than [`MAX_FRAME`] bytes without a delimiter.
    #[error("a frame longer than {MAX_FRAME} bytes")]
    TooLong,
    /// The byte stuffing is broken: bytes were lost or changed.
    #[error("a damaged frame (byte stuffing)")]
    Stuffing,
    /// The checksum does not match, or there is none.
    #[error("a damaged frame (checksum)")]
    Checksum,
    /// The other side speaks another version of the protocol.
    #[error("protocol version {found}, this software speaks version {VERSION}")]
    Version {
        /// The version that the other side speaks.
        found: u8,
    },
    /// The checksum matches, but the content is no message of this version.
    #[error("a frame that is no message of protocol version {VERSION}")]
    Content,
}

/// Writes the frame of a message, delimiter included, into `buffer`; `None` if the message is too long for a frame
/// (no message of this crate is; a test shows it).
pub fn encode<'b, M: Serialize>(message: &M, buffer: &'b mut [u8; MAX_FRAME]) -> Option<&'b [u8]> {
    let mut content = [0; MAX_CONTENT];
    content[0] = VERSION;
    let end = 1 + postcard::to_slice(message, &mut content[1..MAX_CONTENT - CHECKSUM]).ok()?.len();
    let end = seal(&mut content, end)?;
    let stuffed = cobs::encode(&content[..end], &mut buffer[..MAX_FRAME - 1]);
    buffer[stuffed] = DELIMITER;
    Some(&buffer[..=stuffed])
}

/// Finds frames in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Deframer {
    buffer: [u8; MAX_FRAME],
    length: usize,
    overlong: bool,
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

impl Deframer {
    /// An empty buffer: the next byte begins a frame.
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], length: 0, overlong: false }
    }

    /// Takes the next byte; gives the message, or why there is none, when the byte ends a frame. Empty
    /// frames are skipped.
    pub fn push<M: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<M, FrameError>> {
        if byte != DELIMITER {
            match self.buffer.get_mut(self.length) {
                Some(place) => {
                    *place = byte;
                    self.length += 1;
                }
                None => self.overlong = true,
            }
            return None;
        }
        let (length, overlong) = (self.length, self.overlong);
        self.length = 0;
        self.overlong = false;
        if overlong {
            Some(Err(FrameError::TooLong))
        } else if length == 0 {
            None
        } else {
            Some(decode(&mut self.buffer[..length]))
        }
    }
}

fn decode<M: DeserializeOwned>(stuffed: &mut [u8]) -> Result<M, FrameError> {
    let length = cobs::decode_in_place(stuffed).map_err(|_| FrameError::Stuffing)?;
    let frame = stuffed.get(..length).ok_or(FrameError::Stuffing)?;
    let content = unseal(frame).map_err(|_| FrameError::Checksum)?;
    let (&version, message) = content.split_first().ok_or(FrameError::Checksum)?;
    if version != VERSION {
        return Err(FrameError::Version { found: version });
    }
    match postcard::take_from_bytes(message) {
        Ok((message, [])) => Ok(message),
        _ => Err(FrameError::Content),
    }
}
