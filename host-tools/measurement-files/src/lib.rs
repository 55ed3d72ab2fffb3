//! Files as instruments and programs write them, read as columns of numbers with the names, the units and the sample
//! time that the file states: text tables of any dialect behind preambles of any length, MATLAB (v5 to v7.3), LabVIEW
//! (`.lvm`, `.tdms`), each also compressed by gzip.
//!
//! Nothing here knows what a column means; that is chosen by whoever reads the [`Table`]. Text is streamed: a table
//! holds its first quarter of a megabyte, and the rest passes by in [`Table::rows`].

mod array;
mod dialect;
mod excerpt;
mod fault;
mod hdf5;
mod header;
mod layout;
mod lines;
mod mat5;
mod mat5_element;
mod preamble;
mod reading;
mod sample_time;
mod stamp;
mod table;
mod tdms;
mod tdms_cursor;
mod text;
mod text_rows;
mod unit;

use std::io::{BufRead, BufReader, Read};

use flate2::read::MultiGzDecoder;

pub use excerpt::excerpt;
pub use fault::{Fault, Format, Place, PlacedFault};
pub use sample_time::SampleTime;
pub use table::{Column, Table, place};
pub use unit::{Quantity, Unit, UnknownUnit, without_brackets};

/// How far into a file its kind shows, bytes: a MATLAB v7.3 file has its HDF5 signature after 512.
const SIGNATURES: usize = 1024;

/// What a reader makes of a file's first bytes.
enum Kind {
    Gzip,
    Mat5,
    Hdf5,
    Tdms,
    Text,
}

/// Opens the table in a file's bytes.
///
/// # Errors
/// What keeps the bytes from being a table of numbers, and where.
pub fn open<'a>(bytes: impl Read + 'a) -> Result<Table<'a>, PlacedFault> {
    let mut stream: Box<dyn BufRead + 'a> = Box::new(BufReader::with_capacity(1 << 16, bytes));
    // A compressed file may be compressed once more by a transfer; more layers than that are no log.
    for _ in 0..3 {
        let (start, whole) = start(stream)?;
        stream = whole;
        if start.is_empty() {
            return Err(Fault::Empty.into());
        }
        match kind(&start)? {
            Kind::Gzip => stream = Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(stream))),
            Kind::Text => return text::open(stream),
            Kind::Mat5 => return mat5::open(&rest(stream)?),
            Kind::Hdf5 => return hdf5::open(rest(stream)?),
            Kind::Tdms => return tdms::open(&rest(stream)?),
        }
    }
    Err(Fault::Binary { what: "compressed more than twice" }.into())
}

/// The first bytes of a stream, and the stream with them.
fn start<'a>(mut stream: Box<dyn BufRead + 'a>) -> Result<(Vec<u8>, Box<dyn BufRead + 'a>), PlacedFault> {
    let mut start = Vec::with_capacity(SIGNATURES);
    stream.by_ref().take(SIGNATURES as u64).read_to_end(&mut start).map_err(Fault::unreadable)?;
    let whole = std::io::Cursor::new(start.clone()).chain(stream);
    Ok((start, Box::new(whole)))
}

fn kind(start: &[u8]) -> Result<Kind, Fault> {
    let at = |offset: usize, signature: &[u8]| start.get(offset..).is_some_and(|rest| rest.starts_with(signature));
    if at(0, b"\x1f\x8b") {
        return Ok(Kind::Gzip);
    }
    if at(0, hdf5::SIGNATURE) || at(512, hdf5::SIGNATURE) {
        return Ok(Kind::Hdf5);
    }
    if at(0, tdms::SIGNATURE) {
        return Ok(Kind::Tdms);
    }
    if mat5::is_mat5(start) {
        return Ok(Kind::Mat5);
    }
    let other = [
        (&b"PK\x03\x04"[..], "a workbook or zip archive"),
        (b"BZh", "compressed by bzip2 (gzip is read)"),
        (b"\xfd7zXZ", "compressed by xz (gzip is read)"),
        (b"\x28\xb5\x2f\xfd", "compressed by zstd (gzip is read)"),
        (b"\x93NUMPY", "a NumPy array"),
        (b"\xd0\xcf\x11\xe0", "a workbook of an old format"),
        (b"%PDF", "a PDF document"),
        (b"PAR1", "a Parquet file"),
        (b"TDSh", "the index of a .tdms file, not the .tdms file itself"),
        (b"# Parameter table of a piezo actuator", "a parameter table"),
        (b"<svg", "a picture"),
        (b"<!doctype html", "a page"),
        (b"<!DOCTYPE html", "a page"),
    ];
    match other.into_iter().find(|(signature, _)| at(0, signature)) {
        Some((_, what)) => Err(Fault::Binary { what }),
        None => Ok(Kind::Text),
    }
}

/// Everything that is left of a stream.
fn rest(mut stream: impl Read) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).map_err(Fault::unreadable)?;
    Ok(bytes)
}
