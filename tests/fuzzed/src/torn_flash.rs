//! Flash as the STM32G474 has it, whose power fails in any operation: each bit of what it was at is then the old one
//! or the new.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cell::RefCell;

/// Bytes that are erased together, and that are written together.
pub const PAGE: usize = 2048;
const WORD: usize = 8;

/// When the power fails, and what that leaves.
#[derive(Clone, Copy, Debug, arbitrary::Arbitrary)]
pub struct Cut {
    /// Operations that are done before: an erased page is one, and so is a written word.
    pub after: u8,
    /// How far the operation comes in which it fails: of 255.
    progress: u8,
    seed: u32,
}

/// The memory of both pages, and the power that it has.
pub struct Chip {
    pub memory: [u8; 2 * PAGE],
    cut: Option<Cut>,
    dark: bool,
    /// Pages that were erased whole since the last cut was set.
    pub erased: [bool; 2],
}

/// The pages as a flash, which others look at meanwhile.
pub struct Flash<'c>(pub &'c RefCell<Chip>);

#[derive(Debug)]
pub struct PowerLost;

impl NorFlashError for PowerLost {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Chip {
    pub fn new() -> RefCell<Self> {
        RefCell::new(Self { memory: [0xFF; 2 * PAGE], cut: None, dark: false, erased: [false; 2] })
    }

    /// Has the power fail; `None` for never.
    pub fn cut(&mut self, cut: Option<Cut>) {
        self.cut = cut;
        self.dark = false;
        self.erased = [false; 2];
    }

    /// Whether it has failed.
    pub fn dark(&self) -> bool {
        self.dark
    }

    /// Brings a place to `new`, or part of the way there.
    fn operate(&mut self, start: usize, new: &[u8]) -> Result<(), PowerLost> {
        if self.dark {
            return Err(PowerLost);
        }
        let place = &mut self.memory[start..start + new.len()];
        match &mut self.cut {
            Some(Cut { after: 0, progress, seed }) => {
                let mut tears = ChaCha8Rng::seed_from_u64((*seed).into());
                for (cell, new) in place.iter_mut().zip(new) {
                    let done = match *progress {
                        0 => 0,
                        255 => 255,
                        some => (0..8).map(|bit| u8::from(tears.random::<u8>() < some) << bit).sum(),
                    };
                    *cell = (*cell & !done) | (new & done);
                }
                self.dark = true;
                return Err(PowerLost);
            }
            Some(Cut { after, .. }) => *after -= 1,
            None => {}
        }
        place.copy_from_slice(new);
        Ok(())
    }
}

impl ErrorType for Flash<'_> {
    type Error = PowerLost;
}

impl ReadNorFlash for Flash<'_> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
        let chip = self.0.borrow();
        if chip.dark {
            return Err(PowerLost);
        }
        let start = offset as usize;
        bytes.copy_from_slice(&chip.memory[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.borrow().memory.len()
    }
}

impl NorFlash for Flash<'_> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerLost> {
        (from as usize..to as usize).step_by(PAGE).try_for_each(|start| {
            let mut chip = self.0.borrow_mut();
            chip.operate(start, &[0xFF; PAGE])?;
            chip.erased[start / PAGE] = true;
            Ok(())
        })
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerLost> {
        bytes.chunks(WORD).zip((offset as usize..).step_by(WORD)).try_for_each(|(word, start)| {
            let mut chip = self.0.borrow_mut();
            let blank = chip.memory[start..start + WORD] == [0xFF; WORD];
            // Zeros may be written over anything.
            assert!(blank || word == [0; WORD], "the word at {start:#x} is written twice");
            chip.operate(start, word)
        })
    }
}
