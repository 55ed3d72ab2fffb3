//! A transition from one displacement to another that is so slow that the drive's limits do not hold it up: s²(3 − 2s),
//! s from 0 to 1.
//!
//! A displacement that lags behind its voltage overshoots where it is wanted elsewhere from one tick to the next, for
//! the voltage then goes there as fast as it may.

use crate::Table;

/// How many times as long a transition takes as the slew rate would let it, were displacement and voltage proportional.
const UNHURRIED: f32 = 4.0;
/// Most ticks of a transition: their number is exact as an `f32`.
const LONGEST: f32 = (1 << 24) as f32;

/// Ticks that a transition takes by its distance, so that it is slow for the drive's slew rate.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pace {
    ticks_per_um: f32,
}

impl Pace {
    /// That of a table which has a drive.
    #[must_use]
    pub fn of(table: &Table) -> Option<Self> {
        let limits = table.drive?.limits;
        let whole_s = limits.range_v.span() / limits.slew_v_per_s;
        let ticks = UNHURRIED * whole_s / table.sample_period::<f32>();
        Some(Self { ticks_per_um: ticks / table.displacement_limits_um.span() })
    }

    /// Ticks of the transition between two displacements, µm; 1 at least.
    #[must_use]
    pub fn ticks(self, from: f32, to: f32) -> u32 {
        ((self.ticks_per_um * (to - from).abs()).min(LONGEST) as u32).max(1)
    }

    /// The same of the transition back from a line's last point to its first one; `None` where the ticks from each
    /// point to the next are enough for it, which it then takes like the others, straight.
    #[must_use]
    pub fn back(self, last: f32, first: f32, every: u16) -> Option<u32> {
        let ticks = self.ticks(last, first);
        (ticks > u32::from(every)).then_some(ticks)
    }
}

/// A transition between two displacements, µm, at rest at both ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Transition {
    from: f32,
    to: f32,
    ticks: u32,
    part: f32,
}

impl Transition {
    /// The transition between two displacements (µm) in so many ticks, 1 at least.
    #[must_use]
    pub fn new(from: f32, to: f32, ticks: u32) -> Self {
        Self { from, to, ticks, part: 1.0 / ticks as f32 }
    }

    /// Whether it is over so many ticks after its beginning.
    #[inline]
    #[must_use]
    pub fn is_over(&self, tick: u32) -> bool {
        tick >= self.ticks
    }

    /// Where it is then, µm.
    #[inline]
    #[must_use]
    pub fn at(&self, tick: u32) -> f32 {
        if self.is_over(tick) {
            return self.to;
        }
        let s = tick as f32 * self.part;
        self.from + (self.to - self.from) * (s * s * (3.0 - 2.0 * s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transition_begins_and_ends_at_rest_and_takes_as_long_as_it_is_far() {
        let pace = Pace { ticks_per_um: 10.0 };
        let ticks = pace.ticks(5.0, 15.0);
        assert_eq!((ticks, pace.ticks(15.0, 5.0), pace.ticks(3.0, 3.0)), (100, 100, 1));
        assert_eq!(pace.ticks(f32::MIN, f32::MAX), 1 << 24, "none is longer");
        assert_eq!((pace.back(15.0, 5.0, 100), pace.back(15.0, 5.0, 99)), (None, Some(100)));
        let transition = Transition::new(5.0, 15.0, ticks);
        let at: Vec<f32> = (0..=ticks + 5).map(|tick| transition.at(tick)).collect();
        assert_eq!((at[0], at[50], at[100], at[105]), (5.0, 10.0, 15.0, 15.0));
        let steps: Vec<f32> = at.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.iter().all(|&step| (0.0..=0.15001).contains(&step)), "half as fast again as on average at most");
        assert!(steps[0] < 0.004 && steps[99] < 0.004);
        assert!((0..100).all(|tick| !transition.is_over(tick)) && transition.is_over(100));
    }
}
