//! Keeps voltages that the amplifier cannot have made from the estimator. A jump faster than the amplifier's slew rate
//! is a glitch or a loose wire; the estimator's memory of reversals would keep it.
//!
//! **A jump.** A code farther from the last believed one than one tick's slew is held: the estimator is given the last
//! believed code instead. A later code is believed again if it is within one tick's slew of the last believed one, or
//! if it jumps a second time and lands within what the amplifier can have slewed since. Nothing else ends the hold: a
//! voltage that jumps once and stays is no amplifier's. After a hold the estimate needs as many ticks to catch up as
//! the hold took, and the status says so for as long.
//!
//! **The fault.** Codes held for [`TOO_LONG`] ticks in a row, or for more than a fifth of the time, as those of a
//! floating input are, raise [`Faults::SLEW_EXCEEDED`]. From then on the codes are taken for those of an open input.
//! The fault ends when they jump away from there and then, for [`TOO_LONG`] ticks, neither jump nor come back. A change
//! of the mode does not end it. The jump alone would not do: a plug bounces, a conversion in the middle of a jump lies
//! between the two levels, and a glitch on an open wire jumps there and back.

use crate::rate::ticks_in;
use crate::watch::score;
use estimator_core::table::LeastLeap;
use estimator_core::{AdcCode, Status, Table};
use protocol::Faults;

/// Held ticks in a row that are a fault: 10 ms.
pub const TOO_LONG: u32 = ticks_in(10);

/// The monitor's codes so far.
#[derive(Clone, Debug)]
pub struct Leap {
    limit: LeastLeap,
    /// The last code that was believed, or that was taken for the open input's; `None` before the first.
    believed: Option<AdcCode>,
    /// The last code that was read.
    came: AdcCode,
    /// Ticks since the last believed code.
    ticks: u32,
    /// Ticks until the estimate has caught up.
    behind: u32,
    /// The wire may be off: the fault is there.
    off: bool,
    /// Held codes, as [`score`] counts them; while the wire may be off, ticks since the code jumped to where it stays.
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

    /// The estimate starts anew, from the next code, whatever it is. A wire that may be off stays so.
    pub fn restart(&mut self) {
        self.behind = 0;
        if !self.off {
            (self.believed, self.score, self.status) = (None, 0, Status::empty());
        }
    }

    /// [`Status::SLEW_EXCEEDED`] while a code is held, while the estimate catches up after that, and while the wire
    /// may be off.
    #[inline]
    pub fn status(&self) -> Status {
        self.status
    }

    /// [`Faults::SLEW_EXCEEDED`], where the wire may be off.
    #[inline]
    pub fn faults(&self) -> Faults {
        if self.off { Faults::SLEW_EXCEEDED } else { Faults::empty() }
    }

    /// One tick: takes the code that was read and how many ticks did not come before it; returns the code to estimate
    /// from. (Never inlined: a tick without a slew rate is not to pay for it.)
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

    /// What is made of a code that is not near the last one, or of a wire that may be off. (A function of its own: most
    /// ticks, and those whose estimate takes the longest, do without it.)
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
