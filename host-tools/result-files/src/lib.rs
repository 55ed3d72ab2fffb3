//! Writing results: beside the target first, then renamed, so that nothing is ever half-written.

mod error;
mod growing;
mod held;
mod made;
mod replacement;

pub use error::FileError;
pub use growing::partial;
pub use held::{Held, is_held};
pub use replacement::Replacement;

use error::failed;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Reads a regular file of no more than so many bytes: no pipe that nobody writes into, no device without an end.
///
/// # Errors
/// It is no regular file ([`io::ErrorKind::InvalidInput`]), or longer ([`io::ErrorKind::FileTooLarge`]); whatever the
/// operating system says.
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

/// Whether nothing is lost where a result is written here: nothing is there, or an empty file, or one that says near
/// its beginning that it is a former result of the kind. What is no regular file is refused when it comes to writing.
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
/// written leaves all as they were. A program that is killed between the renames can still mix them, and two at once
/// where none of them holds the folder ([`Held`]): let the files say what they belong to.
///
/// # Errors
/// [`FileError::Write`], of the file that cannot be written.
pub fn write_all(files: impl IntoIterator<Item = (PathBuf, impl AsRef<[u8]>)>) -> Result<(), FileError> {
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
