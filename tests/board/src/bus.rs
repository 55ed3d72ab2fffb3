//! What the core's loads and stores reach: registers by their address, and bank 2 of the flash.

use anyhow::{Result, bail};

use crate::{
    NEVER,
    bases::{ADC1, DAC1, DMA1, DMAMUX, DWT, FLASH, GPIOA, GPIOB, GPIOC, IWDG, LPUART1, RCC, SCS, TIM5, TIM6, TIM7},
    clock::{FLASH_ACR, PWR_CR5},
    dac::TIM7_TRGO,
    layout::layout,
    machine::Machine,
    nvic::{DEMCR, TRCENA, Written},
    rcc::Reset,
    record::{FlashKind, FlashOperation},
    stop::Stop,
    timer::PSC,
    uart::TDR,
};

const GPIO: [u32; 3] = [GPIOA, GPIOB, GPIOC];
/// The peripherals with a model, by the 1 KiB that each has.
const MODELLED: [u32; 11] = [TIM5, TIM6, TIM7, IWDG, LPUART1, DMA1, DMAMUX, RCC, FLASH, ADC1, DAC1];
/// Registers of 16 bits or less, which may be written without the rest of the word: prescalers, LPUART1_TDR.
const SHORT: [u32; 4] = [TIM5 + PSC, TIM6 + PSC, TIM7 + PSC, LPUART1 + TDR];

layout! {
    "DWT" {
        CTRL @ 0x00 { CYCCNTENA = 0 }
        CYCCNT @ 0x04 {}
    }
}

const DWT_CTRL: u32 = DWT + CTRL;
const DWT_CYCCNT: u32 = DWT + CYCCNT;

impl Machine {
    fn cycle_counter_runs(&self) -> bool {
        let set = |address, bit: u32| self.plain.get(&address).is_some_and(|value| value & bit != 0);
        set(DWT_CTRL, CYCCNTENA) && set(SCS + DEMCR, TRCENA)
    }

    pub fn read(&mut self, address: u32, size: u32) -> u32 {
        self.fire();
        let word = match self.read_word(address & !3) {
            Ok(Some(word)) => word,
            Ok(None) => {
                self.bench.record.plain.insert(address & !3);
                self.plain.get(&(address & !3)).copied().unwrap_or(0)
            }
            Err(error) => {
                self.refuse(&error);
                0
            }
        };
        // Reading data clears flags.
        self.look_at = 0;
        word >> (8 * (address & 3)) & (u32::MAX >> (32 - 8 * size))
    }

    /// Without its clock a peripheral reads as 0 and takes no writes.
    fn clocked(&mut self, address: u32) -> bool {
        let clocked = self.rcc.clocked(address & !0x3FF);
        if !clocked {
            self.bench.record.unclocked.insert(address);
        }
        clocked
    }

    /// The word, if there is a rule for it.
    fn read_word(&mut self, address: u32) -> Result<Option<u32>> {
        if !self.clocked(address) {
            return Ok(Some(0));
        }
        let offset = address & 0x3FF;
        if let Some(port) = port(address) {
            return Ok(self.gpio[port].read(offset, &self.bench.levels));
        }
        Ok(match address & !0x3FF {
            TIM5 => self.tim5.read(offset, self.clock),
            TIM6 => self.tim6.read(offset, self.clock),
            TIM7 => self.tim7.read(offset, self.clock),
            LPUART1 => self.uart.read(offset),
            DMA1 => self.dma.read(offset),
            DMAMUX => self.dma.read_mux(offset),
            RCC => self.rcc.read(offset),
            FLASH if offset == 0 => self.clocks.read(address),
            FLASH => {
                let value = self.flash.read(offset);
                if self.flash.due() != NEVER {
                    // Whoever reads a register of the busy flash waits for it; nothing is lost in not polling.
                    self.skip();
                }
                value
            }
            ADC1 => self.adc.read(offset),
            DAC1 => self.dac.read(offset),
            _ if address == PWR_CR5 => self.clocks.read(address),
            _ if address == DWT_CYCCNT => {
                Some(if self.cycle_counter_runs() { self.clock.wrapping_sub(self.cycles) as u32 } else { 0 })
            }
            _ if address & !0xFFF == SCS => self.nvic.read(address & 0xFFF)?,
            _ => None,
        })
    }

    pub fn write(&mut self, address: u32, size: u32, value: u32) {
        self.fire();
        self.look_at = 0;
        match self.write_word(address, size, value) {
            Ok(true) => {}
            Ok(false) => {
                let word = address & !3;
                self.bench.record.plain.insert(word);
                let shift = 8 * (address & 3);
                let mask = (u32::MAX >> (32 - 8 * size)) << shift;
                let old = self.plain.entry(word).or_default();
                *old = *old & !mask | value << shift & mask;
            }
            Err(error) => self.refuse(&error),
        }
    }

