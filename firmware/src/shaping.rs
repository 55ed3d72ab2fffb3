//! More steps than a DAC has: between two codes it is switched to and fro so fast that a low-pass behind it shows what
//! lies between them.
//!
//! First-order noise shaping: what a code is off by is carried over to the next one, so that the mean of many is what
//! is wanted to a part of a code, and what they are off by lies at frequencies that the low-pass stops. A wish that
//! stands still is made of its two neighbours and no other code. S. R. Norsworthy, R. Schreier, G. C. Temes,
//! Delta-Sigma Data Converters, IEEE Press 1997, chapter 1.

use estimator_core::DacCode;

/// Parts into which the board's DAC divides a code, where codes are shaped.
pub const PARTS: u16 = 1 << PART_BITS;
const PART_BITS: u32 = 4;

/// What a DAC is given: a code and its fraction, in parts of a code
/// ([`Facts::dac_parts`](crate::Facts::dac_parts) to each).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct DacParts(pub u16);

/// What a DAC is to have: as the table says it, and as it is given.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Codes {
    /// The nearest code.
    pub code: DacCode,
    /// The nearest part of a code.
    pub parts: DacParts,
}

/// What the codes so far are short of what was wanted.
#[derive(Clone, Debug, Default)]
pub struct Shaper {
    /// The last code in the upper half-word; in the lower, what is carried over to the next, in 65,536ths of a code.
    carried: u32,
}

impl Shaper {
    /// Nothing is carried over yet.
    pub const fn new() -> Self {
        Self { carried: 0 }
    }

    /// The next codes, two a word, the first one below; `wanted` in [`PARTS`] of a code. No code is beyond the two
    /// neighbours of what is wanted, and none beyond the range: its end has no parts.
    #[inline]
    pub fn fill(&mut self, DacParts(wanted): DacParts, words: &mut [u32]) {
        let step = u32::from(wanted) << (16 - PART_BITS);
        let mut carried = self.carried;
        for word in words {
            let first = step + (carried & 0xFFFF);
            carried = step + (first & 0xFFFF);
            *word = (carried & 0xFFFF_0000) | (first >> 16);
        }
        self.carried = carried;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of a tick at a hundred thousand a second.
    const CODES: usize = 50;
    const MOST: u16 = 4095 * PARTS;

    fn codes(shaper: &mut Shaper, wanted: u16) -> Vec<u32> {
        let mut words = [0; CODES / 2];
        shaper.fill(DacParts(wanted), &mut words);
        words.iter().flat_map(|word| [word & 0xFFFF, word >> 16]).collect()
    }

    #[test]
    fn the_mean_of_a_tick_is_what_is_wanted_to_less_than_a_part_of_neighbours_alone() {
        let mut shaper = Shaper::new();
        let ramp = (0..=MOST).step_by(7).chain((0..=MOST).rev().step_by(331));
        let jumps = (0..3_000u32).map(|k| (k * k % (u32::from(MOST) + 1)) as u16);
        for wanted in ramp.chain(jumps).chain([0, 1, MOST - 1, MOST, 0, MOST]) {
            let codes = codes(&mut shaper, wanted);
            let mean = codes.iter().sum::<u32>() as f64 / CODES as f64;
            let exact = f64::from(wanted) / f64::from(PARTS);
            assert!((mean - exact).abs() < 1.0 / f64::from(PARTS), "{wanted}: {mean} for {exact}");
            let neighbours = [exact.floor(), exact.ceil()].map(|code| code as u32);
            assert!(codes.iter().all(|code| neighbours.contains(code)), "{wanted}: {codes:?}");
        }
    }

    #[test]
    fn what_stands_still_is_what_is_wanted_in_the_end() {
        for wanted in [0, 1, 7, 8, 33_333, MOST - 1, MOST] {
            let mut shaper = Shaper::new();
            let ticks = 160;
            let sum: u32 = (0..ticks).flat_map(|_| codes(&mut shaper, wanted)).sum();
            assert_eq!(sum * u32::from(PARTS), u32::from(wanted) * ticks * CODES as u32, "{wanted}");
        }
    }
}
