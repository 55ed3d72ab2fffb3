//! The analogue supply, which is the converters' reference: how far off it is. What becomes of the codes is in
//! [`crate::correction`].

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, AtomicU16, Ordering::Relaxed};

/// What converters, dividers and calibrations are made for, mV.
pub const MADE_FOR_MV: f32 = 3300.0;
/// Furthest off that is corrected, as a part of [`MADE_FOR_MV`]; a code times that fits 32 bits. A board calls less than that a
/// fault.
const FURTHEST: f32 = 0.1;
/// Bits of what a measurement is kept in beyond those that a code is scaled with.
const FINER: u32 = 8;
/// A measurement counts for a part of so many, the ones before for the rest: those of 20 ms each settle in some 70 ms.
const SMOOTHED: i32 = 4;
/// Measurements in a row that do not come, which are a fault: 60 ms.
pub const OVERDUE: u8 = 3;
/// What a measurement is kept in: [`MADE_FOR_MV`] is so many.
const WHOLE: i32 = 65_536 << FINER;

/// What is known of the supply. The main loop writes it, the tick reads.
#[derive(Debug, Default)]
pub struct Supply {
    /// mV; 0 where it is not known.
    mv: AtomicU16,
    bad: AtomicBool,
    /// Measurements in a row that did not come.
    overdue: AtomicU8,
    /// Whether the last measurement was within tolerance; none was yet at the start.
    was_good: AtomicBool,
    /// Whether one ever was.
    known: AtomicBool,
    /// Mean of those that were, less 1, in parts of [`MADE_FOR_MV`] of 2 to the power of 16 + [`FINER`].
    off: AtomicI32,
    /// [`MADE_FOR_MV`] as a part of that mean, less 1, likewise.
    short: AtomicI32,
}

impl Supply {
    /// Nothing is known yet.
    pub const fn new() -> Self {
        Self {
            mv: AtomicU16::new(0),
            bad: AtomicBool::new(false),
            overdue: AtomicU8::new(0),
            was_good: AtomicBool::new(false),
            known: AtomicBool::new(false),
            off: AtomicI32::new(0),
            short: AtomicI32::new(0),
        }
    }

    /// The supply when it was measured last, mV; `None` where it cannot be.
    pub fn mv(&self) -> Option<u16> {
        Some(self.mv.load(Relaxed)).filter(|mv| *mv > 0)
    }

    /// Takes what it was found to be (mV), and whether that is within tolerance. Nothing is known to be wrong with one
    /// that was never measured. Of one that was, measurements that do not come any more are a fault: codes are corrected by what it
    /// was, and nobody knows what it is. A measurement that is out of tolerance alone, after a good one, may be a disturbance: the next
    /// one decides. The first of all is believed. Codes are corrected by good ones only.
    pub fn take(&self, mv: Option<f32>, good: fn(f32) -> bool) {
        let Some(mv) = mv else {
            if self.mv().is_some() {
                let overdue = self.overdue.load(Relaxed).saturating_add(1);
                self.overdue.store(overdue, Relaxed);
                if overdue >= OVERDUE {
                    self.bad.store(true, Relaxed);
                    // The next one that is out of tolerance is not alone after a good one.
                    self.was_good.store(false, Relaxed);
                }
            }
            return;
        };
        self.overdue.store(0, Relaxed);
        self.mv.store((mv + 0.5) as u16, Relaxed);
        let is_good = good(mv);
        let was_good = self.was_good.load(Relaxed);
        self.bad.store(!is_good && !was_good, Relaxed);
        self.was_good.store(is_good, Relaxed);
        if !is_good {
            return;
        }
        let off = ((mv / MADE_FOR_MV - 1.0).clamp(-FURTHEST, FURTHEST) * WHOLE as f32) as i32;
        let before = if self.known.load(Relaxed) { self.off.load(Relaxed) } else { off };
        let off = before + (off - before) / SMOOTHED;
        self.off.store(off, Relaxed);
        // No further from a whole than that is from nine tenths of it.
        let short = -i64::from(off) * i64::from(WHOLE) / i64::from(WHOLE + off);
        self.short.store(short as i32, Relaxed);
        self.known.store(true, Relaxed);
    }

    /// Whether it is known to be out of tolerance.
    #[inline]
    pub fn bad(&self) -> bool {
        self.bad.load(Relaxed)
    }

    /// How far above [`MADE_FOR_MV`] it is, in 65,536ths of that; 0 where it was never measured to be good.
    #[inline]
    pub fn off(&self) -> i32 {
        coarse(&self.off)
    }

    /// How far above it [`MADE_FOR_MV`] is, in 65,536ths of it; 0 likewise.
    #[inline]
    pub fn short(&self) -> i32 {
        coarse(&self.short)
    }
}

/// In 65,536ths, rounded.
#[inline]
fn coarse(fine: &AtomicI32) -> i32 {
    (fine.load(Relaxed) + (1 << (FINER - 1))) >> FINER
}
