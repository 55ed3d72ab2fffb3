//! The parts of a `.tdms` file's metadata: words, texts, properties, and where a channel's raw data are.

use crate::fault::{Fault, Format};
use crate::mat5_element::{decode, shortest};

/// Type of a text.
pub(crate) const STRING: u32 = 0x20;
/// Type of a time stamp.
pub(crate) const TIMESTAMP: u32 = 0x44;

/// A file that does not keep its format.
pub(crate) fn damaged(what: &str) -> Fault {
    Fault::Damaged { format: Format::Tdms, what: what.to_owned() }
}

/// Raw data of one object in a segment.
#[derive(Clone, Copy, Default)]
pub(crate) struct Index {
    pub kind: u32,
    pub values: usize,
    /// Bytes of one value; of strings, of all.
    pub width: usize,
}

impl Index {
    /// Bytes in one chunk.
    pub fn bytes(self) -> Option<usize> {
        if self.kind == STRING { Some(self.width) } else { self.values.checked_mul(self.width) }
    }
}

/// Bytes of one value of a type that is a number.
fn width(kind: u32) -> Option<usize> {
    Some(match kind {
        1 | 5 | 0x21 => 1,
        2 | 6 => 2,
        3 | 7 | 9 | 0x19 => 4,
        4 | 8 | 10 | 0x1a => 8,
        TIMESTAMP => 16,
        _ => return None,
    })
}

/// Appends the numbers of one type; nothing of one that is none.
pub(crate) fn numbers(kind: u32, data: &[u8], big: bool, values: &mut Vec<f64>) {
    values.extend(match kind {
        1 => decode(data, big, |b| i8::from_le_bytes(b).into()),
        2 => decode(data, big, |b| i16::from_le_bytes(b).into()),
        3 => decode(data, big, |b| i32::from_le_bytes(b).into()),
        4 => decode(data, big, |b| i64::from_le_bytes(b) as f64),
        5 | 0x21 => decode(data, big, |b| u8::from_le_bytes(b).into()),
        6 => decode(data, big, |b| u16::from_le_bytes(b).into()),
        7 => decode(data, big, |b| u32::from_le_bytes(b).into()),
        8 => decode(data, big, |b| u64::from_le_bytes(b) as f64),
        9 | 0x19 => decode(data, big, |b| shortest(f32::from_le_bytes(b))),
        10 | 0x1a => decode(data, big, f64::from_le_bytes),
        _ => Vec::new(),
    });
}

/// A property's value, as far as it is of use.
pub(crate) enum Property {
    Text(String),
    Number(f64),
    Other,
}

/// Reads a segment's metadata.
pub(crate) struct Cursor<'a> {
    pub bytes: &'a [u8],
    pub big_endian: bool,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let taken = self.bytes.get(..count).ok_or_else(|| damaged("cut short"))?;
        self.bytes = &self.bytes[count..];
        Ok(taken)
    }

    pub fn word(&mut self) -> Result<u32, Fault> {
        let bytes = self.take(4)?.try_into().map_err(|_| damaged("cut short"))?;
        Ok(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub fn long(&mut self) -> Result<u64, Fault> {
        let bytes = self.take(8)?.try_into().map_err(|_| damaged("cut short"))?;
        Ok(if self.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    pub fn text(&mut self) -> Result<String, Fault> {
        let length = self.word()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    pub fn index(&mut self) -> Result<Index, Fault> {
        let (kind, dimensions, values) = (self.word()?, self.word()?, self.long()?);
        if dimensions != 1 {
            return Err(damaged("a channel has more than one dimension"));
        }
        let values = usize::try_from(values).map_err(|_| damaged("false sizes"))?;
        let width = match (kind, width(kind)) {
            (STRING, _) => usize::try_from(self.long()?).map_err(|_| damaged("false sizes"))?,
            (_, Some(width)) => width,
            // Complex numbers and wide floats, of which the width is needed to step over them.
            (0x08_000c, _) => 8,
            (0x10_000d, _) => 16,
            _ => return Err(damaged("a channel is of an unknown type")),
        };
        Ok(Index { kind, values, width })
    }

    pub fn property(&mut self) -> Result<Property, Fault> {
        let kind = self.word()?;
        if kind == STRING {
            return Ok(Property::Text(self.text()?));
        }
        let width = width(kind).or(match kind {
            0x08_000c => Some(8),
            0x10_000d => Some(16),
            _ => None,
        });
        let data = self.take(width.ok_or_else(|| damaged("a property is of an unknown type"))?)?;
        let mut value = Vec::new();
        numbers(kind, data, self.big_endian, &mut value);
        Ok(value.first().map_or(Property::Other, |number| Property::Number(*number)))
    }
}
