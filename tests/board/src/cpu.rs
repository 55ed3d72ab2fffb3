//! The core: Unicorn's, and the state that Unicorn does not have.

use anyhow::Result;
use unicorn_engine::RegisterARM as Register;

use crate::{
    hooks::{self, Chip},
    image::Image,
    machine::Machine,
    memory,
};

/// xPSR of Thumb code, flags clear.
pub const THUMB: u32 = 1 << 24;

/// A handler that runs or waits for one nested in it.
pub struct Handler {
    pub exception: u8,
    /// Its place among the exception's services.
    pub service: usize,
    /// Instructions executed by the board when it was entered.
    pub began: u64,
    /// Instructions of those nested in it.
    pub nested: u64,
}

/// The core with its memory and all that lies behind its bus.
pub struct Cpu {
    pub chip: Chip,
    pub pc: u32,
    pub asleep: bool,
    /// The exceptions that are being handled, the newest last.
    pub handlers: Vec<Handler>,
}

impl Cpu {
    /// Before its first reset.
    pub fn build(flash: &[u8], machine: Machine) -> Result<Self> {
        let mut chip = hooks::chip(flash, machine)?;
        memory::map(&mut chip, flash)?;
        hooks::hang(&mut chip)?;
        Ok(Self { chip, pc: 0, asleep: false, handlers: Vec::new() })
    }

    pub fn machine(&self) -> &Machine {
        &self.chip.get_data().machine
    }

    pub fn machine_mut(&mut self) -> &mut Machine {
        &mut self.chip.get_data_mut().machine
    }

    /// Puts the core into its reset state.
    pub fn restart(&mut self) -> Result<()> {
        for (register, value) in [
            (Register::CONTROL, 0),
            (Register::PRIMASK, 0),
            (Register::FAULTMASK, 0),
            (Register::BASEPRI, 0),
            (Register::FPSCR, 0),
            (Register::FPEXC, 1 << 30),
            (Register::XPSR_NZCVQG, THUMB),
            (Register::LR, u32::MAX),
            (Register::SP, self.word(Image::START)? & !3),
        ] {
            self.chip.reg_write(register, value.into())?;
        }
        (self.pc, self.asleep) = (self.word(Image::START + 4)? & !1, false);
        self.handlers.clear();
        Ok(())
    }

    pub fn word(&self, address: u32) -> Result<u32> {
        let mut bytes = [0; 4];
        self.chip.mem_read(address.into(), &mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub fn register(&self, register: Register) -> Result<u32> {
        Ok(self.chip.reg_read(register)? as u32)
    }

    pub fn half(&self, address: u32) -> Result<u16> {
        let mut bytes = [0; 2];
        self.chip.mem_read(address.into(), &mut bytes)?;
        Ok(u16::from_le_bytes(bytes))
    }
}
