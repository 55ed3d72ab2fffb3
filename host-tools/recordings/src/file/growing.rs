//! What is measured only once grows beside its target, as `log.csv.partial`, and takes the target's place when it has ended.
//!
//! Whoever writes one holds a lock on it, which ends with the program however it ends. One that is not locked is what a program
//! that was killed had by then: a measurement, which nobody sweeps and nothing is written over.

use super::replacement::Place;
use super::{FileError, Replacement};
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
    /// The replacement of `path` as [`Replacement::of`], for what nobody can measure again. Where the program is killed, what was
    /// written stays as [`partial`], and what another one left there is never written over.
    ///
    /// # Errors
    /// Another program writes it, or was killed and left something; as [`Replacement::of`].
    pub fn growing(path: &Path) -> Result<Self, FileError> {
        let failed = |source| FileError::Write { path: path.to_owned(), source };
        let place = Place::of(path).map_err(failed)?;
        let file = held(&partial(&place.target))?;
        place.filled_by(file).map_err(failed)
    }
}

/// An empty file of this name that this program alone writes.
fn held(path: &Path) -> Result<NamedTempFile, FileError> {
    let failed = |source| FileError::Write { path: path.to_owned(), source };
    if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
        return Err(failed(io::Error::new(ErrorKind::InvalidInput, "it is no regular file: remove it")));
    }
    loop {
        let file = File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        if matches!(FileExt::try_lock(&file), Err(TryLockError::WouldBlock)) {
            return Err(FileError::Growing { path: path.to_owned() });
        }
        // Whoever held it may have put it into its place between the two lines above, and a third begun one of this name.
        if !is_at(&file, path) {
            continue;
        }
        if file.metadata().map_err(failed)?.len() > 0 {
            return Err(FileError::Left { path: path.to_owned() });
        }
        return Ok(NamedTempFile::from_parts(file, TempPath::try_from_path(path).map_err(failed)?));
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
    use std::io::Write;

    #[test]
    fn what_a_killed_program_has_measured_is_found_named_and_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        let left = partial(&log);
        assert_eq!(left, folder.path().join("log.csv.partial"));
        fs::write(&left, "1,2\n").unwrap();
        // Neither of these sweeps it.
        Replacement::of(&folder.path().join("table.bin")).unwrap().commit().unwrap();
        assert!(matches!(Replacement::growing(&log), Err(FileError::Left { path }) if path == left));
        assert_eq!(fs::read_to_string(&left).unwrap(), "1,2\n");
        fs::rename(&left, folder.path().join("of-before.csv")).unwrap();
        Replacement::growing(&log).unwrap().commit_measured(false).unwrap();
        assert!(log.exists() && !left.exists());
    }

    /// What it holds that grew beside `log.csv`, where that takes no place: its error names it.
    fn kept(log: &Path, error: &io::Error) -> String {
        let named = format!("what was written is kept in {}", partial(log).display());
        assert!(error.to_string().ends_with(&named), "{error}");
        fs::read_to_string(partial(log)).unwrap()
    }

    #[test]
    fn what_was_measured_stays_where_its_place_was_taken_meanwhile() {
        for over in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let log = folder.path().join("log.csv");
            let begun = || {
                let mut growing = Replacement::growing(&log).unwrap();
                growing.write_all(b"1,2\n").unwrap();
                growing
            };
            let growing = begun();
            fs::create_dir(&log).unwrap();
            assert_eq!(kept(&log, &growing.commit_measured(over).unwrap_err()), "1,2\n");
            fs::remove_dir(&log).unwrap();
            fs::remove_file(partial(&log)).unwrap();
            let growing = begun();
            fs::write(&log, "another's").unwrap();
            match growing.commit_measured(over) {
                Ok(()) => assert!(over && fs::read_to_string(&log).unwrap() == "1,2\n"),
                Err(error) => {
                    assert_eq!(kept(&log, &error), "1,2\n");
                    assert!(!over && fs::read_to_string(&log).unwrap() == "another's");
                    fs::remove_file(partial(&log)).unwrap();
                    // An empty file is nobody's measurement.
                    fs::write(&log, "").unwrap();
                    begun().commit_measured(over).unwrap();
                    assert_eq!(fs::read_to_string(&log).unwrap(), "1,2\n");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_cut_to_its_lines_is_kept_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        fs::write(partial(&log), "1,2\n3,").unwrap();
        // Open for writing alone, its end cannot be looked at.
        let file = File::options().write(true).open(partial(&log)).unwrap();
        let file = NamedTempFile::from_parts(file, TempPath::try_from_path(partial(&log)).unwrap());
        let growing = Place::of(&log).unwrap().filled_by(file).unwrap();
        assert_eq!(kept(&log, &growing.keep_lines().unwrap_err()), "1,2\n3,");
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

    #[test]
    fn what_grows_is_there_by_its_name_and_is_one_program_s() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        let mut growing = Replacement::growing(&log).unwrap();
        growing.write_all(b"1,2\n3,").unwrap();
        assert_eq!(fs::read_to_string(partial(&log)).unwrap(), "1,2\n3,");
        assert!(matches!(Replacement::growing(&log), Err(FileError::Growing { .. })));
        let kept = growing.keep_lines().unwrap().unwrap();
        assert_eq!((&kept, &*fs::read_to_string(&kept).unwrap()), (&partial(&log), "1,2\n"));
        fs::remove_file(kept).unwrap();
        drop(Replacement::growing(&log).unwrap());
        assert_eq!(Replacement::growing(&log).unwrap().keep_lines().unwrap(), None);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "dropped, it leaves nothing");
    }
}
