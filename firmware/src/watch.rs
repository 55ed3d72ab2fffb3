//! When odd ticks become a fault, and when the fault has passed.
//!
//! One odd tick is a status bit in its sample. A fault is a leaky bucket that is full: an odd tick adds [`ODD`], a good
//! one takes 1 away, so that a voltage that is clipped for a fifth of the time is found as well as one that always is.
//! A tick that did not come is an odd one.
//! A fault lasts until [`HOLD`] ticks after the last cause, so that the output does not flicker between safe and wrong.

use crate::rate::{TICK_HZ, ticks_in};
use estimator_core::{AdcCode, Status};
use protocol::Faults;

/// Odd ticks in a row, near an end of the ADC's range, that are a fault: 10 ms.
pub const SATURATED: u32 = ticks_in(10);
/// Ticks in a row with one and the same code that are a fault: 1 s, and 2,000 at least. With sixteenfold oversampling
/// the converter's own noise moves the code hundreds of times a second, whatever its input does; even where it is as
/// little as 0.15 of a step rms (one of 12 bits, of a single conversion), with the input in the middle of a step, so
/// many equal codes come once in a trillion.
pub const STUCK: u32 = if TICK_HZ < 2_000 { 2_000 } else { TICK_HZ };
/// The same of the set-point: 10 s. A controller may hold it by right, and nothing is estimated of it.
pub const SETPOINT_STUCK: u32 = 10 * TICK_HZ;
/// Odd ticks in a row, beyond the table's voltage range, that are a fault: 1 s.
pub const OUT_OF_RANGE: u32 = TICK_HZ;
/// Odd ticks in a row, with the amplifier not where the drive commands it, that are a fault: 100 ms.
pub const ASTRAY: u32 = ticks_in(100);
/// Late or missed ticks in a row that are a fault of the output too: 10 ms, in one gap or in many. One alone costs the
/// estimate one step.
pub const MISSED: u32 = ticks_in(10);
/// How long a fault outlasts its cause: 1 s.
pub const HOLD: u32 = TICK_HZ;
/// What an odd tick weighs.
pub const ODD: u32 = 4;
/// This part of the ADC's range at either end is too near the end: an amplifier in front of it, or an offset of its
/// own, may keep a saturated input from its very last code.
const MARGIN: u16 = 128;

/// The ends of an ADC's range.
#[derive(Clone, Debug)]
pub struct Ends {
    good_codes: core::ops::Range<u16>,
}

impl Ends {
    /// For an ADC with this largest code.
    pub fn new(adc_full_scale: u16) -> Self {
        let margin = adc_full_scale / MARGIN;
        Self { good_codes: margin + 1..adc_full_scale - margin }
    }

    /// Whether a code is too near one of them to be believed.
    #[inline]
    pub fn near(&self, AdcCode(code): AdcCode) -> bool {
        !self.good_codes.contains(&code)
    }
}

/// The scores of one channel.
#[derive(Clone, Debug)]
struct Channel {
    ends: Ends,
    /// Ticks with one code that are too many.
    stuck: u32,
    last: Option<AdcCode>,
    same: u32,
    saturated: u32,
}

impl Channel {
    fn new(adc_full_scale: u16, stuck: u32) -> Self {
        Self { ends: Ends::new(adc_full_scale), stuck, last: None, same: 0, saturated: 0 }
    }

    /// Takes a code, and says whether the channel saturates, and whether it has stopped.
    #[inline]
    fn update(&mut self, code: AdcCode) -> (bool, bool) {
        self.same = if self.last == Some(code) { self.same.saturating_add(1) } else { 0 };
        self.last = Some(code);
        (score(&mut self.saturated, self.ends.near(code), SATURATED), self.same >= self.stuck)
    }
}

/// What the watch is told of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The monitor's code.
    pub monitor: AdcCode,
    /// The set-point's, where that matters.
    pub setpoint: Option<AdcCode>,
    /// The estimate's status.
    pub status: Status,
    /// Ticks that came late or not at all: this one, and those before it that are missing.
    pub missed: u32,
    /// The amplifier is not where the drive commands it.
    pub astray: bool,
    /// The faults that others have found.
    pub others: Faults,
}

/// The scores so far.
#[derive(Clone, Debug)]
pub struct Watch {
    monitor: Channel,
    setpoint: Channel,
    out_of_range: u32,
    missed: u32,
    astray: u32,
    found: Faults,
    hold: u32,
}

