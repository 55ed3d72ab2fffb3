//! Entering exceptions and returning from them (Armv7-M architecture reference manual, "Exception model").
//!
//! Entry pushes the extended frame with the floating-point registers whether they are in use or not, as deep as a
//! stack can get. Only the main stack is modelled. IPSR reads 0 in handlers; ICSR tells the truth. Late arrival
//! is not modelled.

use anyhow::{Result, bail, ensure};
use unicorn_engine::RegisterARM as Register;

use crate::{
    cpu::{Cpu, Handler, THUMB},
    exception::HARD_FAULT,
    hooks::unmasked,
    machine::Look,
    memory,
    nvic::Nvic,
    record::{Fault, Service},
    stop::Stop,
};

/// Clocks of exception entry, return, and going from one to the next without unstacking (Cortex-M4 manual,
/// no wait states).
const ENTRY: u64 = 12;
const RETURN: u64 = 10;
const TAIL_CHAIN: u64 = 6;
/// EXC_RETURN with extended frame on the main stack: to a handler, to the thread.
const TO_HANDLER: u32 = 0xFFFF_FFE1;
const TO_THREAD: u32 = 0xFFFF_FFE9;
/// xPSR in a frame: a word of padding lies above it.
const PADDED: u32 = 1 << 9;

/// The registers of the extended frame in their order, but for PC, xPSR and the reserved word.
const CORE: [Register; 6] = [Register::R0, Register::R1, Register::R2, Register::R3, Register::R12, Register::LR];
#[rustfmt::skip]
const FLOAT: [Register; 17] = [
    Register::S0, Register::S1, Register::S2, Register::S3, Register::S4, Register::S5, Register::S6, Register::S7,
    Register::S8, Register::S9, Register::S10, Register::S11, Register::S12, Register::S13, Register::S14, Register::S15,
    Register::FPSCR,
];
const FRAME: usize = 26;
const PC: usize = 6;
const XPSR: usize = 7;

/// Whether a jump to this address is an exception return.
pub fn is_return(pc: u32) -> bool {
    pc >= TO_HANDLER & !0xF
}

impl Cpu {
    /// HardFault at the instruction `pc`: with these bits for CFSR, or none if it is a breakpoint.
    pub fn fault(&mut self, pc: u32, status: u32, address: Option<u32>) -> Result<()> {
        let masked = !unmasked(&self.chip, HARD_FAULT);
        let machine = self.machine_mut();
        machine.nvic.fault(status, address);
        let fault = Fault { clock: machine.clock, pc, status, address };
        machine.bench.record.faults.push(fault);
        if masked || machine.nvic.running() < 0 {
            machine.end = Some(Ok(Stop::Lockup));
            return Ok(());
        }
        self.pc = pc;
        self.enter(HARD_FAULT)
    }

    /// Pushes the frame and goes to the handler.
    pub fn enter(&mut self, exception: u8) -> Result<()> {
        ensure!(self.register(Register::CONTROL)? & 2 == 0, "the process stack is in use: not modelled");
        let top = self.register(Register::SP)?;
        let sp = (top & !7).wrapping_sub(4 * FRAME as u32);
        let padded = if top & 4 == 0 { 0 } else { PADDED };
        let mut frame = Vec::with_capacity(FRAME);
        for register in CORE {
            frame.push(self.register(register)?);
        }
        frame.push(self.pc);
        frame.push(self.register(Register::XPSR)? | padded);
        for register in FLOAT {
            frame.push(self.register(register)?);
        }
        frame.push(0);
        let bytes: Vec<u8> = frame.iter().flat_map(|word| word.to_le_bytes()).collect();
        if self.chip.mem_write(sp.into(), &bytes).is_err() {
            self.machine_mut().end = Some(Ok(Stop::Lockup));
            return Ok(());
        }
        self.chip.reg_write(Register::SP, sp.into())?;
        self.begin(exception, ENTRY)
    }

    /// Goes to the handler, whose frame is on the stack, after so many clocks.
    fn begin(&mut self, exception: u8, clocks: u64) -> Result<()> {
        let link = if self.handlers.is_empty() { TO_THREAD } else { TO_HANDLER };
        self.chip.reg_write(Register::LR, link.into())?;
        self.chip.reg_write(Register::XPSR_NZCVQG, THUMB.into())?;
        let machine = self.machine_mut();
        machine.nvic.enter(exception);
        let services = machine.bench.record.services.entry(exception).or_default();
        let service = services.len();
        services.push(Service { entry: machine.clock, instructions: None });
        machine.spend(clocks);
        let began = machine.instructions();
        let vector = Nvic::vector(exception);
        self.handlers.push(Handler { exception, service, began, nested: 0 });
        self.pc = self.word(vector)? & !1;
        Ok(())
    }

    /// The newest handler returns: to the next exception if there is one, or else to what it interrupted.
    pub fn leave(&mut self, link: u32) -> Result<()> {
        let expected = if self.handlers.len() == 1 { TO_THREAD } else { TO_HANDLER };
        let Some(handler) = self.handlers.pop().filter(|_| link == expected) else {
            bail!("exception return {link:#x} where {expected:#x} was due");
        };
        memory::see_ring(&mut self.chip);
        let machine = self.machine_mut();
        let instructions = machine.instructions() - handler.began;
        let services = machine.bench.record.services.entry(handler.exception).or_default();
        services[handler.service].instructions = Some(instructions - handler.nested);
        if let Some(meter) = machine.meter() {
            meter.finish()?;
        }
        machine.nvic.leave();
        machine.event = true;
        let next = machine.look();
        if let Some(outer) = self.handlers.last_mut() {
            outer.nested += instructions;
        }
        match next {
            Look::Take(exception) if unmasked(&self.chip, exception) => self.begin(exception, TAIL_CHAIN),
            _ => self.unstack(),
        }
    }

    fn unstack(&mut self) -> Result<()> {
        let sp = self.register(Register::SP)?;
        let mut frame = Vec::with_capacity(FRAME);
        for at in 0..FRAME as u32 {
            frame.push(self.word(sp + 4 * at)?);
        }
        let (core, rest) = frame.split_at(PC);
        for (register, &value) in CORE.into_iter().zip(core).chain(FLOAT.into_iter().zip(&rest[2..])) {
            self.chip.reg_write(register, value.into())?;
        }
        let status = frame[XPSR];
        self.chip.reg_write(Register::XPSR_NZCVQG, status.into())?;
        let padding = if status & PADDED == 0 { 0 } else { 4 };
        self.chip.reg_write(Register::SP, (sp + 4 * FRAME as u32 + padding).into())?;
        self.pc = frame[PC] & !1;
        self.machine_mut().spend(RETURN);
        Ok(())
    }
}
