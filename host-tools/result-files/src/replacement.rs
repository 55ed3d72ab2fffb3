//! A file beside its target: written there, then renamed, and removed by the next program where this one is killed.
//!
//! Whoever writes one holds a lock on it, which ends with the program however it ends: one that is not locked
//! is a leftover.

use crate::error::{FileError, failed};
use crate::made::Made;
use fs4::{FileExt, TryLockError};
use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// How the name of such a file starts, and how many characters follow.
const PREFIX: &str = ".piezo-";
const RANDOM: usize = 6;
/// How the name of one starts that could not be put in its place.
const KEPT: &str = "piezo-kept-";
/// Longer than a line of any text that is written here, bytes.
const LONGEST_LINE: u64 = 4096;

/// A file that is written beside its target and then takes the target's place. Dropped before that, it leaves nothing.
pub struct Replacement {
    file: NamedTempFile,
    target: PathBuf,
    /// Dropped behind the file.
    _made: Made,
}

/// Where a replacement goes: what is there, with links followed, and its permissions.
pub(super) struct Place {
    pub(super) target: PathBuf,
    there: Option<Permissions>,
    made: Made,
}

impl Place {
    /// The place of `path`, in a folder that is made where there is none.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
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
        let made = Made::folder(folder_of(&target))?;
        Ok(Self { target, there, made })
    }

    /// Its replacement, in a file that is there already.
    pub(super) fn filled_by(self, file: NamedTempFile) -> io::Result<Replacement> {
        if let Some(permissions) = self.there {
            file.as_file().set_permissions(permissions)?;
        }
        Ok(Replacement { file, target: self.target, _made: self.made })
    }
}

impl Replacement {
    /// The replacement of `path`, whose links are followed, with the permissions of what is there, or else of an
    /// ordinary new file; in a folder that is made where there is none.
    ///
    /// # Errors
    /// Its folder cannot be made; what is there is a device, a pipe, a folder, a link to nothing, or read-only;
    /// whatever the operating system says.
    pub fn of(path: &Path) -> io::Result<Self> {
        let place = Place::of(path)?;
        let file = temporary(folder_of(&place.target))?;
        place.filled_by(file)
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

    /// Puts files that can be made again into their places, once those of before are gone: a program that is killed
    /// meanwhile leaves some of the one set or some of the other, and none beside another's.
    ///
    /// # Errors
    /// Whatever the operating system says; of the file that it says it of.
    pub fn commit_set(files: Vec<Self>) -> Result<(), FileError> {
        files.iter().try_for_each(|file| file.sync().map_err(failed(&file.target)))?;
        for Self { target, .. } in &files {
            match fs::remove_file(target) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(target)(error)),
                _ => {}
            }
        }
        files
            .into_iter()
            .map(|file| (failed(&file.target), file))
            .try_for_each(|(failed, file)| file.commit().map_err(failed))
    }

    /// Puts what was measured once into the target's place, over what is there only where `over` says so, or where that
    /// is empty. Where it cannot be done what was written is kept beside it, and the error says under which name.
    ///
    /// # Errors
    /// Something is there by now; whatever the operating system says.
    pub fn commit_measured(self, over: bool) -> io::Result<()> {
        if !over && !self.target.metadata().is_ok_and(|there| there.is_file() && there.len() == 0) {
            let target = self.target.clone();
            return self.commit_to_free([target]).map(drop);
        }
        if let Err(error) = self.sync() {
            return Err(kept(self.file, &error));
        }
        self.file.persist(self.target).map(drop).map_err(|failed| kept(failed.file, &failed.error))
    }

    /// Keeps the whole lines of what can be written no further, under the name that it has grown under; `None` where
    /// there is none. What cannot be cut is kept as it is.
    ///
    /// # Errors
    /// Whatever the operating system says, and under which name what was written is kept.
    pub fn keep_lines(mut self) -> io::Result<Option<PathBuf>> {
        match self.cut_to_lines() {
            Ok(0) => Ok(None),
            Ok(_) => self.file.keep().map(|(_, path)| Some(path)).map_err(|failed| kept(failed.file, &failed.error)),
            Err(error) => Err(kept(self.file, &error)),
        }
    }

    /// Cuts off what follows the last line feed: a line that could not be written whole. Returns how many
    /// bytes are left.
    ///
    /// # Errors
    /// Whatever the operating system says.
    pub fn cut_to_lines(&mut self) -> io::Result<u64> {
        let file = self.file.as_file_mut();
        let length = file.seek(SeekFrom::End(0))?;
        let start = length.saturating_sub(LONGEST_LINE);
        file.seek(SeekFrom::Start(start))?;
        let mut tail = Vec::new();
        file.read_to_end(&mut tail)?;
        let kept = start + tail.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1) as u64;
        file.set_len(kept)?;
        Ok(kept)
    }

    /// Puts what was written to the first of these paths at which nothing is, in the target's folder, and says which:
    /// for what must never be written over anything, whoever put it there meanwhile. Where that cannot be done what was
    /// written is kept beside them, and the error says under which name.
    ///
    /// # Errors
    /// Something is at each; whatever the operating system says.
    pub fn commit_to_free(self, paths: impl IntoIterator<Item = PathBuf>) -> io::Result<PathBuf> {
        if let Err(error) = self.sync() {
            return Err(kept(self.file, &error));
        }
        let mut file = self.file;
        for path in paths {
            let error = match file.persist_noclobber(&path) {
                Ok(_) => return Ok(path),
                Err(error) => error,
            };
            file = error.file;
            if error.error.kind() == ErrorKind::AlreadyExists {
                continue;
            }
            // Not every file system can rename or link without writing over what is there.
            match copy(file.path(), &path) {
                Ok(()) => return Ok(path),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(kept(file, &error)),
            }
        }
        Err(kept(file, &ErrorKind::AlreadyExists.into()))
    }
}

