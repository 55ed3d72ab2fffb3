//! RCC, reset and clock control (RM0440): ready bits, reset flags, and the frequencies that the registers ask for.
//!
//! Oscillators are ready at once, but for a crystal that is broken. HSE has the NUCLEO's 24 MHz. Time runs at 170 MHz from the
//! start, also while the firmware still runs on HSI16; only what follows on the crystal's end is as slow as that. Where the clock
//! security system is on, a crystal that stops is switched off with the PLL behind it, HSI16 takes over, and CSSF raises NMI. A reset of a single peripheral does nothing but with PWR and the flash's interface. A peripheral without its clock is dead.

use anyhow::{Result, bail, ensure};

use crate::{CORE_HZ, clock::Speeds, field};

const HSI_HZ: u32 = 16_000_000;
const HSE_HZ: u32 = 24_000_000;
/// The clocks after a reset.
pub const RESET: Speeds = Speeds { system: HSI_HZ, core: HSI_HZ };

const CR: usize = 0x00;
const CFGR: usize = 0x08;
const PLLCFGR: usize = 0x0C;
const AHB1RSTR: usize = 0x28;
const APB1RSTR1: usize = 0x38;
const AHB1ENR: usize = 0x48;
const AHB2ENR: usize = 0x4C;
const APB1ENR1: usize = 0x58;
const APB1ENR2: usize = 0x5C;
const CCIPR: usize = 0x88;
const BDCR: usize = 0x90;
const CIFR: usize = 0x1C;
const CICR: usize = 0x20;
const CSR: usize = 0x94;
const CRRCR: usize = 0x98;
const END: usize = 0xA0;

const RMVF: u32 = 1 << 23;
const FLAGS: u32 = 0xFE00_0000;
const PIN: u32 = 1 << 26;

/// What starts the firmware, and the flags that say so. Every reset but that of power also pulls the NRST pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// Power came or came back: brown-out and pin flag, the others cleared; memory holds garbage.
    PowerOn,
    /// The NRST pin alone.
    Pin,
    /// SYSRESETREQ.
    Software,
    /// The independent watchdog.
    Watchdog,
}

impl Reset {
    fn flags(self) -> u32 {
        PIN | match self {
            Self::PowerOn => 1 << 27,
            Self::Pin => 0,
            Self::Software => 1 << 28,
            Self::Watchdog => 1 << 29,
        }
    }
}

/// CR: HSE and PLL on, ready; the clock security system.
const HSEON: u32 = 1 << 16;
const HSERDY: u32 = 1 << 17;
const CSSON: u32 = 1 << 19;
const PLLON: u32 = 1 << 24;
const PLLRDY: u32 = 1 << 25;
/// CIFR: the crystal has failed.
const CSSF: u32 = 1 << 8;

pub struct Rcc {
    registers: [u32; END / 4],
    /// The crystal does not oscillate, whatever it is told.
    pub broken: bool,
}

impl Rcc {
    /// After `reset`, which came when the flags were `earlier`: they stay until the firmware removes them or power goes.
    pub fn new(reset: Reset, earlier: u32) -> Self {
        let mut rcc = Self { registers: [0; END / 4], broken: false };
        let kept = if reset == Reset::PowerOn { 0 } else { earlier };
        for (offset, value) in
            [(CR, 0x500), (CFGR, 5), (PLLCFGR, 0x1000), (AHB1ENR, 0x100), (CSR, kept | reset.flags())]
        {
            rcc.registers[offset / 4] = value;
        }
        rcc
    }

    fn get(&self, offset: usize) -> u32 {
        self.registers[offset / 4]
    }

