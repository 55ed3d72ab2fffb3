//! What lies behind the core's bus: the clock, the peripherals, and the wires between them.

use std::{collections::HashMap, mem};

use anyhow::{Error, Result};

use crate::{
    CORE_HZ, NEVER,
    adc::{Adc, Inputs},
    clock::Clock,
    contents::{Contents, Tear},
    cycles::Meter,
    dac::{Dac, TIM6_TRGO, TIM7_TRGO},
    dma::Dma,
    exception,
    flash::Flash,
    gpio::{Gpio, Levels},
    nvic::Nvic,
    pin::Port,
    rcc::{RESET, Rcc, Reset},
    record::Record,
    stop::Stop,
    timer::Timer,
    uart::{Uart, Wire},
    watchdog::Watchdog,
};

/// The parts of a clock that an instruction's time is given in.
pub const PARTS: u64 = 16;

/// What is around the chip and stays when it is reset.
#[derive(Default)]
pub struct Bench {
    pub inputs: Inputs,
    pub wire: Wire,
    /// What drives the inputs from outside.
    pub levels: Levels,
    pub record: Record,
    /// What a flash error leaves in ECCR is corrupt.
    pub corrupt: bool,
    /// The crystal does not oscillate.
    pub no_crystal: bool,
    /// FLASH_OPTR, where it is not as delivered.
    pub options: Option<u32>,
    /// Power goes during the operation that makes the record of them this long.
    pub cut: Option<(usize, Tear)>,
    /// Records what a handler executes, where a test asks for it.
    pub meter: Option<Meter>,
    /// What an instruction takes beyond its first clock, in [`PARTS`] of a clock, and what of it has not made a
    /// whole one yet.
    pub slowness: u64,
    pub owed: u64,
}

/// What the core is to do.
pub enum Look {
    /// Execute the next instruction.
    Go,
    /// Nothing: the run ends.
    Stop,
    /// This exception, if its mask registers let it.
    Take(u8),
}

pub struct Machine {
    pub clock: u64,
    /// Of these, the ones in which no instruction ran, or one did not end that took longer than a clock.
    pub skipped: u64,
    /// The core looks for interrupts before the first instruction from here on.
    pub look_at: u64,
    /// When the run ends.
    pub deadline: u64,
    /// The event register of WFE and SEV.
    pub event: bool,
    /// Why nothing runs before the next reset, if so: an end, or what the models refuse.
    pub end: Option<Result<Stop, String>>,
    pub bench: Bench,
    pub nvic: Nvic,
    pub(crate) rcc: Rcc,
    pub(crate) clocks: Clock,
    pub flash: Flash,
    pub adc: Adc,
    pub dac: Dac,
    pub(crate) gpio: [Gpio; 3],
    pub(crate) tim5: Timer,
    pub(crate) tim6: Timer,
    pub(crate) tim7: Timer,
    pub(crate) uart: Uart,
    pub(crate) dma: Dma,
    pub(crate) watchdog: Watchdog,
    pub(crate) plain: HashMap<u32, u32>,
    /// The clock at which CYCCNT was 0.
    pub(crate) cycles: u64,
    /// What an instruction takes beyond [`Bench::slowness`] since the crystal has stopped, in [`PARTS`] of a clock.
    lag: u64,
}

impl Machine {
    fn new(clock: u64, skipped: u64, bench: Bench, contents: Contents, rcc: Rcc) -> Self {
        let mut machine = Self {
            clock,
            skipped,
            look_at: 0,
            deadline: 0,
            event: false,
            end: None,
            bench,
            nvic: Nvic::new(),
            rcc,
            clocks: Clock::new(RESET),
            flash: Flash::new(contents),
            adc: Adc::new(),
            dac: Dac::default(),
            gpio: Port::ALL.map(Gpio::new),
            tim5: Timer::new(u32::MAX, 4),
            tim6: Timer::new(0xFFFF, 0),
            tim7: Timer::new(0xFFFF, 0),
            uart: Uart::new(),
            dma: Dma::default(),
            watchdog: Watchdog::new(),
            plain: HashMap::new(),
            cycles: 0,
            lag: 0,
        };
        machine.flash.corrupt = machine.bench.corrupt;
        machine.flash.options = machine.bench.options.unwrap_or(machine.flash.options);
        machine.rcc.broken = machine.bench.no_crystal;
        machine.listen();
        machine
    }

    /// A board whose power has just come.
    pub fn powered() -> Self {
        Self::new(0, 0, Bench::default(), Contents::erased(), Rcc::new(Reset::PowerOn, 0))
    }

    /// A reset: the registers get their reset values; a flash operation in its midst leaves `tear`.
    pub fn reset(&mut self, cause: Reset, tear: Tear) {
        self.flash.stop(tear);
        let (bench, contents) = (mem::take(&mut self.bench), mem::take(&mut self.flash.contents));
        *self = Self::new(self.clock, self.skipped, bench, contents, Rcc::new(cause, self.rcc.reset_flags()));
    }

    /// The crystal stops, now and at the next starts.
    pub fn break_crystal(&mut self) {
        self.bench.no_crystal = true;
        self.fire();
        if !self.rcc.break_crystal() {
            self.end = Some(Ok(Stop::Lockup));
        } else if self.rcc.crystal_failed() {
            self.lag = PARTS * u64::from(CORE_HZ) / u64::from(RESET.core) - PARTS;
            if let Err(error) = self.clocks_change(self.clock) {
                self.refuse(&error);
            }
        }
        self.look_at = 0;
    }

    /// The host has put bytes on the wire.
    pub fn listen(&mut self) {
        self.uart.listen(self.clock, &self.bench.wire);
    }

