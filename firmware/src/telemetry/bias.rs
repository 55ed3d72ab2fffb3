//! What is added to the model's displacement, by a displacement that was told, and how long that is ago.

use super::maybe::Maybe;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The bias of the estimate; only the tick writes it.
#[derive(Debug, Default)]
pub struct Bias {
    /// Bits of it, µm.
    um: AtomicU32,
    /// Ticks since it was told; none where it was not since the estimate began.
    age: Maybe,
}

impl Bias {
    /// Nothing was told yet.
    pub const fn new() -> Self {
        Self { um: AtomicU32::new(0), age: Maybe::none() }
    }

    /// µm; 0 where nothing was told.
    pub fn um(&self) -> f32 {
        f32::from_bits(self.um.load(Relaxed))
    }

    /// Ticks since it was told, at most [`protocol::Health::OLDEST_BIAS_TICKS`]; `None` where it was not since
    /// the estimate began.
    pub fn age_ticks(&self) -> Option<u32> {
        self.age.get()
    }

    /// It (µm) was told at this tick; without one, the estimate has begun anew.
    pub(crate) fn set(&self, told_um: Option<f32>) {
        self.um.store(told_um.unwrap_or(0.0).to_bits(), Relaxed);
        self.age.set(told_um.map(|_| 0));
    }

    /// A tick has passed since it was told, where it was.
    #[inline]
    pub(crate) fn age(&self) {
        if let Some(ticks) = self.age.get() {
            self.age.set(Some(ticks + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Health;

    #[test]
    fn a_bias_grows_no_older_than_can_be_said() {
        let bias = Bias::new();
        bias.age();
        assert_eq!(bias.age_ticks(), None, "what was never told does not age");
        bias.set(Some(0.5));
        bias.age.set(Some(Health::OLDEST_BIAS_TICKS - 1));
        for _ in 0..3 {
            bias.age();
            assert_eq!(bias.age_ticks(), Some(Health::OLDEST_BIAS_TICKS));
        }
    }
}
