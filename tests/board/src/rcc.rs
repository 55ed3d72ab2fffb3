//! RCC, reset and clock control (RM0440): ready bits, reset flags, and the frequencies that the registers ask for.
//!
//! Oscillators are ready at once, but for a crystal that is broken. HSE has the NUCLEO's 24 MHz. Time runs at 170 MHz
//! from the start, also while the firmware still runs on HSI16; only what follows on the crystal's end is as slow as
//! that. Where the clock security system is on, a crystal that stops is switched off with the PLL behind it, HSI16
//! takes over, and CSSF raises NMI. A reset of a single peripheral does nothing but with PWR and the flash's interface.
//! A peripheral without its clock is dead.

use anyhow::{Result, bail, ensure};

use crate::{
    CORE_HZ,
    bases::{ADC1, DAC1, DMA1, DMAMUX, FLASH, GPIOA, GPIOB, GPIOC, LPUART1, PWR, TIM5, TIM6, TIM7},
    clock::Speeds,
    layout::{field, layout},
};

const HSI_HZ: u32 = 16_000_000;
const HSE_HZ: u32 = 24_000_000;
/// The clocks after a reset.
pub const RESET: Speeds = Speeds { system: HSI_HZ, core: HSI_HZ };

layout! {
    "RCC" {
        CR @ 0x00 { HSION = 8, HSIRDY = 10, HSEON = 16, HSERDY = 17, CSSON = 19, PLLON = 24, PLLRDY = 25 }
        CFGR @ 0x08 { SW = 0..=1, SWS = 2..=3, HPRE = 4..=7, PPRE1 = 8..=10 }
        PLLCFGR @ 0x0C { PLLSRC = 0..=1, PLLM = 4..=7, PLLN = 8..=14, PLLP = 17, PLLR = 25..=26, PLLPDIV = 27..=31 }
        CIFR @ 0x1C { CSSF = 8 }
        CICR @ 0x20 { CSSC = 8 }
        AHB1RSTR @ 0x28 { FLASHRST = 8 }
        APB1RSTR1 @ 0x38 { PWRRST = 28 }
        AHB1ENR @ 0x48 { DMA1EN = 0, DMAMUX1EN = 2, FLASHEN = 8 }
        AHB2ENR @ 0x4C { GPIOAEN = 0, GPIOBEN = 1, GPIOCEN = 2, ADC12EN = 13, DAC1EN = 16 }
        APB1ENR1 @ 0x58 { TIM5EN = 3, TIM6EN = 4, TIM7EN = 5, PWREN = 28 }
        APB1ENR2 @ 0x5C { LPUART1EN = 0 }
        CCIPR @ 0x88 { LPUART1SEL = 10..=11, ADC12SEL = 28..=29 }
        BDCR @ 0x90 { LSEON = 0, LSERDY = 1 }
        CSR @ 0x94 {
            LSION = 0, LSIRDY = 1, RMVF = 23, OBLRSTF = 25, PINRSTF = 26, BORRSTF = 27, SFTRSTF = 28, IWDGRSTF = 29, WWDGRSTF = 30,
            LPWRRSTF = 31,
        }
        CRRCR @ 0x98 { HSI48ON = 0, HSI48RDY = 1 }
    }
}

/// Bytes of all registers.
const END: usize = 0xA0;
/// Why the firmware was started.
const FLAGS: u32 = OBLRSTF | PINRSTF | BORRSTF | SFTRSTF | IWDGRSTF | WWDGRSTF | LPWRRSTF;
/// Oscillators, each with its ready bit behind it.
const FOLLOWED: u32 = HSEON | PLLON;
const _: () = assert!(HSERDY | PLLRDY == FOLLOWED << 1 && LSERDY == LSEON << 1 && LSIRDY == LSION << 1);
const _: () = assert!(HSI48RDY == HSI48ON << 1 && LSEON == LSION && LSION == HSI48ON && SWS == SW << 2 && CSSC == CSSF);

