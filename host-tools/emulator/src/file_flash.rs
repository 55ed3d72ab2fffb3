//! Flash that outlives its device: in memory, and each change of it in a file at once, so that whatever ends the
//! program leaves there what a power cut would leave in a chip.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use parameter_store::{RamFlash, RamFlashError};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A flash in a file.
#[derive(Debug)]
pub struct FileFlash {
    memory: RamFlash<Vec<u8>>,
    file: File,
}

/// The file is none that can be a flash.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be the emulated device's flash", path.display())]
pub struct FileFlashError {
    path: PathBuf,
    source: io::Error,
}

impl FileFlash {
    /// The flash that a file holds; where there is none, or nothing in it, one with this in it.
    ///
    /// # Errors
    /// The file cannot be read or written, is of another length, or is another device's flash now.
    pub fn open(path: &Path, new: &[u8]) -> Result<Self, FileFlashError> {
        let open = || {
            // A pipe would be waited for, and some devices never end.
            if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
                return Err(io::Error::new(ErrorKind::InvalidData, "it is no regular file"));
            }
            let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
            // Where a file system knows no locks, nobody is kept from it.
            if let Err(TryLockError::WouldBlock) = file.try_lock() {
                return Err(io::Error::new(ErrorKind::ResourceBusy, "another emulated device has it as its flash"));
            }
            let mut held = Vec::new();
            match file.metadata()?.len() {
                0 => {
                    file.write_all(new)?;
                    held.extend_from_slice(new);
                }
                length if length == new.len() as u64 => _ = file.read_to_end(&mut held)?,
                length => {
                    let why = format!("it has {length} bytes, the device's flash has {}", new.len());
                    return Err(io::Error::new(ErrorKind::InvalidData, why));
                }
            }
            Ok(Self { memory: RamFlash::new(held), file })
        };
        open().map_err(|source| FileFlashError { path: path.to_owned(), source })
    }

    fn keep(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let kept = self.file.seek(SeekFrom::Start(offset.into())).and_then(|_| self.file.write_all(bytes));
        kept.map_err(|_| FlashError::File)
    }
}

/// What the flash refuses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlashError {
    /// The rules of flash forbid it.
    Rules(RamFlashError),
    /// The file cannot be written.
    File,
}

impl From<RamFlashError> for FlashError {
    fn from(error: RamFlashError) -> Self {
        Self::Rules(error)
    }
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Rules(error) => error.kind(),
            Self::File => NorFlashErrorKind::Other,
        }
    }
}

impl ErrorType for FileFlash {
    type Error = FlashError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = RamFlash::<Vec<u8>>::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        Ok(self.memory.read(offset, bytes).await?)
    }

    fn capacity(&self) -> usize {
        self.memory.capacity()
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = RamFlash::<Vec<u8>>::WRITE_SIZE;
    const ERASE_SIZE: usize = RamFlash::<Vec<u8>>::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        self.memory.erase(from, to).await?;
        self.keep(from, &vec![0xFF; to.saturating_sub(from) as usize])
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        self.memory.write(offset, bytes).await?;
        self.keep(offset, bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::block_on;

    #[test]
    fn what_was_written_is_there_for_the_next_device_and_another_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flash.bin");
        let new = vec![0xFF; 4096];
        let mut flash = FileFlash::open(&path, &new).unwrap();
        block_on(async {
            flash.write(2048, &[1; 16]).await.unwrap();
            flash.write(0, &[2; 8]).await.unwrap();
            flash.erase(0, 2048).await.unwrap();
            assert_eq!(flash.write(2048, &[3; 8]).await, Err(FlashError::Rules(RamFlashError::NotErased)));
        });
        let shared = FileFlash::open(&path, &new).unwrap_err();
        assert!(shared.source.to_string().contains("another emulated device"), "{shared:?}");
        drop(flash);
        let mut flash = FileFlash::open(&path, &new).unwrap();
        let mut held = vec![0; 4096];
        block_on(flash.read(0, &mut held)).unwrap();
        let mut expected = new.clone();
        expected[2048..2064].fill(1);
        drop(flash);
        assert!(held == expected && std::fs::read(&path).unwrap() == expected);
        std::fs::write(&path, "short").unwrap();
        let refused = FileFlash::open(&path, &new).unwrap_err();
        assert!(refused.to_string().contains("flash.bin") && refused.source.to_string().contains("5 bytes"));
    }
}
