//! A folder of results that one program at a time writes into.

use crate::error::FileError;
use crate::made::Made;
use crate::{writable, write_all};
use fs4::{FileExt, TryLockError};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// A folder while this program alone writes its results there. Folders that were made for it and stay empty go when it
/// is let go.
#[derive(Debug)]
pub struct Held {
    path: PathBuf,
    // Above the lock, since fields are dropped in their order: an empty folder is not taken away under the next program
    // that holds it.
    _made: Made,
    /// Ends with the program, however it ends.
    lock: File,
}

impl Held {
    /// Holds a folder, making it and those above it.
    ///
    /// # Errors
    /// Another program holds it; it cannot be made, or not be written into; in each case nothing new is left.
    pub fn of(path: &Path) -> Result<Self, FileError> {
        let failed = |source| FileError::Folder { path: path.to_owned(), source };
        writable(path)?;
        let made = Made::folder(path).map_err(failed)?;
        let held = Self { path: path.to_owned(), lock: handle(path).map_err(failed)?, _made: made };
        // Where the file system knows no locks, what the files say of each other alone tells that they were mixed.
        match FileExt::try_lock(&held.lock) {
            Err(TryLockError::WouldBlock) => Err(FileError::Busy { path: path.to_owned() }),
            _ => Ok(held),
        }
    }

    /// Writes files of these names that belong together, as [`write_all`] does.
    ///
    /// # Errors
    /// [`FileError::Write`], of the file that cannot be written.
    pub fn write_all(
        &self,
        files: impl IntoIterator<Item = (impl AsRef<Path>, impl AsRef<[u8]>)>,
    ) -> Result<(), FileError> {
        write_all(files.into_iter().map(|(name, contents)| (self.path.join(name), contents)))
    }
}

/// Whether a program, this one or another, holds a folder; `false`, too, where the file system knows no locks.
#[must_use]
pub fn is_held(folder: &Path) -> bool {
    there(folder).is_ok_and(|lock| matches!(FileExt::try_lock_shared(&lock), Err(TryLockError::WouldBlock)))
}

#[cfg(unix)]
fn there(folder: &Path) -> io::Result<File> {
    handle(folder)
}

/// What would be locked, which is not made where it is not there.
#[cfg(not(unix))]
fn there(folder: &Path) -> io::Result<File> {
    File::options().write(true).open(folder.join(".piezo-folder"))
}

/// What is locked: the folder itself, which leaves nothing behind.
#[cfg(unix)]
fn handle(folder: &Path) -> io::Result<File> {
    File::open(folder)
}

/// What is locked, where a folder cannot be: a file in it, which the next program sweeps.
#[cfg(not(unix))]
fn handle(folder: &Path) -> io::Result<File> {
    File::options().create(true).truncate(false).write(true).open(folder.join(".piezo-folder"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_folder_is_held_once_and_goes_again_where_nothing_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("not/yet");
        let held = Held::of(&deep).unwrap();
        assert!(matches!(Held::of(&deep), Err(FileError::Busy { path }) if path == deep));
        Held::of(folder.path()).unwrap();
        assert!(is_held(&deep) && !is_held(folder.path()));
        drop(held);
        assert!(!is_held(&deep));
        assert!(!folder.path().join("not").exists());
        Held::of(&deep).unwrap().write_all([("a", "1"), ("b", "2")]).unwrap();
        assert_eq!(fs::read_to_string(deep.join("b")).unwrap(), "2");
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(matches!(Held::of(&folder.path().join("file/x")), Err(FileError::Folder { .. })));
    }
}
