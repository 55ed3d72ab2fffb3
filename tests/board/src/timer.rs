//! TIM5 and TIM6: up-counters with prescaler, reload, four compares and the update trigger (RM0440, general-purpose and
//! basic timers), clocked by the core clock or a divided one.
//!
//! One-pulse, centred and downward counting, disabled updates, DMA requests and dithering are refused. The
//! compare flags do not depend on the channels' modes, and a compare value equal to the count when it is written
//! matches a turn later.

use anyhow::{Result, ensure};

use crate::{
    NEVER,
    layout::{field, layout},
};

layout! {
    "TIM5" {
        CR1 @ 0x00 { CEN = 0, URS = 2, ARPE = 7 }
        CR2 @ 0x04 { MMS = 4..=6 }
        DIER @ 0x0C { UIE = 0, CC1IE = 1, CC2IE = 2, CC3IE = 3, CC4IE = 4 }
        SR @ 0x10 { UIF = 0, CC1IF = 1, CC2IF = 2, CC3IF = 3, CC4IF = 4 }
        EGR @ 0x14 { UG = 0, CC1G = 1, CC2G = 2, CC3G = 3, CC4G = 4 }
        CNT @ 0x24 {}
        PSC @ 0x28 {}
        ARR @ 0x2C {}
        CCR1 @ 0x34 {}
        CCR4 @ 0x40 {}
    }
}

const COMPARES: [u32; 4] = [CC1IF, CC2IF, CC3IF, CC4IF];
/// Update and four compares: the same bits of SR, DIER and EGR.
const FLAGS: u32 = UIF | CC1IF | CC2IF | CC3IF | CC4IF;
const _: () = assert!(UIE | CC1IE | CC2IE | CC3IE | CC4IE == FLAGS && UG | CC1G | CC2G | CC3G | CC4G == FLAGS);

pub struct Timer {
    cr1: u32,
    cr2: u32,
    dier: u32,
    sr: u32,
    prescaler: u32,
    reload: u32,
    /// Of the channels there are.
    compare: Vec<u32>,
    /// Prescaler and reload in use; what is written takes effect at an update.
    used: (u32, u32),
    /// The count at a clock since which nothing but counting happened.
    base: (u32, u64),
    widest: u32,
    /// Core clocks in a clock of the timer.
    clocks: u64,
    /// The clock of the next event.
    pub due: u64,
}

impl Timer {
    pub fn new(widest: u32, channels: usize) -> Self {
        Self {
            cr1: 0,
            cr2: 0,
            dier: 0,
            sr: 0,
            prescaler: 0,
            reload: widest,
            compare: vec![0; channels],
            used: (0, widest),
            base: (0, 0),
            widest,
            clocks: 1,
            due: NEVER,
        }
    }

    /// From now on the timer's clock comes once in so many core clocks; its prescaler begins anew.
    pub fn clock_by(&mut self, clocks: u64, now: u64) {
        if clocks != self.clocks {
            self.base = (self.count(now), now);
            self.clocks = clocks;
            self.schedule(now);
        }
    }

    /// Core clocks from count to count.
    fn stride(&self) -> u64 {
        (u64::from(self.used.0) + 1) * self.clocks
    }

    pub fn running(&self) -> bool {
        self.cr1 & CEN != 0
    }

    pub fn interrupt(&self) -> bool {
        self.sr & self.dier & FLAGS != 0
    }

    fn count(&self, now: u64) -> u32 {
        let (count, since) = self.base;
        if !self.running() {
            return count;
        }
        // Every turn begins with an event that resets the base, so the count stays within 32 bits.
        (u64::from(count) + (now - since) / self.stride()) as u32
    }

    fn schedule(&mut self, now: u64) {
        self.due = NEVER;
        if self.running() {
            let (base, since) = self.base;
            let (_, reload) = self.used;
            let count = self.count(now);
            let turn = u64::from(reload) + 1;
            let next =
                self.compare.iter().filter(|&&c| count < c && c <= reload).map(|&c| c.into()).fold(turn, u64::min);
            self.due = since + (next - u64::from(base)) * self.stride();
        }
    }

    /// The event due at `at`; true if it is an update that goes out as a trigger.
    pub fn advance(&mut self, at: u64) -> bool {
        let (base, since) = self.base;
        let count = u64::from(base) + (at - since) / self.stride();
        let update = count > u64::from(self.used.1);
        let count = if update {
            self.load(at);
            self.sr |= UIF;
            0
        } else {
            count
        };
        for (&compare, flag) in self.compare.iter().zip(COMPARES) {
            if count == u64::from(compare) {
                self.sr |= flag;
            }
        }
        self.schedule(at);
        update && self.trigger_mode() == 2
    }

    fn load(&mut self, at: u64) {
        self.used = (self.prescaler, self.reload);
        self.base = (0, at);
    }

    fn trigger_mode(&self) -> u32 {
        field(self.cr2, MMS)
    }

