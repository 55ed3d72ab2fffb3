//! MATLAB level 5 MAT-files (`save -v6`, `-v7`): one real array of time, voltage and displacement.
//!
//! The array has three rows (s, V, µm) and a column a sample, or the transpose; with columns chosen any number of rows. Other
//! variables are passed over. Format: The MathWorks, "MAT-File Format". Sizes stated in the file are never trusted with
//! memory: an array is read only where the file has, or inflates within [`EXPANSION`] to, the bytes it claims.

use std::io;

use flate2::read::ZlibDecoder;

use super::channels::{self, Channels};
use super::error::PlacedFault;
use super::fault::Fault;
use super::mat_reader::{MI_COMPRESSED, MI_MATRIX, MatReader, Shape, Variable};
use super::read_options::ReadOptions;
use super::recording::{Origin, Recording};
use super::units::Quantity;

/// Largest ratio of an array's size to its compressed size that is read. Measured signals stay below 20.
const EXPANSION: usize = 100;
const HEADER: usize = 128;
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Whether `bytes` begin as a MATLAB file does.
pub(super) fn is_mat(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MATLAB ") || bytes.starts_with(HDF5)
}

/// Reads the only variable that can be a log.
pub(super) fn read(bytes: &[u8], file: &str, options: &ReadOptions) -> Result<Recording, PlacedFault> {
    let big_endian = check_header(bytes)?;
    let needed = options.columns.as_ref().map(|c| c.highest_number());
    let fits = |shape: Shape| match needed {
        Some(channels) => shape.channels() >= channels,
        None => shape.channels() == 3,
    };
    let mut variables = Vec::new();
    let mut rest = &bytes[HEADER..];
    while !rest.is_empty() {
        let mut reader = MatReader { source: &mut rest, big_endian };
        let tag = reader.tag().map_err(damaged)?;
        let body = rest.get(..tag.size).ok_or(Fault::MatDamaged { what: "cut short" })?;
        rest = &rest[tag.size..];
        let variable = match tag.kind {
            MI_MATRIX => MatReader { source: &mut { body }, big_endian }.variable(body.len(), &fits),
            MI_COMPRESSED => MatReader { source: &mut ZlibDecoder::new(body), big_endian }
                .compressed_variable(body.len().saturating_mul(EXPANSION), &fits),
            _ => continue,
        };
        variables.push(variable.map_err(damaged)?);
    }
    recording(only_fitting(variables, options)?, file, options)
}

/// Whether the file is big-endian; refuses what is no level 5 file.
fn check_header(bytes: &[u8]) -> Result<bool, Fault> {
    let version = |what| Err(Fault::MatVersion { what });
    let hdf5 = bytes.starts_with(HDF5) || bytes.get(512..).is_some_and(|b| b.starts_with(HDF5));
    if hdf5 || bytes.starts_with(b"MATLAB 7.3") {
        return version("a MATLAB v7.3 (HDF5) file, which is not read");
    }
    match bytes.get(124..HEADER) {
        Some([_, 1, b'I', b'M']) => Ok(false),
        Some([1, _, b'M', b'I']) => Ok(true),
        _ => version("no MATLAB file of version 5 to 7"),
    }
}

fn damaged(error: io::Error) -> Fault {
    let what = match error.kind() {
        io::ErrorKind::UnexpectedEof => "cut short",
        io::ErrorKind::FileTooLarge => "an array inflates to more than 100 times its size",
        _ => "a part of it cannot be decoded",
    };
    Fault::MatDamaged { what }
}

fn only_fitting(variables: Vec<Variable>, options: &ReadOptions) -> Result<(Shape, Vec<f64>), Fault> {
    let listed = |variables: &[&Variable]| {
        let mut names: Vec<&str> = variables.iter().map(|v| v.description.as_str()).collect();
        if names.len() > 10 {
            names.truncate(10);
            names.push("…");
        }
        names.join(", ")
    };
    let fitting: Vec<&Variable> = variables.iter().filter(|v| v.array.is_some()).collect();
    match fitting.as_slice() {
        [] => Err(Fault::MatNoLog {
            wanted: match &options.columns {
                Some(columns) => {
                    format!(
                        "a real 2-D array with at least {} rows, as the stated columns ask",
                        columns.highest_number()
                    )
                }
                None => "a real 3xN array (time, voltage, displacement)".to_owned(),
            },
            variables: match variables.as_slice() {
                [] => "none".to_owned(),
                _ => listed(&variables.iter().collect::<Vec<_>>()),
            },
        }),
        [first, _, ..] => Err(Fault::MatSeveral { variables: listed(&fitting), first: first.name.clone() }),
        [_] => variables.into_iter().find_map(|v| v.array).ok_or(Fault::Empty),
    }
}

