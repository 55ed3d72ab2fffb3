//! MATLAB files of version 5.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use recordings::log::{Fault, Log, LogError, Place, Quantity, ReadOptions, read};

/// Bytes before the first variable of a level 5 file.
const HEADER: usize = 128;

fn fixture(name: &str, options: &ReadOptions) -> Result<Log, LogError> {
    read(&data("formats").join(name), options)
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name)
}

fn options(columns: &str, sample_rate: Option<f64>) -> ReadOptions {
    let columns = (!columns.is_empty()).then(|| columns.parse().unwrap());
    ReadOptions { columns, sample_rate, ..ReadOptions::default() }
}

/// What is wrong with a file of these bytes, and where.
fn refused(bytes: &[u8]) -> LogError {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.mat");
    fs::write(&path, bytes).unwrap();
    read(&path, &options("", None)).unwrap_err()
}

fn fault(bytes: &[u8]) -> Fault {
    refused(bytes).fault
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
    assert!(matches!(four.unwrap_err().fault, Fault::NoSuchColumn { .. }));
}

#[test]
fn several_or_no_candidates_are_named() {
    let error = fixture("two_logs.mat", &options("", None)).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("(first (3x64 double), second (3x64 double))"), "{text}");
    let mut bytes = fs::read(data("formats/rows.mat")).unwrap();
    bytes[160..164].copy_from_slice(&4_u32.to_le_bytes());
    assert!(matches!(fault(&bytes), Fault::MatDamaged { .. }), "four rows, and numbers for three");
    assert!(fault(&bytes[..HEADER]).to_string().contains("(variables: none)"));
}

#[test]
fn other_versions_are_named() {
    let v73 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64";
    assert!(matches!(fault(v73), Fault::MatVersion { .. }), "the header alone");
    assert!(fault(b"\x89HDF\r\n\x1a\n").to_string().contains("'-v7')"));
    assert!(matches!(fault(&[0; 300]), Fault::Binary { .. }));
}

#[test]
fn values_that_are_not_finite_are_named_by_sample() {
    let mut bytes = fs::read(data("formats/rows.mat")).unwrap();
    let voltage_of_sample_5 = bytes.len() - 8 * (3 * 64 - (3 * 4 + 1));
    bytes[voltage_of_sample_5..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
    let LogError { place, fault, .. } = refused(&bytes);
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

/// Each array is within what one may inflate to; all of them together would take a hundred times the file.
#[test]
fn many_arrays_that_inflate_are_refused_before_they_are_all_in_memory() {
    let plain = fs::read(data("formats/rows.mat")).unwrap();
    let samples = 400_000_usize;
    let mut matrix = plain[HEADER..plain.len() - 3 * 64 * 8].to_vec();
    let size = matrix.len();
    matrix[36..40].copy_from_slice(&(samples as u32).to_le_bytes());
    matrix[size - 4..].copy_from_slice(&(24 * samples as u32).to_le_bytes());
    matrix.resize(size + 24 * samples, 0);
    let rest = matrix.len() as u32 - 8;
    matrix[4..8].copy_from_slice(&rest.to_le_bytes());
    // Some noise among the zeros, which alone would inflate a thousandfold.
    let mut noise = 1_u32;
    for at in (size..matrix.len()).step_by(70) {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        matrix[at] = (noise >> 24) as u8;
    }
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), Default::default());
    encoder.write_all(&matrix).unwrap();
    let packed = encoder.finish().unwrap();
    let ratio = matrix.len() / packed.len();
    assert!((25..100).contains(&ratio), "{ratio}");
    let mut bytes = plain[..HEADER].to_vec();
    for _ in 0..12 {
        bytes.extend(15_u32.to_le_bytes());
        bytes.extend((packed.len() as u32).to_le_bytes());
        bytes.extend(&packed);
    }
    let text = fault(&bytes).to_string();
    assert!(text.contains("more than 20 times as large as the file"), "{text}");
}

#[test]
fn a_wrong_checksum_is_damage() {
    let mut bytes = fs::read(data("formats/single.mat")).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    assert!(matches!(fault(&bytes), Fault::MatDamaged { .. }));
}
