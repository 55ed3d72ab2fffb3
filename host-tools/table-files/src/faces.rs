//! The faces of a table side by side: what table.toml, table.rs and table.bin of one folder say is one table, known by
//! its record's checksum. A program that is killed between two renames, or an edit of one face, leaves faces of two.

use crate::constant::{LINE, rust_source};
use crate::error::{OtherFace, TableFileError};
use crate::file::{MOST_BYTES, TableFile, in_folder, read};
use crate::name::name;
use crate::record::record;
use estimator_core::{Admitted, record::checksum};
use std::io::ErrorKind;
use std::path::Path;

/// The faces' names, and by what each is known near its beginning.
pub const FACES: [(&str, &str); 3] =
    [("table.toml", "# Parameter table of a piezo actuator"), ("table.rs", "// Made by `piezo emit`"), RECORD];
/// The binary record of a table.
pub const RECORD: (&str, &str) = ("table.bin", "PZTB");
/// Ends of the faces' names.
const ENDS: [&str; 3] = ["toml", "rs", "bin"];

impl TableFile {
    /// The files `table.toml`, `table.rs` and `table.bin`, by name, to be written together.
    ///
    /// # Errors
    /// The table is refused.
    pub fn faces(&self) -> Result<[(&'static str, Vec<u8>); 3], TableFileError> {
        let admitted = self.admit()?;
        Ok([
            ("table.toml", self.to_toml()?.into_bytes()),
            ("table.rs", rust_source(&admitted).into_bytes()),
            ("table.bin", record(&admitted)),
        ])
    }
}

/// Compares the table of a face, which may be named by its folder, with the other faces beside it, of the same name but
/// for its end. What is none of ours is not looked at.
///
/// # Errors
/// One of them is of another table.
pub fn agree(face: &Path, table: &Admitted) -> Result<(), OtherFace> {
    let face = &in_folder(face);
    let Some(own_end) = ENDS.into_iter().find(|&end| face.extension().is_some_and(|of_face| of_face == end)) else {
        return Ok(());
    };
    let own = name(table);
    for end in ENDS.into_iter().filter(|&end| end != own_end) {
        let beside = face.with_extension(end);
        match says(&beside) {
            Some(its) if its != own => {
                let its = Some(its).filter(|its| !its.is_empty());
                return Err(OtherFace { named: face.clone(), own, beside, its });
            }
            _ => {}
        }
    }
    Ok(())
}

/// The checksum of a face's table; empty where that is refused; `None` where it is no face.
fn says(face: &Path) -> Option<String> {
    if face.extension()? == "toml" {
        return match TableFile::load(face) {
            Ok((_, table)) => Some(name(&table)),
            Err(TableFileError::Refused { .. } | TableFileError::Earlier { .. }) => Some(String::new()),
            Err(_) => None,
        };
    }
    let bytes = result_files::read(face, MOST_BYTES).ok()?;
    if face.extension()? == "bin" {
        return bytes.starts_with(RECORD.1.as_bytes()).then(|| format!("{:08x}", checksum(&bytes).unwrap_or_default()));
    }
    let text = String::from_utf8(bytes).ok()?;
    text.lines().find_map(|line| line.strip_prefix(LINE)).map(|rest| rest.trim_end_matches('.').to_owned())
}

/// Reads and admits a table that is to go to a device, from one of its faces, with its doubts: those of the table.toml
/// beside a table.bin, which has none of its own.
///
/// # Errors
/// As [`read`]; a face of another table lies beside it, or a table.toml that cannot be read.
pub fn read_doubted(path: &Path) -> Result<(Admitted, Vec<String>), TableFileError> {
    let (file, table) = read(path)?;
    agree(path, &table)?;
    let file = match file {
        Some(file) => Some(file),
        None => beside(path)?,
    };
    Ok((table, file.map_or(Vec::new(), |file| file.doubts)))
}

/// The table.toml beside a table.bin; `None` where there is none.
fn beside(path: &Path) -> Result<Option<TableFile>, TableFileError> {
    match TableFile::load(&path.with_extension("toml")) {
        Ok((file, _)) => Ok(Some(file)),
        Err(TableFileError::Unreadable { error, .. }) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(source) => Err(TableFileError::Doubts { named: path.to_owned(), source: Box::new(source) }),
    }
}
