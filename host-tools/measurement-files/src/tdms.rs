//! National Instruments' `.tdms`: segments of properties and raw data, channel after channel or interleaved.
//!
//! Format: National Instruments, "TDMS File Format Internal Structure". Raw data in DAQmx's own layout is not read.

use std::collections::HashMap;

use crate::array::{self, Array};
use crate::fault::{Fault, Format, Place, PlacedFault};
use crate::mat5_element::{decode, shortest};
use crate::table::{SampleTime, Table};

/// How a segment begins.
pub(crate) const SIGNATURE: &[u8] = b"TDSm";
const LEAD_IN: usize = 28;

// Bits of a segment's table of contents.
const METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

const STRING: u32 = 0x20;
const TIMESTAMP: u32 = 0x44;

/// Raw data of one object in a segment.
#[derive(Clone, Copy, Default)]
struct Index {
    kind: u32,
    values: usize,
    /// Bytes of one value; of strings, of all.
    width: usize,
}

impl Index {
    fn bytes(self) -> Option<usize> {
        if self.kind == STRING { Some(self.width) } else { self.values.checked_mul(self.width) }
    }
}

/// A channel as far as it has been read.
#[derive(Default)]
struct Channel {
    index: Option<Index>,
    values: Vec<f64>,
    /// The first time stamp, 2⁻⁶⁴ s since 1904; the values count from it.
    origin: Option<i128>,
    unit: String,
    increment: Option<f64>,
}

impl Channel {
    fn extend(&mut self, kind: u32, data: &[u8], big_endian: bool) {
        match kind {
            TIMESTAMP => stamps(data, big_endian, self),
            _ => numbers(kind, data, big_endian, &mut self.values),
        }
    }
}

/// Opens the table that the file's channels make.
pub(crate) fn open<'a>(bytes: &[u8]) -> Result<Table<'a>, PlacedFault> {
    let mut file = File::default();
    let mut rest = bytes;
    while rest.len() >= LEAD_IN {
        rest = file.segment(rest)?;
    }
    file.table()
}

fn damaged(what: &str) -> Fault {
    Fault::Damaged { format: Format::Tdms, what: what.to_owned() }
}

#[derive(Default)]
struct File {
    /// Paths in the order in which they appear.
    paths: Vec<String>,
    channels: HashMap<String, Channel>,
    /// Objects with raw data in the current segment, in their order.
    active: Vec<String>,
}

impl File {
    /// Reads one segment; returns what comes after it.
    fn segment<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Fault> {
        if !bytes.starts_with(SIGNATURE) {
            return Err(damaged("a segment does not begin as one"));
        }
        // The table of contents is little-endian whatever the rest is.
        let contents = Cursor { bytes: &bytes[4..], big_endian: false }.word()?;
        let big_endian = contents & BIG_ENDIAN != 0;
        let mut cursor = Cursor { bytes: &bytes[8..], big_endian };
        cursor.word()?;
        let (next, raw) = (cursor.long()?, cursor.long()?);
        let body = &bytes[LEAD_IN..];
        // A recording that was broken off says so by all ones.
        let next =
            if next == u64::MAX { body.len() } else { usize::try_from(next).unwrap_or(usize::MAX).min(body.len()) };
        let raw = usize::try_from(raw).unwrap_or(usize::MAX);
        if contents & DAQMX != 0 {
            return Err(damaged("its raw data is in DAQmx's own layout: let LabVIEW log scaled values"));
        }
        if contents & METADATA != 0 {
            let metadata = body.get(..raw).ok_or_else(|| damaged("cut short"))?;
            self.metadata(Cursor { bytes: metadata, big_endian }, contents & NEW_OBJECTS != 0)?;
        }
        if contents & RAW_DATA != 0 {
            let data = body.get(raw..next).ok_or_else(|| damaged("cut short"))?;
            self.raw(data, contents & INTERLEAVED != 0, big_endian)?;
        }
        Ok(&body[next..])
    }

