//! The folders of a fleet's units, and what each says.

use crate::error::UnitError;
use crate::unit::{UNIT, Unit};
use std::collections::BTreeSet;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// A folder that is to hold a unit's results.
#[derive(Debug)]
pub struct Member {
    /// Where the unit.json is, or is missing.
    pub folder: PathBuf,
    /// What its file says.
    pub unit: Result<Unit, UnitError>,
}

impl Member {
    fn read(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), unit: Unit::read(&folder.join(UNIT.0)) }
    }
}

/// The units of folders, each once.
pub(crate) fn members(named: &[PathBuf]) -> Vec<Member> {
    let mut seen = BTreeSet::new();
    let all = named.iter().flat_map(|named| of_named(named));
    all.filter(|Member { folder, .. }| seen.insert(folder.canonicalize().unwrap_or_else(|_| folder.clone()))).collect()
}

/// Of a unit's file its folder, of a unit's folder that one, of a fleet's those in it.
fn of_named(named: &Path) -> Vec<Member> {
    if named.file_name().is_some_and(|name| name == UNIT.0) && !named.is_dir() {
        let folder = named.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        return vec![Member::read(folder)];
    }
    if has_file(named) { vec![Member::read(named)] } else { within(named, folders(named)) }
}

/// The units within a folder that is none's: a fleet's, where one of the folders in it is a unit's; else a unit's that
/// has no file.
fn within(named: &Path, folders: io::Result<Vec<PathBuf>>) -> Vec<Member> {
    match folders {
        Ok(folders) if folders.iter().any(|folder| has_file(folder)) => {
            folders.iter().map(|folder| Member::read(folder)).collect()
        }
        // A name under which nothing is, or one without a unit's folder.
        Err(error) if error.kind() != ErrorKind::NotFound => {
            vec![Member {
                folder: named.to_owned(),
                unit: Err(UnitError::Unreadable { path: named.to_owned(), error }),
            }]
        }
        _ => vec![Member::read(named)],
    }
}

/// Whether a unit's file is there, or may be: of a folder that may not be looked into, reading it says so.
fn has_file(folder: &Path) -> bool {
    let absent = [ErrorKind::NotFound, ErrorKind::NotADirectory];
    !folder.join(UNIT.0).symlink_metadata().is_err_and(|error| absent.contains(&error.kind()))
}

/// The folders in one, but for hidden ones, by name.
fn folders(of: &Path) -> io::Result<Vec<PathBuf>> {
    let hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let entries: Vec<PathBuf> = std::fs::read_dir(of)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    let mut folders: Vec<PathBuf> = entries.into_iter().filter(|path| path.is_dir() && !hidden(path)).collect();
    folders.sort();
    Ok(folders)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_unit_without_a_file_is_not_taken_for_a_fleet_of_what_lies_in_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let unit = folder.path().join("SN042");
        fs::create_dir_all(unit.join("plots")).unwrap();
        let found = members(std::slice::from_ref(&unit));
        let [Member { folder: found, unit: Err(UnitError::Missing { folder: missing }) }] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!([found, missing], [&unit, &unit]);
        // Where one beside it has a file, the folder above them is the fleet's.
        let sibling = folder.path().join("SN043");
        fs::create_dir(&sibling).unwrap();
        fs::write(sibling.join(UNIT.0), "{}").unwrap();
        let found = members(&[folder.path().to_owned()]);
        assert_eq!(found.iter().map(|member| &member.folder).collect::<Vec<_>>(), [&unit, &sibling]);
    }

    #[test]
    fn a_folder_that_cannot_be_read_is_not_said_to_lack_a_file() {
        let named = Path::new("fleet");
        let found = within(named, Err(ErrorKind::PermissionDenied.into()));
        let [Member { folder, unit: Err(error) }] = &found[..] else { panic!("{found:?}") };
        assert_eq!(folder, named);
        assert_eq!(error.to_string(), "fleet: cannot be read (permission denied)");
    }
}
