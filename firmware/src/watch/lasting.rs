//! Faults that outlast their causes, each by its own.

use crate::rate::TICK_HZ;
use protocol::Faults;

/// How long a fault outlasts its cause: 1 s.
pub const HOLD: u32 = TICK_HZ;

/// The faults that last, by the numbers of their bits: where nothing changes, a tick costs next to nothing.
#[derive(Clone, Debug)]
pub(super) struct Lasting {
    /// Ticks with a fault so far.
    tick: u32,
    /// The tick that is the last of each fault whose cause has gone.
    last: [u32; u16::BITS as usize],
    /// What had a cause at the last tick.
    caused: Faults,
    found: Faults,
}

impl Lasting {
    pub(super) fn new() -> Self {
        Self { tick: 0, last: [0; u16::BITS as usize], caused: Faults::empty(), found: Faults::empty() }
    }

    /// What lasts after the last tick.
    pub(super) fn found(&self) -> Faults {
        self.found
    }

    /// Ends a fault at once.
    pub(super) fn end(&mut self, fault: Faults) {
        self.caused.remove(fault);
        self.found.remove(fault);
    }

    /// One tick, with the causes that it has.
    #[inline]
    pub(super) fn update(&mut self, now: Faults) -> FaultState {
        let lasted = self.found | now;
        if lasted.is_empty() {
            return FaultState::Healthy;
        }
        self.tick = self.tick.wrapping_add(1);
        let ended = self.caused.difference(now);
        self.caused = now;
        let mut passed = Faults::empty();
        let mut without_cause = lasted.difference(now).bits();
        while without_cause != 0 {
            let bit = without_cause & without_cause.wrapping_neg();
            without_cause ^= bit;
            let fault = Faults::from_bits_retain(bit);
            let Some(last) = self.last.get_mut(bit.trailing_zeros() as usize) else { break };
            if ended.contains(fault) {
                *last = self.tick.wrapping_add(HOLD - 1);
            }
            passed.set(fault, *last == self.tick);
        }
        self.found = lasted.difference(passed);
        let sound_again = passed.harm_estimate() && !self.found.harm_estimate();
        if self.found.is_empty() || sound_again { FaultState::Recovered(lasted) } else { FaultState::Faulty(lasted) }
    }
}

/// What a tick finds of faults.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaultState {
    /// There is no fault.
    Healthy,
    /// These faults have lasted until this tick. With it the last of them has passed, or the last that an estimate
    /// suffers from, and this tick's is still made of what they brought.
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
