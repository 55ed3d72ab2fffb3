//! What the amplifier cannot do is not estimated from: a voltage that leaps farther than its slew rate allows is a glitch, or a wire
//! that is off, and would go through the model's memory of reversals.
//!
//! A code that is too far from the last that was believed is held: the estimator is given that last one instead. A code is believed
//! again if it is within one leap of the last believed one, or if it leaps a second time and lands within what the amplifier can have
//! slewed since. Nothing else ends it: a voltage that leaps once and stays is no amplifier's. An estimate that was given one voltage for a while and then the
//! present one takes as long to catch up, and the status says so as long. Held for [`TOO_LONG`] ticks in a row, or for more than a fifth
//! of the time as those of a floating input are, codes are a fault.
//!
//! The fault lasts for as long as the wire may be off, whatever mode is set meanwhile: nothing but another leap shows that it is
//! back. What comes meanwhile is taken for the open input's. Codes that leap away from it, and for [`TOO_LONG`] ticks in a row neither leap nor come back, are the
//! wire's again. (The leap alone would not do: a plug bounces, a conversion amid a leap lies between the two, and a glitch on
//! an open wire leaps there and back.)

use crate::rate::ticks_in;
use crate::watch::score;
use estimator_core::table::LeastLeap;
use estimator_core::{AdcCode, Status, Table};
use protocol::Faults;

/// Held ticks in a row that are a fault: 10 ms.
pub const TOO_LONG: u32 = ticks_in(10);

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

    /// The estimate begins anew, and with the next code, whatever it is. A wire that may be off is none the less so.
    pub fn restart(&mut self) {
        self.behind = 0;
        if !self.off {
            (self.believed, self.score, self.status) = (None, 0, Status::empty());
        }
    }

    /// [`Status::SLEW_EXCEEDED`], where the last code leapt, or codes that leapt were held no fewer ticks than have passed since; or
    /// where the wire may be off.
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
        let step = missed.saturating_add(1);
        let near = self.believed.is_none_or(|believed| way(code, believed) <= self.limit.after(step));
        if near && !self.off { self.believe(code, step) } else { self.doubt(code, step, near) }
    }

    #[inline]
    fn believe(&mut self, code: AdcCode, step: u32) -> AdcCode {
        self.status = if self.behind > 0 { Status::SLEW_EXCEEDED } else { Status::empty() };
        (self.believed, self.came, self.ticks) = (Some(code), code, 0);
        self.behind = self.behind.saturating_sub(step);
        score(&mut self.score, false, TOO_LONG);
        code
    }

    /// What is made of a code that is not near the last one, or of a wire that may be off. (A function of its own: most ticks, and those
    /// whose estimate takes the longest, do without it.)
    #[cold]
    #[inline(never)]
    fn doubt(&mut self, code: AdcCode, step: u32, near: bool) -> AdcCode {
        let before = self.believed.unwrap_or(code);
        let leapt = way(code, self.came) > self.limit.after(step);
        let ticks = self.ticks.saturating_add(step);
        if self.off {
            self.score = if near || leapt { 0 } else { self.score + 1 };
            self.came = code;
            if self.score >= TOO_LONG {
                self.turn(false);
            } else if near {
                self.believed = Some(code);
                return code;
            }
            return before;
        }
        if leapt && way(code, before) <= self.limit.after(ticks) {
            return self.believe(code, step);
        }
        (self.came, self.ticks, self.behind) = (code, ticks, self.behind.saturating_add(step));
        self.status = Status::SLEW_EXCEEDED;
        if score(&mut self.score, true, TOO_LONG) {
            self.turn(true);
        }
        before
    }

    /// From now on the wire may be off, or is back; the code that came is its own.
    fn turn(&mut self, off: bool) {
        (self.off, self.believed, self.ticks, self.score) = (off, Some(self.came), 0, 0);
    }
}

/// How far a code is from another.
#[inline]
fn way(AdcCode(code): AdcCode, AdcCode(other): AdcCode) -> u32 {
    code.abs_diff(other).into()
}

#[cfg(test)]
mod tests;
