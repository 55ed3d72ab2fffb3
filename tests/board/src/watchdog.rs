//! IWDG, the independent watchdog (RM0440): a 12-bit down-counter on the 32 kHz of LSI; at zero it resets the chip.
//!
//! LSI is exact here; on silicon it is off by some per cent. Its registers read as 0, and a window is refused. It stops
//! in a reset, not in stop modes.

use anyhow::{Result, ensure};

use crate::{
    CORE_HZ, NEVER,
    layout::{field, layout},
};

const LSI_HZ: u64 = 32_000;

layout! {
    "IWDG" {
        KR @ 0x00 {}
        PR @ 0x04 { PRESCALER as "PR" = 0..=2 }
        RLR @ 0x08 { RL = 0..=11 }
        WINR @ 0x10 { WIN = 0..=11 }
    }
}

pub struct Watchdog {
    prescaler: u32,
    reload: u32,
    unlocked: bool,
    /// The clock at which it resets the chip.
    pub due: u64,
}

impl Watchdog {
    pub fn new() -> Self {
        Self { prescaler: 0, reload: RL, unlocked: false, due: NEVER }
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<bool> {
        match offset {
            KR => {
                self.unlocked = value == 0x5555;
                // To start one that runs reloads nothing: only 0xAAAA takes what RLR holds.
                if value == 0xCCCC && self.due == NEVER || value == 0xAAAA && self.due != NEVER {
                    let divider = 4 << self.prescaler.min(6);
                    self.due = now + u64::from(self.reload + 1) * divider * u64::from(CORE_HZ) / LSI_HZ;
                }
            }
            PR if self.unlocked => self.prescaler = field(value, PRESCALER),
            RLR if self.unlocked => self.reload = field(value, RL),
            WINR => ensure!(value & WIN == WIN, "IWDG window {value:#x}: windows are not modelled"),
            PR | RLR => {}
            _ => return Ok(false),
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_bites_after_reload_times_prescaler_and_feeding_starts_over() {
        let mut watchdog = Watchdog::new();
        for (offset, value) in [(RLR, 7), (KR, 0xAAAA)] {
            watchdog.write(offset, value, 0).unwrap();
        }
        assert_eq!(watchdog.due, NEVER, "neither locked registers nor a reload start it");
        for (offset, value) in [(KR, 0x5555), (PR, 1), (RLR, 399), (KR, 0xCCCC)] {
            watchdog.write(offset, value, 0).unwrap();
        }
        // 400 × 8 / 32 kHz = 100 ms
        assert_eq!(watchdog.due, 17_000_000);
        watchdog.write(KR, 0xCCCC, 5_000_000).unwrap();
        assert_eq!(watchdog.due, 17_000_000, "it is started once");
        watchdog.write(KR, 0xAAAA, 5_000_000).unwrap();
        assert_eq!(watchdog.due, 22_000_000);
    }
}
