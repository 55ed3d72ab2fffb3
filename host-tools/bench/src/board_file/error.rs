//! Why a board's file is not taken.

use protocol::Uid;
use std::path::PathBuf;

/// A file was measured on one board, and another one is connected.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("it was measured on the board {of}, and this is {}: a calibration belongs to its board", match this {
    Some(this) => format!("the board {this}"),
    None => "a board that states no UID".to_owned(),
})]
pub struct AnotherBoard {
    /// Whose calibration it is.
    pub of: Uid,
    /// The one that is connected, where it says so.
    pub this: Option<Uid>,
}

/// Why a file says nothing of a board.
#[derive(Debug, thiserror::Error)]
pub enum BoardFileError {
    /// It cannot be read.
    #[error("{}: cannot be read ({error})", path.display())]
    Unreadable {
        /// The board.toml that was named.
        path: PathBuf,
        /// What the operating system says.
        error: std::io::Error,
    },
    /// It says something else.
    #[error("{}: is no board.toml: {}", path.display(), error.to_string().trim_end())]
    Wrong {
        /// The board.toml that was named.
        path: PathBuf,
        /// Where, and what is wrong there.
        error: Box<toml::de::Error>,
    },
    /// It cannot be edited.
    #[error("{}: cannot be edited: {error}", path.display())]
    Edit {
        /// The board.toml that was named.
        path: PathBuf,
        /// Where, and what is wrong there.
        error: toml_edit::TomlError,
    },
    /// A value cannot be.
    #[error("{}: {}{field} = {value}: {rule}", path.display(), line.map_or(String::new(), |line| format!("line {line}: ")))]
    Value {
        /// The board.toml that was named.
        path: PathBuf,
        /// Where, where that is found.
        line: Option<usize>,
        /// What it is the value of.
        field: &'static str,
        /// As it stands there.
        value: String,
        /// What it would have to be.
        rule: &'static str,
    },
}
