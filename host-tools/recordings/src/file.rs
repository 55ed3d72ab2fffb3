//! Writing results: beside the target first, then renamed, so that nothing is ever half-written.

use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file or a folder that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be written.
    #[error("{}: cannot be written", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The folder cannot be created.
    #[error("{}: cannot create the folder", path.display())]
    Folder {
        /// The folder that was to be created.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
}

/// Writes a file whole or not at all.
///
/// # Errors
/// [`FileError::Write`], and the file is as it was.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), FileError> {
    let attempt = || -> std::io::Result<()> {
        let mut file = beside(path)?;
        file.write_all(contents.as_ref())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    attempt().map_err(|source| FileError::Write { path: path.to_owned(), source })
}

/// A temporary file in the folder of `path`, with the permissions of an ordinary new file, to be renamed to `path`.
///
/// # Errors
/// Whatever the operating system says.
pub fn beside(path: &Path) -> std::io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".piezo-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Creates a folder and those above it.
///
/// # Errors
/// [`FileError::Folder`].
pub fn folder(path: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(path).map_err(|source| FileError::Folder { path: path.to_owned(), source })
}
