//! The flash decays: any bit of the pages flips, any word is torn. The store gives the newest record, never another:
//! where that is no longer whole it says so, whether the one before is or not.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use parameter_store::{ParameterStore, RamFlash, RamFlashError, StoreError};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PAGE: usize = 2048;
const WORD: usize = 8;
/// Number and length before a record, and its checksum behind it.
const AROUND: usize = 12;
/// Where a page says that the other one holds a newer record.
const MARK: usize = 1280;

/// Two pages with a record in each.
#[derive(Clone)]
struct Pages {
    memory: Vec<u8>,
    /// The page of the newer record.
    newest: usize,
    old: Vec<u8>,
    new: Vec<u8>,
}

fn record(number: usize) -> Vec<u8> {
    (0..180 + number % 9).map(|i| (number * 31 + i) as u8).collect()
}

fn store(memory: &mut [u8]) -> ParameterStore<RamFlash<&mut [u8]>> {
    ParameterStore::new(RamFlash::new(memory), 0..2 * PAGE as u32).unwrap()
}

/// The record, or what the store says of it, and never that it is empty.
fn load(memory: &[u8]) -> Result<Vec<u8>, StoreError> {
    let mut memory = memory.to_vec();
    block_on(store(&mut memory).load()).map(|found| found.expect("nothing here is blank").to_vec())
}

impl Pages {
    /// After so many writes, two at least.
    fn written(writes: usize) -> Self {
        let mut memory = vec![0xFF; 2 * PAGE];
        (0..writes).for_each(|number| block_on(store(&mut memory).store(&record(number))).unwrap());
        let [old, new] = [writes - 2, writes - 1].map(record);
        let newest = (writes - 1) % 2;
        let pages = Self { memory, newest, old, new };
        assert_eq!(load(&pages.memory), Ok(pages.new.clone()));
        assert!(pages.memory[newest * PAGE + 8..].starts_with(&pages.new), "it is in the other page");
        pages
    }

    fn both() -> [Self; 2] {
        [Self::written(4), Self::written(5)]
    }

    /// What the store must give where these bytes are no longer what they were.
    fn expected(&self, memory: &[u8]) -> Result<Vec<u8>, StoreError> {
        let whole = |page: usize, record: &Vec<u8>| {
            let bytes = page * PAGE..page * PAGE + record.len() + AROUND;
            self.memory[bytes.clone()] == memory[bytes]
        };
        match (whole(self.newest, &self.new), whole(1 - self.newest, &self.old)) {
            (true, _) => Ok(self.new.clone()),
            (false, true) => Err(StoreError::NewestLost),
            (false, false) => Err(StoreError::Damaged),
        }
    }

    /// Whatever has happened, the next record can be written.
    fn can_be_written(mut memory: Vec<u8>) {
        block_on(store(&mut memory).store(&record(77))).unwrap();
        assert_eq!(load(&memory), Ok(record(77)));
    }
}

#[test]
fn a_flipped_bit_costs_the_record_that_it_is_in_and_the_newest_is_not_replaced_by_the_one_before() {
    for pages in Pages::both() {
        let mut costs = 0;
        for bit in 0..8 * 2 * PAGE {
            let mut memory = pages.memory.clone();
            memory[bit / 8] ^= 1 << (bit % 8);
            let found = load(&memory);
            assert_eq!(found, pages.expected(&memory), "bit {bit}");
            costs += usize::from(found == Err(StoreError::NewestLost));
            if bit % 61 == 0 {
                Pages::can_be_written(memory);
            }
        }
        assert_eq!(costs, 8 * (pages.new.len() + AROUND), "bits of the newest record");
    }
}

