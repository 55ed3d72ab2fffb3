//! Writing results: beside the target first, then renamed, so that nothing is ever half-written.

mod held;
mod made;
mod replacement;

pub use held::Held;
pub use replacement::Replacement;

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// A file or a folder that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be written.
    #[error("{}: cannot be written", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The folder cannot be created.
    #[error("{}: cannot create the folder", path.display())]
    Folder {
        /// The folder that was to be created.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// Another program holds the folder.
    #[error("{}: another program is writing its results into this folder", path.display())]
    Busy {
        /// The folder that was to be written into.
        path: PathBuf,
    },
}

/// Reads a regular file of no more than so many bytes: no pipe that nobody writes into, no device without an end.
///
/// # Errors
/// It is no regular file ([`io::ErrorKind::InvalidInput`]), or longer ([`io::ErrorKind::FileTooLarge`]); whatever the operating
/// system says.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let refused = |kind, what: String| Err(io::Error::new(kind, what));
    let found = std::fs::metadata(path)?;
    if found.is_dir() {
        return refused(io::ErrorKind::IsADirectory, "it is a folder".to_owned());
    }
    if !found.is_file() {
        return refused(io::ErrorKind::InvalidInput, "it is no regular file".to_owned());
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return refused(io::ErrorKind::FileTooLarge, format!("it is longer than {most} bytes"));
    }
    Ok(bytes)
}

/// The same of text.
///
/// # Errors
/// Besides, it is not text ([`io::ErrorKind::InvalidData`]).
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not text"))
}

/// Where a result says by then what it is, bytes.
const NEAR: u64 = 512;

/// Whether nothing is lost where a result is written here: nothing is there, or an empty file, or one that says near its beginning
/// that it is a former result of the kind. What is no regular file is refused when it comes to writing.
///
/// # Errors
/// It cannot be read.
pub fn may_be_replaced(path: &Path, known_by: &str) -> io::Result<bool> {
    if !path.is_file() {
        return Ok(true);
    }
    let mut start = Vec::new();
    std::fs::File::open(path)?.take(NEAR).read_to_end(&mut start)?;
    Ok(start.is_empty() || String::from_utf8_lossy(&start).contains(known_by))
}

/// Writes a file whole or not at all.
///
/// # Errors
/// [`FileError::Write`], and the file is as it was.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), FileError> {
    write_all([(path.to_owned(), contents)])
}

/// Writes files that belong together: each whole before the first takes its place, so that what fails while they are
/// written leaves all as they were. A program that is killed between the renames can still mix them, and two at once where
/// none of them holds the folder ([`Held`]): let the files say what they belong to.
///
/// # Errors
/// [`FileError::Write`], of the file that cannot be written.
pub fn write_all(files: impl IntoIterator<Item = (PathBuf, impl AsRef<[u8]>)>) -> Result<(), FileError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| FileError::Write { path, source }
    };
    let mut written = Vec::new();
    for (path, contents) in files {
        let attempt = || -> io::Result<Replacement> {
            let mut file = Replacement::of(&path)?;
            file.write_all(contents.as_ref())?;
            file.sync()?;
            Ok(file)
        };
        let file = attempt().map_err(failed(&path))?;
        written.push((path, file));
    }
    written.into_iter().try_for_each(|(path, file)| file.commit().map_err(failed(&path)))
}

/// Whether something can be written into a folder that may not exist yet; to be asked before a search of minutes.
///
/// # Errors
/// [`FileError::Folder`], and nothing was created.
pub fn writable(folder: &Path) -> Result<(), FileError> {
    let there = folder.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    replacement::temporary(there).map(drop).map_err(|source| FileError::Folder { path: folder.to_owned(), source })
}

/// Creates a folder and those above it.
///
/// # Errors
/// [`FileError::Folder`].
pub fn folder(path: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(path).map_err(|source| FileError::Folder { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_that_belong_together_are_written_all_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "old").unwrap();
        fs::create_dir(at("b")).unwrap();
        let FileError::Write { path, .. } = write_all([(at("a"), "new"), (at("b"), "new")]).unwrap_err() else {
            panic!()
        };
        assert_eq!(path, at("b"));
        assert_eq!(fs::read_to_string(at("a")).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a", "b"]);
        write_all([(at("a"), "new"), (at("c"), "new")]).unwrap();
        assert_eq!(fs::read_to_string(at("a")).unwrap(), "new");
        assert_eq!(names(folder.path()), ["a", "b", "c"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("real"), "old").unwrap();
        // Wider than a new file's.
        fs::set_permissions(at("real"), fs::Permissions::from_mode(0o666)).unwrap();
        symlink(at("real"), at("link")).unwrap();
        write(&at("link"), "new").unwrap();
        assert!(at("link").is_symlink());
        assert_eq!(fs::read_to_string(at("real")).unwrap(), "new");
        assert_eq!(fs::metadata(at("real")).unwrap().permissions().mode() & 0o777, 0o666);
    }

    /// Even where the operating system would allow it, as to the superuser.
    #[cfg(unix)]
    #[test]
    fn what_would_be_lost_is_refused_and_stays() {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("locked"), "old").unwrap();
        fs::set_permissions(at("locked"), fs::Permissions::from_mode(0o444)).unwrap();
        symlink(at("nowhere"), at("dangling")).unwrap();
        symlink("/dev/null", at("device")).unwrap();
        for name in ["locked", "dangling", "device"] {
            assert!(matches!(write(&at(name), "new"), Err(FileError::Write { .. })), "{name}");
        }
        assert_eq!(fs::read_to_string(at("locked")).unwrap(), "old");
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        assert_eq!(names(folder.path()), ["dangling", "device", "locked"]);
    }

    #[test]
    fn only_what_is_known_as_a_former_result_may_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("ours"), "# A result\n1.0").unwrap();
        fs::write(at("empty"), "").unwrap();
        fs::write(at("strange"), "wages").unwrap();
        fs::write(at("late"), format!("{}# A result", " ".repeat(512))).unwrap();
        let may = ["ours", "empty", "missing", "strange", "late"]
            .map(|name| may_be_replaced(&at(name), "# A result").unwrap());
        assert_eq!(may, [true, true, true, false, false]);
    }

    #[test]
    fn a_folder_is_tried_before_it_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("not/yet");
        writable(&deep).unwrap();
        assert!(names(folder.path()).is_empty());
        fs::write(folder.path().join("not"), "a file").unwrap();
        assert!(matches!(writable(&deep), Err(FileError::Folder { .. })));
    }
}
