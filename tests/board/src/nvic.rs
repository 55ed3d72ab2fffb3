//! NVIC and system control block of the Cortex-M4 (Armv7-M architecture reference manual): which exception comes next,
//! fault status, reset request.
//!
//! Peripherals' lines are levels: a line that rises makes its interrupt pending, one that is still high when its
//! handler returns makes it pending again, and one that falls leaves it pending. All faults end in HardFault. Only the
//! registers that the firmware uses are there, most of them to be written only; every other is refused, with priority
//! groups, SysTick, PendSV, a moved vector table, the MPU, separate fault handlers, deep sleep and sleep on exit.

use anyhow::{Result, bail, ensure};

use crate::{
    bases::SCS,
    image::Image,
    layout::{field, layout},
};

/// Exception numbers as [`Record::services`](crate::Record::services) has them.
pub mod exception {
    /// Flash ECC double error.
    pub const NMI: u8 = 2;
    /// Any fault that escalates.
    pub const HARD_FAULT: u8 = 3;
    /// The flash controller's interrupt.
    pub const FLASH: u8 = 16 + 4;
    /// The interrupt of DMA1's channel 1.
    pub const DMA1_CHANNEL1: u8 = 16 + 11;
    /// The interrupt of DMA1's channel 2.
    pub const DMA1_CHANNEL2: u8 = 16 + 12;
    /// The interrupt of DMA1's channel 3.
    pub const DMA1_CHANNEL3: u8 = 16 + 13;
    /// ADC1's and ADC2's interrupt.
    pub const ADC1_2: u8 = 16 + 18;
    /// The interrupt of TIM5.
    pub const TIM5: u8 = 16 + 50;
    /// The interrupt of TIM6.
    pub const TIM6: u8 = 16 + 54;
    /// The interrupt of LPUART1.
    pub const LPUART1: u8 = 16 + 91;
}

use exception::{HARD_FAULT, NMI};

layout! {
    "NVIC" {
        ISER @ 0x100 {}
        ICER @ 0x180 {}
        ISPR @ 0x200 {}
        ICPR @ 0x280 {}
        IPR @ 0x400 {}
    }
    "SCB" {
        ICSR @ 0xD04 { NMIPENDSET = 31, RETTOBASE = 11 }
        AIRCR @ 0xD0C { SYSRESETREQ = 2, PRIGROUP = 8..=10, VECTKEY = 16..=31 }
        CFSR @ 0xD28 { IBUSERR = 8, PRECISERR = 9, BFARVALID = 15, UNDEFINSTR = 16 }
        BFAR @ 0xD38 {}
        CPACR @ 0xD88 {}
    }
    "DCB" {
        DEMCR @ 0xDFC { TRCENA = 24 }
    }
}

/// AIRCR: what its upper half reads as, and the key to write it.
const KEY_READ: u32 = 0xFA05 << VECTKEY.trailing_zeros();
const KEY: u32 = 0x5FA;
/// Bytes of the interrupt registers: 102 interrupts, rounded up to whole words of bits.
const BITS: u32 = 16;
const PRIORITIES: u32 = 128;

/// The core's mask registers.
pub struct Masks {
    pub primask: bool,
    pub faultmask: bool,
    pub basepri: u8,
}

/// What a write did.
#[derive(Debug, PartialEq, Eq)]
pub enum Written {
    Done,
    Plain,
    Reset,
}

pub struct Nvic {
    enabled: u128,
    pending: u128,
    lines: u128,
    /// The flash's line to NMI, and NMI asked for by software.
    nmi: bool,
    nmi_asked: bool,
    priorities: [u8; PRIORITIES as usize],
    /// The exceptions being handled, the newest last.
    pub active: Vec<u8>,
    fault_status: u32,
    fault_address: u32,
}

impl Nvic {
    pub fn new() -> Self {
        Self {
            enabled: 0,
            pending: 0,
            lines: 0,
            nmi: false,
            nmi_asked: false,
            priorities: [0; PRIORITIES as usize],
            active: Vec::new(),
            fault_status: 0,
            fault_address: 0,
        }
    }

