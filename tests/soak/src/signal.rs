//! What the converter of a soaked device reads at each of its ticks.

use estimator_core::AdcCode;

/// The code of a tick, counted from the converter's first.
pub type Signal = fn(u32) -> AdcCode;

/// Ticks of the triangle.
const SECOND: u32 = 2_000;

/// Ticks of a swing up and down.
const PERIOD: u32 = 1_900;
/// The middle of the range, and how far a swing goes from there at most.
const MIDDLE: i64 = 32_500;
const HALF: i64 = 29_000;
/// Parts of that, swing after swing: within each other, and beyond.
const PARTS: [i64; 7] = [100, 60, 90, 30, 75, 45, 100];
/// Every so many ticks, a glitch to an end of the range.
const GLITCH: u32 = 9_973;

/// What stands for a converter in the image for the MPS2 (`firmware/src/board/mps2_an386/main.rs`): a triangle of 1 Hz
/// between 3,000 and 62,000.
pub fn triangle(tick: u32) -> AdcCode {
    let phase = tick % SECOND;
    // At most 62,000.
    AdcCode((3_000 + 118_000 * phase.min(SECOND - phase) / SECOND) as u16)
}

/// Swings of several sizes, noise, and now and then a glitch: the [`crate::device`]'s.
pub fn swings(tick: u32) -> AdcCode {
    let noise = mixed(tick);
    if tick % GLITCH == GLITCH - 1 {
        return AdcCode(if noise.is_multiple_of(2) { 0 } else { 65_520 });
    }
    let (swing, phase) = (tick / PERIOD, i64::from(tick % PERIOD));
    let part = PARTS[swing as usize % PARTS.len()];
    let half = i64::from(PERIOD / 2);
    // From −half to half and back.
    let height = half - 2 * (phase - half).abs();
    let code = MIDDLE + HALF * part * height / (100 * half) + i64::from(noise % 64);
    // Within 3,500 … 61,600.
    AdcCode(code as u16)
}

/// Bits that look like chance (splitmix).
fn mixed(tick: u32) -> u32 {
    let mut bits = u64::from(tick).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (bits >> 40) as u32
}