/// Whether a score has reached its limit.
#[inline]
pub(crate) fn score(score: &mut u32, odd: bool, limit: u32) -> bool {
    score_of(score, u32::from(odd), limit)
}

/// The same of several odd ticks at once.
#[inline]
fn score_of(score: &mut u32, odd: u32, limit: u32) -> bool {
    *score = match odd {
        0 => score.saturating_sub(1),
        // No more than the limit count, so that this fits.
        _ => (*score + ODD * odd.min(limit)).min(ODD * limit),
    };
    *score >= ODD * limit
}

impl Watch {
    /// For an ADC with this largest code.
    pub fn new(adc_full_scale: u16) -> Self {
        Self {
            monitor: Channel::new(adc_full_scale, STUCK),
            setpoint: Channel::new(adc_full_scale, SETPOINT_STUCK),
            out_of_range: 0,
            missed: 0,
            astray: 0,
            found: Faults::empty(),
            hold: 0,
        }
    }

    /// Another mode begins. It ends no fault but that of the set-point, which only one mode follows: what was
    /// seen of the converter is none of the mode's, and an amplifier that went astray is believed a second after
    /// it was last driven.
    pub fn change_mode(&mut self) {
        (self.setpoint.last, self.setpoint.same, self.setpoint.saturated) = (None, 0, 0);
        self.astray = 0;
        self.found.remove(Faults::SETPOINT);
        if self.found.is_empty() {
            self.hold = 0;
        }
    }

    /// Whether ticks come so late, or so seldom, that it is a fault.
    pub fn late(&self) -> bool {
        self.found.contains(Faults::MISSED_DEADLINE)
    }

    /// Whether nothing lasts that an estimate [`suffers`] from.
    pub fn sound(&self) -> bool {
        !suffers(self.found)
    }

    /// Takes what is seen of one tick, and says which faults last after it.
    #[inline(always)]
    pub fn update(&mut self, seen: Seen) -> FaultState {
        let Seen { monitor, setpoint, status, missed, astray, others } = seen;
        let beyond = status.contains(Status::VOLTAGE_OUT_OF_RANGE);
        let (saturated, stuck) = self.monitor.update(monitor);
        let mut now = others;
        now.set(Faults::ADC_SATURATED, saturated);
        now.set(Faults::OUT_OF_CALIBRATION, score(&mut self.out_of_range, beyond, OUT_OF_RANGE));
        now.set(Faults::ADC_STUCK, stuck);
        if let Some(code) = setpoint {
            let (saturated, stuck) = self.setpoint.update(code);
            now.set(Faults::SETPOINT, saturated || stuck);
        }
        now.set(Faults::MISSED_DEADLINE, score_of(&mut self.missed, missed, MISSED));
        now.set(Faults::AMPLIFIER, score(&mut self.astray, astray, ASTRAY));
        if !now.is_empty() {
            self.found |= now;
            self.hold = HOLD;
        } else if self.hold > 0 {
            self.hold -= 1;
            if self.hold == 0 {
                return FaultState::Recovered(core::mem::take(&mut self.found));
            }
        }
        if self.found.is_empty() { FaultState::Healthy } else { FaultState::Faulty(self.found) }
    }
}

/// Whether an estimate suffers from any of these faults: of the set-point nothing is estimated, and the tick goes on
/// where the main loop stands still.
pub fn suffers(faults: Faults) -> bool {
    !Faults::SETPOINT.union(Faults::STALLED).contains(faults)
}

/// What [`Watch::update`] finds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaultState {
    /// There is no fault.
    Healthy,
    /// The last of these faults has passed with this tick, whose estimate is still made of what they brought.
    Recovered(Faults),
    /// These faults last: the output is not to be believed.
    Faulty(Faults),
}

