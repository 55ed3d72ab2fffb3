//! Where a verb's results go: never over what it reads, and to standard output for as long as somebody reads there.

use anyhow::{Context, Result, bail, ensure};
pub use recordings::file::{Replacement, folder, write};
use std::io::Write;
use std::path::Path;

/// Refuses to write over what is read.
pub fn not_over(path: &Path, inputs: &[&Path]) -> Result<()> {
    let same =
        |input: &&&Path| path.canonicalize().is_ok_and(|path| input.canonicalize().is_ok_and(|input| path == input));
    match inputs.iter().find(same) {
        Some(input) => {
            bail!("{}: --out would overwrite {}, which is read: name another file", path.display(), input.display())
        }
        None => Ok(()),
    }
}

/// Refuses a folder for results that is a file, or that cannot be written: before a search of minutes, not after it.
pub fn to_folder(path: &Path) -> Result<()> {
    ensure!(!path.exists() || path.is_dir(), "{}: is a file, --out names a folder", path.display());
    Ok(recordings::file::writable(path)?)
}

/// Writes bytes to standard output, all of them unless its reader has gone.
pub fn standard(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}