/// Copies a file to where nothing is; where that fails, nothing is there.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    let mut source = File::open(from)?;
    let mut target = File::create_new(to)?;
    io::copy(&mut source, &mut target).and_then(|_| target.sync_all()).inspect_err(|_| {
        // What is left of it is said by the error that follows.
        let _ = fs::remove_file(to);
    })
}

/// Keeps what was written, under a name that is not swept; the error says which.
fn kept(file: NamedTempFile, why: &io::Error) -> io::Error {
    let random = file.path().file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_prefix(PREFIX));
    // What has no such name grows, and is not swept.
    let name = random.map_or(file.path().to_owned(), |random| file.path().with_file_name(format!("{KEPT}{random}")));
    let (open, path) = match file.keep() {
        Ok(there) => there,
        Err(error) => return io::Error::new(why.kind(), format!("{why}, and what was written is lost: {error}")),
    };
    let path = if !name.exists() && fs::rename(&path, &name).is_ok() { name } else { path };
    // Its lock ends with it: not before its name is one that is not swept.
    drop(open);
    // The folder itself may be gone.
    let said = if path.exists() { format!("kept in {}", path.display()) } else { "lost".to_owned() };
    io::Error::new(why.kind(), format!("{why}; what was written is {said}"))
}

impl Write for Replacement {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Not by the temporary's own, whose errors name it: nobody knows that file.
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_file_mut().flush()
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
        // A sweep by another program may have come before the lock: then the file is gone, or about to go. Where the
        // file system knows no locks nothing is swept either.
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

    #[test]
    fn what_finds_no_place_is_kept_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = Replacement::of(&folder.path().join("log.csv")).unwrap();
        file.write_all(b"1,2\n3,4\n5,").unwrap();
        file.cut_to_lines().unwrap();
        let error = file.commit_to_free([folder.path().join("missing/log.csv")]).unwrap_err().to_string();
        let (_, path) = error.split_once("what was written is kept in ").unwrap();
        // The next program sweeps it no more than a stranger's.
        drop(Replacement::of(&folder.path().join("other.csv")).unwrap());
        assert_eq!(fs::read_to_string(path).unwrap(), "1,2\n3,4\n", "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_copy_writes_over_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["from", "to"].map(|name| folder.path().join(name));
        fs::write(&from, "ours").unwrap();
        copy(&from, &to).unwrap();
        fs::write(&from, "again").unwrap();
        assert_eq!(copy(&from, &to).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read_to_string(&to).unwrap(), "ours");
    }
}
