//! The memory map (RM0440, "Memory organization"): what is memory, what goes to the models.
//!
//! CCM's own address, 0x1000_0000, and the flash's shadow at 0 are not there.

use anyhow::Result;
use unicorn_engine::{Prot, Unicorn};

use crate::{
    contents::{BANK, Contents},
    hooks::{Chip, Hooked},
    image::Image,
    ram::{RAM, RAM_SIZE},
};

const SYSTEM: u64 = 0x1FFF_0000;
/// Up to the option bytes; nothing lies between them and RAM, where a stack could grow into.
const SYSTEM_SIZE: u64 = 32 << 10;
/// A factory word of the system memory: the internal reference's code at 3.0 V.
const VREFINT_CALIBRATION: (u64, u16) = (0x1FFF_75AA, 1650);
/// The chip's unique number.
const UID: (u64, [u8; 12]) = (0x1FFF_7590, *b"board-tests\0");
/// Where registers are: peripherals, GPIO, ADC and DAC, the core.
const REGISTERS: [(u32, u64); 4] =
    [(0x4000_0000, 512 << 10), (0x4800_0000, 64 << 10), (0x5000_0000, 512 << 10), (0xE000_0000, 1 << 20)];

/// Lets DMA see what has been written to the ring that the DAC converts.
pub fn see_ring(chip: &mut Unicorn<'_, Hooked>) {
    if let Some(ring) = chip.get_data().machine.dma.ring() {
        // Cannot fail: the channel's memory was looked at when it was switched on.
        let bytes = chip.mem_read_as_vec(ring.start.into(), ring.len()).expect("DMA comes from RAM");
        chip.get_data_mut().machine.dma.see(bytes);
    }
}

/// Maps everything, with `flash` in bank 1.
pub fn map(chip: &mut Chip, flash: &[u8]) -> Result<()> {
    chip.mem_map(Image::START.into(), flash.len() as u64, Prot::READ | Prot::EXEC)?;
    chip.mem_write(Image::START.into(), flash)?;
    chip.mem_map(RAM, RAM_SIZE, Prot::ALL)?;
    chip.mem_map(SYSTEM, SYSTEM_SIZE, Prot::READ)?;
    chip.mem_write(SYSTEM, &vec![0xFF; SYSTEM_SIZE as usize])?;
    let (address, code) = VREFINT_CALIBRATION;
    chip.mem_write(address, &code.to_le_bytes())?;
    let (address, bytes) = UID;
    chip.mem_write(address, &bytes)?;
    for (base, size) in REGISTERS {
        chip.mmio_map(
            base.into(),
            size,
            Some(move |chip: &mut Unicorn<'_, Hooked>, offset, size| {
                chip.get_data_mut().machine.read(base + offset as u32, size as u32).into()
            }),
            Some(move |chip: &mut Unicorn<'_, Hooked>, offset, size, value| {
                chip.get_data_mut().machine.write(base + offset as u32, size as u32, value as u32);
                if let Some(block) = chip.get_data().machine.dma.wanted() {
                    // Cannot fail: the channel's memory was looked at when it was switched on.
                    let bytes = chip.mem_read_as_vec(block.start.into(), block.len()).expect("DMA comes from RAM");
                    chip.get_data_mut().machine.load_block(bytes);
                }
                see_ring(chip);
            }),
        )?;
    }
    chip.mmio_map(
        Contents::START.into(),
        BANK.into(),
        Some(|chip: &mut Unicorn<'_, Hooked>, offset, size| {
            chip.get_data_mut().machine.load(offset as u32, size as u32).into()
        }),
        Some(|chip: &mut Unicorn<'_, Hooked>, offset, size, value| {
            chip.get_data_mut().machine.store(offset as u32, size as u32, value as u32);
        }),
    )?;
    Ok(())
}
