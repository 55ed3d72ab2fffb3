//! How far the analogue supply, which is the converters' reference, is off its nominal voltage. [`crate::correction`]
//! corrects the codes by it.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU16, Ordering::Relaxed};

/// What converters, dividers and calibrations are made for, mV.
pub const MADE_FOR_MV: f32 = 3300.0;
/// How far off that it may be: more is a fault, and is not corrected, so that a code times the deviation fits 32 bits.
pub const TOLERANCE: f32 = 0.05;
/// Bits of the smoothed deviation beyond the 16 that a code is scaled by.
const FINER: u32 = 8;
/// Smoothing: mean ← mean + (measured − mean)/4. With a measurement every 20 ms it settles in 70 ms.
const SMOOTHED: i32 = 4;
/// So many measurements in a row that do not come are a fault: 60 ms.
pub const MISSING: u8 = 3;
/// A relative deviation of 1, as it is kept.
const WHOLE: i32 = 65_536 << FINER;

/// What the measurements so far say. The main loop has it, and publishes it as [`Supply`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// The last one, mV.
    mv: Option<u16>,
    /// Measurements in a row that did not come.
    missing: u8,
    /// Whether the last one was within tolerance; `false` before the first.
    was_good: bool,
    /// Whether the supply is known to be out of tolerance.
    bad: bool,
    /// (V − 3.3 V)/3.3 V, smoothed over the measurements within tolerance, in parts of [`WHOLE`].
    off: Option<i32>,
}

impl Measured {
    /// What a first measurement (mV) says, or that there is none.
    pub fn of(mv: Option<f32>) -> Self {
        let mut measured = Self::default();
        measured.take(mv);
        measured
    }

    /// Takes a measurement (mV), or that none has come.
    ///
    /// A supply that was never measured is no fault. Once it was, [`MISSING`] measurements in a row that do not come
    /// are one: codes are corrected by a voltage that may have changed. A single measurement out of tolerance after a
    /// good one may be a disturbance, and the next one decides; the very first is believed. Codes are corrected by
    /// measurements within tolerance only.
    pub fn take(&mut self, mv: Option<f32>) {
        let Some(mv) = mv else {
            if self.mv.is_some() {
                self.missing = self.missing.saturating_add(1);
                if self.missing >= MISSING {
                    // The next one that is out of tolerance is not alone after a good one.
                    (self.bad, self.was_good) = (true, false);
                }
            }
            return;
        };
        self.missing = 0;
        self.mv = Some((mv + 0.5) as u16).filter(|mv| *mv > 0);
        let off = mv / MADE_FOR_MV - 1.0;
        let is_good = off.abs() <= TOLERANCE;
        self.bad = !is_good && !self.was_good;
        self.was_good = is_good;
        if is_good {
            let off = (off * WHOLE as f32) as i32;
            let before = self.off.unwrap_or(off);
            self.off = Some(before + (off - before) / SMOOTHED);
        }
    }
}

/// What is known of the supply. The main loop writes it, the tick reads.
#[derive(Debug, Default)]
pub struct Supply {
    /// mV; 0 where it is not known.
    mv: AtomicU16,
    bad: AtomicBool,
    /// As [`Measured::off`]; 0 where it is not known.
    off: AtomicI32,
    /// (3.3 V − V)/V of the same V, in parts of [`WHOLE`].
    short: AtomicI32,
}

impl Supply {
    /// Nothing is known yet.
    pub const fn new() -> Self {
        Self { mv: AtomicU16::new(0), bad: AtomicBool::new(false), off: AtomicI32::new(0), short: AtomicI32::new(0) }
    }

    /// Publishes what the measurements say.
    pub fn publish(&self, measured: &Measured) {
        let off = measured.off.unwrap_or(0);
        // No further from a whole than that is from nineteen twentieths of it.
        let short = -i64::from(off) * i64::from(WHOLE) / i64::from(WHOLE + off);
        self.mv.store(measured.mv.unwrap_or(0), Relaxed);
        self.off.store(off, Relaxed);
        self.short.store(short as i32, Relaxed);
        self.bad.store(measured.bad, Relaxed);
    }

    /// The supply when it was measured last, mV; `None` where it cannot be.
    pub fn mv(&self) -> Option<u16> {
        Some(self.mv.load(Relaxed)).filter(|mv| *mv > 0)
    }

    /// Whether it is known to be out of tolerance.
    #[inline]
    pub fn bad(&self) -> bool {
        self.bad.load(Relaxed)
    }

    /// (V − V₀)/V₀ of the supply V and [`MADE_FOR_MV`] V₀, in 65,536ths; 0 where it was never measured to be good.
    #[inline]
    pub fn off(&self) -> i32 {
        coarse(&self.off)
    }

    /// (V₀ − V)/V likewise.
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
