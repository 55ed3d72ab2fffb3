//! What is measured only once grows beside its target, as `log.csv.partial`, and takes the target's place when
//! it has ended.
//!
//! Whoever writes one holds a lock on it, which ends with the program however it ends. One that is not locked is what a
//! program that was killed had by then: a measurement, which nobody sweeps and nothing is written over.

use crate::error::{FileError, failed};
use crate::replacement::{Place, Replacement};
use fs4::{FileExt, TryLockError};
use std::fs::File;
#[cfg(unix)]
use std::fs::Metadata;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};

/// The name of what grows, beside its target.
#[must_use]
pub fn partial(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

impl Replacement {
    /// The replacement of `path` as [`Replacement::of`], for what nobody can measure again. Where the program is
    /// killed, what was written stays as [`partial`], and what another one left there is never written over.
    ///
    /// # Errors
    /// Another program writes it, or was killed and left something; as [`Replacement::of`].
    pub fn growing(path: &Path) -> Result<Self, FileError> {
        let place = Place::of(path).map_err(failed(path))?;
        let file = held(&partial(&place.target))?;
        place.filled_by(file).map_err(failed(path))
    }
}

/// An empty file of this name that this program alone writes.
fn held(path: &Path) -> Result<NamedTempFile, FileError> {
    if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
        return Err(failed(path)(io::Error::new(ErrorKind::InvalidInput, "it is no regular file: remove it")));
    }
    loop {
        let file =
            File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(failed(path))?;
        if matches!(FileExt::try_lock(&file), Err(TryLockError::WouldBlock)) {
            return Err(FileError::Growing { path: path.to_owned() });
        }
        // Whoever held it may have put it into its place between the two lines above, and a third begun one
        // of this name.
        if !is_at(&file, path) {
            continue;
        }
        if file.metadata().map_err(failed(path))?.len() > 0 {
            return Err(FileError::Left { path: path.to_owned() });
        }
        return Ok(NamedTempFile::from_parts(file, TempPath::try_from_path(path).map_err(failed(path))?));
    }
}

/// Whether this open file is the one of this name.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let id = |of: Metadata| (of.dev(), of.ino());
        file.metadata().map(id).ok().is_some_and(|own| path.metadata().map(id).is_ok_and(|there| there == own))
    }
    // Elsewhere a file that is open keeps its name to itself.
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_cannot_be_cut_to_its_lines_is_kept_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        fs::write(partial(&log), "1,2\n3,").unwrap();
        // Open for writing alone, its end cannot be looked at.
        let file = File::options().write(true).open(partial(&log)).unwrap();
        let file = NamedTempFile::from_parts(file, TempPath::try_from_path(partial(&log)).unwrap());
        let growing = Place::of(&log).unwrap().filled_by(file).unwrap();
        let error = growing.keep_lines().unwrap_err().to_string();
        assert!(error.ends_with(&format!("what was written is kept in {}", partial(&log).display())), "{error}");
        assert_eq!(fs::read_to_string(partial(&log)).unwrap(), "1,2\n3,");
    }

    #[test]
    fn a_file_is_told_from_another_that_took_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv.partial");
        let file = File::create(&path).unwrap();
        assert!(is_at(&file, &path));
        fs::rename(&path, folder.path().join("log.csv")).unwrap();
        assert!(!is_at(&file, &path));
        #[cfg(unix)]
        {
            fs::write(&path, "of a third").unwrap();
            assert!(!is_at(&file, &path));
        }
    }
}
