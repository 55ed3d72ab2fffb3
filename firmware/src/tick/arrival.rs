//! Whether a tick comes when it should.

use crate::facts::Facts;

/// How a tick has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Arrival {
    /// A period after the last one, whose output was ready in time.
    InTime,
    /// Later than that, or after one whose output was not ready in time; `lost` ticks before it did not come at all.
    Late { lost: u32 },
}

impl Arrival {
    pub fn is_late(self) -> bool {
        matches!(self, Self::Late { .. })
    }

    /// Ticks before this one that did not come.
    pub fn lost(self) -> u32 {
        match self {
            Self::InTime => 0,
            Self::Late { lost } => lost,
        }
    }
}

/// The cycle counter from tick to tick.
pub(super) struct Clock {
    /// Its counts from one to the next.
    period: u32,
    last: Option<u32>,
    /// An emulated board is as late as its host: however long a gap in its ticks, it is one odd tick.
    emulated: bool,
}

impl Clock {
    pub fn new(facts: &Facts) -> Self {
        Self { period: facts.cycles_per_tick, last: None, emulated: facts.emulated }
    }

    /// Takes the tick that comes at this count, after one whose output was ready in time, or was not.
    pub fn tick(&mut self, now: u32, last_was_ready: bool) -> Arrival {
        let Some(last) = self.last.replace(now) else { return Arrival::InTime };
        let elapsed = now.wrapping_sub(last);
        if elapsed <= self.period + self.period / 8 && last_was_ready {
            return Arrival::InTime;
        }
        Arrival::Late { lost: ((elapsed + self.period / 2) / self.period).saturating_sub(1) }
    }

    /// How many odd ticks that is to the watch: a late one, and those that did not come.
    pub fn odd_ticks(&self, arrival: Arrival) -> u32 {
        match arrival {
            Arrival::InTime => 0,
            Arrival::Late { .. } if self.emulated => 1,
            Arrival::Late { lost } => lost.saturating_add(1),
        }
    }
}
