//! The folders of a fleet's units, and what each says.

use crate::error::UnitError;
use crate::unit::{UNIT, Unit};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A folder that is to hold a unit's results.
#[derive(Debug)]
pub struct Member {
    /// The folder.
    pub folder: PathBuf,
    /// What its file says.
    pub unit: Result<Unit, UnitError>,
}

/// The units of folders, each once.
pub(crate) fn members(named: &[PathBuf]) -> Vec<Member> {
    let mut seen = BTreeSet::new();
    let folders = named.iter().flat_map(|named| folders(named));
    let new = folders.filter(|folder| seen.insert(folder.canonicalize().unwrap_or_else(|_| folder.clone())));
    new.map(|folder| Member { unit: Unit::read(&folder.join(UNIT.0)), folder }).collect()
}

/// The folder itself where it is a unit's, or holds no others; else those in it, but for hidden ones. Of a unit's file its folder.
fn folders(named: &Path) -> Vec<PathBuf> {
    if named.file_name().is_some_and(|name| name == UNIT.0) && !named.is_dir() {
        return vec![
            named.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned(),
        ];
    }
    if named.join(UNIT.0).symlink_metadata().is_ok() {
        return vec![named.to_owned()];
    }
    let entries = std::fs::read_dir(named).into_iter().flatten().flatten();
    let hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let mut within: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.is_dir() && !hidden(path)).collect();
    within.sort();
    if within.is_empty() { vec![named.to_owned()] } else { within }
}
