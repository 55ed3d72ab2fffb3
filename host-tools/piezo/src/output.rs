//! Where a verb's results go: never over what it reads, and to standard output for as long as somebody reads there.

use crate::option::Overwrite;
use anyhow::{Context, Result, ensure};
use result_files::may_be_replaced;
pub use result_files::{Held, Replacement, write};
use std::io::Write;
use std::path::Path;
pub use table_files::{FACES, RECORD};

/// What a page of this program has near its beginning.
pub const PAGE: &str = "<meta name=\"generator\" content=\"piezo\">";
/// What a picture of this program has near its beginning.
pub const PICTURE: &str = "class=\"figure\" role=\"img\"";
impl Overwrite {
    /// Refuses to write over a file that does not say near its beginning that it is a former result of the kind.
    pub fn of(self, path: &Path, known_by: &str) -> Result<()> {
        let free = || may_be_replaced(path, known_by).with_context(|| format!("{}: cannot be read", path.display()));
        ensure!(
            self.force || free()?,
            "{}: is there already, and no former result of this kind: name another file or folder, or lose it with --force",
            path.display()
        );
        Ok(())
    }

    /// The same, and refuses a folder in the file's place, and to write over what is read.
    pub fn of_inputs<P: AsRef<Path>>(self, path: &Path, by: &str, inputs: impl IntoIterator<Item = P>) -> Result<()> {
        not_over(path, inputs)?;
        self.of(path, by)
    }

    /// Refuses to write over what was measured once: nobody can measure it again.
    pub fn of_measurement(self, path: &Path) -> Result<()> {
        let free = self.force || !path.metadata().is_ok_and(|of| of.is_file() && of.len() > 0);
        free.then_some(()).with_context(|| remedy::kept(path))
    }

    /// The log that grows beside this one, not over what is read, and over what was measured once only where
    /// that was meant.
    pub fn growing(self, path: &Path, inputs: &[&Path]) -> Result<Replacement> {
        not_over(path, inputs)?;
        // What a killed run left is named first: nobody knows of it.
        let file = Replacement::growing(path)?;
        self.of_measurement(path)?;
        Ok(file)
    }

    /// Puts such a log into its place.
    pub fn grown(self, path: &Path, file: Replacement) -> Result<()> {
        file.commit_measured(self.force).with_context(|| format!("{}: cannot be written", path.display()))
    }
}

/// Refuses a folder in a file's place, and to write over what is read.
fn not_over<P: AsRef<Path>>(path: &Path, inputs: impl IntoIterator<Item = P>) -> Result<()> {
    ensure!(!path.is_dir(), "{}: is a folder, --out names a file", path.display());
    for input in inputs {
        let input = input.as_ref();
        let same = path.canonicalize().is_ok_and(|path| input.canonicalize().is_ok_and(|input| path == input));
        ensure!(
            !same,
            "{}: --out would overwrite {}, which is read: name another file",
            path.display(),
            input.display()
        );
    }
    Ok(())
}

/// Holds a folder for results, made where there is none, until what comes is written; refuses one that is a file, that
/// cannot be written, or that another run holds: before a search of minutes, not after it.
pub fn to_folder(path: &Path) -> Result<Held> {
    ensure!(!path.exists() || path.is_dir(), "{}: is a file, --out names a folder", path.display());
    Ok(Held::of(path)?)
}

/// Writes bytes to standard output, all of them unless its reader has gone: `false` where it has.
pub fn standard(bytes: &[u8]) -> Result<bool> {
    let mut stdout = std::io::stdout();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error).context("standard output"),
        written => Ok(written.is_ok()),
    }
}
