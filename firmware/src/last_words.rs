//! What a panic or hard fault leaves behind: a message in memory that no reset clears, to be read after it.
//!
//! Only a message that is whole is believed: after power-on the memory holds anything.

use core::cell::UnsafeCell;
use core::fmt::Write;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use estimator_core::sealed::checksum;
use protocol::{LAST_WORDS, LastWords, text};

/// Longest message, bytes: as many as are told.
const LENGTH: usize = LAST_WORDS;

/// A message with its checksum.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Words {
    length: u32,
    checksum: u32,
    bytes: [u8; LENGTH],
}

impl Words {
    /// The start of a message, whole characters.
    pub fn new(message: impl core::fmt::Display) -> Self {
        let text: LastWords = text(message);
        let mut bytes = [0; LENGTH];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Self { length: text.len() as u32, checksum: checksum(text.as_bytes()), bytes }
    }

    /// The message, if it is whole.
    pub fn read(&self) -> Option<LastWords> {
        let bytes = self.bytes.get(..usize::try_from(self.length).ok()?).filter(|bytes| !bytes.is_empty())?;
        if checksum(bytes) != self.checksum {
            return None;
        }
        let mut text = LastWords::new();
        text.write_str(core::str::from_utf8(bytes).ok()?).ok()?;
        Some(text)
    }

    /// What the slot holds where there is no message.
    const SILENCE: Self = Self { length: 0, checksum: 0, bytes: [0; LENGTH] };
}

/// Memory that no reset clears.
struct Slot(UnsafeCell<MaybeUninit<Words>>);

// SAFETY: there is one core, and `keep` and `take` say when they may be called.
unsafe impl Sync for Slot {}

#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.last_words"))]
static SLOT: Slot = Slot(UnsafeCell::new(MaybeUninit::uninit()));

/// Keeps a message for the next start.
///
/// # Safety
/// Only from a panic or fault handler that does not return, with interrupts off.
pub unsafe fn keep(message: impl core::fmt::Display) {
    let words = Words::new(message);
    // SAFETY: by the caller's promise. Volatile, so that the store is not removed although this program never reads it.
    unsafe { SLOT.0.get().write_volatile(MaybeUninit::new(words)) };
}

/// Keeps what a panic says, before where it was: paths are long.
///
/// # Safety
/// As for [`keep`].
pub unsafe fn keep_panic(info: &PanicInfo<'_>) {
    // SAFETY: by the caller's promise.
    unsafe { keep(PanicText(info)) }
}

/// Keeps where a hard fault was, and what the core says of it (Armv7-M, B3.2.15 and B3.2.18).
///
/// # Safety
/// As for [`keep`].
#[cfg(feature = "on-target")]
pub unsafe fn keep_hard_fault(frame: &cortex_m_rt::ExceptionFrame) {
    // SAFETY: two registers of the core that reading does not change.
    let (status, address) = unsafe {
        let core = &*cortex_m::peripheral::SCB::PTR;
        (core.cfsr.read(), core.bfar.read())
    };
    let (at, from) = (frame.pc(), frame.lr());
    // SAFETY: by the caller's promise.
    unsafe {
        keep(format_args!(
            "hard fault at {at:#010x}, called from {from:#010x}, status {status:#010x}, address {address:#010x}"
        ));
    }
}

struct PanicText<'p>(&'p PanicInfo<'p>);

impl core::fmt::Display for PanicText<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "panic: {}", self.0.message())?;
        self.0.location().map_or(Ok(()), |at| write!(f, ", {}:{}", at.file(), at.line()))
    }
}

/// Takes the message of the last run, if it left one.
///
/// # Safety
/// Once, before the tick and every task; no handler that returns may touch the slot.
pub unsafe fn take() -> Option<LastWords> {
    // SAFETY: by the caller's promise. Every bit pattern is a `Words`; whether it was written by `keep` is what
    // `read` finds out.
    let words = unsafe { SLOT.0.get().read_volatile().assume_init() };
    // SAFETY: as above.
    unsafe { SLOT.0.get().write_volatile(MaybeUninit::new(Words::SILENCE)) };
    words.read()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_messages_are_believed() {
        let words = Words::new("panicked at the disco");
        assert_eq!(words.read().unwrap(), "panicked at the disco");
        assert!(Words { bytes: [b'x'; LENGTH], ..words }.read().is_none());
        for length in [0, 20, LENGTH as u32 + 1, u32::MAX] {
            assert!(Words { length, ..words }.read().is_none(), "{length}");
        }
        assert!(Words::SILENCE.read().is_none());
        let long = Words::new(format_args!("{:1$}µ", "", LENGTH - 1)).read().unwrap();
        assert_eq!(long.len(), LENGTH - 1, "a character that does not fit whole is left out");
    }

    #[test]
    fn what_is_kept_is_taken_once() {
        // SAFETY: no other test uses the slot.
        unsafe {
            keep("gone");
            assert_eq!(take().unwrap(), "gone");
            assert!(take().is_none());
        }
    }
}
