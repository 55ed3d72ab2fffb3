//! A file of any content as a log: read, or refused by an error that names the file.

use recordings::log::{Log, LogError, MINIMUM_ROWS, Need, ReadOptions, read_bytes};
use std::path::Path;

/// What a file may be called; the readers go by its content.
const EXTENSIONS: [&str; 7] = ["csv", "dat", "txt", "lvm", "tdms", "mat", "csv.gz"];
/// What may be said of its columns.
const COLUMNS: [&str; 4] =
    ["", "voltage=1,displacement=2", "time=1,voltage=2,displacement=3", "voltage=2:mV,displacement=1"];
/// No error needs more characters.
const LONGEST: usize = 4_000;

/// The first byte chooses the file's name and what is said of it; the rest is its content. Whether a log was read.
///
/// # Panics
/// What is read breaks a promise, or an error says not enough or too much.
pub fn check(bytes: &[u8]) -> bool {
    let Some((&choice, content)) = bytes.split_first() else { return false };
    let of = |shift: u8, count: usize| usize::from(choice >> shift) % count;
    let columns = COLUMNS[of(3, COLUMNS.len())];
    let options = ReadOptions {
        columns: (!columns.is_empty()).then(|| columns.parse().expect("it is of the form that is asked for")),
        sample_rate: (choice & 0x20 != 0).then_some(2_000.0),
        displacement: if choice & 0x40 == 0 { Need::Required } else { Need::Optional },
        voltage_required: choice & 0x80 == 0,
        ..ReadOptions::default()
    };
    let path = Path::new("logs").join(format!("measured.{}", EXTENSIONS[of(0, 8) % EXTENSIONS.len()]));
    let with_holes = ReadOptions { holes: true, ..options.clone() };
    let read = [&options, &with_holes].map(|options| read_bytes(&path, content, options));
    // What has no hole is read alike.
    assert!(read[0].is_err() || read[0].as_ref().ok() == read[1].as_ref().ok());
    read.map(|read| sound(read, &path, options.voltage_required))[0]
}

/// Whether a log was read, which is then one.
fn sound(read: Result<Log, LogError>, path: &Path, voltage_required: bool) -> bool {
    match read {
        Ok(log) => {
            assert!(log.holes.iter().all(
                |hole| hole.start < hole.end && hole.end <= log.displacement.as_ref().unwrap_or(&log.voltage).len()
            ));
            let rows = log.voltage.len();
            assert!(log.sample_period.is_finite() && log.sample_period > 0.0, "{} s", log.sample_period);
            assert!(log.voltage.iter().all(|volts| volts.is_finite()));
            let displacement = log.displacement.unwrap_or_default();
            assert!(displacement.iter().all(|um| um.is_finite()));
            if voltage_required {
                assert!(rows >= MINIMUM_ROWS && (displacement.is_empty() || displacement.len() == rows));
            }
            true
        }
        Err(error) => {
            said(&error.to_string(), path);
            false
        }
    }
}

/// What an error says is of that file, and no longer than can be read.
pub(crate) fn said(error: &str, path: &Path) {
    assert!(error.starts_with(&path.display().to_string()), "{error}");
    assert!(error.chars().count() <= LONGEST, "{} characters", error.chars().count());
}
