//! The flash controller (RM0440, dual-bank mode): keys, page erase and double-word programming in bank 2,
//! ECC, power cuts.
//!
//! An operation changes the flash when it ends; until then reading bank 2 stalls the core. What an operation leaves
//! when power goes or a reset comes in its midst is a [`Tear`]. A torn double word has an ECC double error: reading it
//! gives its bits and raises ECCD, which is an NMI until it is cleared. Single errors and weak bits never happen. That
//! ADDR_ECC counts bytes within the bank is taken from other chips' drivers. Refused: whole-bank erase, fast
//! programming, option bytes, and any erase or program in bank 1, where the code is.

use anyhow::{Result, ensure};

use crate::{
    NEVER,
    contents::{Contents, Operation, Tear},
    layout::{field, layout},
    microseconds,
    record::FlashKind,
};

layout! {
    "FLASH" {
        KEYR @ 0x08 {}
        SR @ 0x10 {
            EOP = 0, OPERR = 1, PROGERR = 3, WRPERR = 4, PGAERR = 5, SIZERR = 6, PGSERR = 7, MISERR = 8, FASTERR = 9, RDERR = 14,
            OPTVERR = 15, BSY = 16,
        }
        CR @ 0x14 {
            PG = 0, PER = 1, MER1 = 2, PNB = 3..=9, BKER = 11, MER2 = 15, STRT = 16, OPTSTRT = 17, FSTPG = 18, EOPIE = 24, ERRIE = 25,
            OBL_LAUNCH = 27, SEC_PROT1 = 28, SEC_PROT2 = 29, OPTLOCK = 30, LOCK = 31,
        }
        ECCR @ 0x18 { ADDR_ECC = 0..=18, BK_ECC = 21, ECCD = 31 }
        OPTR @ 0x20 { BOR_LEV = 8..=10, DBANK = 22 }
    }
}

/// After any of them nothing is programmed.
const ERRORS: u32 = OPERR | PROGERR | WRPERR | PGAERR | SIZERR | PGSERR | MISERR | FASTERR | RDERR | OPTVERR;
/// Operations that are not modelled.
const REFUSED: u32 = MER1 | MER2 | OPTSTRT | FSTPG | OBL_LAUNCH | SEC_PROT1 | SEC_PROT2;

/// Option bytes as delivered: dual bank, no protection, software watchdogs, brown-out reset at 1.7 V.
const DELIVERED: u32 = 0xFFEF_F8AA;
const ERASE: u64 = microseconds(22_000);
const PROGRAM: u64 = microseconds(82);

pub struct Flash {
    pub contents: Contents,
    status: u32,
    control: u32,
    ecc: u32,
    key: u32,
    /// Offset and value of a double word's first half.
    half: Option<(u32, u32)>,
    /// ECCR tells neither bank nor address of an error.
    pub corrupt: bool,
    /// The option bytes.
    pub options: u32,
    running: Option<(Operation, u64)>,
}

impl Flash {
    pub fn new(contents: Contents) -> Self {
        Self {
            contents,
            status: 0,
            control: LOCK | OPTLOCK,
            ecc: 0,
            key: 0,
            half: None,
            corrupt: false,
            options: DELIVERED,
            running: None,
        }
    }

    /// The clock at which the operation that runs ends.
    pub fn due(&self) -> u64 {
        self.running.map_or(NEVER, |(_, end)| end)
    }

    pub fn interrupt(&self) -> bool {
        self.control & EOPIE != 0 && self.status & EOP != 0 || self.control & ERRIE != 0 && self.status & OPERR != 0
    }

    /// The line to NMI.
    pub fn double_error(&self) -> bool {
        self.ecc & ECCD != 0
    }

    pub fn advance(&mut self) {
        if let Some((operation, _)) = self.running.take() {
            self.contents.change(operation);
            self.status |= if self.control & EOPIE != 0 { EOP } else { 0 };
        }
    }

    /// Power has gone or a reset has come: an operation in its midst leaves `tear`.
    pub fn stop(&mut self, tear: Tear) {
        if let Some((operation, _)) = self.running.take() {
            self.contents.interrupt(operation, tear);
        }
    }