#[test]
fn a_torn_word_costs_the_record_that_it_is_in_and_the_newest_is_not_replaced_by_the_one_before() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for pages in Pages::both() {
        for word in (0..2 * PAGE).step_by(WORD) {
            let mut noise = [[0; WORD]; 4];
            noise.iter_mut().for_each(|bytes| random.fill_bytes(bytes));
            let mut half = [0xFF; WORD];
            half[..WORD / 2].copy_from_slice(&pages.memory[word..word + WORD / 2]);
            for torn in [[0; WORD], [0xFF; WORD], half].iter().chain(&noise) {
                let mut memory = pages.memory.clone();
                memory[word..word + WORD].copy_from_slice(torn);
                assert_eq!(load(&memory), pages.expected(&memory), "{word:#x}: {torn:?}");
            }
        }
    }
}

#[test]
fn whatever_decays_in_both_pages_no_record_comes_that_was_not_written() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let both = Pages::both();
    let mut lost = 0;
    for _ in 0..20_000 {
        let pages = &both[random.random_range(0..2)];
        let mut memory = pages.memory.clone();
        for _ in 0..random.random_range(1..=40) {
            // Where the records are, most of the time.
            let page = random.random_range(0..2) * PAGE;
            let at =
                page + if random.random_bool(0.9) { random.random_range(0..210) } else { random.random_range(0..PAGE) };
            memory[at] ^= 1 << random.random_range(0..8);
        }
        let found = load(&memory);
        assert_eq!(found, pages.expected(&memory));
        lost += u32::from(found == Err(StoreError::Damaged));
    }
    assert!((1_000..20_000).contains(&lost), "both records were hit {lost} times");
}

#[test]
fn a_newest_record_that_is_erased_is_lost_too_and_the_one_before_can_be_stored_anew() {
    for pages in Pages::both() {
        let mut memory = pages.memory.clone();
        memory[pages.newest * PAGE..][..PAGE].fill(0xFF);
        assert_eq!(load(&memory), Err(StoreError::NewestLost));
        // It lies there whole, and is none that is stored.
        block_on(store(&mut memory).store(&pages.old)).unwrap();
        assert_eq!(load(&memory), Ok(pages.old.clone()));
        block_on(store(&mut memory).erase()).unwrap();
        assert_eq!(block_on(store(&mut memory).load()), Ok(None));
    }
}

#[test]
fn a_mark_of_which_a_bit_flips_is_one_and_a_blank_one_is_none() {
    for pages in Pages::both() {
        for bit in 0..8 * WORD {
            let mut memory = pages.memory.clone();
            let mut flip = |page: usize| memory[page * PAGE + MARK + bit / 8] ^= 1 << (bit % 8);
            (0..2).for_each(&mut flip);
            let mut decayed = memory.clone();
            decayed[pages.newest * PAGE + 8] ^= 1;
            assert_eq!(load(&decayed), Err(StoreError::NewestLost), "bit {bit}");
            // As a cut write of the next record leaves it.
            memory[(1 - pages.newest) * PAGE..][..8].fill(0);
            assert_eq!(load(&memory), Ok(pages.new.clone()), "bit {bit}");
        }
    }
}

#[test]
fn without_a_mark_the_one_before_comes_back_until_a_table_is_stored_again_or_all_is_erased() {
    for pages in Pages::both() {
        let decayed = |memory: &[u8], page: usize| {
            let mut memory = memory.to_vec();
            memory[page * PAGE + 8] ^= 1;
            memory
        };
        // As firmware leaves it that set none.
        let mut unmarked = pages.memory.clone();
        unmarked[(1 - pages.newest) * PAGE + MARK..][..WORD].fill(0xFF);
        assert_eq!(load(&unmarked), Ok(pages.new.clone()));
        assert_eq!(load(&decayed(&unmarked, pages.newest)), Ok(pages.old.clone()));
        for (next, page) in [(pages.new.clone(), pages.newest), (record(77), 1 - pages.newest)] {
            let mut memory = unmarked.clone();
            block_on(store(&mut memory).store(&next)).unwrap();
            assert_eq!(load(&decayed(&memory, page)), Err(StoreError::NewestLost));
        }
        // The page that has decayed is erased first.
        let mut cut = unmarked.clone();
        cut[pages.newest * PAGE..][..PAGE].fill(0xFF);
        assert_eq!(load(&cut), Ok(pages.old.clone()));
        block_on(store(&mut cut).erase()).unwrap();
        assert_eq!(block_on(store(&mut cut).load()), Ok(None));
    }
}

