//! The number that a chip has from its factory and no other chip has.

use core::fmt;
use core::str::FromStr;
use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde::{Serialize, Serializer};

/// Its bytes. People and files see them as 24 hexadecimal digits.
const BYTES: usize = 12;

/// The unique number of a board's chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Uid(pub [u8; BYTES]);

/// The text is no such number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("expected the 24 hexadecimal digits of a board's UID")]
pub struct NoUid;

impl fmt::Display for Uid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for Uid {
    type Err = NoUid;

    fn from_str(text: &str) -> Result<Self, NoUid> {
        if text.len() != 2 * BYTES || !text.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(NoUid);
        }
        let mut bytes = [0; BYTES];
        for (byte, at) in bytes.iter_mut().zip((0..).step_by(2)) {
            *byte = u8::from_str_radix(&text[at..at + 2], 16).map_err(|_| NoUid)?;
        }
        Ok(Self(bytes))
    }
}

impl Serialize for Uid {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() { serializer.collect_str(self) } else { self.0.serialize(serializer) }
    }
}

impl<'de> Deserialize<'de> for Uid {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Digits;

        impl Visitor<'_> for Digits {
            type Value = Uid;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the 24 hexadecimal digits of a board's UID")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Uid, E> {
                text.parse().map_err(E::custom)
            }
        }

        match deserializer.is_human_readable() {
            true => deserializer.deserialize_str(Digits),
            false => Deserialize::deserialize(deserializer).map(Self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_as_it_is_written_and_nothing_else_is() {
        let uid = Uid([0x00, 0x39, 0xff, 1, 2, 3, 4, 5, 6, 7, 8, 0xa9]);
        assert_eq!(uid.to_string(), "0039ff0102030405060708a9");
        assert_eq!(uid.to_string().to_uppercase().parse(), Ok(uid));
        for text in ["", "0039ff0102030405060708a", "0039ff0102030405060708ag", "+039ff0102030405060708a9"] {
            assert_eq!(text.parse::<Uid>(), Err(NoUid), "{text}");
        }
    }
}
