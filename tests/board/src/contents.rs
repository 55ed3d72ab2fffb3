//! Bank 2 of the flash: what it holds without power, and what an operation leaves in it that power was cut in.

use std::collections::BTreeSet;

use crate::{Garbage, record::FlashKind};

/// Bytes of a bank and of a page.
pub(crate) const BANK: u32 = 256 << 10;
pub(crate) const PAGE: u32 = 2 << 10;

/// The content of bank 2, which survives power.
#[derive(Clone, PartialEq, Eq)]
pub struct Contents {
    words: Vec<u64>,
    /// Double words whose ECC is wrong in two bits or more.
    torn: BTreeSet<u32>,
}

impl Default for Contents {
    fn default() -> Self {
        Self::erased()
    }
}

impl Contents {
    /// Address of the first byte.
    pub const START: u32 = 0x0804_0000;

    /// All bits one.
    #[must_use]
    pub fn erased() -> Self {
        Self { words: vec![u64::MAX; BANK as usize / 8], torn: BTreeSet::new() }
    }

    /// The bytes from `address` on.
    ///
    /// # Panics
    /// If they are not all in bank 2.
    #[must_use]
    pub fn bytes(&self, address: u32, length: usize) -> Vec<u8> {
        let start = (address - Self::START) as usize;
        (start..start + length).map(|at| (self.words[at / 8] >> (8 * (at % 8))) as u8).collect()
    }

    /// Puts `bytes` at `address`, whatever was there, with sound ECC: a test's way, not the firmware's.
    ///
    /// # Panics
    /// If they are not all in bank 2.
    pub fn set(&mut self, address: u32, bytes: &[u8]) {
        for (at, &byte) in ((address - Self::START) as usize..).zip(bytes) {
            let shift = 8 * (at % 8);
            self.words[at / 8] = self.words[at / 8] & !(0xFF << shift) | u64::from(byte) << shift;
            self.torn.remove(&(at as u32 / 8));
        }
    }

    /// Gives the double word at `address` an ECC double error.
    pub fn tear(&mut self, address: u32) {
        self.torn.insert((address - Self::START) / 8);
    }

    pub(crate) fn change(&mut self, operation: Operation) {
        for (index, value) in operation.words() {
            self.words[index as usize] = value;
            self.torn.remove(&index);
        }
    }

    /// The double word with this index, and whether its ECC is sound.
    pub(crate) fn word(&self, index: u32) -> (u64, bool) {
        (self.words[index as usize], !self.torn.contains(&index))
    }

    /// `operation`, cut short.
    pub(crate) fn interrupt(&mut self, operation: Operation, tear: Tear) {
        match tear {
            Tear::Before => {}
            Tear::After => self.change(operation),
            Tear::Midst(seed) => {
                let mut garbage = Garbage::new(seed);
                for (index, target) in operation.words() {
                    let word = &mut self.words[index as usize];
                    // A program always leaves a torn double word; of a page, some are old, some erased, some torn.
                    let fate = if operation.kind() == FlashKind::Program { 2 } else { garbage.word() >> 62 };
                    match fate {
                        0 => {}
                        1 => {
                            *word = target;
                            self.torn.remove(&index);
                        }
                        _ => {
                            // Bits change from the old value to the new, each sooner or later than the others.
                            *word ^= (*word ^ target) & garbage.word();
                            self.torn.insert(index);
                        }
                    }
                }
            }
        }
    }
}

/// What a flash operation leaves if power goes while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tear {
    /// Nothing has changed yet.
    Before,
    /// The operation is complete.
    After,
    /// Something in between, by this seed: a program's double word is torn, an erase's are old, erased or torn.
    Midst(u64),
}

/// What changes the flash.
#[derive(Clone, Copy)]
pub(crate) enum Operation {
    Erase { page: u32 },
    Program { index: u32, value: u64 },
}

impl Operation {
    pub fn kind(self) -> FlashKind {
        match self {
            Self::Erase { .. } => FlashKind::Erase,
            Self::Program { .. } => FlashKind::Program,
        }
    }

    /// The double words it changes and what they become.
    pub fn words(self) -> impl Iterator<Item = (u32, u64)> {
        let (range, value) = match self {
            Self::Erase { page } => (page * PAGE / 8..(page + 1) * PAGE / 8, u64::MAX),
            Self::Program { index, value } => (index..index + 1, value),
        };
        range.map(move |index| (index, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_erase_leaves_some_old_some_erased_and_some_torn() {
        let page = |tear| {
            let mut contents = Contents::erased();
            contents.set(Contents::START + 127 * PAGE, &[0; PAGE as usize]);
            let erase = Operation::Erase { page: 127 };
            contents.interrupt(erase, tear);
            erase.words().fold([0; 3], |[old, erased, torn], (index, _)| match contents.word(index) {
                (_, false) => [old, erased, torn + 1],
                (0, true) => [old + 1, erased, torn],
                (u64::MAX, true) => [old, erased + 1, torn],
                other => panic!("{other:x?}"),
            })
        };
        assert_eq!(page(Tear::Before), [256, 0, 0]);
        assert_eq!(page(Tear::After), [0, 256, 0]);
        for seed in 0..20 {
            let counts = page(Tear::Midst(seed));
            assert!(counts.iter().sum::<u32>() == 256 && counts.iter().all(|&n| n > 20), "{seed}: {counts:?}");
        }
    }

    #[test]
    fn bytes_are_little_endian_and_setting_them_mends_the_double_word() {
        let mut contents = Contents::erased();
        let (index, at) = (PAGE / 8, Contents::START + PAGE);
        contents.tear(at);
        assert!(!contents.word(index).1);
        contents.set(at + 6, &[1, 2, 3]);
        assert_eq!(contents.word(index), (0x0201_FFFF_FFFF_FFFF, true));
        assert_eq!(contents.bytes(at + 5, 5), [0xFF, 1, 2, 3, 0xFF]);
    }
}