impl FaultState {
    /// The faults that last at this tick.
    pub fn lasting(self) -> Faults {
        match self {
            Self::Healthy => Faults::empty(),
            Self::Recovered(faults) | Self::Faulty(faults) => faults,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: u16 = 65_520;
    const GOOD: Status = Status::empty();

    fn moving(k: u32) -> AdcCode {
        AdcCode(30_000 + (k % 2) as u16)
    }

    /// Ticks until a fault shows, and from its last cause until it has passed.
    fn life(tick: impl Fn(u32) -> (AdcCode, Status, bool, bool)) -> (u32, Faults, u32) {
        life_of(|k| seen(tick(k)))
    }

    fn seen((monitor, status, missed, astray): (AdcCode, Status, bool, bool)) -> Seen {
        Seen { monitor, setpoint: None, status, missed: missed.into(), astray, others: Faults::empty() }
    }

    /// The same of ticks of which more is seen.
    fn life_of(tick: impl Fn(u32) -> Seen) -> (u32, Faults, u32) {
        let mut watch = Watch::new(FULL);
        let update = |watch: &mut Watch, seen: Seen| watch.update(seen);
        let good = |k| Seen { setpoint: Some(moving(k)), ..seen((moving(k), GOOD, false, false)) };
        let (after, faults) = (1..100_000)
            .find_map(|k| match update(&mut watch, tick(k)) {
                FaultState::Faulty(faults) => Some((k, faults)),
                _ => None,
            })
            .expect("a fault");
        let passed = (1..)
            .find(|&k| match update(&mut watch, good(k)) {
                FaultState::Healthy => panic!("it has not been said that it passed"),
                FaultState::Recovered(lasted) => {
                    assert_eq!(lasted, faults);
                    true
                }
                FaultState::Faulty(_) => false,
            })
            .expect("its end");
        assert_eq!(update(&mut watch, good(passed + 1)), FaultState::Healthy);
        (after, faults, passed)
    }

    #[test]
    fn lasting_oddities_become_faults_and_pass_a_second_after_their_end() {
        let beyond = Status::VOLTAGE_OUT_OF_RANGE;
        for end in [0, FULL / MARGIN, FULL - FULL / MARGIN, FULL] {
            let at_the_end = |k| (AdcCode(end.saturating_add((k % 2) as u16).min(end)), GOOD, false, false);
            assert_eq!(life(at_the_end), (SATURATED, Faults::ADC_SATURATED, HOLD), "{end}");
        }
        assert_eq!(life(|k| (moving(k), beyond, false, false)), (OUT_OF_RANGE, Faults::OUT_OF_CALIBRATION, HOLD));
        assert_eq!(life(|k| (moving(k), GOOD, true, false)), (MISSED, Faults::MISSED_DEADLINE, HOLD));
        assert_eq!(life(|k| (moving(k), GOOD, false, true)), (ASTRAY, Faults::AMPLIFIER, HOLD));
        let stuck = life(|_| (AdcCode(7_000), GOOD, false, false));
        assert_eq!(stuck, (STUCK + 1, Faults::ADC_STUCK, HOLD), "the first code is no repetition");
    }

    #[test]
    fn a_gap_in_the_ticks_is_as_long_a_fault_as_ticks_that_are_late_for_as_long() {
        let gap = |missed: u32| {
            let mut watch = Watch::new(FULL);
            let missing = Seen { missed, ..seen((moving(0), GOOD, false, false)) };
            (watch.update(missing), watch.late())
        };
        assert_eq!(gap(MISSED - 1), (FaultState::Healthy, false));
        for missed in [MISSED, u32::MAX] {
            assert_eq!(gap(missed), (FaultState::Faulty(Faults::MISSED_DEADLINE), true));
        }
    }

    #[test]
    fn what_is_clipped_a_third_of_the_time_is_found_and_a_tenth_is_not() {
        // A sine of 100 Hz: twenty ticks.
        let clipped = |part: u32| {
            move |k: u32| (AdcCode(if k % 20 < part { FULL } else { 30_000 + k as u16 % 2 }), GOOD, false, false)
        };
        let (after, faults, _) = life(clipped(7));
        assert!(faults == Faults::ADC_SATURATED && after < 4_000, "{after}");
        let mut watch = Watch::new(FULL);
        let tick = clipped(2);
        assert!((0..100_000).all(|k| { watch.update(seen(tick(k))) == FaultState::Healthy }));
    }

    #[test]
    fn a_set_point_at_an_end_or_one_that_has_stopped_is_a_fault_where_it_matters() {
        let with = |k, code| Seen { setpoint: Some(AdcCode(code)), ..seen((moving(k), GOOD, false, false)) };
        for end in [0, FULL / MARGIN, FULL - FULL / MARGIN, FULL] {
            assert_eq!(life_of(|k| with(k, end)), (SATURATED, Faults::SETPOINT, HOLD), "{end}");
        }
        assert_eq!(life_of(|k| with(k, 7_000)), (SETPOINT_STUCK + 1, Faults::SETPOINT, HOLD));
        let mut watch = Watch::new(FULL);
        let unused = |k| seen((moving(k), GOOD, false, false));
        assert!((0..2 * SETPOINT_STUCK).all(|k| watch.update(unused(k)) == FaultState::Healthy));
    }
}
