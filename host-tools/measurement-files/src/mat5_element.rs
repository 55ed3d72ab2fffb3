//! The elements of a MATLAB level 5 MAT-file.
//!
//! Every element is a tag (type and size) and data padded to eight bytes; data of up to four bytes may sit in the tag.
//! A variable is a matrix element whose sub-elements are flags, dimensions, name and what it holds: numbers, text, or
//! the matrices of its fields.

use crate::array::Array;
use crate::excerpt::excerpt;

const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
/// Element type of a variable.
pub(crate) const MI_MATRIX: u32 = 14;
/// Element type of a compressed variable.
pub(crate) const MI_COMPRESSED: u32 = 15;
/// Deepest structs within structs that are read.
const DEEPEST: usize = 8;

/// Why an element cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Damage {
    Short,
    Undecodable,
    Large,
}

/// The elements in a slice.
#[derive(Clone, Copy)]
pub(crate) struct Elements<'a> {
    pub bytes: &'a [u8],
    pub big_endian: bool,
}

impl<'a> Elements<'a> {
    /// The next element's type and data.
    pub fn next(&mut self) -> Result<(u32, &'a [u8]), Damage> {
        let (first, second) = (self.word(0)?, self.word(4)?);
        let (kind, size, start) = match first >> 16 {
            0 => (first, second as usize, 8),
            size @ 1..=4 => (first & 0xffff, size as usize, 4),
            _ => return Err(Damage::Undecodable),
        };
        let data = self.bytes.get(start..).and_then(|rest| rest.get(..size)).ok_or(Damage::Short)?;
        // Compressed variables are not padded.
        let padded = if kind == MI_COMPRESSED { start + size } else { (start + size).next_multiple_of(8) };
        self.bytes = self.bytes.get(padded..).unwrap_or_default();
        Ok((kind, data))
    }

    fn word(&self, at: usize) -> Result<u32, Damage> {
        let bytes = self.bytes.get(at..).and_then(|rest| rest.first_chunk()).ok_or(Damage::Short)?;
        Ok(if self.big_endian { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) })
    }

    fn words(&self, data: &[u8]) -> Vec<u32> {
        let word =
            |&bytes: &[u8; 4]| if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) };
        data.as_chunks().0.iter().map(word).collect()
    }

    fn within(&self, bytes: &'a [u8]) -> Self {
        Self { bytes, ..*self }
    }

    /// Appends the arrays of the variable in a matrix element's data: itself, or those in its fields; of all of them
    /// there may be no more than so many numbers.
    pub fn variable(self, arrays: &mut Vec<Array>, most: usize) -> Result<(), Damage> {
        let matrix = self.matrix()?;
        let name = matrix.name.clone();
        matrix.arrays(&name, DEEPEST, arrays, most)
    }

    fn matrix(mut self) -> Result<Matrix<'a>, Damage> {
        let (MI_UINT32, flags) = self.next()? else { return Err(Damage::Undecodable) };
        let &[flags, _] = self.words(flags).as_slice() else { return Err(Damage::Undecodable) };
        let (class, complex) = (flags & 0xff, flags & 0x800 != 0);
        let (MI_INT32, dimensions) = self.next()? else {
            // Opaque classes (strings, tables, timeseries) have their name here, and no dimensions.
            let name = String::from_utf8_lossy(self.next().map(|(_, name)| name).unwrap_or_default()).into_owned();
            return Ok(Matrix { class: OPAQUE, complex, dimensions: Vec::new(), name, rest: self });
        };
        let dimensions = self.words(dimensions).into_iter().map(|side| side as usize).collect();
        let (_, name) = self.next()?;
        let name = String::from_utf8_lossy(name).escape_debug().to_string();
        Ok(Matrix { class, complex, dimensions, name, rest: self })
    }
}

const STRUCT: u32 = 2;
const CHARACTERS: u32 = 4;
const OPAQUE: u32 = 17;

/// A matrix element whose contents have not been read.
struct Matrix<'a> {
    class: u32,
    complex: bool,
    dimensions: Vec<usize>,
    name: String,
    rest: Elements<'a>,
}

