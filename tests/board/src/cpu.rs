//! The core around Unicorn's: instructions, clock, sleep, faults.
//!
//! A hook before every instruction counts it and stops Unicorn when an exception is to be taken. Unicorn ignores a stop
//! inside an IT block; the hook then comes again and stops behind it. Instructions that an IT condition skips are not
//! counted. EXC_RETURN addresses and WFE, which Unicorn cannot execute, end up here. An access to no memory is a precise bus
//! fault, whatever a store's would be on silicon; a jump to where no code is is an instruction bus error.

use std::mem;

use anyhow::{Result, bail};
use unicorn_engine::{Arch, ArmCpuModel, HookType, MemType, Mode, RegisterARM as Register, Unicorn, uc_error};

use crate::{
    board::Board,
    exceptions::{Handler, THUMB, is_return},
    image::Image,
    machine::{Look, Machine},
    memory,
    nvic::Masks,
};

// Instructions.
const YIELD: u16 = 0xBF10;
const WFE: u16 = 0xBF20;
const WFI: u16 = 0xBF30;
const SEV: u16 = 0xBF40;
/// The first of 256 each, and what follows.
const BKPT: u16 = 0xBE00;
const AFTER_BKPT: u16 = 0xBF00;
const SVC: u16 = 0xDF00;
const AFTER_SVC: u16 = 0xE000;

// Bits of CFSR.
const IBUSERR: u32 = 1 << 8;
const BFARVALID: u32 = 1 << 15;
const PRECISERR: u32 = 1 << 9;
const UNDEFINSTR: u32 = 1 << 16;

pub type Chip = Unicorn<'static, Hooked>;

/// What Unicorn's hooks work on.
pub struct Hooked {
    pub machine: Machine,
    /// The instruction that is executed, or that Unicorn has been stopped before.
    address: u32,
    stopping: bool,
    /// The exception it has been stopped for.
    take: Option<u8>,
    /// The access that no memory has answered, its address, and the instruction.
    access: Option<(MemType, u32, u32)>,
    /// A bit for every half-word of bank 1 that reads as SEV, which Unicorn takes for a NOP.
    sends_event: Vec<u64>,
}

/// The state of the core that Unicorn does not have.
#[derive(Default)]
pub struct Core {
    pub pc: u32,
    pub asleep: bool,
    /// The newest last.
    pub handlers: Vec<Handler>,
}

/// The chip with its memory, before its first reset.
pub fn build(flash: &[u8], machine: Machine) -> Result<Chip> {
    let mut sends_event = vec![0; flash.len() / 128];
    for (at, half) in flash.chunks_exact(2).enumerate() {
        sends_event[at / 64] |= u64::from(half == SEV.to_le_bytes()) << (at % 64);
    }
    let hooked = Hooked { machine, address: 0, stopping: false, take: None, access: None, sends_event };
    let mut chip = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, hooked)?;
    chip.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    memory::map(&mut chip, flash)?;
    // An empty range is every address.
    chip.add_code_hook(1, 0, before_instruction)?;
    chip.add_mem_hook(HookType::MEM_INVALID, 1, 0, |chip, kind, address, _, _| {
        let hooked = chip.get_data_mut();
        hooked.access.get_or_insert((kind, address as u32, hooked.address));
        false
    })?;
    Ok(chip)
}

fn before_instruction(chip: &mut Unicorn<'_, Hooked>, address: u64, _: u32) {
    let address = address as u32;
    let hooked = chip.get_data_mut();
    if hooked.machine.clock >= hooked.machine.look_at && stopped(chip, address) {
        return;
    }
    if chip.get_data().machine.dma.stores() {
        for (address, byte) in chip.get_data_mut().machine.dma.stored() {
            // Cannot fail: the channel's memory was looked at when it was switched on.
            chip.mem_write(address.into(), &[byte]).expect("DMA goes to RAM");
        }
    }
    let hooked = chip.get_data_mut();
    hooked.address = address;
    hooked.machine.execute();
    if let Some(meter) = hooked.machine.meter() {
        meter.trace.push(address);
    }
    let half = (address.wrapping_sub(Image::START) / 2) as usize;
    hooked.machine.event |= hooked.sends_event.get(half / 64).is_some_and(|bits| bits >> (half % 64) & 1 != 0);
}

/// Stops Unicorn before the instruction at `address`, if there is a reason.
fn stopped(chip: &mut Unicorn<'_, Hooked>, address: u32) -> bool {
    let hooked = chip.get_data_mut();
    // Unicorn has ignored the stop: the instruction it was for has been executed.
    hooked.machine.clock += u64::from(mem::take(&mut hooked.stopping));
    let take = match hooked.machine.look() {
        Look::Go => return false,
        Look::Stop => None,
        Look::Take(exception) if unmasked(chip, exception) => Some(exception),
        Look::Take(_) => {
            let machine = &mut chip.get_data_mut().machine;
            machine.look_at = machine.clock + 1;
            return false;
        }
    };
    let hooked = chip.get_data_mut();
    (hooked.address, hooked.stopping, hooked.take) = (address, true, take);
    hooked.machine.look_at = 0;
    chip.emu_stop().is_ok()
}

/// Whether the core's mask registers let the exception through.
pub fn unmasked(chip: &Unicorn<'_, Hooked>, exception: u8) -> bool {
    let read = |register| chip.reg_read(register).unwrap_or_default();
    let masks = Masks {
        primask: read(Register::PRIMASK) != 0,
        faultmask: read(Register::FAULTMASK) != 0,
        basepri: read(Register::BASEPRI) as u8,
    };
    chip.get_data().machine.nvic.passes(exception, &masks)
}

impl Board {
    /// Puts the core into its reset state.
    pub(crate) fn restart(&mut self) -> Result<()> {
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
        self.core = Core { pc: self.word(Image::START + 4)? & !1, ..Core::default() };
        Ok(())
    }

    pub(crate) fn word(&self, address: u32) -> Result<u32> {
        let mut bytes = [0; 4];
        self.chip.mem_read(address.into(), &mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub(crate) fn register(&self, register: Register) -> Result<u32> {
        Ok(self.chip.reg_read(register)? as u32)
    }

    /// Runs until something happens that is not an instruction, and does it.
    pub(crate) fn step(&mut self) -> Result<()> {
        if self.core.asleep {
            return self.sleep();
        }
        let outcome = self.chip.emu_start((self.core.pc | 1).into(), 0, 0, 0);
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
            self.core.pc = address;
            return take.map_or(Ok(()), |exception| self.enter(exception));
        }
        self.core.pc = address + 2;
        match self.half(address)? {
            YIELD => {}
            WFE => self.core.asleep = !mem::take(&mut self.machine_mut().event),
            WFI => self.core.asleep = true,
            // No debugger is there to take it.
            BKPT..AFTER_BKPT => return self.fault(address, 0, None),
            SVC..AFTER_SVC => bail!("SVC at {address:#x}: not modelled"),
            _ if outcome == Err(uc_error::INSN_INVALID) => return self.fault(address, UNDEFINSTR, None),
            _ => return self.fault(pc, IBUSERR, None),
        }
        Ok(())
    }

    fn half(&self, address: u32) -> Result<u16> {
        let mut bytes = [0; 2];
        self.chip.mem_read(address.into(), &mut bytes)?;
        Ok(u16::from_le_bytes(bytes))
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
                    self.core.asleep = false;
                    return if unmasked(&self.chip, exception) { self.enter(exception) } else { Ok(()) };
                }
            }
        }
    }
}
