//! How far what the DAC is given may go in a tick, and the way to its safe code for whoever has to go it without the
//! tick: after a panic or a hard fault.

use crate::shaping::DacParts;
use core::num::NonZeroU32;

/// Most that a DAC may change in a tick, in 65,536ths: of a code, or of a part of a code, as its owner says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stride(NonZeroU32);

impl Stride {
    /// From any code to any other.
    pub const JUMP: Self = Self(NonZeroU32::MAX);

    /// Of so many 65,536ths a tick; at least one.
    pub const fn new(most: u32) -> Self {
        match NonZeroU32::new(most) {
            Some(most) => Self(most),
            None => Self(NonZeroU32::MIN),
        }
    }

    /// Most that may change in a tick, in 65,536ths; at least 1.
    pub const fn get(self) -> u32 {
        self.0.get()
    }

    /// Of so many a tick; at least the smallest there is.
    pub fn of(most: f32) -> Self {
        // Saturates at the ends, and NaN is 0.
        Self::new((most * 65_536.0) as u32)
    }

    /// Ticks that a way from the one to the other takes.
    pub const fn ticks(self, from: u16, to: u16) -> u32 {
        (from.abs_diff(to) as u32 * 65_536).div_ceil(self.get())
    }

    /// `to`, limited to one stride from `from`, plus `more` for what rounding makes of both.
    #[inline]
    pub fn limit(self, DacParts(from): DacParts, DacParts(to): DacParts, more: u16) -> DacParts {
        // Of a jump it is the whole range.
        let most = ((self.get() >> 16) as u16).saturating_add(more);
        DacParts(to.clamp(from.saturating_sub(most), from.saturating_add(most)))
    }
}

/// What the DAC is given on the way, one a tick, the last for its safe code.
#[derive(Clone, Debug)]
pub struct Ramp {
    /// 65,536ths of a part, as below.
    at: u32,
    safe: u32,
    stride: Stride,
    done: bool,
}

impl Ramp {
    /// From what it is given to what it is given for its safe code.
    pub fn new(from: DacParts, safe: DacParts, stride: Stride) -> Self {
        let fine = |DacParts(parts)| u32::from(parts) << 16;
        Self { at: fine(from), safe: fine(safe), stride, done: false }
    }
}

impl Iterator for Ramp {
    type Item = DacParts;

    fn next(&mut self) -> Option<DacParts> {
        if self.done {
            return None;
        }
        let stride = self.stride.get();
        self.at = self.safe.clamp(self.at.saturating_sub(stride), self.at.saturating_add(stride));
        self.done = self.at == self.safe;
        Some(DacParts((self.at >> 16) as u16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_the_stride_is_reached_and_what_is_beyond_is_not() {
        let stride = Stride::of(20.48);
        for (from, to, limited) in
            [(100, 120, 120), (100, 121, 121), (100, 122, 121), (100, 0, 79), (5, 0, 0), (5, 9_999, 26)]
        {
            assert_eq!(stride.limit(DacParts(from), DacParts(to), 1), DacParts(limited), "{from} to {to}");
        }
        assert_eq!(Stride::JUMP.limit(DacParts(0), DacParts(65_520), 1), DacParts(65_520));
    }

    #[test]
    fn no_step_is_longer_than_the_stride_and_the_last_code_is_the_safe_one() {
        for (from, safe, codes) in [(4095, 512, 20.48), (0, 4095, 0.3), (512, 512, 1.0), (7, 4000, 1e9), (7, 0, 0.0)] {
            let stride = Stride::of(codes);
            let ticks = stride.ticks(from, safe);
            let way: Vec<u16> =
                Ramp::new(DacParts(from), DacParts(safe), stride).map(|DacParts(parts)| parts).collect();
            let before = std::iter::once(&from).chain(&way);
            let longest = before.zip(&way).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(f32::from(longest) <= codes.ceil().max(1.0), "{from:?}, {codes}: {longest}");
            assert_eq!((way.last(), way.len()), (Some(&safe), ticks.max(1) as usize), "{from:?}, {codes}");
        }
    }

    #[test]
    fn what_drives_nothing_jumps() {
        assert!(Ramp::new(DacParts(4095), DacParts(7), Stride::JUMP).eq([DacParts(7)]));
        assert!(Ramp::new(DacParts(0), DacParts(u16::MAX), Stride::of(f32::INFINITY)).eq([DacParts(u16::MAX)]));
    }
}
