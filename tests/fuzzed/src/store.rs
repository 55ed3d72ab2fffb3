//! Writes, erases, cuts of the power and flipped bits, in any order: the store gives the record that was written last,
//! and never one that was not written.

use crate::torn_flash::{Chip, Cut, Flash, PAGE};
use arbitrary::{Arbitrary, Unstructured};
use embassy_futures::block_on;
use parameter_store::{MAX_RECORD, ParameterStore, StoreError};
use std::cell::RefCell;

/// Most steps of an input, so that each is quick.
const STEPS: usize = 40;

#[derive(Debug, Arbitrary)]
enum Step {
    Store { length: u16, fill: u8, cut: Option<Cut> },
    Erase { cut: Option<Cut> },
    Flip { at: u16, bit: u8 },
}

/// What the flash may give, by all that has happened to it.
struct Known {
    /// How many records were handed to the store.
    written: usize,
    /// The one that it gives.
    newest: Option<Vec<u8>>,
    /// The one that it gave when something was last written or erased: a bit that flips back may bring an older
    /// one to light.
    last: Option<Vec<u8>>,
    /// Pages with more in them than whole writes and erases have left: one more flipped bit may make a
    /// record whole again.
    doubtful: [bool; 2],
    /// The record that was written into each page, or begun, since it was last erased whole.
    held: [Option<Vec<u8>>; 2],
    /// Pages in which a bit has flipped by itself since then.
    decayed: [bool; 2],
}

/// Bytes as steps.
///
/// # Panics
/// The store gives what it should not, or fails where nothing keeps it from working.
pub fn check(bytes: &[u8]) {
    let mut input = Unstructured::new(bytes);
    let chip = Chip::new();
    let mut known =
        Known { written: 0, newest: None, last: None, doubtful: [false; 2], held: [None, None], decayed: [false; 2] };
    for _ in 0..STEPS {
        if input.is_empty() {
            break;
        }
        let Ok(step) = Step::arbitrary(&mut input) else { return };
        match step {
            Step::Store { length, fill, cut } => known.store(&chip, length, fill, cut),
            Step::Erase { cut } => known.erase(&chip, cut),
            Step::Flip { at, bit } => known.flip(&chip, at, bit),
        }
    }
}

fn store(chip: &RefCell<Chip>) -> ParameterStore<Flash<'_>> {
    ParameterStore::new(Flash(chip), 0..2 * PAGE as u32).expect("the pages fit")
}

/// The newest record; `None` where there is none, or none that is whole.
fn load(chip: &RefCell<Chip>) -> Option<Vec<u8>> {
    match block_on(store(chip).load()) {
        Ok(record) => record.map(<[u8]>::to_vec),
        Err(error) => {
            assert!(matches!(error, StoreError::Damaged | StoreError::NewestLost), "{error}");
            None
        }
    }
}

impl Known {
    fn store(&mut self, chip: &RefCell<Chip>, length: u16, fill: u8, cut: Option<Cut>) {
        let mut record = vec![fill; usize::from(length) % (MAX_RECORD + 1)];
        // No two are equal, but for those too short to say which they are.
        let number = self.written.to_le_bytes();
        record.iter_mut().zip(number).for_each(|(byte, of)| *byte ^= of);
        self.written += 1;
        let before = chip.borrow().memory;
        chip.borrow_mut().cut(cut);
        let done = block_on(store(chip).store(&record));
        let dark = chip.borrow().dark();
        self.forget(chip, Some(&record));
        chip.borrow_mut().cut(None);
        assert_eq!(done.is_ok(), !dark, "{done:?}");
        let found = load(chip);
        let old_or_new = if dark {
            found == self.newest || found.as_ref() == Some(&record) || self.mended(found.as_ref())
        } else {
            found == Some(record)
        };
        assert!(old_or_new, "after a write: {found:?}");
        for (page, doubtful) in self.doubtful.iter_mut().enumerate() {
            let bytes = page * PAGE..(page + 1) * PAGE;
            if before[bytes.clone()] != chip.borrow().memory[bytes] {
                *doubtful = dark;
            }
        }
        self.last.clone_from(&found);
        self.newest = found;
    }

    fn erase(&mut self, chip: &RefCell<Chip>, cut: Option<Cut>) {
        chip.borrow_mut().cut(cut);
        let done = block_on(store(chip).erase());
        let dark = chip.borrow().dark();
        self.forget(chip, None);
        chip.borrow_mut().cut(None);
        assert_eq!(done.is_ok(), !dark, "{done:?}");
        let found = load(chip);
        let old = found == self.newest || self.mended(found.as_ref());
        assert!(found.is_none() || dark && old, "after an erase: {found:?}");
        self.doubtful = [dark; 2];
        self.last.clone_from(&found);
        self.newest = found;
    }

    /// Forgets what the pages held that were erased whole; this record was then written, or begun.
    fn forget(&mut self, chip: &RefCell<Chip>, written: Option<&Vec<u8>>) {
        for page in (0..2).filter(|&page| chip.borrow().erased[page]) {
            (self.held[page], self.decayed[page]) = (written.cloned(), false);
        }
    }

    /// Whether a record may have come back: an erase that is cut may set the very bits again by which its
    /// page had decayed.
    fn mended(&self, found: Option<&Vec<u8>>) -> bool {
        found.is_some() && (0..2).any(|page| self.decayed[page] && self.held[page].as_ref() == found)
    }

    fn flip(&mut self, chip: &RefCell<Chip>, at: u16, bit: u8) {
        let at = usize::from(at) % (2 * PAGE);
        let page = at / PAGE;
        let holds = |record: &Vec<u8>| chip.borrow().memory[page * PAGE + 8..].starts_with(record);
        let elsewhere = self.newest.as_ref().is_some_and(|newest| !holds(newest));
        chip.borrow_mut().memory[at] ^= 1 << (bit % 8);
        let found = load(chip);
        assert!(found.is_none() || self.held.contains(&found), "in no page: {found:?}");
        let untouched = elsewhere && self.newest == self.last && !self.doubtful[page];
        assert!(!untouched || found == self.newest, "a bit of the other page was flipped: {found:?}");
        self.doubtful[page] = true;
        self.decayed[page] = true;
        self.newest = found;
    }
}
