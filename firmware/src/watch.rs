//! When odd ticks become a fault, and when the fault has passed.
//!
//! One odd tick is a status bit in its sample. A fault is a leaky bucket that is full: an odd tick adds [`ODD`], a good
//! one takes 1 away, so that a voltage that is clipped for a fifth of the time is found as well as one that always is.
//! A tick that did not come is an odd one.
//! A fault lasts until [`HOLD`] ticks after its last cause, so that the output does not flicker between safe and wrong.

mod lasting;

pub use lasting::{FaultState, HOLD};

use crate::ends::Ends;
use crate::rate::{TICK_HZ, ticks_in};
use estimator_core::{AdcCode, Status};
use lasting::Lasting;
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
/// What an odd tick weighs.
pub const ODD: u32 = 4;

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
    /// Ticks that came late or not at all: this one, and those before it that were lost.
    pub late_or_lost: u32,
    /// The amplifier is not where the drive commands it.
    pub astray: bool,
    /// The tick's faults so far, of which [`Watch::KEPT`] last as the watch's own do.
    pub faults: Faults,
}

/// The scores so far.
#[derive(Clone, Debug)]
pub struct Watch {
    monitor: Channel,
    setpoint: Channel,
    out_of_range: u32,
    late_or_lost: u32,
    astray: u32,
    lasting: Lasting,
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
    /// Faults that others find, and that last as the watch's own do.
    pub const KEPT: Faults = Faults::SUPPLY.union(Faults::SLEW_EXCEEDED).union(Faults::STALLED);

    /// For an ADC with this largest code.
    pub fn new(adc_full_scale: u16) -> Self {
        Self {
            monitor: Channel::new(adc_full_scale, STUCK),
            setpoint: Channel::new(adc_full_scale, SETPOINT_STUCK),
            out_of_range: 0,
            late_or_lost: 0,
            astray: 0,
            lasting: Lasting::new(),
        }
    }

    /// Another mode begins. It ends no fault but that of the set-point, which only one mode follows: what was
    /// seen of the converter is none of the mode's, and of an amplifier that went astray a mode that does not drive it
    /// forgets a tick's worth each tick, as one does that it follows.
    pub fn change_mode(&mut self) {
        (self.setpoint.last, self.setpoint.same, self.setpoint.saturated) = (None, 0, 0);
        self.lasting.end(Faults::SETPOINT);
    }

    /// Whether ticks have come so late, or so seldom, that it is a fault, which lasts.
    pub fn deadline_missed(&self) -> bool {
        self.lasting.found().contains(Faults::MISSED_DEADLINE)
    }

    /// Whether the monitor's code is at an end of the ADC's range.
    #[inline]
    pub fn at_an_end(&self, monitor: AdcCode) -> bool {
        self.monitor.ends.at(monitor)
    }

    /// Whether nothing lasts that an estimate suffers from.
    pub fn sound(&self) -> bool {
        !self.lasting.found().harm_estimate()
    }

    /// Takes what is seen of one tick, and says which faults last after it.
    #[inline(always)]
    pub fn update(&mut self, seen: Seen) -> FaultState {
        let Seen { monitor, setpoint, status, late_or_lost, astray, faults } = seen;
        let beyond = status.contains(Status::VOLTAGE_OUT_OF_RANGE);
        let (saturated, stuck) = self.monitor.update(monitor);
        let mut now = faults & Self::KEPT;
        now.set(Faults::ADC_SATURATED, saturated);
        now.set(Faults::OUT_OF_CALIBRATION, score(&mut self.out_of_range, beyond, OUT_OF_RANGE));
        now.set(Faults::ADC_STUCK, stuck);
        if let Some(code) = setpoint {
            let (saturated, stuck) = self.setpoint.update(code);
            now.set(Faults::SETPOINT, saturated || stuck);
        }
        now.set(Faults::MISSED_DEADLINE, score_of(&mut self.late_or_lost, late_or_lost, MISSED));
        now.set(Faults::AMPLIFIER, score(&mut self.astray, astray, ASTRAY));
        self.lasting.update(now)
    }
}

#[cfg(test)]
mod tests;
