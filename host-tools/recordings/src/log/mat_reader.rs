//! The elements of a MATLAB level 5 MAT-file, from a slice or an inflating stream.
//!
//! Every element is a tag (type and size) and data padded to eight bytes; data of up to four bytes may sit in the tag. A
//! variable is a matrix element whose sub-elements are flags, dimensions, name and numbers. Damage is an [`io::Error`].

use std::io::{self, ErrorKind, Read};

use super::number::excerpt;

const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
/// Element type of a variable.
pub(super) const MI_MATRIX: u32 = 14;
/// Element type of a compressed variable.
pub(super) const MI_COMPRESSED: u32 = 15;
/// Longest dimensions and name that are read, bytes.
const LONGEST: usize = 4096;

/// Rows and columns of a two-dimensional array.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub rows: usize,
    pub columns: usize,
}

impl Shape {
    /// The shorter side: how many signals the array can hold.
    pub fn channels(self) -> usize {
        self.rows.min(self.columns)
    }
}

/// One variable.
#[derive(Debug)]
pub(super) struct Variable {
    pub name: String,
    /// Name, size and class, for messages.
    pub description: String,
    /// If it fits: its numbers, column by column; as many as the shape says.
    pub array: Option<(Shape, Vec<f64>)>,
}

/// Type and size of an element, with its data if that is in the tag.
pub(super) struct Tag {
    pub kind: u32,
    pub size: usize,
    small: Option<[u8; 4]>,
}

/// Reads elements from `source`.
pub(super) struct MatReader<'a> {
    pub source: &'a mut dyn Read,
    pub big_endian: bool,
}

impl MatReader<'_> {
    /// The next element's tag.
    pub fn tag(&mut self) -> io::Result<Tag> {
        let mut words = [[0; 4]; 2];
        self.source.read_exact(words.as_flattened_mut())?;
        let [first, second] = words.map(|word| self.word(word));
        if first >> 16 == 0 {
            return Ok(Tag { kind: first, size: second as usize, small: None });
        }
        match (first >> 16) as usize {
            size @ 1..=4 => Ok(Tag { kind: first & 0xffff, size, small: Some(words[1]) }),
            _ => Err(ErrorKind::InvalidData.into()),
        }
    }

    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    /// The next element's type and data, of at most `limit` bytes. Memory grows with what arrives, not with what the
    /// tag claims.
    fn element(&mut self, limit: usize) -> io::Result<(u32, Vec<u8>)> {
        let Tag { kind, size, small } = self.tag()?;
        if let Some(data) = small {
            return Ok((kind, data[..size].to_vec()));
        }
        if size > limit {
            return Err(ErrorKind::FileTooLarge.into());
        }
        let mut data = Vec::new();
        self.source.take(size as u64).read_to_end(&mut data)?;
        if data.len() < size {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let padding = size.next_multiple_of(8) - size;
        io::copy(&mut self.source.take(padding as u64), &mut io::sink())?;
        Ok((kind, data))
    }

    /// The variable in a matrix element that was inflated: its tag comes first, a checksum last.
    pub fn compressed_variable(&mut self, limit: usize, fits: &dyn Fn(Shape) -> bool) -> io::Result<Variable> {
        if self.tag()?.kind != MI_MATRIX {
            return Err(ErrorKind::InvalidData.into());
        }
        let variable = self.variable(limit, fits)?;
        // The checksum is compared when the stream ends.
        if variable.array.is_some() && self.source.read(&mut [0])? > 0 {
            return Err(ErrorKind::InvalidData.into());
        }
        Ok(variable)
    }

    /// The variable in a matrix element whose tag has been read. Its numbers, at most `limit` bytes, are read if it is
    /// real, two-dimensional and `fits`.
    pub fn variable(&mut self, limit: usize, fits: &dyn Fn(Shape) -> bool) -> io::Result<Variable> {
        let (MI_UINT32, flags) = self.element(LONGEST)? else {
            return Err(ErrorKind::InvalidData.into());
        };
        let &[[a, b, c, d], _] = flags.as_chunks::<4>().0 else {
            return Err(ErrorKind::InvalidData.into());
        };
        let flags = self.word([a, b, c, d]);
        let (class, complex) = (class_name(flags & 0xff), flags & 0x0800 != 0);
        let (MI_INT32, dimensions) = self.element(LONGEST)? else {
            // Opaque classes (strings, tables) have no dimensions.
            return Ok(Variable { name: String::new(), description: "an object".to_owned(), array: None });
        };
        let dimensions: Vec<usize> =
            dimensions.as_chunks::<4>().0.iter().map(|&bytes| self.word(bytes) as usize).collect();
        let (_, name) = self.element(LONGEST)?;
        let name = excerpt(&String::from_utf8_lossy(&name).escape_debug().to_string());
        let sides: Vec<String> = dimensions.iter().map(usize::to_string).collect();
        let sides = excerpt(&sides.join("x"));
        let kind = if complex { "complex" } else { class.0 };

        let array = match dimensions[..] {
            [rows, columns] if class.1 && !complex && fits(Shape { rows, columns }) => {
                let (kind, data) = self.element(limit)?;
                let values = numbers(kind, &data, self.big_endian)
                    .filter(|values| Some(values.len()) == rows.checked_mul(columns))
                    .ok_or(ErrorKind::InvalidData)?;
                Some((Shape { rows, columns }, values))
            }
            _ => None,
        };
        Ok(Variable { description: format!("{name} ({sides} {kind})"), name, array })
    }
}

/// Name of an array class, and whether it is numeric.
fn class_name(class: u32) -> (&'static str, bool) {
    match class {
        1 => ("cell", false),
        2 => ("struct", false),
        4 => ("char", false),
        5 => ("sparse", false),
        6 => ("double", true),
        7 => ("single", true),
        8..=15 => ("integer", true),
        _ => ("object", false),
    }
}

/// `data` of element type `kind` as f64; whole numbers may be stored in a narrower type than their array's class.
fn numbers(kind: u32, data: &[u8], big_endian: bool) -> Option<Vec<f64>> {
    let big = big_endian;
    Some(match kind {
        1 => decode(data, big, |bytes| i8::from_le_bytes(bytes).into()),
        2 => decode(data, big, |bytes| u8::from_le_bytes(bytes).into()),
        3 => decode(data, big, |bytes| i16::from_le_bytes(bytes).into()),
        4 => decode(data, big, |bytes| u16::from_le_bytes(bytes).into()),
        MI_INT32 => decode(data, big, |bytes| i32::from_le_bytes(bytes).into()),
        MI_UINT32 => decode(data, big, |bytes| u32::from_le_bytes(bytes).into()),
        7 => decode(data, big, |bytes| shortest(f32::from_le_bytes(bytes))),
        9 => decode(data, big, f64::from_le_bytes),
        12 => decode(data, big, |bytes| i64::from_le_bytes(bytes) as f64),
        13 => decode(data, big, |bytes| u64::from_le_bytes(bytes) as f64),
        _ => return None,
    })
}

fn decode<const WIDTH: usize>(data: &[u8], big_endian: bool, number: fn([u8; WIDTH]) -> f64) -> Vec<f64> {
    let little = |&(mut bytes): &[u8; WIDTH]| {
        if big_endian {
            bytes.reverse();
        }
        number(bytes)
    };
    data.as_chunks().0.iter().map(little).collect()
}

/// The shortest decimal that is this single, so that its rounding can be told from an irregular clock.
fn shortest(single: f32) -> f64 {
    single.to_string().parse().unwrap_or(single.into())
}