/// A flash of which a page can no longer be erased, and says nothing of it, as a worn one may.
struct Worn<'m> {
    flash: RamFlash<&'m mut [u8]>,
    page: usize,
    /// Nor can it be written, as one that is protected.
    protected: bool,
}

impl ErrorType for Worn<'_> {
    type Error = RamFlashError;
}

impl ReadNorFlash for Worn<'_> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), RamFlashError> {
        self.flash.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl NorFlash for Worn<'_> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), RamFlashError> {
        if from as usize == self.page * PAGE { Ok(()) } else { self.flash.erase(from, to).await }
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), RamFlashError> {
        let kept = self.protected && offset as usize / PAGE == self.page;
        if kept { Ok(()) } else { self.flash.write(offset, bytes).await }
    }
}

fn worn(memory: &mut [u8], page: usize) -> ParameterStore<Worn<'_>> {
    ParameterStore::new(Worn { flash: RamFlash::new(memory), page, protected: false }, 0..2 * PAGE as u32).unwrap()
}

#[test]
fn a_newest_record_that_has_decayed_on_a_page_that_is_worn_leaves_a_store_that_takes_another() {
    for pages in Pages::both() {
        let newest = pages.newest;
        let mut memory = pages.memory.clone();
        memory[newest * PAGE + 8] ^= 1;
        assert_eq!(load(&memory), Err(StoreError::NewestLost));
        let decayed = memory.clone();
        block_on(worn(&mut memory, newest).store(&record(77))).unwrap();
        assert_eq!(load(&memory), Ok(record(77)));
        // Were what has decayed read whole again, it would be the older one.
        memory[newest * PAGE + 8] ^= 1;
        assert_eq!(load(&memory), Ok(record(77)));
        // Erased, the page that is worn is said, and no record comes from the other.
        let mut memory = decayed;
        assert_eq!(block_on(worn(&mut memory, newest).erase()), Err(StoreError::NotErased));
        assert_eq!(load(&memory), Err(StoreError::Damaged));
        block_on(worn(&mut memory, newest).store(&record(78))).unwrap();
        assert_eq!(load(&memory), Ok(record(78)));
    }
}

fn protected(memory: &mut [u8], page: usize) -> ParameterStore<Worn<'_>> {
    let protected = Worn { flash: RamFlash::new(memory), page, protected: true };
    ParameterStore::new(protected, 0..2 * PAGE as u32).unwrap()
}

#[test]
fn a_page_that_is_worn_costs_no_record_that_is_used() {
    for pages in Pages::both() {
        let older = 1 - pages.newest;
        for flash in [worn, protected] {
            let mut memory = pages.memory.clone();
            assert_eq!(block_on(flash(&mut memory, older).store(&record(77))), Err(StoreError::NotErased));
            assert_eq!(load(&memory), Ok(pages.new.clone()));
        }
        // As a store of earlier firmware, whose older record has no mark: it would be used in the newest's stead.
        let mut unmarked = pages.memory.clone();
        unmarked[older * PAGE + MARK..][..WORD].fill(0xFF);
        let mut memory = unmarked.clone();
        assert_eq!(block_on(protected(&mut memory, older).erase()), Err(StoreError::NotErased));
        assert_eq!(load(&memory), Ok(pages.new.clone()));
        // With the mark, none is.
        let mut memory = pages.memory.clone();
        assert_eq!(block_on(protected(&mut memory, older).erase()), Err(StoreError::NotErased));
        assert_eq!(load(&memory), Err(StoreError::NewestLost));
        // Nor one whose beginning is zeros.
        let mut memory = unmarked;
        assert_eq!(block_on(worn(&mut memory, older).erase()), Err(StoreError::NotErased));
        assert_eq!(load(&memory), Err(StoreError::Damaged));
    }
}