fn recording((shape, values): (Shape, Vec<f64>), file: &str, options: &ReadOptions) -> Result<Recording, PlacedFault> {
    let count = shape.channels();
    let channels = match &options.columns {
        Some(columns) => channels::from_columns(columns, count, None)?,
        None => Channels::in_order(count),
    };
    channels.check_complete(count, None, file, options)?;
    let column = |quantity: Quantity| -> Result<Option<Vec<f64>>, PlacedFault> {
        let Some(channel) = channels.get(quantity) else {
            return Ok(None);
        };
        let samples = shape.rows.max(shape.columns);
        let at = |k: usize| match shape.rows <= shape.columns {
            true => values[k * shape.rows + channel.index],
            false => values[channel.index * shape.rows + k],
        };
        let series = (0..samples).map(|k| {
            let value = channel.unit.to_base(at(k));
            if value.is_finite() {
                return Ok(value);
            }
            let value = at(k).to_string();
            Err(Fault::NotFinite { quantity, value }.at(Origin::Sample.place(k)))
        });
        series.collect::<Result<_, _>>().map(Some)
    };
    Ok(Recording {
        channels,
        origin: Origin::Sample,
        time: column(Quantity::Time)?,
        voltage: column(Quantity::Voltage)?.unwrap_or_default(),
        displacement: column(Quantity::Displacement)?,
    })
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write;

    use super::super::error::Place;
    use super::super::tests::{data, options};
    use super::super::{Log, LogError};
    use super::*;

    fn fixture(name: &str, options: &ReadOptions) -> Result<Log, LogError> {
        super::super::read(&data("formats").join(name), options)
    }

    fn fault(bytes: &[u8]) -> Fault {
        read(bytes, "log.mat", &options("", None)).unwrap_err().1
    }

    #[test]
    fn every_layout_holds_the_same_log() {
        let reference = fixture("rows.mat", &options("", None)).unwrap();
        assert_eq!(reference.sample_period, 0.0005);
        assert_eq!(reference.voltage.len(), 64);
        assert_eq!(reference.voltage[1], 3.1287);
        assert_eq!(reference.displacement.as_ref().unwrap()[0], -0.7947);
        for name in ["columns.mat", "single.mat", "big_endian.mat"] {
            let log = fixture(name, &options("", None)).unwrap();
            assert_eq!(log.voltage, reference.voltage, "{name}");
            assert_eq!(log.displacement, reference.displacement, "{name}");
            assert_eq!(log.sample_period, reference.sample_period, "{name}");
        }
    }

    #[test]
    fn columns_restate_units_and_rate() {
        let stated = options("voltage=2:mV,displacement=3:nm", Some(1e4));
        let log = fixture("rows.mat", &stated).unwrap();
        assert_eq!(log.sample_period, 1e-4);
        assert_eq!(log.voltage[1], 0.0031287);
        let four = fixture("rows.mat", &options("voltage=4,displacement=1", Some(1e4)));
        assert!(matches!(four.unwrap_err().fault, Fault::MatNoLog { .. }));
    }

    #[test]
    fn several_or_no_candidates_are_named() {
        let error = fixture("two_logs.mat", &options("", None)).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("(first (3x64 double), second (3x64 double))"), "{text}");
        let mut bytes = fs::read(data("formats/rows.mat")).unwrap();
        bytes[160..164].copy_from_slice(&4_u32.to_le_bytes());
        assert!(fault(&bytes).to_string().contains("log (4x64 double)"));
        assert!(fault(&bytes[..HEADER]).to_string().contains("(variables: none)"));
    }

    #[test]
    fn other_versions_are_named() {
        let v73 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64";
        assert!(fault(v73).to_string().contains("v7.3 (HDF5)"));
        assert!(fault(HDF5).to_string().contains("'-v7')"));
        assert!(matches!(fault(&[0; 300]), Fault::MatVersion { .. }));
    }

    #[test]
    fn values_that_are_not_finite_are_named_by_sample() {
        let mut bytes = fs::read(data("formats/rows.mat")).unwrap();
        let voltage_of_sample_5 = bytes.len() - 8 * (3 * 64 - (3 * 4 + 1));
        bytes[voltage_of_sample_5..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
        let PlacedFault(place, fault) = read(&bytes, "log.mat", &options("", None)).unwrap_err();
        assert_eq!(place, Place::Sample(5));
        assert!(matches!(fault, Fault::NotFinite { quantity: Quantity::Voltage, .. }));
    }

    #[test]
    fn false_sizes_cost_no_memory() {
        let mut bytes = fs::read(data("formats/rows.mat")).unwrap();
        // Dimensions 3 x 2^31 - 1, and a data element of 4 GB.
        bytes[164..168].copy_from_slice(&i32::MAX.to_le_bytes());
        let data_size = bytes.len() - 3 * 64 * 8 - 4;
        bytes[data_size..][..4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(matches!(fault(&bytes), Fault::MatDamaged { .. }));
    }

    #[test]
    fn a_compressed_bomb_is_refused() {
        let plain = fs::read(data("formats/rows.mat")).unwrap();
        let samples = 1_000_000_usize;
        let mut matrix = plain[HEADER..plain.len() - 3 * 64 * 8].to_vec();
        let size = matrix.len();
        matrix[36..40].copy_from_slice(&(samples as u32).to_le_bytes());
        matrix[size - 4..].copy_from_slice(&(24 * samples as u32).to_le_bytes());
        matrix.resize(size + 24 * samples, 0);
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), Default::default());
        encoder.write_all(&matrix).unwrap();
        let packed = encoder.finish().unwrap();
        let mut bytes = plain[..HEADER].to_vec();
        bytes.extend(15_u32.to_le_bytes());
        bytes.extend((packed.len() as u32).to_le_bytes());
        bytes.extend(packed);
        let text = fault(&bytes).to_string();
        assert!(text.contains("more than 100 times"), "{text}");
    }

    #[test]
    fn a_wrong_checksum_is_damage() {
        let mut bytes = fs::read(data("formats/single.mat")).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        assert!(matches!(fault(&bytes), Fault::MatDamaged { .. }));
    }
}
