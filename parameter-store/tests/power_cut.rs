//! Power is cut at every flash write and erase, and every bit concerned is left old or new, by chance; the store must
//! hold the old record or the new one, never none, and go on working. Where there was none, it is empty, or says that a
//! write was cut.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use parameter_store::{MAX_RECORD, ParameterStore, RamFlash, StoreError};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cell::RefCell;

const PAGE: usize = 2048;
const WORD: usize = 8;
/// Where a page says that the other one holds a newer record.
const MARK: usize = 1280;

struct Chip {
    memory: Vec<u8>,
    /// Operations until the cut; `None` for ever.
    left: Option<usize>,
    tears: ChaCha8Rng,
    /// The only word that a cut erase has erased; `None` for some bits anywhere.
    word: Option<usize>,
    erases: usize,
}

struct Flash<'c>(&'c RefCell<Chip>);

#[derive(Debug)]
struct PowerLost;

impl NorFlashError for PowerLost {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Chip {
    fn new() -> RefCell<Self> {
        let tears = ChaCha8Rng::seed_from_u64(1);
        RefCell::new(Self { memory: vec![0xFF; 2 * PAGE], left: None, tears, word: None, erases: 0 })
    }

    /// Brings `place` to `new`, or cuts the power.
    fn operate(&mut self, start: usize, new: &[u8]) -> Result<(), PowerLost> {
        match &mut self.left {
            Some(0) => return Err(PowerLost),
            Some(left) => *left -= 1,
            None => {}
        }
        let place = &mut self.memory[start..start + new.len()];
        if self.left != Some(0) {
            place.copy_from_slice(new);
            return Ok(());
        }
        if let (PAGE, Some(word)) = (new.len(), self.word) {
            place[WORD * word..][..WORD].fill(0xFF);
            return Err(PowerLost);
        }
        // Hardly begun, nearly done, or anything between; each bit for itself.
        let progress = [0.0, 0.001, 0.5, 0.999, 1.0][self.tears.random_range(0..5)];
        for (cell, new) in place.iter_mut().zip(new) {
            let done = (0..8).map(|bit| u8::from(self.tears.random_bool(progress)) << bit).sum::<u8>();
            *cell = (*cell & !done) | (new & done);
        }
        Err(PowerLost)
    }

    fn cut_after(&mut self, operations: usize) {
        self.left = Some(operations);
    }
}

impl ErrorType for Flash<'_> {
    type Error = PowerLost;
}

