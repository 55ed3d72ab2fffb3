//! A number that is shared, and may be none.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// One more than the number; 0 where there is none. The largest that it holds is `u32::MAX - 1`.
#[derive(Debug, Default)]
pub(crate) struct Maybe(AtomicU32);

impl Maybe {
    /// Before the first number is set.
    pub const fn none() -> Self {
        Self(AtomicU32::new(0))
    }

    #[inline]
    pub fn get(&self) -> Option<u32> {
        self.0.load(Relaxed).checked_sub(1)
    }

    #[inline]
    pub fn set(&self, number: Option<u32>) {
        self.0.store(number.map_or(0, |number| number.saturating_add(1)), Relaxed);
    }
}
