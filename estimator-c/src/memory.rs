//! Memory that a C program gives for a value of Rust.

use crate::PiezoResult;
use core::ptr::NonNull;

/// What `begun` says once there is a value. Memory of zeros, as static memory is in C, has none.
pub(crate) const BEGUN: u32 = 0x505A_4547;

/// A structure of C: a word that says whether there is a value, and storage for it.
///
/// # Safety
/// `storage` points into the structure, and has the size and the alignment of a `Value` at least.
pub(crate) unsafe trait Memory {
    /// What lies in it.
    type Value;

    /// Where the word is.
    fn begun(this: *mut Self) -> *mut u32;

    /// Where the value is.
    fn storage(this: *mut Self) -> *mut Self::Value;
}

/// Puts a value into memory. One that was there is forgotten: it owns nothing outside of itself.
///
/// # Safety
/// The pointer is null, or points to memory of a `M` that nobody else uses during the call.
pub(crate) unsafe fn put<M: Memory>(memory: *mut M, value: M::Value) -> Result<(), PiezoResult> {
    if memory.is_null() {
        return Err(PiezoResult::Null);
    }
    // SAFETY: the caller's promise, and the trait's. The memory may be uninitialised: it is written only.
    unsafe {
        M::storage(memory).write(value);
        M::begun(memory).write(BEGUN);
    }
    Ok(())
}

/// The value in memory.
///
/// # Safety
/// The pointer is null, or points to memory of a `M` that is initialised, if only with zeros, and that nobody else uses
/// as long as the value is borrowed.
pub(crate) unsafe fn get<'a, M: Memory>(memory: *mut M) -> Result<&'a mut M::Value, PiezoResult> {
    if memory.is_null() {
        return Err(PiezoResult::Null);
    }
    // SAFETY: the caller's promise.
    if unsafe { M::begun(memory).read() } != BEGUN {
        return Err(PiezoResult::NotBegun);
    }
    // SAFETY: only `put` writes the word, after the value.
    Ok(unsafe { &mut *M::storage(memory) })
}

/// Where a result goes.
pub(crate) struct Out<T>(NonNull<T>);

impl<T> Out<T> {
    /// Refuses a null pointer: before anything is done whose result would then be lost.
    pub(crate) fn of(out: *mut T) -> Result<Self, PiezoResult> {
        NonNull::new(out).map(Self).ok_or(PiezoResult::Null)
    }

    /// Writes the result.
    ///
    /// # Safety
    /// The pointer points to memory for a `T`.
    pub(crate) unsafe fn write(self, value: T) {
        // SAFETY: the caller's promise.
        unsafe { self.0.write(value) };
    }
}

/// The bytes of the caller.
///
/// # Safety
/// The pointer is null, or points to that many bytes, which nobody changes as long as they are borrowed.
pub(crate) unsafe fn bytes<'a>(start: *const u8, length: usize) -> Result<&'a [u8], PiezoResult> {
    if start.is_null() {
        return Err(PiezoResult::Null);
    }
    // SAFETY: the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(start, length) })
}

/// Says that a structure's words hold a value.
macro_rules! memory {
    ($structure:ident of $value:ty) => {
        const _: () = assert!(size_of::<$value>() <= size_of::<[u64; $structure::WORDS]>());
        const _: () = assert!(align_of::<$value>() <= align_of::<u64>());

        // SAFETY: the words lie in the structure, and are large and aligned enough, as is asserted above.
        unsafe impl crate::memory::Memory for $structure {
            type Value = $value;

            fn begun(this: *mut Self) -> *mut u32 {
                this.wrapping_byte_add(core::mem::offset_of!(Self, begun)).cast()
            }

            fn storage(this: *mut Self) -> *mut $value {
                this.wrapping_byte_add(core::mem::offset_of!(Self, words)).cast()
            }
        }
    };
}
pub(crate) use memory;
