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
}

/// What goes where the DAC is wanted, by a stride a tick and no more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Slewed {
    /// 65,536ths of a part.
    at: u32,
}

impl Slewed {
    /// At what the DAC is given.
    pub const fn at(DacParts(parts): DacParts) -> Self {
        Self { at: (parts as u32) << 16 }
    }

    /// What the DAC is given there.
    pub const fn given(self) -> DacParts {
        DacParts((self.at >> 16) as u16)
    }

    /// One tick. What is returned is `to` itself within so many parts, which rounding makes of a stride: a command that
    /// keeps the slew rate passes as it is, and one that is further away is come to at the slew rate.
    #[inline]
    pub fn step(&mut self, to: DacParts, stride: Stride, rounding: u16) -> DacParts {
        let Self { at: wanted } = Self::at(to);
        let stride = stride.get();
        self.at = wanted.clamp(self.at.saturating_sub(stride), self.at.saturating_add(stride));
        let (DacParts(at), DacParts(to)) = (self.given(), to);
        DacParts(to.clamp(at.saturating_sub(rounding), at.saturating_add(rounding)))
    }
}

/// What the DAC is given on the way, one a tick, the last for its safe code.
#[derive(Clone, Debug)]
pub struct Ramp {
    at: Slewed,
    safe: DacParts,
    stride: Stride,
    done: bool,
}

impl Ramp {
    /// From what it is given to what it is given for its safe code.
    pub fn new(from: DacParts, safe: DacParts, stride: Stride) -> Self {
        Self { at: Slewed::at(from), safe, stride, done: false }
    }
}

impl Iterator for Ramp {
    type Item = DacParts;

    fn next(&mut self) -> Option<DacParts> {
        if self.done {
            return None;
        }
        let given = self.at.step(self.safe, self.stride, 0);
        self.done = self.at == Slewed::at(self.safe);
        Some(given)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_that_keeps_the_slew_rate_passes_as_it_is_to_within_its_rounding() {
        for stride in [0.053, 0.5, 1.6, 20.48, 327.3] {
            let mut slewed = Slewed::at(DacParts(1_000));
            for tick in 1..60_000 {
                let exact = f64::from(stride) * f64::from(tick);
                let wanted = DacParts(1_000 + (exact + f64::from(tick % 3)).min(60_000.0) as u16);
                assert_eq!(slewed.step(wanted, Stride::of(stride), 4), wanted, "{stride}, tick {tick}");
            }
        }
    }

    #[test]
    fn what_is_further_away_is_come_to_at_the_slew_rate_however_slow_it_is() {
        for (from, to) in [(0, 3_000), (3_000, 0), (65_520, 60_000)] {
            for stride in [0.053, 1.6, 20.48] {
                let mut slewed = Slewed::at(DacParts(from));
                let mut last = from;
                for tick in 1..=2_000 {
                    let DacParts(given) = slewed.step(DacParts(to), Stride::of(stride), 4);
                    let most = stride * tick as f32 + 5.0;
                    assert!(
                        f32::from(given.abs_diff(from)) <= most,
                        "{from} to {to}, {stride}: {given} in {tick} ticks"
                    );
                    assert!(f32::from(given.abs_diff(last)) <= stride.ceil() + 5.0, "{from} to {to}: {last}, {given}");
                    last = given;
                }
                assert!(stride < 2.0 || last == to, "{from} to {to}, {stride}: {last}");
            }
        }
        let mut jumps = Slewed::at(DacParts(0));
        assert_eq!(jumps.step(DacParts(65_520), Stride::JUMP, 4), DacParts(65_520));
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
