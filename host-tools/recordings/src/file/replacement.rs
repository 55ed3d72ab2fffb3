//! A file beside its target: written there, then renamed, and removed by the next program where this one is killed.
//!
//! Whoever writes one holds a lock on it, which ends with the program however it ends: one that is not locked is a leftover.

use fs4::{FileExt, TryLockError};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// How the name of such a file starts, and how many characters follow.
const PREFIX: &str = ".piezo-";
const RANDOM: usize = 6;

/// A file that is written beside its target and then takes the target's place. Dropped before that, it leaves nothing.
pub struct Replacement {
    file: NamedTempFile,
    target: PathBuf,
}

impl Replacement {
    /// The replacement of `path`, whose links are followed, with the permissions of what is there, or else of an ordinary
    /// new file.
    ///
    /// # Errors
    /// What is there is a device, a pipe, a folder, a link to nothing, or read-only; whatever the operating system says.
    pub fn of(path: &Path) -> io::Result<Self> {
        let refused = |kind, why| Err(io::Error::new(kind, why));
        let (target, there) = match path.canonicalize() {
            Ok(target) => {
                let there = target.metadata()?;
                if !there.is_file() {
                    return refused(ErrorKind::InvalidInput, "it is no regular file, and would be lost: name another");
                }
                if there.permissions().readonly() {
                    return refused(ErrorKind::PermissionDenied, "it is read-only: make it writable, or name another");
                }
                (target, Some(there.permissions()))
            }
            Err(_) if path.is_symlink() => {
                return refused(ErrorKind::NotFound, "it is a link to nothing: remove it, or name another");
            }
            Err(_) => (path.to_owned(), None),
        };
        let file = temporary(folder_of(&target))?;
        if let Some(permissions) = there {
            file.as_file().set_permissions(permissions)?;
        }
        Ok(Self { file, target })
    }

    /// Has what was written on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.as_file().sync_all()
    }

    /// Puts what was written into the target's place.
    ///
    /// # Errors
    /// Whatever the operating system says; the target is as it was.
    pub fn commit(self) -> io::Result<()> {
        self.sync()?;
        self.file.persist(self.target).map_err(|error| error.error)?;
        Ok(())
    }

    /// Puts what was written to the first of these paths at which nothing is, in the target's folder, and says which: for what must
    /// never be written over anything, whoever put it there meanwhile.
    ///
    /// # Errors
    /// Something is at each; whatever the operating system says.
    pub fn commit_to_free(self, paths: impl IntoIterator<Item = PathBuf>) -> io::Result<PathBuf> {
        self.sync()?;
        let mut file = self.file;
        for path in paths {
            match file.persist_noclobber(&path) {
                Ok(_) => return Ok(path),
                Err(error) if error.error.kind() == ErrorKind::AlreadyExists => file = error.file,
                Err(error) => return Err(error.error),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }
}

impl Write for Replacement {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A temporary file in a folder, locked, with the permissions of an ordinary new one. Leftovers there are removed.
pub(super) fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    sweep(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(folder)?;
        // A sweep by another program may have come before the lock: then the file is gone, or about to go. Where the file system
        // knows no locks nothing is swept either.
        let swept = matches!(FileExt::try_lock(file.as_file()), Err(TryLockError::WouldBlock));
        if !swept && file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes what programs that were killed have left in a folder.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let ours = name.len() == PREFIX.len() + RANDOM && name.as_encoded_bytes().starts_with(PREFIX.as_bytes());
        if !ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        if FileExt::try_lock(&file).is_ok() {
            // The lock lasts until the file is gone. One that cannot be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_program_has_left_is_swept_and_what_another_writes_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at(".piezo-aB3xYz"), "half a table").unwrap();
        fs::write(at(".piezo-notes.txt"), "a stranger's").unwrap();
        let mut other = Replacement::of(&at("log.csv")).unwrap();
        other.write_all(b"of another program").unwrap();
        assert!(!at(".piezo-aB3xYz").exists());
        Replacement::of(&at("table.bin")).unwrap().commit().unwrap();
        other.commit().unwrap();
        assert_eq!(fs::read_to_string(at("log.csv")).unwrap(), "of another program");
        assert!(at(".piezo-notes.txt").exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn what_is_there_is_kept_and_the_next_free_name_taken() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["1.csv", "2.csv", "3.csv"].map(|name| folder.path().join(name));
        let write = |contents: &str| {
            let mut file = Replacement::of(&names[0]).unwrap();
            file.write_all(contents.as_bytes()).unwrap();
            file
        };
        let file = write("ours");
        fs::write(&names[0], "another's").unwrap();
        fs::create_dir(&names[1]).unwrap();
        assert_eq!(file.commit_to_free(names.clone()).unwrap(), names[2]);
        assert_eq!(fs::read_to_string(&names[0]).unwrap(), "another's");
        assert_eq!(fs::read_to_string(&names[2]).unwrap(), "ours");
        assert_eq!(write("late").commit_to_free(names).unwrap_err().kind(), ErrorKind::AlreadyExists);
    }
}
