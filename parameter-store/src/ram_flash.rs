//! Memory that obeys the rules of the STM32G474's flash: pages of 2 KiB, double words written once between erases.
//!
//! For the emulated board, for making a page image on the host, and for tests.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

/// Bytes that are erased together.
pub const PAGE: usize = 2048;
/// Bytes that are written together.
pub const WORD: usize = 8;

/// Flash in memory, its own (`Vec<u8>`) or another's (`&mut [u8]`).
#[derive(Clone, Debug)]
pub struct RamFlash<M> {
    memory: M,
}

impl<M: AsRef<[u8]> + AsMut<[u8]>> RamFlash<M> {
    /// Takes memory as flash, with what is in it. Erased flash is all 0xFF.
    pub fn new(memory: M) -> Self {
        Self { memory }
    }
}

/// What flash in memory refuses, as a chip's does: nothing is changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RamFlashError {
    /// A read, write or erase that reaches beyond the end of the memory.
    OutOfBounds,
    /// Not a whole word or page.
    NotAligned,
    /// A word that is not erased.
    NotErased,
}

impl NorFlashError for RamFlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::NotErased => NorFlashErrorKind::Other,
        }
    }
}

impl<M> ErrorType for RamFlash<M> {
    type Error = RamFlashError;
}

impl<M: AsRef<[u8]>> ReadNorFlash for RamFlash<M> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), RamFlashError> {
        let start = offset as usize;
        let stored =
            self.memory.as_ref().get(start..start.saturating_add(bytes.len())).ok_or(RamFlashError::OutOfBounds)?;
        bytes.copy_from_slice(stored);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.memory.as_ref().len()
    }
}

impl<M: AsRef<[u8]> + AsMut<[u8]>> NorFlash for RamFlash<M> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), RamFlashError> {
        let (from, to) = (from as usize, to as usize);
        if !from.is_multiple_of(PAGE) || !to.is_multiple_of(PAGE) {
            return Err(RamFlashError::NotAligned);
        }
        self.memory.as_mut().get_mut(from..to).ok_or(RamFlashError::OutOfBounds)?.fill(0xFF);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), RamFlashError> {
        let start = offset as usize;
        if !start.is_multiple_of(WORD) || !bytes.len().is_multiple_of(WORD) {
            return Err(RamFlashError::NotAligned);
        }
        let place =
            self.memory.as_mut().get_mut(start..start.saturating_add(bytes.len())).ok_or(RamFlashError::OutOfBounds)?;
        for (word, new) in place.chunks_exact_mut(WORD).zip(bytes.chunks_exact(WORD)) {
            // As on the chip: a written word may only be cleared to all zeros.
            if word.iter().any(|&byte| byte != 0xFF) && new.iter().any(|&byte| byte != 0) {
                return Err(RamFlashError::NotErased);
            }
            word.copy_from_slice(new);
        }
        Ok(())
    }
}
