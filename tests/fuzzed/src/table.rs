//! Any text as a table.toml: refused by an error that names the file, or a table that is written and read
//! again as itself.

use crate::log::said;
use std::path::Path;
use table_files::{TableFile, record};

/// Text as a table.toml. Whether one was read.
///
/// # Panics
/// What is read is written as something else, or an error says not enough or too much.
pub fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let path = Path::new("tables/table.toml");
    let (file, admitted) = match TableFile::parse(path, text) {
        Ok(read) => read,
        Err(error) => {
            said(&error.to_string(), path);
            return false;
        }
    };
    let written = file.to_toml().expect("what was read can be written");
    let (again, equal) = TableFile::parse(path, &written).expect("what was written can be read");
    assert_eq!(record(&equal), record(&admitted), "a bit of the table has changed");
    assert_eq!(again.to_toml().expect("what was read can be written"), written, "it is written in two ways");
    assert!(again == file, "something of the file has changed");
    true
}