    fn metadata(&mut self, mut cursor: Cursor<'_>, new: bool) -> Result<(), Fault> {
        if new {
            self.active.clear();
        }
        for _ in 0..cursor.word()? {
            let path = cursor.text()?;
            if !self.channels.contains_key(&path) {
                self.paths.push(path.clone());
            }
            let channel = self.channels.entry(path.clone()).or_default();
            match cursor.word()? {
                u32::MAX => self.active.retain(|other| *other != path),
                length => {
                    if length != 0 {
                        channel.index = Some(cursor.index()?);
                    }
                    if !self.active.contains(&path) {
                        self.active.push(path);
                    }
                }
            }
            for _ in 0..cursor.word()? {
                let name = cursor.text()?;
                match (&*name, cursor.property()?) {
                    ("unit_string", Property::Text(unit)) => channel.unit = unit,
                    ("wf_increment", Property::Number(increment)) if increment > 0.0 => {
                        channel.increment = Some(increment)
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Reads a segment's raw data: as many chunks as there are, the last perhaps cut short.
    fn raw(&mut self, data: &[u8], interleaved: bool, big_endian: bool) -> Result<(), Fault> {
        let indices = self.active.iter().map(|path| self.channels.get(path).and_then(|channel| channel.index));
        let indices: Vec<Index> = indices.map(Option::unwrap_or_default).collect();
        let sizes: Vec<usize> =
            indices.iter().map(|index| index.bytes()).collect::<Option<_>>().ok_or_else(|| damaged("false sizes"))?;
        let chunk =
            sizes.iter().try_fold(0_usize, |sum, size| sum.checked_add(*size)).ok_or_else(|| damaged("false sizes"))?;
        if chunk == 0 {
            return Ok(());
        }
        let stride: usize = indices.iter().map(|index| index.width).sum();
        for chunk in data.chunks(chunk) {
            let mut at = 0;
            for ((path, index), size) in self.active.iter().zip(&indices).zip(&sizes) {
                let Some(channel) = self.channels.get_mut(path) else { continue };
                if interleaved && index.kind != STRING {
                    let rows = chunk.chunks_exact(stride.max(1));
                    let own: Vec<u8> = rows.flat_map(|row| row.get(at..at + index.width)).flatten().copied().collect();
                    channel.extend(index.kind, &own, big_endian);
                    at += index.width;
                } else {
                    let end = at.saturating_add(*size).min(chunk.len());
                    channel.extend(index.kind, chunk.get(at..end).unwrap_or_default(), big_endian);
                    at = end;
                }
            }
        }
        Ok(())
    }

    fn table<'a>(self) -> Result<Table<'a>, PlacedFault> {
        let (mut increments, mut arrays, mut stamped) = (Vec::new(), Vec::new(), Vec::new());
        for path in &self.paths {
            let channel = self.channels.get(path).and_then(|channel| Some((channel, channel.index?)));
            let (Some((channel, index)), Some(name)) = (channel, channel_name(path)) else { continue };
            let name = if channel.unit.is_empty() { name } else { format!("{name} ({})", channel.unit) };
            let rows = channel.values.len();
            let description = format!("{name} ({rows} values)");
            if index.kind == TIMESTAMP {
                stamped.push(name.clone());
            }
            arrays.push(Array {
                name,
                description,
                rows,
                columns: 1,
                values: (rows > 0).then(|| channel.values.clone()),
            });
            increments.extend(channel.increment);
        }
        let mut table = array::table(Format::Tdms, &arrays)?;
        for column in &mut table.columns {
            column.stamps = stamped.contains(&column.name);
        }
        if let [first, others @ ..] = increments.as_slice()
            && others.iter().all(|other| other == first)
        {
            table.sample_time =
                Some(SampleTime { seconds: *first, place: Place::File, name: "wf_increment".to_owned() });
        }
        Ok(table)
    }
}

/// The channel in a path `/'group'/'channel'`; nothing for a group or the file.
fn channel_name(path: &str) -> Option<String> {
    let (_, channel) = path.strip_prefix("/'")?.strip_suffix('\'')?.split_once("'/'")?;
    Some(channel.replace("''", "'"))
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
fn numbers(kind: u32, data: &[u8], big: bool, values: &mut Vec<f64>) {
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

/// Appends time stamps as seconds since the channel's first: 64 bits of seconds since 1904, 64 behind the point.
fn stamps(data: &[u8], big: bool, channel: &mut Channel) {
    for &bytes in data.as_chunks().0 {
        let instant = if big { i128::from_be_bytes(bytes) } else { i128::from_le_bytes(bytes) };
        let since = instant.wrapping_sub(*channel.origin.get_or_insert(instant));
        channel.values.push(since as f64 / 2_f64.powi(64));
    }
}

/// A property's value, as far as it is of use.
enum Property {
    Text(String),
    Number(f64),
    Other,
}

/// Reads a segment's metadata.
struct Cursor<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let taken = self.bytes.get(..count).ok_or_else(|| damaged("cut short"))?;
        self.bytes = &self.bytes[count..];
        Ok(taken)
    }

    fn word(&mut self) -> Result<u32, Fault> {
        let bytes = self.take(4)?.try_into().map_err(|_| damaged("cut short"))?;
        Ok(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    fn long(&mut self) -> Result<u64, Fault> {
        let bytes = self.take(8)?.try_into().map_err(|_| damaged("cut short"))?;
        Ok(if self.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    fn text(&mut self) -> Result<String, Fault> {
        let length = self.word()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    fn index(&mut self) -> Result<Index, Fault> {
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

    fn property(&mut self) -> Result<Property, Fault> {
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