    pub fn refuse(&mut self, error: &Error) {
        self.end.get_or_insert_with(|| Err(format!("{error:#}")));
    }

    /// The clock of the next event.
    fn due(&self) -> u64 {
        [
            self.tim5.due,
            self.tim6.due,
            self.tim7.due,
            self.adc.due(),
            self.uart.due(),
            self.flash.due(),
            self.watchdog.due,
        ]
        .into_iter()
        .fold(NEVER, u64::min)
    }

    /// Everything that is due by now, in its order.
    pub(crate) fn fire(&mut self) {
        loop {
            let at = self.due();
            if at > self.clock || self.end.is_some() {
                return;
            }
            if let Err(error) = self.advance(at) {
                self.refuse(&error);
            }
        }
    }

    fn advance(&mut self, at: u64) -> Result<()> {
        if self.tim5.due == at {
            self.tim5.advance(at);
        }
        if self.adc.due() == at {
            self.bench.inputs.pin = self.dac.output();
            self.adc.advance(at, &mut self.bench.inputs, &self.rcc, &mut self.bench.record)?;
        }
        if self.tim7.due == at && self.tim7.advance(at) {
            self.convert(at, TIM7_TRGO);
        }
        if self.tim6.due == at && self.tim6.advance(at) {
            self.trigger(at)?;
        }
        if self.uart.due() == at {
            self.uart.advance(at, &mut self.bench.wire, &mut self.bench.record.overruns)?;
            self.transfer(at)?;
        }
        if self.flash.due() == at {
            self.flash.advance();
        }
        if self.watchdog.due == at {
            self.watchdog.due = NEVER;
            self.end = Some(Ok(Stop::Reset(Reset::Watchdog)));
        }
        Ok(())
    }

    /// Serves LPUART1's requests for DMA.
    pub(crate) fn transfer(&mut self, at: u64) -> Result<()> {
        while self.uart.wants_to_store() && self.dma.receives() {
            self.dma.receive(self.uart.take());
        }
        while self.uart.wants_to_send()
            && let Some(byte) = self.dma.transmit()
        {
            self.uart.put(byte, at)?;
        }
        Ok(())
    }

    /// A block that DMA is to send, as it is in memory.
    pub(crate) fn load_block(&mut self, bytes: Vec<u8>) {
        self.dma.load(bytes);
        if let Err(error) = self.transfer(self.clock) {
            self.refuse(&error);
        }
    }

    /// An instruction is executed.
    pub(crate) fn execute(&mut self) {
        self.bench.owed += self.bench.slowness + self.lag;
        let more = self.bench.owed / PARTS;
        self.bench.owed %= PARTS;
        self.clock += 1 + more;
        self.skipped += more;
    }

    /// What TIM6's TRGO does.
    pub(crate) fn trigger(&mut self, at: u64) -> Result<()> {
        self.convert(at, TIM6_TRGO);
        self.adc.trigger(at, &self.rcc, &mut self.bench.record)
    }

    /// A timer's trigger, at the DAC.
    pub(crate) fn convert(&mut self, at: u64, trigger: u32) {
        self.dac.trigger(at, trigger, &mut self.bench.record.outputs);
        self.serve();
    }

    /// Serves the DAC's request for DMA.
    pub(crate) fn serve(&mut self) {
        if self.dac.requests()
            && let Some(code) = self.dma.convert()
        {
            self.dac.take(code);
        }
    }

    /// Makes happen what is due, and says what the core is to do before its next instruction.
    pub fn look(&mut self) -> Look {
        self.fire();
        self.nvic.update(self.lines(), self.flash.double_error() || self.rcc.crystal_failed());
        self.look_at = self.due().min(self.deadline);
        if self.end.is_some() || self.clock >= self.deadline {
            return Look::Stop;
        }
        self.nvic.next().map_or(Look::Go, Look::Take)
    }

    fn lines(&self) -> u128 {
        [
            (self.flash.interrupt(), exception::FLASH),
            (self.dma.interrupt(1), exception::DMA1_CHANNEL1),
            (self.dma.interrupt(2), exception::DMA1_CHANNEL2),
            (self.dma.interrupt(3), exception::DMA1_CHANNEL3),
            (self.adc.interrupt(), exception::ADC1_2),
            (self.tim5.interrupt(), exception::TIM5),
            (self.tim6.interrupt(), exception::TIM6),
            (self.uart.interrupt(), exception::LPUART1),
        ]
        .into_iter()
        .fold(0, |lines, (high, exception)| lines | u128::from(high) << (exception - 16))
    }

    /// Lets time pass without instructions, to the next event or the end of the run.
    pub fn skip(&mut self) {
        let to = self.due().min(self.deadline).max(self.clock);
        self.skipped += to - self.clock;
        self.clock = to;
    }

    /// Holds the core until the flash is no longer busy; events happen, interrupts wait.
    pub(crate) fn stall(&mut self) {
        while self.flash.due() != NEVER && self.end.is_none() {
            let to = self.due().max(self.clock);
            self.skipped += to - self.clock;
            self.clock = to;
            self.fire();
        }
    }

    /// Takes `clocks` of exception entry or return.
    pub fn spend(&mut self, clocks: u64) {
        self.clock += clocks;
        self.skipped += clocks;
        self.look_at = 0;
    }

    /// What records the handler that runs now, if it is to be recorded.
    pub fn meter(&mut self) -> Option<&mut Meter> {
        let running = self.nvic.active.last();
        self.bench.meter.as_mut().filter(|meter| running == Some(&meter.exception))
    }

    /// Instructions executed so far.
    pub fn instructions(&self) -> u64 {
        self.clock - self.skipped
    }
}
