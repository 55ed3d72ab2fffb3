//! Why a folder says nothing of a unit.

use std::io;
use std::path::PathBuf;

/// What is wrong with a unit's file, or with its name.
#[derive(Debug, thiserror::Error)]
pub enum UnitError {
    /// The folder holds no `unit.json`.
    #[error("{}: has no unit.json", folder.display())]
    Missing {
        /// The folder that was to hold it.
        folder: PathBuf,
    },
    /// It cannot be read.
    #[error("{}: cannot be read ({error})", path.display())]
    Unreadable {
        /// The file, or the folder that was to hold it.
        path: PathBuf,
        /// What the operating system says, or that it is no regular file, or too large.
        error: io::Error,
    },
    /// It holds something else.
    #[error("{}: is no unit.json ({error})", path.display())]
    NoUnit {
        /// Path of the unit.json.
        path: PathBuf,
        /// Where in it, and why.
        error: serde_json::Error,
    },
    /// Its format is of another version.
    #[error("{}: is a unit.json of version {version}, and this program reads version {read}", path.display())]
    Version {
        /// Path of the unit.json.
        path: PathBuf,
        /// The version that it states of its format.
        version: u64,
        /// The version that is read.
        read: u64,
    },
    /// The program that runs cannot be told from another.
    #[error("{}: cannot be read ({error}), so whether a result is this program's is not known", path.display())]
    Program {
        /// The program's own file.
        path: PathBuf,
        /// What the operating system says.
        error: io::Error,
    },
    /// A name that is none.
    #[error(
        "`{name}` is no unit's name: it is at most {longest} characters long, none of them a control character, and begins with none of \
         `- = + @`"
    )]
    Name {
        /// The text that was given as a unit's name.
        name: String,
        /// Characters that it may have.
        longest: usize,
    },
}
