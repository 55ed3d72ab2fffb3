//! Recording what a handler executes, and reads from the flash, for the model of [cycles](crate::cycles).

use anyhow::{Result, ensure};
use unicorn_engine::HookType;

use crate::{
    board::Board,
    clock::{DCEN, FLASH_ACR, ICEN, LATENCY, PRFTEN},
    contents::{BANK, Contents},
    cycles::{Measured, Meter},
    image::Image,
};

/// The caches of instructions and of data.
const CACHES: u32 = ICEN | DCEN;

impl Board {
    /// From now on the runs of an exception's handler are recorded, and none before.
    ///
    /// # Errors
    /// The firmware has not set up the flash as the model has it: caches on, prefetch off.
    pub fn measure(&mut self, exception: u8) -> Result<()> {
        let access = self.machine().clocks.read(FLASH_ACR).unwrap_or_default();
        ensure!(
            access & CACHES == CACHES && access & PRFTEN == 0,
            "FLASH_ACR is {access:#x}: the model of cycles has both caches on, and the prefetch off"
        );
        if self.machine().bench.meter.is_none() {
            let end = Contents::START + BANK - 1;
            self.cpu.chip.add_mem_hook(
                HookType::MEM_READ,
                Image::START.into(),
                end.into(),
                |chip, _, address, _, _| {
                    if let Some(meter) = chip.get_data_mut().machine.meter() {
                        meter.load(address as u32);
                    }
                    true
                },
            )?;
        }
        let code = self.cpu.chip.mem_read_as_vec(Image::START.into(), Image::SIZE)?;
        let meter = Meter::new(exception, code, u64::from(access & LATENCY))?;
        self.machine_mut().bench.meter = Some(meter);
        Ok(())
    }

    /// What the recorded runs cost; those that went on when recording began are not among them.
    #[must_use]
    pub fn measured(&self) -> Measured {
        self.machine().bench.meter.as_ref().map_or_else(Measured::default, Meter::measured)
    }
}