    pub fn reset_flags(&self) -> u32 {
        self.get(CSR) & FLAGS
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        let offset = offset as usize;
        let value = *self.registers.get(offset / 4)?;
        // The bits that follow others: a ready bit its oscillator's, SWS the switch SW.
        let (from, by) = match offset {
            CR => (0x0101_0000, 1),
            CFGR => (0x3, 2),
            BDCR | CSR | CRRCR => (0x1, 1),
            _ => return Some(value),
        };
        let mut value = value & !(from << by) | (value & from) << by;
        if offset == CR {
            value = value & !(1 << 10) | (value & 1 << 8) << 2;
            if self.broken {
                value &= !if self.by_crystal() { HSERDY | PLLRDY } else { HSERDY };
            }
        }
        Some(value)
    }

    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        let offset = offset as usize;
        let Some(register) = self.registers.get_mut(offset / 4) else { return false };
        *register = match offset {
            CSR if value & RMVF != 0 => value & !(FLAGS | RMVF),
            CSR => value & !FLAGS | *register & FLAGS,
            CIFR => *register,
            _ => value,
        };
        if offset == CICR {
            self.registers[CIFR / 4] &= !value;
        }
        true
    }

    /// Whether the PLL's source is the crystal.
    fn by_crystal(&self) -> bool {
        self.get(PLLCFGR) & 3 == 3
    }

    /// The crystal stops. Whether the core goes on.
    pub fn break_crystal(&mut self) -> bool {
        self.broken = true;
        let (on, switch) = (self.get(CR), self.get(CFGR) & 3);
        let used = switch == 2 || switch == 3 && self.by_crystal();
        if on & HSEON == 0 || on & CSSON == 0 {
            return !used;
        }
        self.registers[CR / 4] &= !if self.by_crystal() { HSEON | PLLON } else { HSEON };
        self.registers[CIFR / 4] |= CSSF;
        if used {
            self.registers[CFGR / 4] = self.get(CFGR) & !3 | 1;
        }
        true
    }

    /// The line to NMI.
    pub fn crystal_failed(&self) -> bool {
        self.get(CIFR) & CSSF != 0
    }

    /// The PLL's outputs P and R.
    fn pll(&self) -> Result<(u32, u32)> {
        let value = self.get(PLLCFGR);
        let source = match value & 3 {
            2 => HSI_HZ,
            3 => HSE_HZ,
            _ => bail!("the PLL has no source (PLLCFGR = {value:#x})"),
        };
        let vco = source / (field(value, 4, 4) + 1) * field(value, 8, 7);
        let p = match (field(value, 27, 5), field(value, 17, 1)) {
            (0, 0) => 7,
            (0, _) => 17,
            (divider, _) => divider,
        };
        Ok((vco / p, vco / (2 * (field(value, 25, 2) + 1))))
    }

    /// The frequencies of the system clock and of the core.
    pub fn speeds(&self) -> Result<Speeds> {
        let value = self.get(CFGR);
        let system = match value & 3 {
            1 => HSI_HZ,
            2 => HSE_HZ,
            3 => self.pll()?.1,
            _ => bail!("no system clock is chosen"),
        };
        // There is no 32.
        let shift = match field(value, 4, 4) {
            0..8 => 0,
            divided @ 8..12 => divided - 7,
            divided => divided - 6,
        };
        Ok(Speeds { system, core: system >> shift })
    }

    /// Whether PWR is held in reset.
    pub fn holds_power(&self) -> bool {
        self.get(APB1RSTR1) & 1 << 28 != 0
    }

    /// Whether the flash's interface is.
    pub fn holds_flash(&self) -> bool {
        self.get(AHB1RSTR) & 1 << 8 != 0
    }

    /// That the core runs at [`CORE_HZ`], which every other model takes for granted.
    pub fn check_core(&self) -> Result<()> {
        let Speeds { core, .. } = self.speeds()?;
        let value = self.get(CFGR);
        ensure!(core == CORE_HZ, "the core runs at {core} Hz (CFGR = {value:#x}); the models need {CORE_HZ} Hz");
        Ok(())
    }

    /// How many clocks of [`CORE_HZ`] the timers on APB1 count once in: they run at twice the bus's clock, where that is divided.
    pub fn timer_clocks(&self) -> Result<u64> {
        let divided = self.get(CFGR) >> 8 & 7;
        let timer_hz = self.speeds()?.core >> divided.saturating_sub(4);
        // No whole number where the core is still slow, and no timer runs.
        Ok((CORE_HZ / timer_hz).into())
    }

    /// The clock of ADC1 before its own prescaler.
    pub fn adc_hz(&self) -> Result<u32> {
        match field(self.get(CCIPR), 28, 2) {
            1 => Ok(self.pll()?.0),
            2 => Ok(CORE_HZ),
            _ => bail!("ADC1 has no clock: ADC12SEL chooses none"),
        }
    }

    /// That LPUART1 runs on the system clock of [`CORE_HZ`].
    pub fn check_uart(&self) -> Result<()> {
        ensure!(field(self.get(CCIPR), 10, 2) == 1, "LPUART1 on PCLK1, HSI16 or LSE is not modelled");
        ensure!(self.speeds()?.system == CORE_HZ, "LPUART1 is set up before the system clock is");
        Ok(())
    }

    /// Whether the peripheral that begins at `base` has its bus clock.
    pub fn clocked(&self, base: u32) -> bool {
        let (register, bit) = match base {
            0x4000_0C00 => (APB1ENR1, 3),
            0x4000_1000 => (APB1ENR1, 4),
            0x4000_1400 => (APB1ENR1, 5),
            0x4000_7000 => (APB1ENR1, 28),
            0x4000_8000 => (APB1ENR2, 0),
            0x4002_0000 => (AHB1ENR, 0),
            0x4002_0800 => (AHB1ENR, 2),
            0x4002_2000 => (AHB1ENR, 8),
            0x4800_0000 => (AHB2ENR, 0),
            0x4800_0400 => (AHB2ENR, 1),
            0x4800_0800 => (AHB2ENR, 2),
            0x5000_0000 => (AHB2ENR, 13),
            0x5000_0800 => (AHB2ENR, 16),
            _ => return true,
        };
        self.get(register) & 1 << bit != 0
    }
}

#[cfg(test)]
mod tests;
