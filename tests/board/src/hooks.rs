//! What Unicorn calls: a hook before every instruction, and one where no memory answers.
//!
//! The first counts the instruction and stops Unicorn when an exception is to be taken. Unicorn ignores a stop inside
//! an IT block; the hook then comes again and stops behind it. Instructions that an IT condition skips are not counted.

use std::mem;

use anyhow::Result;
use unicorn_engine::{Arch, ArmCpuModel, HookType, MemType, Mode, RegisterARM as Register, Unicorn};

use crate::{
    image::Image,
    machine::{Look, Machine},
    nvic::Masks,
};

/// The instruction SEV.
const SEV: u16 = 0xBF40;

/// Unicorn, with what its hooks work on.
pub type Chip = Unicorn<'static, Hooked>;

/// What Unicorn's hooks work on.
pub struct Hooked {
    pub machine: Machine,
    /// The instruction that is executed, or that Unicorn has been stopped before.
    pub address: u32,
    pub stopping: bool,
    /// The exception it has been stopped for.
    pub take: Option<u8>,
    /// The access that no memory has answered, its address, and the instruction.
    pub access: Option<(MemType, u32, u32)>,
    /// A bit for every half-word of bank 1 that reads as SEV, which Unicorn takes for a NOP.
    sends_event: Vec<u64>,
}

/// The chip without memory.
pub fn chip(flash: &[u8], machine: Machine) -> Result<Chip> {
    let mut sends_event = vec![0; flash.len() / 128];
    for (at, half) in flash.chunks_exact(2).enumerate() {
        sends_event[at / 64] |= u64::from(half == SEV.to_le_bytes()) << (at % 64);
    }
    let hooked = Hooked { machine, address: 0, stopping: false, take: None, access: None, sends_event };
    let mut chip = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, hooked)?;
    chip.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    Ok(chip)
}

/// Hangs the hooks in.
pub fn hang(chip: &mut Chip) -> Result<()> {
    // An empty range is every address.
    chip.add_code_hook(1, 0, before_instruction)?;
    chip.add_mem_hook(HookType::MEM_INVALID, 1, 0, |chip, kind, address, _, _| {
        let hooked = chip.get_data_mut();
        hooked.access.get_or_insert((kind, address as u32, hooked.address));
        false
    })?;
    Ok(())
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
