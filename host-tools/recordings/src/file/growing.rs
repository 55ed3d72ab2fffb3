//! What is measured only once grows beside its target, as `log.csv.partial`, and takes the target's place when it has ended.
//!
//! Whoever writes one holds a lock on it, which ends with the program however it ends. One that is not locked is what a program
//! that was killed had by then: a measurement, which nobody sweeps and nothing is written over.

use super::replacement::Place;
use super::{FileError, Replacement};
use fs4::{FileExt, TryLockError};
use std::fs::File;
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
    /// written stays as [`partial`]; what another one left there is lost only where `lose` says so.
    ///
    /// # Errors
    /// Another program writes it, or was killed and left something; as [`Replacement::of`].
    pub fn growing(path: &Path, lose: bool) -> Result<Self, FileError> {
        let failed = |source| FileError::Write { path: path.to_owned(), source };
        let place = Place::of(path).map_err(failed)?;
        let file = held(&partial(&place.target), lose)?;
        place.filled_by(file).map_err(failed)
    }

    /// Keeps the whole lines of what can be written no further, under the name that it has grown under; `None` where there is none.
    ///
    /// # Errors
    /// Whatever the operating system says.
    pub fn keep_lines(mut self) -> io::Result<Option<PathBuf>> {
        match self.cut_to_lines()? {
            0 => Ok(None),
            _ => self.leave().map(Some),
        }
    }
}

/// An empty file of this name that this program alone writes.
fn held(path: &Path, lose: bool) -> Result<NamedTempFile, FileError> {
    let failed = |source| FileError::Write { path: path.to_owned(), source };
    if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
        return Err(failed(io::Error::new(ErrorKind::InvalidInput, "it is no regular file: remove it")));
    }
    loop {
        let file = File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        if matches!(FileExt::try_lock(&file), Err(TryLockError::WouldBlock)) {
            return Err(FileError::Growing { path: path.to_owned() });
        }
        // Whoever held it may have put it into its place between the two lines above: then it is no longer this one.
        if !path.exists() {
            continue;
        }
        if !lose && file.metadata().map_err(failed)?.len() > 0 {
            return Err(FileError::Left { path: path.to_owned() });
        }
        file.set_len(0).map_err(failed)?;
        return Ok(NamedTempFile::from_parts(file, TempPath::try_from_path(path).map_err(failed)?));
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
        assert!(matches!(Replacement::growing(&log, false), Err(FileError::Left { path }) if path == left));
        assert_eq!(fs::read_to_string(&left).unwrap(), "1,2\n");
        Replacement::growing(&log, true).unwrap().commit().unwrap();
        assert!(log.exists() && !left.exists());
    }

    #[test]
    fn what_grows_is_there_by_its_name_and_is_one_program_s() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        let mut growing = Replacement::growing(&log, false).unwrap();
        growing.write_all(b"1,2\n3,").unwrap();
        assert_eq!(fs::read_to_string(partial(&log)).unwrap(), "1,2\n3,");
        for lose in [false, true] {
            assert!(matches!(Replacement::growing(&log, lose), Err(FileError::Growing { .. })));
        }
        let kept = growing.keep_lines().unwrap().unwrap();
        assert_eq!((&kept, &*fs::read_to_string(&kept).unwrap()), (&partial(&log), "1,2\n"));
        fs::remove_file(kept).unwrap();
        drop(Replacement::growing(&log, false).unwrap());
        assert_eq!(Replacement::growing(&log, false).unwrap().keep_lines().unwrap(), None);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "dropped, it leaves nothing");
    }
}
