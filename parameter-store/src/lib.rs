//! Two flash pages in which a parameter table survives a power cut.
//!
//! Each page holds one numbered record, or nothing:
//!
//! | offset | bytes | content |
//! |---|---|---|
//! | 0 | 4 | number, little-endian; each record's is one more than the last one's |
//! | 4 | 4 | length of the record, little-endian |
//! | 8 | n | the record |
//! | 8 + n | 4 | CRC-32 (ISO-HDLC) of all before, little-endian; then zeros up to a whole flash word |
//! | 1280 | a word | erased; zeros once the other page holds a newer record, whole |
//!
//! The newest record is the whole one with the higher number. A new one goes into the *other* page: that page is
//! erased, checked to be blank, written, and read back, while the newest is not touched. So whatever a cut erase or
//! write leaves, the last record is found or the new one; nothing but checksums is ever believed.
//! (sequential-storage, which judges a page by its first and last word, loses a table by some erases that are cut;
//! the tests here find them.)
//!
//! **The mark.** Once the new record is whole, the page of the previous one is marked "superseded". At boot the mark
//! tells a write that was cut from decay, where only one page is whole:
//!
//! - no mark: the other page is what a power cut left of a write, and the whole record is the newest that was stored;
//! - a mark: a newer record was stored and has decayed. The whole one may belong to another actuator, and is refused
//!   ([`StoreError::NewestLost`]).
//!
//! A power cut between the new record's last word and the mark leaves no mark. The caller was then not told that the
//! record is stored, and storing it again sets the mark. Firmware that is older than the mark sets none either: if the
//! record that it stored decays, the previous one is given. An erase that is cut could take the mark and leave the
//! record, so a record's first word is overwritten with zeros before its page is erased.
//!
//! The store does not know what a record means: what it gives back must still be parsed.
#![cfg_attr(not(test), no_std)]

mod ram_flash;

pub use ram_flash::{RamFlash, RamFlashError};

use core::ops::Range;
use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage_async::nor_flash::NorFlash;

/// Longest record that the store takes, bytes; a longer one is refused, and a page has to hold it with 12 bytes more.
pub const MAX_RECORD: usize = 1268;

const HEADER: usize = 8;
const CHECKSUM: usize = 4;
/// Longest content of a page, in whole words of any flash this is for.
const BUFFER: usize = (HEADER + MAX_RECORD + CHECKSUM).next_multiple_of(WORD);
/// No flash word may be longer, bytes.
const WORD: usize = 32;
/// Where a page has the mark that a newer record was whole, behind the longest content.
const MARK: u32 = BUFFER as u32;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why the store failed. A record that was in use is untouched by a store, but for [`StoreError::NotMarked`], after
/// which the new one is in use; an erase leaves it, or none.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum StoreError {
    /// The pages do not fit this flash: not two of its pages, or its words are too long.
    #[error("the parameter pages do not fit the flash")]
    Layout,
    /// The flash itself reported an error.
    #[error("the flash reports an error")]
    Flash,
    /// The record is longer than [`MAX_RECORD`].
    #[error("the record is too long")]
    TooLong,
    /// An erased page is not blank.
    #[error("an erased page is not blank: the flash is worn or protected; try again")]
    NotErased,
    /// What was read back is not what was written.
    #[error("what was read back is not what was written: the flash is worn or protected; try again")]
    NotWritten,
    /// The new record is stored, whole, and the page of the one before has no mark: where the new one decays, that
    /// one comes back.
    #[error("the table is stored, but the page of the one before could not be marked as older: push it again")]
    NotMarked,
    /// Something lies in the pages, and no whole record.
    #[error("the stored table is damaged, by a write that was cut or by decay")]
    Damaged,
    /// The newest record was whole and is not any more; the one before is, and may say something else altogether.
    #[error("the newest stored table has decayed, and the one before it is not used: it may be another actuator's")]
    NewestLost,
}

/// The store in two pages of a flash.
pub struct ParameterStore<F: NorFlash> {
    flash: F,
    /// Start of either page, bytes from the flash's start.
    pages: [u32; 2],
    buffer: [u8; BUFFER],
}

/// What lies in a page, as far as a record can reach.
#[derive(Clone, Copy)]
enum Content {
    Blank,
    Damaged,
    /// A whole record of this length, in the buffer.
    Record {
        number: u32,
        length: usize,
    },
}

/// The newest record that is whole.
#[derive(Clone, Copy)]
struct Newest {
    page: usize,
    number: u32,
    /// The other page holds a whole record, too, which is older.
    beside: bool,
}