/// SW and PLLSRC: HSI16, the crystal, the PLL; the PLL's sources.
const BY_HSI: u32 = 1;
const BY_HSE: u32 = 2;
const BY_PLL: u32 = 3;
const PLL_BY_HSI: u32 = 2;
const PLL_BY_HSE: u32 = 3;

/// What starts the firmware, and the flags that say so. Every reset but that of power also pulls the NRST pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// Power came or came back: brown-out and pin flag, the others cleared; memory holds garbage.
    PowerOn,
    /// The NRST pin alone.
    Pin,
    /// Asked for by SYSRESETREQ.
    Software,
    /// The independent watchdog.
    Watchdog,
}

impl Reset {
    fn flags(self) -> u32 {
        PINRSTF
            | match self {
                Self::PowerOn => BORRSTF,
                Self::Pin => 0,
                Self::Software => SFTRSTF,
                Self::Watchdog => IWDGRSTF,
            }
    }
}

pub struct Rcc {
    registers: [u32; END / 4],
    /// The crystal does not oscillate, whatever it is told.
    pub broken: bool,
}

impl Rcc {
    /// After `reset`, which came when the flags were `earlier`: they stay until the firmware removes them
    /// or power goes.
    pub fn new(reset: Reset, earlier: u32) -> Self {
        let mut rcc = Self { registers: [0; END / 4], broken: false };
        let kept = if reset == Reset::PowerOn { 0 } else { earlier };
        for (offset, value) in
            [(CR, HSION | HSIRDY), (CFGR, 5), (PLLCFGR, 0x1000), (AHB1ENR, FLASHEN), (CSR, kept | reset.flags())]
        {
            *rcc.register(offset) = value;
        }
        rcc
    }

    fn get(&self, offset: u32) -> u32 {
        self.registers[offset as usize / 4]
    }

    fn register(&mut self, offset: u32) -> &mut u32 {
        &mut self.registers[offset as usize / 4]
    }

    pub fn reset_flags(&self) -> u32 {
        self.get(CSR) & FLAGS
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        let value = *self.registers.get(offset as usize / 4)?;
        // The bits that follow others: a ready bit its oscillator's, SWS the switch SW.
        let (from, by) = match offset {
            CR => (FOLLOWED, 1),
            CFGR => (SW, 2),
            BDCR | CSR | CRRCR => (LSION, 1),
            _ => return Some(value),
        };
        let mut value = value & !(from << by) | (value & from) << by;
        if offset == CR {
            value = value & !HSIRDY | if value & HSION != 0 { HSIRDY } else { 0 };
            if self.broken {
                value &= !if self.by_crystal() { HSERDY | PLLRDY } else { HSERDY };
            }
        }
        Some(value)
    }

    pub fn write(&mut self, offset: u32, value: u32) -> bool {
        let Some(register) = self.registers.get_mut(offset as usize / 4) else { return false };
        *register = match offset {
            CSR if value & RMVF != 0 => value & !(FLAGS | RMVF),
            CSR => value & !FLAGS | *register & FLAGS,
            CIFR => *register,
            _ => value,
        };
        if offset == CICR {
            *self.register(CIFR) &= !value;
        }
        true
    }

    /// Whether the PLL's source is the crystal.
    fn by_crystal(&self) -> bool {
        field(self.get(PLLCFGR), PLLSRC) == PLL_BY_HSE
    }

