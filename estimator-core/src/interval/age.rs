//! Decades of time since the start of an estimate, counted in steps of 1/64 of the time that has gone by.

use crate::math::Real;

/// The age counts from this long before the start, s: creep begins somewhere.
pub(super) const BEGINNING_S: f32 = 0.05;
/// The age is stepped on when the time since then has grown by this factor, and by its decimal logarithm.
const STEP: f32 = 65.0 / 64.0;
const STEP_DECADES: f32 = 0.006_733_383;
/// Where so many ticks have been counted, they go on from fewer at the next step. Such steps are shorter than 2³²
/// ticks, which is as far as is counted, for the first 238 days at 10 kHz; only after these does the age stand still.
const MANY: u32 = 1 << 30;
const FEWEST: u32 = 1 << 29;

/// How long ago the start was. (Of 64 bits, or in a function of its own, the count would cost each tick more.)
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Age<T> {
    /// Ticks since the start; where there were [`MANY`], any number from [`FEWEST`] on.
    ticks: u32,
    /// What they are less than those from [`BEGINNING_S`] before the start on.
    before: T,
    /// Ticks from [`BEGINNING_S`] before the start to where the age is stepped on.
    next: T,
}

impl<T: Real> Age<T> {
    /// At the start, before which lie so many ticks.
    pub fn start(before: T) -> Self {
        Self { ticks: 0, before, next: before * T::of(STEP) }
    }

    /// Whether so many ticks have come since the start, or [`FEWEST`], if that is less.
    pub fn reaches(&self, ticks: u32) -> bool {
        self.ticks >= ticks.min(FEWEST)
    }

    /// Ticks from [`BEGINNING_S`] before the start on.
    #[inline]
    fn since_beginning(&self) -> T {
        self.before + T::of(self.ticks as f32)
    }

    /// One tick; the decades by which the age is stepped on, at the few ticks at which it is: by one step where ticks
    /// are short, and by many where they are long.
    #[inline]
    pub fn tick(&mut self) -> Option<T> {
        self.ticks = self.ticks.wrapping_add(1);
        let now = self.since_beginning();
        if now < self.next {
            return None;
        }
        if self.ticks > MANY {
            (self.ticks, self.before) = (FEWEST, now - T::of(FEWEST as f32));
        }
        let mut decades = T::zero();
        loop {
            self.next = self.next * T::of(STEP);
            decades = decades + T::of(STEP_DECADES);
            if now < self.next {
                return Some(decades);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn started<T: Real>(sample_period: f32) -> Age<T> {
        Age::start(T::of(BEGINNING_S) / T::of(sample_period))
    }

    /// Decades that are counted in so many ticks, in `f32` and in `f64`.
    fn counted(sample_period: f32, ticks: u64) -> [f64; 2] {
        fn of<T: Real>(mut age: Age<T>, ticks: u64) -> f64 {
            let decades = (0..ticks).filter_map(|_| age.tick()).fold(T::zero(), |sum, decades| sum + decades);
            decades.to_f64().unwrap()
        }
        [of::<f32>(started(sample_period), ticks), of::<f64>(started(sample_period), ticks)]
    }

    /// Decades from the start to the tick.
    fn decades(ticks: u64, sample_period: f32) -> f64 {
        (1.0 + ticks as f64 * f64::from(sample_period) / f64::from(BEGINNING_S)).log10()
    }

    #[test]
    fn decades_are_counted_to_within_a_step_however_long_a_tick_is() {
        for sample_period in [5e-4f32, 5e-3, 0.05, 1.0] {
            for ticks in [1, 2, 10, 64, 1_000, 100_000] {
                for counted in counted(sample_period, ticks) {
                    let missing = decades(ticks, sample_period) - counted;
                    assert!(
                        missing.abs() < 1.1 * f64::from(STEP_DECADES),
                        "{ticks} ticks of {sample_period} s: {missing} decades"
                    );
                }
            }
        }
    }

    #[test]
    fn it_grows_on_beyond_what_32_bits_count() {
        let mut age = started::<f32>(1e-4);
        let (mut ticks, mut counted) = (0, 0.0);
        while ticks < 44 << 32 {
            // All ticks but the last of those to the next step.
            let skipped = (age.next - age.since_beginning()) as u32;
            age.ticks += skipped;
            ticks += u64::from(skipped) + 1;
            counted += f64::from(age.tick().unwrap_or(0.0));
            let missing = decades(ticks, 1e-4) - counted;
            assert!(missing.abs() < 1.1 * f64::from(STEP_DECADES), "{ticks} ticks: {missing} decades");
        }
    }
}