impl ReadNorFlash for Flash<'_> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
        let chip = self.0.borrow();
        if chip.left == Some(0) {
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
        (from as usize..to as usize).step_by(PAGE).try_for_each(|page| {
            self.0.borrow_mut().erases += 1;
            self.0.borrow_mut().operate(page, &[0xFF; PAGE])
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

fn store(chip: &RefCell<Chip>) -> ParameterStore<Flash<'_>> {
    ParameterStore::new(Flash(chip), 0..2 * PAGE as u32).unwrap()
}

/// The newest record; `None` where the store is empty or says that what it held is damaged.
fn stored(chip: &RefCell<Chip>) -> Option<Vec<u8>> {
    match block_on(store(chip).load()) {
        Ok(record) => record.map(<[u8]>::to_vec),
        Err(error) => {
            assert_eq!(error, StoreError::Damaged);
            None
        }
    }
}

/// A record that tells its number; not all are of one length.
fn record(number: usize) -> Vec<u8> {
    (0..180 + number % 9).map(|i| (number * 31 + i) as u8).collect()
}

/// Stores `number`, cut after `operations`; `false` when that were more than it takes.
fn cut_store(chip: &RefCell<Chip>, number: usize, operations: usize) -> bool {
    chip.borrow_mut().cut_after(operations);
    let written = block_on(store(chip).store(&record(number)));
    let cut = chip.borrow().left == Some(0);
    chip.borrow_mut().left = None;
    assert_ne!(cut, written.is_ok(), "a cut store does not call itself done");
    cut
}

#[test]
fn a_cut_at_any_operation_leaves_the_old_record_or_the_new() {
    let chip = Chip::new();
    let mut cuts = 0;
    for number in 0..4 {
        let before = chip.borrow().memory.clone();
        for operations in 1.. {
            // The erase comes first, or after the zeros in a record's beginning, and has many more ways to be torn.
            let tears = if operations <= 3 { 2_000 } else { 50 };
            let whole = (0..tears).any(|_| {
                chip.borrow_mut().memory.clone_from(&before);
                if !cut_store(&chip, number, operations) {
                    return true;
                }
                cuts += 1;
                let old = number.checked_sub(1).map(record);
                let found = stored(&chip);
                assert!(found == old || found == Some(record(number)), "write {number}, operation {operations}");
                // And a second cut, and then writes as good as any.
                let second = 1 + cuts % 25;
                assert!(cut_store(&chip, 77, second), "too few operations for a second cut");
                assert!(
                    [found, Some(record(77))].contains(&stored(&chip)),
                    "write {number}, cuts {operations}, {second}"
                );
                for next in 100..103 {
                    block_on(store(&chip).store(&record(next))).unwrap();
                    assert_eq!(stored(&chip), Some(record(next)), "write {number}, operation {operations}");
                }
                false
            });
            if whole {
                break;
            }
        }
        assert_eq!(stored(&chip), Some(record(number)));
    }
    assert!(cuts > 10_000 && chip.borrow().erases > cuts, "{cuts} cuts");
}

#[test]
fn a_cut_erase_leaves_the_newest_record_or_none() {
    for seed in 0..1500 {
        let chip = Chip::new();
        chip.borrow_mut().tears = ChaCha8Rng::seed_from_u64(seed);
        (0..3).for_each(|number| block_on(store(&chip).store(&record(number))).unwrap());
        chip.borrow_mut().cut_after(1 + seed as usize % 6);
        assert_eq!(block_on(store(&chip).erase()), Err(StoreError::Flash));
        chip.borrow_mut().left = None;
        assert!([None, Some(record(2))].contains(&stored(&chip)), "an older record has come back");
    }
}

#[test]
fn an_erase_that_takes_the_mark_alone_leaves_no_older_record_to_come_back_when_the_newest_decays() {
    let chip = Chip::new();
    (0..3).for_each(|number| block_on(store(&chip).store(&record(number))).unwrap());
    let whole = chip.borrow().memory.clone();
    assert!(whole[..PAGE][8..].starts_with(&record(2)), "the newest, in the first page");
    let begins: [fn(&RefCell<Chip>) -> bool; 2] =
        [|chip| block_on(store(chip).store(&record(3))).is_ok(), |chip| block_on(store(chip).erase()).is_ok()];
    let mut newest = 0;
    for begin in begins {
        for word in 0..PAGE / WORD {
            chip.borrow_mut().word = Some(word);
            for operations in 1.. {
                chip.borrow_mut().memory.clone_from(&whole);
                chip.borrow_mut().cut_after(operations);
                let done = begin(&chip);
                chip.borrow_mut().left = None;
                if done {
                    break;
                }
                if stored(&chip) == Some(record(2)) {
                    newest += 1;
                    chip.borrow_mut().memory[8] ^= 1;
                    let found = block_on(store(&chip).load()).map(|found| found.map(<[u8]>::to_vec));
                    assert!(found.is_err(), "word {word}, operation {operations}: {found:?}");
                }
            }
        }
    }
    assert!(newest > 2 * PAGE / WORD, "the newest was in use after {newest} cuts");
}

#[test]
fn numbers_may_wrap() {
    let chip = Chip::new();
    (0..2).for_each(|number| block_on(store(&chip).store(&record(number))).unwrap());
    // What two more writes make of these is what they make of any two neighbours.
    for (page, number) in [(0, u32::MAX), (PAGE, 0)] {
        let mut chip = chip.borrow_mut();
        let end = 8 + record(page / PAGE).len();
        chip.memory[page..page + 4].copy_from_slice(&number.to_le_bytes());
        let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&chip.memory[page..page + end]);
        chip.memory[page + end..page + end + 4].copy_from_slice(&checksum.to_le_bytes());
    }
    for next in 1..5 {
        assert_eq!(stored(&chip), Some(record(next)), "the newest");
        block_on(store(&chip).store(&record(next + 1))).unwrap();
    }
}

#[test]
fn whatever_lies_in_the_pages_a_record_can_be_written() {
    let mut noise = vec![0; 2 * PAGE];
    ChaCha8Rng::seed_from_u64(1).fill_bytes(&mut noise);
    for mut memory in [vec![0; 2 * PAGE], vec![0x55; 2 * PAGE], vec![0xFE; 2 * PAGE], noise] {
        let mut store = ParameterStore::new(RamFlash::new(&mut memory), 0..2 * PAGE as u32).unwrap();
        assert_eq!(block_on(store.load()), Err(StoreError::Damaged));
        block_on(store.store(&record(1))).unwrap();
        assert_eq!(block_on(store.load()), Ok(Some(&*record(1))));
        block_on(store.erase()).unwrap();
        assert_eq!(block_on(store.load()), Ok(None));
    }
}

#[test]
fn a_record_that_is_stored_already_costs_nothing_and_leaves_the_one_before() {
    let chip = Chip::new();
    (0..2).for_each(|number| block_on(store(&chip).store(&record(number))).unwrap());
    let (memory, erases) = (chip.borrow().memory.clone(), chip.borrow().erases);
    block_on(store(&chip).store(&record(1))).unwrap();
    assert!(chip.borrow().memory == memory && chip.borrow().erases == erases, "something was written");
    block_on(store(&chip).store(&record(0))).unwrap();
    assert_eq!((stored(&chip), chip.borrow().erases), (Some(record(0)), erases + 1), "the older one is no newest");
}

#[test]
fn a_record_whose_mark_was_cut_is_marked_when_it_is_stored_again() {
    let chip = Chip::new();
    (0..2).for_each(|number| block_on(store(&chip).store(&record(number))).unwrap());
    let mark = MARK..MARK + WORD;
    assert_eq!(chip.borrow().memory[mark.clone()], [0; WORD], "in the page of the record before");
    // As power leaves it that fails before the mark, or hardly into it.
    for left in [[0xFF; WORD], [0x7F; WORD]] {
        chip.borrow_mut().memory[mark.clone()].copy_from_slice(&left);
        assert_eq!(stored(&chip), Some(record(1)), "the new one is in use");
        assert_eq!(chip.borrow().memory[mark.clone()], left, "to look changes nothing");
        block_on(store(&chip).store(&record(1))).unwrap();
        assert_eq!((stored(&chip), &chip.borrow().memory[mark.clone()]), (Some(record(1)), &[0; WORD][..]));
    }
}

#[test]
fn a_mark_that_fails_is_said_and_that_the_new_record_is_stored() {
    let chip = Chip::new();
    block_on(store(&chip).store(&record(0))).unwrap();
    let before = chip.borrow().memory.clone();
    let mut said = 0;
    for operations in 1.. {
        chip.borrow_mut().memory.clone_from(&before);
        chip.borrow_mut().cut_after(operations);
        let done = block_on(store(&chip).store(&record(1)));
        chip.borrow_mut().left = None;
        if done.is_ok() {
            break;
        }
        if done == Err(StoreError::NotMarked) {
            said += 1;
            assert_eq!(stored(&chip), Some(record(1)), "operation {operations}");
            block_on(store(&chip).store(&record(1))).unwrap();
            assert_eq!(chip.borrow().memory[MARK..MARK + WORD], [0; WORD]);
        }
    }
    assert_eq!(said, 1, "the mark is the last operation");
}

#[test]
fn an_erased_store_is_empty_and_limits_are_kept() {
    let mut memory = vec![0xFF; 3 * PAGE];
    for pages in [0..PAGE, 8..8 + 2 * PAGE, 0..3 * PAGE] {
        let pages = pages.start as u32..pages.end as u32;
        assert_eq!(ParameterStore::new(RamFlash::new(&mut memory), pages).err(), Some(StoreError::Layout));
    }
    let mut store = ParameterStore::new(RamFlash::new(&mut memory), PAGE as u32..3 * PAGE as u32).unwrap();
    assert_eq!(block_on(store.load()), Ok(None));
    assert_eq!(block_on(store.store(&[7; MAX_RECORD + 1])), Err(StoreError::TooLong));
    for length in [0, 1, MAX_RECORD - 1, MAX_RECORD] {
        block_on(store.store(&vec![7; length])).unwrap();
        assert_eq!(block_on(store.load()), Ok(Some(&*vec![7; length])));
    }
    block_on(store.erase()).unwrap();
    assert_eq!(block_on(store.load()), Ok(None));
}

/// A flash that says "done" and has done nothing, as a write-protected one may.
struct Deaf(Vec<u8>);

impl ErrorType for Deaf {
    type Error = PowerLost;
}

impl ReadNorFlash for Deaf {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
        bytes.copy_from_slice(&self.0[offset as usize..offset as usize + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Deaf {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, _: u32, _: u32) -> Result<(), PowerLost> {
        Ok(())
    }

    async fn write(&mut self, _: u32, _: &[u8]) -> Result<(), PowerLost> {
        Ok(())
    }
}

#[test]
fn a_flash_that_does_nothing_is_noticed() {
    for (fill, error) in [(0xFF, StoreError::NotWritten), (0x00, StoreError::NotErased)] {
        let mut store = ParameterStore::new(Deaf(vec![fill; 2 * PAGE]), 0..2 * PAGE as u32).unwrap();
        assert_eq!(block_on(store.store(&record(1))), Err(error));
    }
}
