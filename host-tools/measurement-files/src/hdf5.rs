//! MATLAB v7.3 files and other HDF5: arrays of numbers, and those in groups, which are MATLAB's structs.

use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use crate::array::{self, Array};
use crate::excerpt::excerpt;
use crate::fault::{Fault, Format, PlacedFault};
use crate::mat5_element::{decode, shortest};
use crate::table::Table;

/// How an HDF5 file begins; MATLAB puts 512 bytes before it.
pub(crate) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Largest ratio of an array's size to the file's that is read.
const EXPANSION: usize = 100;
/// Deepest groups within groups that are read.
const DEEPEST: usize = 8;

/// Opens the table that the file's datasets make.
pub(crate) fn open<'a>(bytes: Vec<u8>) -> Result<Table<'a>, PlacedFault> {
    let most = bytes.len().saturating_mul(EXPANSION);
    let options = OpenOptions::default().with_max_read_bytes(most).with_max_chunk_bytes(most);
    let mut arrays = Vec::new();
    let file = Hdf5File::from_vec_with_options(bytes, options).map_err(damaged)?;
    group(&file.root_group().map_err(damaged)?, "", DEEPEST, &mut arrays)?;
    array::table(Format::Matlab, &arrays)
}

fn damaged(error: hdf5_reader::error::Error) -> Fault {
    Fault::Damaged { format: Format::Matlab, what: excerpt(&error.to_string()) }
}

/// Appends a group's arrays. Those of a signal that has a label are called by it.
fn group(group: &Group, name: &str, deepest: usize, arrays: &mut Vec<Array>) -> Result<(), Fault> {
    let (groups, datasets) = group.members().map_err(damaged)?;
    let labels = ["label", "name", "Name", "blockName"];
    let labelled = labels.iter().find_map(|label| text(datasets.iter().find(|data| own_name(data.name()) == *label)?));
    for data in &datasets {
        let own = own_name(data.name());
        let called = match own {
            "values" | "Data" | "data" if !name.is_empty() => labelled.as_deref().unwrap_or(name),
            own => own,
        };
        arrays.push(array(data, called)?);
    }
    for inner in groups.iter().filter(|inner| deepest > 0 && !own_name(inner.name()).starts_with('#')) {
        self::group(inner, own_name(inner.name()), deepest - 1, arrays)?;
    }
    Ok(())
}

fn own_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// The class that MATLAB notes beside a dataset; empty in files of other programs.
fn class(data: &Dataset) -> String {
    let attribute = data.attribute("MATLAB_class").ok();
    attribute.and_then(|attribute| attribute.read_string().ok()).unwrap_or_default()
}

/// The text of a dataset of MATLAB's characters.
fn text(data: &Dataset) -> Option<String> {
    let bytes = data.read_native_bytes().ok()?;
    let codes = bytes.as_chunks().0.iter().map(|&code| u16::from_ne_bytes(code));
    let text: String = char::decode_utf16(codes).map(|c| c.unwrap_or('\u{fffd}')).collect();
    (class(data) == "char" && !text.is_empty()).then_some(text)
}

/// The unit that other programs note beside a dataset.
fn unit(data: &Dataset) -> Option<String> {
    let attribute = ["unit", "units", "Unit", "Units"].iter().find_map(|name| data.attribute(name).ok())?;
    attribute.read_string().ok().filter(|unit| !unit.is_empty())
}

fn array(data: &Dataset, name: &str) -> Result<Array, Fault> {
    // HDF5 counts rows first and MATLAB columns: the last side is MATLAB's first.
    let side = |&side: &u64| usize::try_from(side).unwrap_or(usize::MAX);
    let sides: Vec<usize> = data.shape().iter().rev().map(side).collect();
    let shown: Vec<String> = sides.iter().map(usize::to_string).collect();
    let class = class(data);
    let kind = if class.is_empty() { "numbers" } else { &class };
    let name = match unit(data) {
        Some(unit) => format!("{name} ({unit})"),
        None => name.to_owned(),
    };
    let description = format!("{} ({} {kind})", excerpt(&name), shown.join("x"));
    let mut array = Array { name, description, ..Array::default() };
    (array.rows, array.columns) = match sides[..] {
        [] => (1, 1),
        [length] => (length, 1),
        [rows, columns] => (rows, columns),
        _ => return Ok(array),
    };
    // An object, such as a timeseries, is a list of where its parts are.
    let no_numbers = ["MATLAB_empty", "MATLAB_object_decode"].iter().any(|name| data.attribute(name).is_ok());
    if no_numbers || ["char", "cell", "logical"].contains(&class.as_str()) {
        return Ok(array);
    }
    let Some(numbers) = decoder(data.dtype()) else { return Ok(array) };
    let values = numbers(&data.read_native_bytes().map_err(damaged)?);
    if Some(values.len()) != array.rows.checked_mul(array.columns) {
        return Err(Fault::Damaged { format: Format::Matlab, what: "an array is cut short".to_owned() });
    }
    array.values = Some(values);
    Ok(array)
}

/// Turns bytes into numbers.
type Decoder = fn(&[u8]) -> Vec<f64>;

/// What turns the native bytes of a datatype into numbers.
fn decoder(datatype: &Datatype) -> Option<Decoder> {
    const BIG: bool = cfg!(target_endian = "big");
    Some(match datatype {
        Datatype::FloatingPoint { size: 8, .. } => |bytes| decode(bytes, BIG, f64::from_le_bytes),
        Datatype::FloatingPoint { size: 4, .. } => |bytes| decode(bytes, BIG, |b| shortest(f32::from_le_bytes(b))),
        Datatype::FixedPoint { size: 1, signed: true, .. } => {
            |bytes| decode(bytes, BIG, |b| i8::from_le_bytes(b).into())
        }
        Datatype::FixedPoint { size: 1, .. } => |bytes| decode(bytes, BIG, |b| u8::from_le_bytes(b).into()),
        Datatype::FixedPoint { size: 2, signed: true, .. } => {
            |bytes| decode(bytes, BIG, |b| i16::from_le_bytes(b).into())
        }
        Datatype::FixedPoint { size: 2, .. } => |bytes| decode(bytes, BIG, |b| u16::from_le_bytes(b).into()),
        Datatype::FixedPoint { size: 4, signed: true, .. } => {
            |bytes| decode(bytes, BIG, |b| i32::from_le_bytes(b).into())
        }
        Datatype::FixedPoint { size: 4, .. } => |bytes| decode(bytes, BIG, |b| u32::from_le_bytes(b).into()),
        Datatype::FixedPoint { size: 8, signed: true, .. } => {
            |bytes| decode(bytes, BIG, |b| i64::from_le_bytes(b) as f64)
        }
        Datatype::FixedPoint { size: 8, .. } => |bytes| decode(bytes, BIG, |b| u64::from_le_bytes(b) as f64),
        _ => return None,
    })
}