impl Matrix<'_> {
    fn arrays(&self, name: &str, deepest: usize, arrays: &mut Vec<Array>, most: usize) -> Result<(), Damage> {
        if self.class == STRUCT && deepest > 0 {
            return self.fields(name, deepest - 1, arrays, most);
        }
        let mut array = Array { name: name.to_owned(), description: self.description(name), ..Array::default() };
        if let ([rows, columns], (_, true), false) = (&self.dimensions[..], class_name(self.class), self.complex) {
            let (kind, data) = self.rest.clone().next()?;
            let before: usize = arrays.iter().filter_map(|array| array.values.as_ref()).map(Vec::len).sum();
            // A number of a byte takes eight here, so that this is seen before.
            if rows.saturating_mul(*columns).min(data.len()).saturating_add(before) > most {
                return Err(Damage::Large);
            }
            let values = numbers(kind, data, self.rest.big_endian).ok_or(Damage::Undecodable)?;
            if Some(values.len()) != rows.checked_mul(*columns) {
                return Err(Damage::Undecodable);
            }
            (array.rows, array.columns, array.values) = (*rows, *columns, Some(values));
        }
        arrays.push(array);
        Ok(())
    }

    fn description(&self, name: &str) -> String {
        let sides: Vec<String> = self.dimensions.iter().map(usize::to_string).collect();
        let kind = if self.complex { "complex" } else { class_name(self.class).0 };
        match self.class {
            OPAQUE => format!("{} (an object)", excerpt(name)),
            _ => format!("{} ({} {kind})", excerpt(name), excerpt(&sides.join("x"))),
        }
    }

    /// The arrays of a struct's fields; of several elements one after the other. A signal with a label is called by it.
    fn fields(&self, name: &str, deepest: usize, arrays: &mut Vec<Array>, most: usize) -> Result<(), Damage> {
        let mut rest = self.rest;
        let (_, length) = rest.next()?;
        let &[length] = rest.words(length).as_slice() else { return Err(Damage::Undecodable) };
        let (_, names) = rest.next()?;
        let length = (length as usize).max(1);
        let field =
            |bytes: &[u8]| String::from_utf8_lossy(bytes.split(|b| *b == 0).next().unwrap_or_default()).into_owned();
        let names: Vec<String> = names.chunks(length).map(field).collect();
        let elements = self.dimensions.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        for _ in 0..elements.ok_or(Damage::Undecodable)? {
            let mut fields = Vec::with_capacity(names.len());
            for field in &names {
                let (MI_MATRIX, data) = rest.next()? else { return Err(Damage::Undecodable) };
                // An empty field is a matrix element of no bytes.
                if !data.is_empty() {
                    fields.push((field.as_str(), rest.within(data).matrix()?));
                }
            }
            if names.is_empty() || fields.is_empty() {
                break;
            }
            let text = |keys: &[&str]| {
                let found = fields.iter().find(|(field, matrix)| keys.contains(field) && matrix.class == CHARACTERS)?;
                found.1.text().filter(|text| !text.is_empty())
            };
            let label = text(&["label", "name", "Name"]).or_else(|| text(&["blockName"]));
            let unit = text(&["unit", "units", "Units"]).map(|unit| format!(" ({unit})")).unwrap_or_default();
            for (field, matrix) in &fields {
                let called = match (&label, *field) {
                    (Some(label), "values" | "Data" | "data") => format!("{label}{unit}"),
                    (None, "values" | "Data" | "data") => format!("{name}{unit}"),
                    _ => (*field).to_owned(),
                };
                matrix.arrays(&called, deepest, arrays, most)?;
            }
        }
        Ok(())
    }

    /// The text of a row of characters.
    fn text(&self) -> Option<String> {
        let (kind, data) = self.rest.clone().next().ok()?;
        let codes = numbers(kind, data, self.rest.big_endian);
        match kind {
            16 => Some(String::from_utf8_lossy(data).into_owned()),
            _ => Some(codes?.into_iter().map(|code| char::from_u32(code as u32).unwrap_or('\u{fffd}')).collect()),
        }
    }
}

/// Name of an array class, and whether it is numeric.
fn class_name(class: u32) -> (&'static str, bool) {
    match class {
        1 => ("cell", false),
        STRUCT => ("struct", false),
        CHARACTERS => ("char", false),
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
        4 | 17 => decode(data, big, |bytes| u16::from_le_bytes(bytes).into()),
        MI_INT32 => decode(data, big, |bytes| i32::from_le_bytes(bytes).into()),
        MI_UINT32 => decode(data, big, |bytes| u32::from_le_bytes(bytes).into()),
        7 => decode(data, big, |bytes| shortest(f32::from_le_bytes(bytes))),
        9 => decode(data, big, f64::from_le_bytes),
        12 => decode(data, big, |bytes| i64::from_le_bytes(bytes) as f64),
        13 => decode(data, big, |bytes| u64::from_le_bytes(bytes) as f64),
        16 => Vec::new(),
        _ => return None,
    })
}

/// Numbers of `WIDTH` bytes each.
pub(crate) fn decode<const WIDTH: usize>(data: &[u8], big_endian: bool, number: fn([u8; WIDTH]) -> f64) -> Vec<f64> {
    let little = |&(mut bytes): &[u8; WIDTH]| {
        if big_endian {
            bytes.reverse();
        }
        number(bytes)
    };
    data.as_chunks().0.iter().map(little).collect()
}

/// The shortest decimal that is this single, so that its rounding can be told from an irregular clock.
pub(crate) fn shortest(single: f32) -> f64 {
    single.to_string().parse().unwrap_or(single.into())
}