    /// The address of an exception's vector; the flash is mapped at 0.
    pub fn vector(exception: u8) -> u32 {
        Image::START + 4 * u32::from(exception)
    }

    /// The lines as they are now.
    pub fn update(&mut self, lines: u128, nmi: bool) {
        self.pending |= lines & !self.lines;
        self.lines = lines;
        self.nmi = nmi;
    }

    /// Lower is more urgent.
    fn priority(&self, exception: u8) -> i16 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            _ => self.priorities[usize::from(exception - 16)].into(),
        }
    }

    /// The priority of what runs, without the masks; 256 if no exception is being handled.
    pub fn running(&self) -> i16 {
        self.active.iter().map(|&exception| self.priority(exception)).min().unwrap_or(256)
    }

    /// The most urgent exception that is pending and enabled, if it is more urgent than what runs.
    pub fn next(&self) -> Option<u8> {
        let mut ready = self.pending & self.enabled;
        let mut best = (self.nmi || self.nmi_asked).then_some((self.priority(NMI), NMI));
        while ready != 0 {
            let exception = 16 + ready.trailing_zeros() as u8;
            ready &= ready - 1;
            let key = (self.priority(exception), exception);
            best = Some(best.map_or(key, |other| other.min(key)));
        }
        best.filter(|&(priority, _)| priority < self.running()).map(|(_, exception)| exception)
    }

    /// Whether the mask registers let it through.
    pub fn passes(&self, exception: u8, masks: &Masks) -> bool {
        let limit = match masks {
            Masks { faultmask: true, .. } => -1,
            Masks { primask: true, .. } => 0,
            Masks { basepri: 0, .. } => 256,
            Masks { basepri, .. } => (*basepri).into(),
        };
        self.priority(exception) < limit
    }

    pub fn enter(&mut self, exception: u8) {
        self.active.push(exception);
        match exception {
            NMI => self.nmi_asked = false,
            16.. => self.pending &= !(1 << (exception - 16)),
            _ => {}
        }
    }

    /// The newest handler returns.
    pub fn leave(&mut self) {
        if let Some(exception @ 16..) = self.active.pop() {
            self.pending |= self.lines & 1 << (exception - 16);
        }
    }

    /// A fault's bits for CFSR, and the address for BFAR.
    pub fn fault(&mut self, status: u32, address: Option<u32>) {
        self.fault_status |= status;
        self.fault_address = address.unwrap_or(self.fault_address);
    }

    /// The register's value, if it is none of plain memory.
    pub fn read(&self, offset: u32) -> Result<Option<u32>> {
        match offset {
            // Of its fields, only which exception is being handled, and whether it has interrupted no other.
            ICSR => {
                let alone = if self.active.len() == 1 { RETTOBASE } else { 0 };
                Ok(Some(self.active.last().map_or(0, |&exception| exception.into()) | alone))
            }
            AIRCR => Ok(Some(KEY_READ)),
            CFSR => Ok(Some(self.fault_status)),
            BFAR => Ok(Some(self.fault_address)),
            // Coprocessor access and debug control are plain memory.
            CPACR | DEMCR => Ok(None),
            _ => bail!("{:#x} is read: not modelled", SCS + offset),
        }
    }

    /// A write of `size` bytes; the priorities take single bytes.
    pub fn write(&mut self, offset: u32, size: u32, value: u32) -> Result<Written> {
        if (IPR..IPR + PRIORITIES).contains(&offset) {
            for byte in 0..size {
                // Four bits are implemented.
                self.priorities[(offset - IPR + byte) as usize] = (value >> (8 * byte)) as u8 & 0xF0;
            }
            return Ok(Written::Done);
        }
        let bits = |base| u128::from(value) << (8 * (offset - base));
        match offset {
            ISER..ICER if offset - ISER < BITS => self.enabled |= bits(ISER),
            ICER..ISPR if offset - ICER < BITS => self.enabled &= !bits(ICER),
            ISPR..ICPR if offset - ISPR < BITS => self.pending |= bits(ISPR),
            ICPR..IPR if offset - ICPR < BITS => self.pending = self.pending & !bits(ICPR) | self.lines & bits(ICPR),
            ICSR if value == NMIPENDSET => self.nmi_asked = true,
            AIRCR if field(value, VECTKEY) != KEY => {}
            AIRCR => {
                ensure!(value & PRIGROUP == 0, "AIRCR = {value:#x}: priority groups are not modelled");
                if value & SYSRESETREQ != 0 {
                    return Ok(Written::Reset);
                }
            }
            CPACR | DEMCR => return Ok(Written::Plain),
            _ => bail!("{value:#x} is written to {:#x}: not modelled", SCS + offset),
        }
        Ok(Written::Done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nvic(priorities: &[(u8, u8)]) -> Nvic {
        let mut nvic = Nvic::new();
        for &(exception, priority) in priorities {
            let irq = u32::from(exception) - 16;
            nvic.write(IPR + irq, 1, priority.into()).unwrap();
            nvic.write(ISER + irq / 32 * 4, 4, 1 << (irq % 32)).unwrap();
        }
        nvic
    }

    const fn line(exception: u8) -> u128 {
        1 << (exception - 16)
    }

    #[test]
    fn the_more_urgent_goes_first_and_interrupts_the_less_urgent() {
        let (adc, uart) = (exception::ADC1_2, exception::LPUART1);
        let mut nvic = nvic(&[(adc, 0x10), (uart, 0x60)]);
        nvic.update(line(uart), false);
        assert_eq!(nvic.next(), Some(uart));
        nvic.enter(uart);
        assert_eq!(nvic.next(), None);
        assert_eq!(nvic.read(ICSR).unwrap(), Some(u32::from(uart) | RETTOBASE));
        nvic.update(line(uart) | line(adc), false);
        assert_eq!(nvic.next(), Some(adc));
        nvic.enter(adc);
        assert_eq!(nvic.read(ICSR).unwrap(), Some(u32::from(adc)), "it has interrupted another");
        nvic.write(ICSR, 4, NMIPENDSET).unwrap();
        assert_eq!(nvic.next(), Some(NMI));
        nvic.enter(NMI);
        nvic.leave();
        assert_eq!(nvic.next(), None, "asked for once");
        nvic.update(line(uart) | line(adc), true);
        assert_eq!(nvic.next(), Some(NMI));
    }

    #[test]
    fn masks_hold_back_what_is_not_more_urgent() {
        let nvic = nvic(&[(exception::ADC1_2, 0x10)]);
        let passes =
            |exception, primask, faultmask, basepri| nvic.passes(exception, &Masks { primask, faultmask, basepri });
        assert!(passes(exception::ADC1_2, false, false, 0));
        assert!(passes(exception::ADC1_2, false, false, 0x20));
        assert!(!passes(exception::ADC1_2, false, false, 0x10));
        assert!(!passes(exception::ADC1_2, true, false, 0));
        assert!(!passes(exception::ADC1_2, false, true, 0));
        assert!(passes(NMI, true, true, 0x10));
    }

    #[test]
    fn a_line_that_falls_leaves_its_interrupt_pending_and_one_that_stays_brings_it_back() {
        let mut nvic = nvic(&[(exception::TIM5, 0)]);
        nvic.update(line(exception::TIM5), false);
        nvic.update(0, false);
        assert_eq!(nvic.next(), Some(exception::TIM5));
        nvic.enter(exception::TIM5);
        nvic.leave();
        assert_eq!(nvic.next(), None);
        nvic.update(line(exception::TIM5), false);
        nvic.enter(exception::TIM5);
        nvic.leave();
        assert_eq!(nvic.next(), Some(exception::TIM5));
    }

    #[test]
    fn reset_needs_the_key_and_what_is_not_modelled_is_refused() {
        let mut nvic = Nvic::new();
        assert!(nvic.write(0xD08, 4, 0x2000_0000).is_err() && nvic.read(0xD08).is_err());
        assert_eq!(nvic.write(AIRCR, 4, 4).unwrap(), Written::Done);
        assert_eq!(nvic.write(AIRCR, 4, 0x05FA_0004).unwrap(), Written::Reset);
    }
}
