//! A flash that says whether it is being read now: a board whose flash raises a non-maskable interrupt at a word that a
//! power cut has left half-written asks so whether it was the parameter store's, rather than a register that the cut
//! may have corrupted as well.

use core::sync::atomic::{AtomicBool, Ordering::SeqCst, fence};
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// A flash whose reads are known.
pub struct MarkedReads<F> {
    flash: F,
    reading: &'static AtomicBool,
}

impl<F> MarkedReads<F> {
    /// The flash; `reading` is set while it is read.
    pub fn new(flash: F, reading: &'static AtomicBool) -> Self {
        Self { flash, reading }
    }
}

impl<F: ErrorType> ErrorType for MarkedReads<F> {
    type Error = F::Error;
}

impl<F: ReadNorFlash> ReadNorFlash for MarkedReads<F> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.reading.store(true, SeqCst);
        let read = self.flash.read(offset, bytes).await;
        // The loads are over, and so is what they raise.
        fence(SeqCst);
        self.reading.store(false, SeqCst);
        read
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> NorFlash for MarkedReads<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.flash.erase(from, to).await
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.flash.write(offset, bytes).await
    }
}
