//! Folders that are made for results.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folders that were made, the deepest first. Those that are empty go when this is dropped.
#[derive(Debug)]
pub struct Made(Vec<PathBuf>);

impl Made {
    /// Makes a folder and those above it.
    ///
    /// # Errors
    /// Whatever the operating system says.
    pub fn folder(path: &Path) -> io::Result<Self> {
        let missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = path.ancestors().take_while(missing).map(Path::to_owned).collect();
        fs::create_dir_all(path)?;
        Ok(Self(made))
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        // One that holds something is not removed.
        self.0.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}