    /// Whether there is a rule for the register.
    fn write_word(&mut self, address: u32, size: u32, value: u32) -> Result<bool> {
        if !self.clocked(address) {
            return Ok(true);
        }
        if address & !0xFFF == SCS {
            return Ok(match self.nvic.write(address & 0xFFF, size, value)? {
                Written::Done => true,
                Written::Plain => false,
                Written::Reset => {
                    self.end = Some(Ok(Stop::Reset(Reset::Software)));
                    true
                }
            });
        }
        let (now, offset) = (self.clock, address & 0x3FF);
        if let Some(port) = port(address).filter(|_| size == 4) {
            return Ok(self.gpio[port].write(offset, value, now, &mut self.bench.record.edges));
        }
        Ok(match address & !0x3FF {
            page if size != 4 && MODELLED.contains(&page) && !SHORT.contains(&address) => {
                bail!("{size} bytes are written to register {address:#x}; only whole words are modelled");
            }
            TIM5 => self.tim5.write(offset, value, now)?.is_some(),
            TIM6 => match self.tim6.write(offset, value, now)? {
                Some(trigger) => {
                    if self.tim6.running() {
                        self.rcc.check_core()?;
                    }
                    if trigger {
                        self.trigger(now)?;
                    }
                    true
                }
                None => false,
            },
            TIM7 => match self.tim7.write(offset, value, now)? {
                Some(trigger) => {
                    if trigger {
                        self.convert(now, TIM7_TRGO);
                    }
                    true
                }
                None => false,
            },
            IWDG => self.watchdog.write(offset, value, now)?,
            LPUART1 => {
                self.rcc.check_uart()?;
                let known = self.uart.write(offset, value, now)?;
                self.transfer(now)?;
                known
            }
            DMA1 => {
                let known = self.dma.write(offset, value)?;
                self.transfer(now)?;
                self.serve();
                known
            }
            DMAMUX => self.dma.write_mux(offset, value),
            RCC => {
                let known = self.rcc.write(offset, value);
                self.clocks_change(now)?;
                known
            }
            _ if [PWR_CR5, FLASH_ACR].contains(&address) => {
                self.clocks.write(address, value);
                self.clocks_change(now)?;
                true
            }
            FLASH if self.flash.read(offset).is_some() => {
                self.stall();
                let started = self.flash.write(offset, value, self.clock)?;
                self.started(started);
                true
            }
            ADC1 => self.adc.write(offset, value, now, &self.rcc)?,
            DAC1 => self.dac.write(offset, value, now, &mut self.bench.record.outputs)?,
            _ if address == DWT_CYCCNT => {
                self.cycles = now.wrapping_sub(value.into());
                true
            }
            _ => false,
        })
    }

    /// The registers that make the clocks have been written.
    pub(crate) fn clocks_change(&mut self, now: u64) -> Result<()> {
        self.clocks.hold(self.rcc.holds_power(), self.rcc.holds_flash());
        self.clocks.check(self.rcc.speeds()?, now)?;
        let clocks = self.rcc.timer_clocks()?;
        self.tim5.clock_by(clocks, now);
        self.tim6.clock_by(clocks, now);
        self.tim7.clock_by(clocks, now);
        Ok(())
    }

    /// A load from bank 2.
    pub fn load(&mut self, offset: u32, size: u32) -> u32 {
        self.fire();
        self.stall();
        self.look_at = 0;
        self.flash.load(offset, size)
    }

    /// A store to bank 2.
    pub fn store(&mut self, offset: u32, size: u32, value: u32) {
        self.fire();
        self.stall();
        self.look_at = 0;
        match self.flash.store(offset, size, value, self.clock) {
            Ok(started) => self.started(started),
            Err(error) => self.refuse(&error),
        }
    }

    fn started(&mut self, operation: Option<(FlashKind, u32)>) {
        let Some((kind, address)) = operation else { return };
        self.bench.record.flash.push(FlashOperation { clock: self.clock, kind, address });
        if let Some((nth, tear)) = self.bench.cut
            && nth == self.bench.record.flash.len()
        {
            self.bench.cut = None;
            self.flash.stop(tear);
            self.end = Some(Ok(Stop::PowerCut));
        }
    }
}

/// The index of the port that has a register at this address.
fn port(address: u32) -> Option<usize> {
    GPIO.iter().position(|&base| base == address & !0x3FF)
}
