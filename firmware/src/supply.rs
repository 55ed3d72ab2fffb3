//! The analogue supply, which is the converters' reference: how far off it is, and what the monitor's code would be without.
//!
//! The monitor comes through a divider that adds a part of the supply, so that both signs of a voltage fit. That part's code is
//! the same at every supply; what the voltage adds to it goes down as the supply goes up. So the distance from the code of 0 V
//! is what is scaled. The set-point and the DAC are left as they are: a supply that is too high makes too little of the one and too
//! much of the other. So is the sensor's code: no table says what it is without the sensor's voltage.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU16, Ordering::Relaxed};
use estimator_core::{AdcCalibration, AdcCode};

/// What converters, dividers and calibrations are made for, mV.
pub const MADE_FOR_MV: f32 = 3300.0;
/// Furthest off that is corrected, as a part of [`MADE_FOR_MV`]; a code times that fits 32 bits. A board calls less than that a
/// fault.
const FURTHEST: f32 = 0.1;
/// Furthest that the code of 0 V is taken to be from the range, in ranges: far enough for any divider, and a code's distance
/// times what is off still fits 32 bits.
const BEYOND: f32 = 3.0;
/// Bits of what a measurement is kept in beyond those that a code is scaled with.
const FINER: u32 = 8;
/// A measurement counts for a part of so many, the ones before for the rest: those of 20 ms each settle in some 70 ms.
const SMOOTHED: i32 = 4;

/// What is known of the supply. The main loop writes it, the tick reads.
#[derive(Debug, Default)]
pub struct Supply {
    /// mV; 0 where it is not known.
    mv: AtomicU16,
    bad: AtomicBool,
    /// Whether the last measurement was within tolerance; none was yet at the start.
    was_good: AtomicBool,
    /// Whether one ever was.
    known: AtomicBool,
    /// Mean of those that were, less 1, in parts of [`MADE_FOR_MV`] of 2 to the power of 16 + [`FINER`].
    off: AtomicI32,
}

impl Supply {
    /// Nothing is known yet.
    pub const fn new() -> Self {
        Self {
            mv: AtomicU16::new(0),
            bad: AtomicBool::new(false),
            was_good: AtomicBool::new(false),
            known: AtomicBool::new(false),
            off: AtomicI32::new(0),
        }
    }

    /// The supply when it was measured last, mV; `None` where it cannot be.
    pub fn mv(&self) -> Option<u16> {
        Some(self.mv.load(Relaxed)).filter(|mv| *mv > 0)
    }

    /// Takes what it was found to be (mV), and whether that is within tolerance. Nothing is known to be wrong with one
    /// that cannot be measured. A measurement that is out of tolerance alone, after a good one, may be a disturbance: the next
    /// one decides. The first of all is believed. Codes are corrected by good ones only.
    pub fn take(&self, mv: Option<f32>, good: fn(f32) -> bool) {
        self.mv.store(mv.map_or(0, |mv| (mv + 0.5) as u16), Relaxed);
        let is_good = mv.is_none_or(good);
        let was_good = self.was_good.load(Relaxed);
        self.bad.store(!is_good && !was_good, Relaxed);
        self.was_good.store(is_good, Relaxed);
        let Some(mv) = mv.filter(|_| is_good) else { return };
        let off = ((mv / MADE_FOR_MV - 1.0).clamp(-FURTHEST, FURTHEST) * (65_536 << FINER) as f32) as i32;
        let before = if self.known.load(Relaxed) { self.off.load(Relaxed) } else { off };
        self.off.store(before + (off - before) / SMOOTHED, Relaxed);
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
        (self.off.load(Relaxed) + (1 << (FINER - 1))) >> FINER
    }
}

/// The monitor's code as it would be at [`MADE_FOR_MV`].
#[derive(Clone, Debug)]
pub struct Correction {
    /// The code of 0 V, which may lie beyond the range.
    zero: i32,
    full_scale: i32,
    /// How far off the supply is taken to be, in 65,536ths; `None` before the first tick of an estimate.
    off: Option<i32>,
}

impl Correction {
    /// For codes of this calibration.
    pub fn new(adc: &AdcCalibration) -> Self {
        let full_scale = f32::from(adc.full_scale);
        let gain = if adc.invert { -adc.gain_v_per_code } else { adc.gain_v_per_code };
        let zero = (-adc.offset_v / gain).clamp(-BEYOND * full_scale, (1.0 + BEYOND) * full_scale);
        Self { zero: zero as i32, full_scale: adc.full_scale.into(), off: None }
    }

    /// The estimate begins anew: the next tick may scale as it likes.
    pub fn restart(&mut self) {
        self.off = None;
    }

    /// One tick: goes towards what the supply is off by, a 65,536th at most, so that no code moves by more than one for it; and
    /// corrects the code. One beyond the range is at its end.
    #[inline]
    pub fn tick(&mut self, off: i32, AdcCode(code): AdcCode) -> AdcCode {
        let off = self.off.map_or(off, |before| before + (off - before).signum());
        self.off = Some(off);
        let code = i32::from(code);
        let corrected = code + (((code - self.zero) * off + (1 << 15)) >> 16);
        // Between 0 and a code.
        AdcCode(corrected.clamp(0, self.full_scale) as u16)
    }
}
