//! Writing results: beside the target first, then renamed, so that nothing is ever half-written.

use anyhow::{Context, Result, bail};
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file whole or not at all.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<()> {
    let attempt = || -> std::io::Result<()> {
        let mut file = beside(path)?;
        file.write_all(contents.as_ref())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    attempt().with_context(|| format!("{}: cannot be written", path.display()))
}

/// A temporary file in the folder of `path`, with the permissions of an ordinary new file, to be renamed to `path`.
pub fn beside(path: &Path) -> std::io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".piezo-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

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

/// Creates a folder and those above it.
pub fn folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path).with_context(|| format!("{}: cannot create the folder", path.display()))
}

/// Writes bytes to standard output, all of them unless its reader has gone.
pub fn standard(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}