impl<F: NorFlash> ParameterStore<F> {
    /// A store in these bytes of the flash (offsets from its start): two of its pages.
    ///
    /// # Errors
    /// They are not two whole pages, or the flash's words or pages are too small ([`StoreError::Layout`]).
    pub fn new(flash: F, pages: Range<u32>) -> Result<Self, StoreError> {
        let page = F::ERASE_SIZE as u32;
        let fits = pages.start.is_multiple_of(page) && pages.end.checked_sub(pages.start) == Some(2 * page);
        if !fits || BUFFER + WORD > F::ERASE_SIZE || !WORD.is_multiple_of(F::WRITE_SIZE) {
            return Err(StoreError::Layout);
        }
        Ok(Self { flash, pages: [pages.start, pages.start + page], buffer: [0; BUFFER] })
    }

    /// The newest record; `None` in an empty store.
    ///
    /// # Errors
    /// The flash reports one; the store is neither empty nor has a whole record ([`StoreError::Damaged`]); or the
    /// newest has decayed ([`StoreError::NewestLost`]).
    pub async fn load(&mut self) -> Result<Option<&[u8]>, StoreError> {
        let Some(newest) = self.newest().await? else {
            for page in 0..self.pages.len() {
                if !matches!(self.read(page).await?, Content::Blank) {
                    return Err(StoreError::Damaged);
                }
            }
            return Ok(None);
        };
        if self.lost(newest).await? {
            return Err(StoreError::NewestLost);
        }
        self.record(newest.page).await.map(Some)
    }

    /// Writes a record, unless it is the newest: whoever asks twice keeps the one before. A power cut at any instant
    /// leaves the last record or this one. Where no record is used, since the newest has decayed or none is whole, and
    /// the one page is worn, it goes into the other.
    ///
    /// # Errors
    /// The record is too long; the flash reports an error, and the last record is used as before; or the record is
    /// stored and used, but the one before could not be marked as older ([`StoreError::NotMarked`]).
    pub async fn store(&mut self, record: &[u8]) -> Result<(), StoreError> {
        if record.len() > MAX_RECORD {
            return Err(StoreError::TooLong);
        }
        let newest = self.newest().await?;
        let used = match newest {
            Some(last) => !self.lost(last).await?,
            None => false,
        };
        if let Some(last) = newest
            && used
            && self.record(last.page).await? == record
        {
            return if last.beside { self.mark(1 - last.page).await } else { Ok(()) };
        }
        let (page, number) = newest.map_or((0, 0), |last| (1 - last.page, last.number.wrapping_add(1)));
        let written = self.write(page, number, record).await;
        if written.is_err() && !used {
            // Of what the other page holds nothing is used: that one may be sound where this one is worn. The number is
            // above that of a record which has decayed here, should it ever be read whole again.
            return self.write(1 - page, number.wrapping_add(1), record).await.or(written);
        }
        written?;
        match newest {
            Some(last) => self.mark(last.page).await,
            None => Ok(()),
        }
    }

    /// Empties the store: the older record first, so that a cut never brings it back. A page that is worn keeps the
    /// other one only where it would be believed without that; the error is said in any case.
    ///
    /// # Errors
    /// The first page that does not become blank.
    pub async fn erase(&mut self) -> Result<(), StoreError> {
        let newest = self.newest().await?.map_or(0, |newest| newest.page);
        let older = self.clear(1 - newest).await;
        if older.is_err()
            && matches!(self.read(1 - newest).await?, Content::Record { .. })
            && !self.marked(1 - newest).await?
        {
            return older;
        }
        let newer = self.clear(newest).await;
        older.and(newer)
    }

