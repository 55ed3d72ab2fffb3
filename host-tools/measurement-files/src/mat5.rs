//! MATLAB level 5 MAT-files (`save -v6`, `-v7`): arrays of numbers, and those in structs.
//!
//! Format: The MathWorks, "MAT-File Format". Sizes stated in the file are never trusted with memory: an array is read
//! only where the file has, or inflates within [`EXPANSION`] to, the bytes it claims; all arrays together may be
//! [`LARGER`] times as large as the file.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::array::{self, Array};
use crate::fault::{Fault, Format, PlacedFault};
use crate::mat5_element::{Damage, Elements, MI_COMPRESSED, MI_MATRIX};
use crate::table::Table;

/// Largest ratio of an array's size to its compressed size that is read. Measured signals stay below 20.
const EXPANSION: usize = 100;
/// Largest ratio of all numbers' size to the file's, and how many numbers a small file may have all the same.
const LARGER: usize = 20;
const NUMBERS: usize = 8 << 20;
/// Bytes of a number in memory.
const WIDTH: usize = size_of::<f64>();
const HEADER: usize = 128;

/// Whether `start` is how a MATLAB file begins.
pub(crate) fn is_mat5(start: &[u8]) -> bool {
    start.starts_with(b"MATLAB ") || (start.len() >= HEADER && big_endian(start).is_some())
}

/// Whether the file is big-endian, by its header's last four bytes; nothing if it is no level 5 file.
fn big_endian(bytes: &[u8]) -> Option<bool> {
    match bytes.get(124..HEADER)? {
        [_, 1, b'I', b'M'] => Some(false),
        [1, _, b'M', b'I'] => Some(true),
        _ => None,
    }
}

/// Opens the table that the file's variables make.
pub(crate) fn open<'a>(bytes: &[u8]) -> Result<Table<'a>, PlacedFault> {
    let Some(big_endian) = big_endian(bytes) else {
        return Err(Fault::MatVersion { what: "no MATLAB file of version 5 to 7.3" }.into());
    };
    let mut arrays: Vec<Array> = Vec::new();
    let most = (bytes.len() / WIDTH).saturating_mul(LARGER).max(NUMBERS);
    let mut elements = Elements { bytes: &bytes[HEADER..], big_endian };
    while !elements.bytes.is_empty() {
        let (kind, data) = elements.next().map_err(damaged)?;
        match kind {
            MI_MATRIX => Elements { bytes: data, big_endian }.variable(&mut arrays, most).map_err(damaged)?,
            MI_COMPRESSED => {
                let inflated = inflate(data, most.saturating_mul(WIDTH))?;
                let (MI_MATRIX, data) = (Elements { bytes: &inflated, big_endian }).next().map_err(damaged)? else {
                    return Err(damaged(Damage::Undecodable).into());
                };
                Elements { bytes: data, big_endian }.variable(&mut arrays, most).map_err(damaged)?;
            }
            _ => {}
        }
    }
    array::table(Format::Matlab, &arrays)
}

/// The bytes of a compressed variable, no more than so many; its checksum is compared at its end.
fn inflate(data: &[u8], of_file: usize) -> Result<Vec<u8>, Fault> {
    let most = data.len().saturating_mul(EXPANSION).min(of_file);
    let mut inflated = Vec::new();
    let read = ZlibDecoder::new(data).take(most as u64 + 1).read_to_end(&mut inflated);
    match read {
        Ok(_) if inflated.len() > most && most == of_file => Err(damaged(Damage::Large)),
        Ok(_) if inflated.len() > most => Err(matlab("an array inflates to more than 100 times its size")),
        Ok(_) => Ok(inflated),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Err(damaged(Damage::Short)),
        Err(_) => Err(damaged(Damage::Undecodable)),
    }
}

fn damaged(damage: Damage) -> Fault {
    matlab(match damage {
        Damage::Short => "cut short",
        Damage::Large => "its arrays are more than 20 times as large as the file",
        Damage::Undecodable => "a part of it cannot be decoded",
    })
}

fn matlab(what: &str) -> Fault {
    Fault::Damaged { format: Format::Matlab, what: what.to_owned() }
}
