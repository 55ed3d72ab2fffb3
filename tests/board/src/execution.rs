//! What the core does: instructions until something happens, sleep, faults.
//!
//! EXC_RETURN addresses and WFE, which Unicorn cannot execute, end up here. An access to no memory is a precise bus
//! fault, whatever a store's would be on silicon; a jump to where no code is is an instruction bus error.

use std::mem;

use anyhow::{Result, bail};
use unicorn_engine::{MemType, RegisterARM as Register, uc_error};

use crate::{
    cpu::Cpu,
    exceptions::is_return,
    hooks::unmasked,
    machine::Look,
    nvic::{BFARVALID, IBUSERR, PRECISERR, UNDEFINSTR},
};

// Instructions.
const YIELD: u16 = 0xBF10;
const WFE: u16 = 0xBF20;
const WFI: u16 = 0xBF30;
/// The first of 256 each, and what follows.
const BKPT: u16 = 0xBE00;
const AFTER_BKPT: u16 = 0xBF00;
const SVC: u16 = 0xDF00;
const AFTER_SVC: u16 = 0xE000;

impl Cpu {
    /// Runs until something happens that is not an instruction, and does it.
    pub fn step(&mut self) -> Result<()> {
        if self.asleep {
            return self.sleep();
        }
        let outcome = self.chip.emu_start((self.pc | 1).into(), 0, 0, 0);
        let pc = self.register(Register::PC)?;
        let hooked = self.chip.get_data_mut();
        let (address, access) = (hooked.address, hooked.access.take());
        let (stopped, take) = (mem::take(&mut hooked.stopping), hooked.take.take());
        if is_return(pc) {
            return self.leave(pc | 1);
        }
        match access {
            Some((MemType::FETCH_UNMAPPED | MemType::FETCH_PROT, ..)) => return self.fault(pc, IBUSERR, None),
            Some((MemType::WRITE_PROT, to, by)) => bail!("the instruction at {by:#x} writes to read-only {to:#x}"),
            Some((_, to, by)) => return self.fault(by, PRECISERR | BFARVALID, Some(to)),
            None => {}
        }
        if stopped {
            self.pc = address;
            return take.map_or(Ok(()), |exception| self.enter(exception));
        }
        self.pc = address + 2;
        match self.half(address)? {
            YIELD => {}
            WFE => self.asleep = !mem::take(&mut self.machine_mut().event),
            WFI => self.asleep = true,
            // No debugger is there to take it.
            BKPT..AFTER_BKPT => return self.fault(address, 0, None),
            SVC..AFTER_SVC => bail!("SVC at {address:#x}: not modelled"),
            _ if outcome == Err(uc_error::INSN_INVALID) => return self.fault(address, UNDEFINSTR, None),
            _ => return self.fault(pc, IBUSERR, None),
        }
        Ok(())
    }

    /// Sleeps until an exception is pending or the run ends.
    fn sleep(&mut self) -> Result<()> {
        loop {
            let machine = self.machine_mut();
            match machine.look() {
                Look::Go => machine.skip(),
                Look::Stop => return Ok(()),
                Look::Take(exception) => {
                    machine.look_at = 0;
                    self.asleep = false;
                    return if unmasked(&self.chip, exception) { self.enter(exception) } else { Ok(()) };
                }
            }
        }
    }
}
