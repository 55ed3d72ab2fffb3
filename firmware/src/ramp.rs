//! How far the DAC's code may go in a tick, and the way to its safe one for whoever has to go it without the tick: after a panic or
//! a hard fault.

use estimator_core::DacCode;

/// Most that the DAC's code may change in a tick on its way to the safe one, in 65,536ths of a code.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stride(pub u32);

impl Stride {
    /// The code may jump: it drives nothing.
    pub const JUMP: Self = Self(u32::MAX);

    /// Of so many codes a tick; at least the smallest there is.
    pub fn of(codes: f32) -> Self {
        // Saturates at the ends, and NaN is 0.
        Self(((codes * 65_536.0) as u32).max(1))
    }

    /// `to`, limited to one stride from `from`, plus `more` for what rounding makes of both.
    #[inline]
    pub fn limit(self, DacCode(from): DacCode, DacCode(to): DacCode, more: u16) -> DacCode {
        // Of a jump it is the whole range.
        let most = ((self.0 >> 16) as u16).saturating_add(more);
        DacCode(to.clamp(from.saturating_sub(most), from.saturating_add(most)))
    }
}

/// The codes of the way, one a tick, the safe one last.
#[derive(Clone, Debug)]
pub struct Ramp {
    /// 65,536ths of a code, as below.
    at: u32,
    safe: u32,
    stride: Stride,
    done: bool,
}

impl Ramp {
    /// From a code to the safe one.
    pub fn new(from: DacCode, safe: DacCode, stride: Stride) -> Self {
        let fine = |DacCode(code)| u32::from(code) << 16;
        Self { at: fine(from), safe: fine(safe), stride, done: false }
    }

    /// Ticks that the way takes.
    pub fn ticks(&self) -> u32 {
        self.at.abs_diff(self.safe).div_ceil(self.stride.0)
    }
}

impl Iterator for Ramp {
    type Item = DacCode;

    fn next(&mut self) -> Option<DacCode> {
        if self.done {
            return None;
        }
        let Stride(stride) = self.stride;
        self.at = self.safe.clamp(self.at.saturating_sub(stride), self.at.saturating_add(stride));
        self.done = self.at == self.safe;
        Some(DacCode((self.at >> 16) as u16))
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
            assert_eq!(stride.limit(DacCode(from), DacCode(to), 1), DacCode(limited), "{from} to {to}");
        }
        assert_eq!(Stride::JUMP.limit(DacCode(0), DacCode(65_520), 1), DacCode(65_520));
    }

    #[test]
    fn no_step_is_longer_than_the_stride_and_the_last_code_is_the_safe_one() {
        for (from, safe, codes) in [(4095, 512, 20.48), (0, 4095, 0.3), (512, 512, 1.0), (7, 4000, 1e9), (7, 0, 0.0)] {
            let (from, safe, stride) = (DacCode(from), DacCode(safe), Stride::of(codes));
            let ramp = Ramp::new(from, safe, stride);
            let ticks = ramp.ticks();
            let way: Vec<u16> = ramp.map(|code| code.0).collect();
            let before = std::iter::once(&from.0).chain(&way);
            let longest = before.zip(&way).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(f32::from(longest) <= codes.ceil().max(1.0), "{from:?}, {codes}: {longest}");
            assert_eq!((way.last(), way.len()), (Some(&safe.0), ticks.max(1) as usize), "{from:?}, {codes}");
        }
    }

    #[test]
    fn what_drives_nothing_jumps() {
        assert!(Ramp::new(DacCode(4095), DacCode(7), Stride::JUMP).eq([DacCode(7)]));
        assert!(Ramp::new(DacCode(0), DacCode(u16::MAX), Stride::of(f32::INFINITY)).eq([DacCode(u16::MAX)]));
    }
}