    fn fail(&mut self, error: u32) {
        self.status |= error | if self.control & ERRIE != 0 { OPERR } else { 0 };
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            KEYR => 0,
            SR => self.status | if self.running.is_some() { BSY } else { 0 },
            CR => self.control,
            ECCR => self.ecc,
            OPTR => self.options,
            _ => return None,
        })
    }

    /// The operation that this write starts, with the first address it changes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<Option<(FlashKind, u32)>> {
        match offset {
            KEYR => {
                if (self.key, value) == (0x4567_0123, 0xCDEF_89AB) {
                    self.control &= !LOCK;
                } else {
                    ensure!(value == 0x4567_0123 && self.control & LOCK != 0, "KEYR: {value:#x} out of sequence");
                }
                self.key = value;
            }
            SR => self.status &= !value,
            ECCR => self.ecc &= !(value & ECCD),
            CR if self.control & LOCK == 0 => {
                ensure!(value & REFUSED == 0, "FLASH_CR = {value:#x}: an operation that is not modelled");
                self.control = value & !STRT;
                if value & STRT != 0 && value & PER != 0 {
                    let page = field(value, PNB);
                    ensure!(value & BKER != 0, "page {page} of bank 1 would be erased");
                    ensure!(self.running.is_none(), "an erase is started while the flash is busy");
                    return Ok(Some(self.start(Operation::Erase { page }, now + ERASE)));
                }
            }
            _ => {}
        }
        Ok(None)
    }

    fn start(&mut self, operation: Operation, end: u64) -> (FlashKind, u32) {
        self.running = Some((operation, end));
        let first = operation.words().next().map_or(0, |(index, _)| 8 * index);
        (operation.kind(), Contents::START + first)
    }

    /// A load from bank 2 at `offset`.
    pub fn load(&mut self, offset: u32, size: u32) -> u32 {
        let index = offset / 8;
        let (word, sound) = self.contents.word(index);
        if !sound && self.ecc & ECCD == 0 {
            self.ecc = ECCD | if self.corrupt { 0 } else { BK_ECC | (8 * index) & ADDR_ECC };
        }
        (word >> (8 * (offset % 8)) & (u64::MAX >> (64 - 8 * size))) as u32
    }

    /// A store to bank 2 at `offset`; the operation that it starts.
    pub fn store(&mut self, offset: u32, size: u32, value: u32, now: u64) -> Result<Option<(FlashKind, u32)>> {
        ensure!(self.running.is_none(), "bank 2 is written at {offset:#x} while the flash is busy");
        let first = self.half.take().filter(|&(at, _)| at + 4 == offset).map(|(_, value)| value);
        let index = offset / 8;
        if self.control & PG == 0 || self.status & ERRORS != 0 {
            self.fail(PGSERR);
        } else if size != 4 {
            self.fail(SIZERR);
        } else if offset.is_multiple_of(8) {
            self.half = Some((offset, value));
        } else if let Some(first) = first {
            let value = u64::from(value) << 32 | u64::from(first);
            if self.contents.word(index).0 != u64::MAX && value != 0 {
                self.fail(PROGERR);
            } else {
                return Ok(Some(self.start(Operation::Program { index, value }, now + PROGRAM)));
            }
        } else {
            self.fail(PGAERR);
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contents::PAGE;

    const PAGE_127: u32 = 127 * PAGE;
    const ERASE_127: u32 = PER | BKER | STRT | 127 << PNB.trailing_zeros();

    fn unlocked() -> Flash {
        let mut flash = Flash::new(Contents::erased());
        for key in [0x4567_0123, 0xCDEF_89AB] {
            flash.write(KEYR, key, 0).unwrap();
        }
        flash
    }

    fn program(flash: &mut Flash, offset: u32, value: u64) -> u32 {
        flash.write(CR, PG | EOPIE, 0).unwrap();
        flash.store(offset, 4, value as u32, 0).unwrap();
        if flash.store(offset + 4, 4, (value >> 32) as u32, 0).unwrap().is_some() {
            assert_eq!((flash.due(), flash.read(SR)), (PROGRAM, Some(BSY)));
            flash.advance();
        }
        let status = flash.status;
        flash.write(SR, status, 0).unwrap();
        status
    }

    fn word(flash: &mut Flash, offset: u32) -> u64 {
        u64::from(flash.load(offset + 4, 4)) << 32 | u64::from(flash.load(offset, 4))
    }

    #[test]
    fn a_double_word_is_programmed_once_between_erases_but_for_zeros() {
        let mut flash = unlocked();
        assert_eq!(program(&mut flash, PAGE_127 + 8, 0x1122_3344_5566_7788), EOP);
        assert_eq!(program(&mut flash, PAGE_127 + 8, 0x1122_3344_5566_7700), PROGERR);
        assert_eq!(word(&mut flash, PAGE_127 + 8), 0x1122_3344_5566_7788);
        assert_eq!(flash.contents.bytes(Contents::START + PAGE_127 + 14, 3), [0x22, 0x11, 0xFF]);
        assert_eq!(program(&mut flash, PAGE_127 + 8, 0), EOP);
        let started = flash.write(CR, ERASE_127, 5).unwrap();
        assert_eq!(started, Some((FlashKind::Erase, Contents::START + PAGE_127)));
        assert_eq!((flash.due(), word(&mut flash, PAGE_127 + 8)), (5 + ERASE, 0));
        flash.advance();
        assert!(flash.contents == Contents::erased());
    }

    #[test]
    fn the_controller_flags_what_it_does_not_take() {
        let mut flash = unlocked();
        assert!(flash.store(0, 4, 0, 0).unwrap().is_none());
        assert_eq!(flash.read(SR), Some(PGSERR), "PG is not set");
        flash.write(SR, PGSERR, 0).unwrap();
        flash.write(CR, PG, 0).unwrap();
        flash.store(0, 1, 0, 0).unwrap();
        assert_eq!(flash.read(SR), Some(SIZERR));
        flash.store(0, 4, 0, 0).unwrap();
        assert_eq!(flash.read(SR), Some(SIZERR | PGSERR), "an error must be cleared first");
        flash.write(SR, ERRORS, 0).unwrap();
        flash.store(8, 4, 0, 0).unwrap();
        flash.store(4, 4, 0, 0).unwrap();
        assert_eq!(flash.read(SR), Some(PGAERR));
        flash.write(CR, LOCK, 0).unwrap();
        flash.write(CR, ERASE_127, 0).unwrap();
        assert_eq!(flash.due(), NEVER, "locked");
    }

    #[test]
    fn bank_1_fast_programming_and_mass_erase_are_refused() {
        for value in [PER | STRT, 1 << 18, 1 << 2, 1 << 15, 1 << 27] {
            assert!(unlocked().write(CR, value, 0).is_err(), "{value:#x}");
        }
        assert!(Flash::new(Contents::erased()).write(KEYR, 1, 0).is_err());
    }

    #[test]
    fn a_torn_double_word_is_an_nmi_until_cleared_and_zeros_mend_it() {
        let mut flash = unlocked();
        flash.write(CR, PG, 0).unwrap();
        flash.store(PAGE_127, 4, 0x5555_5555, 0).unwrap();
        flash.store(PAGE_127 + 4, 4, 0, 0).unwrap();
        flash.stop(Tear::Midst(3));
        assert_eq!(flash.load(PAGE_127 + 8, 4), u32::MAX);
        assert!(!flash.double_error());
        let torn = word(&mut flash, PAGE_127);
        assert_eq!(torn & 0x5555_5555, 0x5555_5555, "programming only clears bits");
        assert!(torn != u64::MAX && torn != 0x5555_5555);
        assert_eq!(flash.read(ECCR), Some(ECCD | BK_ECC | PAGE_127));
        flash.write(ECCR, ECCD, 0).unwrap();
        assert!(!flash.double_error());
        assert_eq!(program(&mut flash, PAGE_127, 0), EOP);
        assert_eq!((word(&mut flash, PAGE_127), flash.double_error()), (0, false));
    }
}
