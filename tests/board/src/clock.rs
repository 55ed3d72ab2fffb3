//! How fast the core may run: the supply's range (PWR_CR5), the flash's wait states (FLASH_ACR), and the way from one
//! clock to another (RM0440, "Dynamic voltage scaling management", "Read access latency", "System clock selection").
//!
//! | rule | |
//! |---|---|
//! | above 150 MHz | range 1 boost: R1MODE is 0 |
//! | wait states | one more for every 34 MHz of the core with boost, 30 MHz without |
//! | to a system clock above 80 MHz | with the core at half of it, or less, for a microsecond |
//!
//! Refused are steps that break one. Range 2 is not modelled. A step down is not looked at, and time runs at 170 MHz
//! whatever the clock, so that the microsecond is the longer the slower the core is.

use anyhow::{Result, ensure};

use crate::{
    bases::{FLASH, PWR},
    layout::layout,
    microseconds,
};

layout! {
    "PWR" {
        CR5 @ 0x80 { R1MODE = 8 }
    }
    "FLASH" {
        ACR @ 0x00 { LATENCY = 0..=3, PRFTEN = 8, ICEN = 9, DCEN = 10, DBG_SWEN = 18 }
    }
}

pub const PWR_CR5: u32 = PWR + CR5;
pub const FLASH_ACR: u32 = FLASH + ACR;
/// What ACR is after a reset.
const DELIVERED: u32 = DBG_SWEN | DCEN | ICEN;

const MHZ: u32 = 1_000_000;
/// How long the core must run at half a fast clock before it runs at all of it.
const HALF: u64 = microseconds(1);

/// The frequencies that RCC's registers ask for, Hz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Speeds {
    pub system: u32,
    pub core: u32,
}

pub struct Clock {
    power: u32,
    access: u32,
    speeds: Speeds,
    /// When the system clock was switched to what it is.
    switched: u64,
}

impl Clock {
    pub fn new(speeds: Speeds) -> Self {
        Self { power: R1MODE, access: DELIVERED, speeds, switched: 0 }
    }

    pub fn read(&self, address: u32) -> Option<u32> {
        match address {
            PWR_CR5 => Some(self.power),
            FLASH_ACR => Some(self.access),
            _ => None,
        }
    }

    pub fn write(&mut self, address: u32, value: u32) -> bool {
        match address {
            PWR_CR5 => self.power = value,
            FLASH_ACR => self.access = value,
            _ => return false,
        }
        true
    }

    /// RCC holds PWR or the flash's interface in reset.
    pub fn hold(&mut self, power: bool, flash: bool) {
        let reset = Self::new(self.speeds);
        if power {
            self.power = reset.power;
        }
        if flash {
            self.access = reset.access;
        }
    }

    /// What has been written asks for these speeds.
    pub fn check(&mut self, to: Speeds, now: u64) -> Result<()> {
        let from = std::mem::replace(&mut self.speeds, to);
        let (system, core) = (to.system / MHZ, to.core / MHZ);
        let boost = self.power & R1MODE == 0;
        ensure!(boost || to.system <= 150 * MHZ, "a system clock of {system} MHz without range 1 boost (PWR_CR5)");
        let wait_states = self.access & LATENCY;
        let fast_enough = (wait_states + 1) * if boost { 34 } else { 30 } * MHZ;
        ensure!(
            to.core <= fast_enough,
            "the core at {core} MHz with {wait_states} wait states of the flash (FLASH_ACR)"
        );
        if to.system != from.system {
            self.switched = now;
            ensure!(
                to.system <= 80 * MHZ || to.core <= to.system / 2,
                "a system clock of {system} MHz in one step: the core must run at half of it first (HPRE)"
            );
        } else if to.core > from.core && to.system > 80 * MHZ {
            let after = now - self.switched;
            ensure!(
                after >= HALF,
                "the core at {core} MHz {after} clocks after the switch to {system} MHz, before {HALF}"
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESET: Speeds = Speeds { system: 16 * MHZ, core: 16 * MHZ };

    /// The way to 170 MHz: boost or not, wait states, the core's first and second speed and the clocks between them.
    fn switched(boost: bool, wait_states: u32, first: u32, between: u64, second: u32) -> Result<()> {
        let mut clock = Clock::new(RESET);
        clock.write(PWR_CR5, if boost { 0 } else { R1MODE });
        clock.write(FLASH_ACR, 0x0004_0600 | wait_states);
        clock.check(RESET, 10)?;
        let at = |core| Speeds { system: 170 * MHZ, core: core * MHZ };
        clock.check(at(first), 1000)?;
        clock.check(at(second), 1000 + between)
    }

    #[test]
    fn there_is_one_way_to_170_mhz() {
        switched(true, 4, 85, 170, 170).unwrap();
        for (boost, wait_states, first, between, second, why) in [
            (false, 8, 85, 170, 170, "without range 1 boost"),
            (true, 3, 85, 170, 170, "170 MHz with 3 wait states"),
            (true, 1, 85, 170, 85, "85 MHz with 1 wait states"),
            (true, 4, 170, 170, 170, "in one step"),
            (true, 4, 85, 169, 170, "169 clocks after"),
        ] {
            let error = switched(boost, wait_states, first, between, second).expect_err(why).to_string();
            assert!(error.contains(why), "{error}");
        }
    }

    #[test]
    fn wait_states_may_not_be_taken_away() {
        let mut clock = Clock::new(RESET);
        clock.write(PWR_CR5, 0);
        clock.write(FLASH_ACR, 4);
        let half = Speeds { system: 170 * MHZ, core: 85 * MHZ };
        clock.check(half, 0).unwrap();
        assert!(clock.write(FLASH_ACR, 1) && clock.check(half, 0).is_err());
        assert_eq!((clock.read(FLASH_ACR), clock.read(PWR_CR5), clock.read(0)), (Some(1), Some(0), None));
        clock.hold(true, true);
        assert_eq!((clock.read(FLASH_ACR), clock.read(PWR_CR5)), (Some(0x0004_0600), Some(R1MODE)));
    }
}