    /// Writes a record into a page, whatever that holds, and sees that it is there.
    async fn write(&mut self, page: usize, number: u32, record: &[u8]) -> Result<(), StoreError> {
        self.clear(page).await?;

        let end = HEADER + record.len();
        self.buffer.fill(0);
        self.buffer[..4].copy_from_slice(&number.to_le_bytes());
        self.buffer[4..HEADER].copy_from_slice(&(record.len() as u32).to_le_bytes());
        self.buffer[HEADER..end].copy_from_slice(record);
        let checksum = CRC.checksum(&self.buffer[..end]);
        self.buffer[end..end + CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
        let whole = (end + CHECKSUM).next_multiple_of(F::WRITE_SIZE);
        self.flash.write(self.pages[page], &self.buffer[..whole]).await.map_err(|_| StoreError::Flash)?;

        // A flash driver need not notice a failed write (embassy-stm32 0.6's interrupt clears the error flags).
        match self.read(page).await? {
            Content::Record { number: found, length }
                if found == number && self.buffer[HEADER..HEADER + length] == *record =>
            {
                Ok(())
            }
            _ => Err(StoreError::NotWritten),
        }
    }

    async fn newest(&mut self) -> Result<Option<Newest>, StoreError> {
        let mut newest: Option<Newest> = None;
        for page in 0..self.pages.len() {
            let Content::Record { number, .. } = self.read(page).await? else { continue };
            // Numbers wrap; the two that are compared are neighbours.
            newest = match newest {
                Some(other) if number.wrapping_sub(other.number) >= u32::MAX / 2 => {
                    Some(Newest { beside: true, ..other })
                }
                other => Some(Newest { page, number, beside: other.is_some() }),
            };
        }
        Ok(newest)
    }

    /// The record of a page that was whole when it was read last, into the buffer again: that may hold the other page.
    async fn record(&mut self, page: usize) -> Result<&[u8], StoreError> {
        match self.read(page).await? {
            Content::Record { length, .. } => Ok(&self.buffer[HEADER..HEADER + length]),
            Content::Blank | Content::Damaged => Err(StoreError::Damaged),
        }
    }

    /// Whether a newer record than the newest whole one was stored, and has decayed.
    async fn lost(&mut self, newest: Newest) -> Result<bool, StoreError> {
        Ok(!newest.beside && self.marked(newest.page).await?)
    }

    /// Whether a page has the mark: by the majority of the word's bits, so that one bit that flips neither sets it
    /// nor clears it.
    async fn marked(&mut self, page: usize) -> Result<bool, StoreError> {
        let mut word = [0; WORD];
        let word = &mut word[..F::WRITE_SIZE];
        self.flash.read(self.pages[page] + MARK, word).await.map_err(|_| StoreError::Flash)?;
        let zeros: u32 = word.iter().map(|byte| byte.count_zeros()).sum();
        Ok(zeros as usize > 4 * F::WRITE_SIZE)
    }

    /// Marks a page: the other one holds a newer record, whole.
    async fn mark(&mut self, page: usize) -> Result<(), StoreError> {
        self.set_mark(page).await.map_err(|_| StoreError::NotMarked)
    }

    /// Sets the mark of a page that has none. (Zeros may be written over a word that a cut has torn.)
    async fn set_mark(&mut self, page: usize) -> Result<(), StoreError> {
        if self.marked(page).await? {
            return Ok(());
        }
        let zeros = &[0; WORD][..F::WRITE_SIZE];
        self.flash.write(self.pages[page] + MARK, zeros).await.map_err(|_| StoreError::Flash)?;
        if self.marked(page).await? { Ok(()) } else { Err(StoreError::NotWritten) }
    }

    /// Reads a page into the buffer, as far as a record can reach.
    async fn read(&mut self, page: usize) -> Result<Content, StoreError> {
        self.flash.read(self.pages[page], &mut self.buffer).await.map_err(|_| StoreError::Flash)?;
        if self.buffer.iter().all(|&byte| byte == 0xFF) {
            return Ok(Content::Blank);
        }
        let [n0, n1, n2, n3, l0, l1, l2, l3, ..] = self.buffer;
        let (number, length) = (u32::from_le_bytes([n0, n1, n2, n3]), u32::from_le_bytes([l0, l1, l2, l3]) as usize);
        if length > MAX_RECORD {
            return Ok(Content::Damaged);
        }
        let (content, rest) = self.buffer.split_at(HEADER + length);
        let whole = rest.first_chunk().is_some_and(|stored| u32::from_le_bytes(*stored) == CRC.checksum(content));
        Ok(if whole { Content::Record { number, length } } else { Content::Damaged })
    }

    /// Makes a whole record none: the checksum of a number and a length that are both zero is not zero. Zeros may be
    /// written over any word of this flash.
    async fn void(&mut self, page: usize) -> Result<(), StoreError> {
        if let Content::Record { .. } = self.read(page).await? {
            let zeros = &[0; BUFFER][..(HEADER + CHECKSUM).next_multiple_of(F::WRITE_SIZE)];
            self.flash.write(self.pages[page], zeros).await.map_err(|_| StoreError::Flash)?;
        }
        Ok(())
    }

    /// Erases a page and sees that it is blank, all of it.
    async fn clear(&mut self, page: usize) -> Result<(), StoreError> {
        // The erase makes it none in any case; this is for where the erase is cut.
        let _ = self.void(page).await;
        let (start, end) = (self.pages[page], self.pages[page] + F::ERASE_SIZE as u32);
        self.flash.erase(start, end).await.map_err(|_| StoreError::Flash)?;
        let mut word = [0; WORD];
        for offset in (start..end).step_by(WORD) {
            self.flash.read(offset, &mut word).await.map_err(|_| StoreError::Flash)?;
            if word.iter().any(|&byte| byte != 0xFF) {
                return Err(StoreError::NotErased);
            }
        }
        Ok(())
    }
}