    /// The crystal stops. Whether the core goes on.
    pub fn break_crystal(&mut self) -> bool {
        self.broken = true;
        let (on, switch) = (self.get(CR), field(self.get(CFGR), SW));
        let used = switch == BY_HSE || switch == BY_PLL && self.by_crystal();
        if on & HSEON == 0 || on & CSSON == 0 {
            return !used;
        }
        *self.register(CR) &= !if self.by_crystal() { HSEON | PLLON } else { HSEON };
        *self.register(CIFR) |= CSSF;
        if used {
            *self.register(CFGR) = self.get(CFGR) & !SW | BY_HSI;
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
        let source = match field(value, PLLSRC) {
            PLL_BY_HSI => HSI_HZ,
            PLL_BY_HSE => HSE_HZ,
            _ => bail!("the PLL has no source (PLLCFGR = {value:#x})"),
        };
        let vco = source / (field(value, PLLM) + 1) * field(value, PLLN);
        let p = match (field(value, PLLPDIV), field(value, PLLP)) {
            (0, 0) => 7,
            (0, _) => 17,
            (divider, _) => divider,
        };
        Ok((vco / p, vco / (2 * (field(value, PLLR) + 1))))
    }

    /// The frequencies of the system clock and of the core.
    pub fn speeds(&self) -> Result<Speeds> {
        let value = self.get(CFGR);
        let system = match field(value, SW) {
            BY_HSI => HSI_HZ,
            BY_HSE => HSE_HZ,
            BY_PLL => self.pll()?.1,
            _ => bail!("no system clock is chosen"),
        };
        // There is no 32.
        let shift = match field(value, HPRE) {
            0..8 => 0,
            divided @ 8..12 => divided - 7,
            divided => divided - 6,
        };
        Ok(Speeds { system, core: system >> shift })
    }

    /// Whether PWR is held in reset.
    pub fn holds_power(&self) -> bool {
        self.get(APB1RSTR1) & PWRRST != 0
    }

    /// Whether the flash's interface is.
    pub fn holds_flash(&self) -> bool {
        self.get(AHB1RSTR) & FLASHRST != 0
    }

    /// That the core runs at [`CORE_HZ`], which every other model takes for granted.
    pub fn check_core(&self) -> Result<()> {
        let Speeds { core, .. } = self.speeds()?;
        let value = self.get(CFGR);
        ensure!(core == CORE_HZ, "the core runs at {core} Hz (CFGR = {value:#x}); the models need {CORE_HZ} Hz");
        Ok(())
    }

    /// How many clocks of [`CORE_HZ`] the timers on APB1 count once in: they run at twice the bus's clock, where
    /// that is divided.
    pub fn timer_clocks(&self) -> Result<u64> {
        let divided = field(self.get(CFGR), PPRE1);
        let timer_hz = self.speeds()?.core >> divided.saturating_sub(4);
        // No whole number where the core is still slow, and no timer runs.
        Ok((CORE_HZ / timer_hz).into())
    }

    /// The clock of ADC1 before its own prescaler.
    pub fn adc_hz(&self) -> Result<u32> {
        match field(self.get(CCIPR), ADC12SEL) {
            1 => Ok(self.pll()?.0),
            2 => Ok(CORE_HZ),
            _ => bail!("ADC1 has no clock: ADC12SEL chooses none"),
        }
    }

    /// That LPUART1 runs on the system clock of [`CORE_HZ`].
    pub fn check_uart(&self) -> Result<()> {
        ensure!(field(self.get(CCIPR), LPUART1SEL) == 1, "LPUART1 on PCLK1, HSI16 or LSE is not modelled");
        ensure!(self.speeds()?.system == CORE_HZ, "LPUART1 is set up before the system clock is");
        Ok(())
    }

    /// Whether the peripheral that begins at `base` has its bus clock.
    pub fn clocked(&self, base: u32) -> bool {
        let (register, bit) = match base {
            TIM5 => (APB1ENR1, TIM5EN),
            TIM6 => (APB1ENR1, TIM6EN),
            TIM7 => (APB1ENR1, TIM7EN),
            PWR => (APB1ENR1, PWREN),
            LPUART1 => (APB1ENR2, LPUART1EN),
            DMA1 => (AHB1ENR, DMA1EN),
            DMAMUX => (AHB1ENR, DMAMUX1EN),
            FLASH => (AHB1ENR, FLASHEN),
            GPIOA => (AHB2ENR, GPIOAEN),
            GPIOB => (AHB2ENR, GPIOBEN),
            GPIOC => (AHB2ENR, GPIOCEN),
            ADC1 => (AHB2ENR, ADC12EN),
            DAC1 => (AHB2ENR, DAC1EN),
            _ => return true,
        };
        self.get(register) & bit != 0
    }
}

#[cfg(test)]
mod tests;
