//! National Instruments' `.tdms`: segments of properties and raw data, channel after channel or interleaved.
//!
//! Format: National Instruments, "TDMS File Format Internal Structure". Raw data in DAQmx's own layout is not read.

use std::collections::HashMap;

use crate::array::{self, Array};
use crate::fault::{Fault, Format, Place, PlacedFault};
use crate::sample_time::SampleTime;
use crate::table::Table;
use crate::tdms_cursor::{Cursor, Index, Property, STRING, TIMESTAMP, damaged, numbers};

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
        let stride = indices.iter().fold(0_usize, |sum, index| sum.saturating_add(index.width));
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
        let own_names: Vec<Option<String>> = self.paths.iter().map(|path| channel_name(path)).collect();
        for (path, own_name) in self.paths.iter().zip(&own_names) {
            let channel = self.channels.get(path).and_then(|channel| Some((channel, channel.index?)));
            let (Some((channel, index)), Some(name)) = (channel, own_name) else { continue };
            // Channels of one name are told apart by their groups.
            let unique = own_names.iter().flatten().filter(|other| *other == name).count() == 1;
            let name = if unique { name.clone() } else { path.trim_matches(['/', '\'']).replace("'/'", "/") };
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

/// Appends time stamps as seconds since the channel's first: 64 bits of seconds since 1904, 64 behind the point.
fn stamps(data: &[u8], big: bool, channel: &mut Channel) {
    for &bytes in data.as_chunks().0 {
        let instant = if big { i128::from_be_bytes(bytes) } else { i128::from_le_bytes(bytes) };
        let since = instant.wrapping_sub(*channel.origin.get_or_insert(instant));
        channel.values.push(since as f64 / 2_f64.powi(64));
    }
}
