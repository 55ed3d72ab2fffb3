//! What the amplifier cannot do is not estimated from: a voltage that leaps farther than its slew rate allows is a glitch, or a wire
//! that is off, and would go through the model's memory of reversals.
//!
//! A code that is too far from the last that was believed is held: the estimator is given that last one instead. It is believed
//! again where it is back near that one; or where it leaps once more, to where the voltage can have gone meanwhile. Nothing else
//! ends it: a voltage that leaps once and stays is no amplifier's. An estimate that was given one voltage for a while and then the
//! present one takes as long to catch up, and the status says so as long. Held for [`TOO_LONG`] ticks in a row, or for more than a fifth
//! of the time as those of a floating input are, codes are a fault.
//!
//! The fault lasts for as long as the wire may be off: nothing but another leap shows that it is back. What comes meanwhile is
//! taken for the open input's. Codes that leap away from it, and for [`TOO_LONG`] ticks in a row neither leap nor come back, are the
//! wire's again. (The leap alone would not do: a plug bounces, a conversion amid a leap lies between the two, and a glitch on
//! an open wire leaps there and back.)

use crate::watch::score;
use estimator_core::table::LeastLeap;
use estimator_core::{AdcCode, Status, Table};
use protocol::Faults;

/// Held ticks in a row that are a fault: 10 ms.
pub const TOO_LONG: u32 = crate::rate::TICK_HZ / 100;

/// The codes so far.
#[derive(Clone, Debug)]
pub struct Leap {
    limit: LeastLeap,
    /// The last that was believed, or taken for the open input's; `None` before the first.
    believed: Option<AdcCode>,
    /// The last that came.
    came: AdcCode,
    /// Ticks since the one that was believed.
    ticks: u32,
    /// Ticks that the estimate takes to catch up.
    behind: u32,
    /// The wire may be off.
    off: bool,
    /// Of codes that are held; of a wire that may be off, ticks since it leapt to where it stays.
    score: u32,
    status: Status,
}

impl Leap {
    /// For a table's codes; `None` where it does not say how fast the amplifier is.
    pub fn new(table: &Table) -> Option<Self> {
        let limit = table.least_leap()?;
        let (believed, came, status) = (None, AdcCode(0), Status::empty());
        Some(Self { limit, believed, came, ticks: 0, behind: 0, off: false, score: 0, status })
    }

    /// The next code is believed, whatever it is.
    pub fn restart(&mut self) {
        (self.believed, self.off) = (None, false);
        (self.behind, self.score) = (0, 0);
        self.status = Status::empty();
    }

    /// [`Status::SLEW_EXCEEDED`], where the last code leapt, or codes that leapt were held no fewer ticks than have passed since.
    #[inline]
    pub fn status(&self) -> Status {
        self.status
    }

    /// [`Faults::SLEW_EXCEEDED`], where the wire may be off.
    #[inline]
    pub fn faults(&self) -> Faults {
        if self.off { Faults::SLEW_EXCEEDED } else { Faults::empty() }
    }

    /// One tick: the code to estimate from, of the one that came, before which so many ticks did not come. (Never inlined: a tick
    /// that has no use for it is not to pay for it.)
    #[inline(never)]
    pub fn tick(&mut self, code: AdcCode, missed: u32) -> AdcCode {
        let limit = self.limit;
        let step = missed.saturating_add(1);
        let ticks = self.ticks.saturating_add(step);
        let way = |from: AdcCode| u32::from(code.0.abs_diff(from.0));
        let farthest = limit.after(step);
        let leapt = way(self.came) > farthest;
        let sound = self.believed.is_none_or(|believed| {
            // An open input does not move as an amplifier does: from there the way of a tick is all.
            way(believed) <= farthest || (leapt && !self.off && way(believed) <= limit.after(ticks))
        });
        self.came = code;
        self.status.set(Status::SLEW_EXCEEDED, !sound || self.behind > 0);
        if sound {
            self.believed = Some(code);
            (self.ticks, self.behind) = (0, self.behind.saturating_sub(step));
        } else {
            (self.ticks, self.behind) = (ticks, self.behind.saturating_add(step));
        }
        let given = self.believed.unwrap_or(code);
        if self.turns(sound, leapt) {
            self.off = !self.off;
            (self.believed, self.ticks, self.score) = (Some(code), 0, 0);
        }
        given
    }

    /// Whether the wire is found to be off; or back, where it is.
    #[inline]
    fn turns(&mut self, sound: bool, leapt: bool) -> bool {
        if !self.off {
            return score(&mut self.score, !sound, TOO_LONG);
        }
        self.score = if sound || leapt { 0 } else { self.score + 1 };
        self.score >= TOO_LONG
    }
}

#[cfg(test)]
mod tests;