    /// `None`: no rule for this register.
    pub fn read(&self, offset: u32, now: u64) -> Option<u32> {
        Some(match offset {
            CR1 => self.cr1,
            CR2 => self.cr2,
            DIER => self.dier,
            SR => self.sr,
            EGR => 0,
            CNT => self.count(now),
            PSC => self.prescaler,
            ARR => self.reload,
            CCR1..=CCR4 => *self.compare.get((offset - CCR1) as usize / 4)?,
            _ => return None,
        })
    }

    /// `None`: no rule for this register; true: a trigger goes out.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<Option<bool>> {
        let mut trigger = false;
        match offset {
            CR1 => {
                ensure!(value & !(CEN | URS | ARPE) == 0, "CR1 = {value:#x}: a way of counting that is not modelled");
                self.base = (self.count(now), now);
                self.cr1 = value;
            }
            CR2 => self.cr2 = value,
            DIER => {
                ensure!(value & !FLAGS == 0, "DIER = {value:#x}: neither DMA nor trigger interrupts are modelled");
                self.dier = value;
            }
            SR => self.sr &= value,
            EGR => {
                self.sr |= value & FLAGS & !UG;
                if value & UG != 0 {
                    self.load(now);
                    self.sr |= if self.cr1 & URS == 0 { UIF } else { 0 };
                    trigger = matches!(self.trigger_mode(), 0 | 2);
                }
            }
            CNT => self.base = (value & self.widest, now),
            PSC => self.prescaler = value & 0xFFFF,
            ARR => {
                self.reload = value & self.widest;
                if self.cr1 & ARPE == 0 {
                    self.used.1 = self.reload;
                }
            }
            CCR1..=CCR4 => match self.compare.get_mut((offset - CCR1) as usize / 4) {
                Some(compare) => *compare = value & self.widest,
                None => return Ok(None),
            },
            _ => return Ok(None),
        }
        ensure!(!self.running() || self.count(now) <= self.used.1, "the counter is beyond its reload {}", self.used.1);
        self.schedule(now);
        Ok(Some(trigger))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timer(writes: &[(u32, u32)]) -> Timer {
        let mut timer = Timer::new(0xFFFF, 4);
        for &(offset, value) in writes {
            assert!(timer.write(offset, value, 0).unwrap().is_some());
        }
        timer
    }

    #[test]
    fn two_kilohertz_is_an_update_every_85000_clocks() {
        let mut timer = timer(&[(PSC, 16), (ARR, 4999), (CR2, 2 << 4), (EGR, 1), (SR, 0), (DIER, 1), (CR1, CEN)]);
        for tick in 1..4 {
            assert_eq!(timer.due, tick * 85_000);
            assert_eq!(timer.read(CNT, timer.due - 1), Some(4999));
            assert!(timer.advance(timer.due), "the update goes out as a trigger");
            assert!(timer.interrupt());
            timer.write(SR, !UIF, tick * 85_000).unwrap();
            assert!(!timer.interrupt());
        }
    }

    #[test]
    fn at_half_the_clock_it_takes_twice_as_long() {
        let mut timer = Timer::new(0xFFFF, 0);
        timer.clock_by(2, 0);
        timer.write(ARR, 99, 0).unwrap();
        timer.write(CR1, CEN, 0).unwrap();
        assert_eq!((timer.due, timer.read(CNT, 100)), (200, Some(50)));
        timer.clock_by(1, 100);
        assert_eq!((timer.due, timer.read(CNT, 149)), (150, Some(99)));
    }

    #[test]
    fn without_an_update_the_prescaler_is_not_loaded() {
        assert_eq!(timer(&[(PSC, 16), (ARR, 4999), (CR1, CEN)]).due, 5000);
    }

    #[test]
    fn preloaded_reload_waits_for_the_update() {
        let mut timer = timer(&[(ARR, 99), (CR1, CEN | ARPE), (ARR, 49)]);
        assert_eq!(timer.due, 100);
        timer.advance(100);
        assert_eq!(timer.due, 150);
    }

    #[test]
    fn compare_comes_before_the_update_and_raises_its_own_flag() {
        let mut timer = timer(&[(ARR, 99), (CCR1, 30), (CCR1 + 4, 70), (CR1, CEN)]);
        let mut seen = Vec::new();
        for _ in 0..3 {
            let at = timer.due;
            timer.advance(at);
            seen.push((at, timer.read(SR, at).unwrap() & FLAGS));
        }
        // The unused channels compare with 0, which the update brings.
        assert_eq!(seen, [(30, 0b00010), (70, 0b00110), (100, 0b11111)]);
    }

    #[test]
    fn what_is_not_modelled_is_refused() {
        for (offset, value) in [(CR1, CEN | 1 << 3), (CR1, CEN | 1 << 4), (DIER, 1 << 8)] {
            assert!(Timer::new(0xFFFF, 4).write(offset, value, 0).is_err());
        }
    }
}
