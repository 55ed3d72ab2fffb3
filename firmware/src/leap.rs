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
    state: State,
    /// The last code that was read.
    came: AdcCode,
    /// Ticks until the estimate has caught up.
    catching_up: u32,
    status: Status,
}

/// What codes are taken for.
///
/// ```text
/// Fresh ─► Believing ── held for too long, or too often ─► Open ── away, and stays there ─► Believing
/// ```
#[derive(Clone, Copy, Debug)]
enum State {
    /// The next code is believed, whatever it is.
    Fresh,
    /// They are the monitor's.
    Believing {
        /// The last code that was believed.
        last: AdcCode,
        /// Ticks since then, while codes are held.
        since: u32,
        /// Held codes, as [`score`] counts them.
        held: u32,
    },
    /// They are those of an open input: the fault is there.
    Open {
        /// The last code near the open input's.
        level: AdcCode,
        /// Ticks since the code jumped away to where it stays.
        away: u32,
    },
}

impl Leap {
    /// For a table's codes; `None` where it does not say how fast the amplifier is.
    pub fn new(table: &Table) -> Option<Self> {
        let limit = table.least_leap()?;
        Some(Self { limit, state: State::Fresh, came: AdcCode(0), catching_up: 0, status: Status::empty() })
    }

    /// The estimate starts anew, from the next code, whatever it is. A wire that may be off stays so.
    pub fn restart(&mut self) {
        self.catching_up = 0;
        if self.faults().is_empty() {
            (self.state, self.status) = (State::Fresh, Status::empty());
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
        match self.state {
            State::Open { .. } => Faults::SLEW_EXCEEDED,
            State::Fresh | State::Believing { .. } => Faults::empty(),
        }
    }

    /// One tick: takes the code that was read and how many ticks before it were lost; returns the code to estimate
    /// from. (Never inlined: a tick without a slew rate is not to pay for it.)
    #[inline(never)]
    pub fn tick(&mut self, code: AdcCode, lost: u32) -> AdcCode {
        let step = lost.saturating_add(1);
        match self.state {
            State::Fresh => self.believe(code, step, 0),
            State::Believing { last, held, .. } if self.near(code, last, step) => self.believe(code, step, held),
            State::Believing { last, since, held } => self.doubt(code, step, (last, since, held)),
            State::Open { level, away } => self.stay_open(code, step, (level, away)),
        }
    }

    /// Whether the amplifier can have gone from one code to the other in so many ticks.
    #[inline]
    fn near(&self, AdcCode(code): AdcCode, AdcCode(other): AdcCode, ticks: u32) -> bool {
        u32::from(code.abs_diff(other)) <= self.limit.after(ticks)
    }

    #[inline]
    fn believe(&mut self, code: AdcCode, step: u32, mut held: u32) -> AdcCode {
        self.status = if self.catching_up > 0 { Status::SLEW_EXCEEDED } else { Status::empty() };
        self.catching_up = self.catching_up.saturating_sub(step);
        score(&mut held, false, TOO_LONG);
        (self.state, self.came) = (State::Believing { last: code, since: 0, held }, code);
        code
    }

    /// What is made of a code that is not near the last believed one. (A function of its own: most ticks, and those
    /// whose estimate takes the longest, do without it.)
    #[cold]
    #[inline(never)]
    fn doubt(&mut self, code: AdcCode, step: u32, (last, since, mut held): (AdcCode, u32, u32)) -> AdcCode {
        let since = since.saturating_add(step);
        if !self.near(code, self.came, step) && self.near(code, last, since) {
            return self.believe(code, step, held);
        }
        (self.came, self.catching_up, self.status) =
            (code, self.catching_up.saturating_add(step), Status::SLEW_EXCEEDED);
        self.state = match score(&mut held, true, TOO_LONG) {
            true => State::Open { level: code, away: 0 },
            false => State::Believing { last, since, held },
        };
        last
    }

    /// What is made of a code while the wire may be off.
    #[cold]
    #[inline(never)]
    fn stay_open(&mut self, code: AdcCode, step: u32, (level, away): (AdcCode, u32)) -> AdcCode {
        let (near, leapt) = (self.near(code, level, step), !self.near(code, self.came, step));
        let away = if near || leapt { 0 } else { away + 1 };
        let given = if near { code } else { level };
        self.came = code;
        self.state = match away >= TOO_LONG {
            true => State::Believing { last: code, since: 0, held: 0 },
            false => State::Open { level: given, away },
        };
        given
    }
}

#[cfg(test)]
mod tests;
