//! Why a result was not written.

use std::io;
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
    /// Another program writes the file.
    #[error("{}: another program is recording into it", path.display())]
    Growing {
        /// The file as it is called meanwhile.
        path: PathBuf,
    },
    /// A program that was killed, or could write no further, has left what it had.
    #[error("{}: holds what an earlier recording has left, a log as far as it goes", path.display())]
    Left {
        /// The file as it is called.
        path: PathBuf,
    },
    /// Another program holds the folder.
    #[error("{}: another program is writing its results into this folder", path.display())]
    Busy {
        /// The folder that was to be written into.
        path: PathBuf,
    },
}

/// That a file cannot be written, for this reason.
pub(super) fn failed(path: &Path) -> impl Fn(io::Error) -> FileError + use<> {
    let path = path.to_owned();
    move |source| FileError::Write { path: path.clone(), source }
}
