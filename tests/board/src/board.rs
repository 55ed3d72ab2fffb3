//! The board as a test holds it: power, reset, the host's serial line, the voltage at the ADC, flash and RAM.

use std::mem;

use anyhow::{Context, Result, bail};

use crate::{
    CORE_HZ, Garbage, Image, Record,
    contents::{Contents, Tear},
    cpu::Cpu,
    flash::{BOR_LEV, DBANK},
    machine::{Machine, PARTS},
    pin::Pin,
    ram::{RAM, RAM_SIZE},
    rcc::Reset,
    stop::Stop,
};

/// A NUCLEO-G474RE with its firmware.
pub struct Board {
    garbage: Garbage,
    pub(crate) cpu: Cpu,
}

impl Board {
    /// Power comes to a new board: bank 2 is erased, the supply is 3.3 V. Nothing runs before [`Board::run`].
    ///
    /// # Errors
    /// The CPU emulator failed.
    pub fn power_on(image: &Image) -> Result<Self> {
        let cpu = Cpu::build(image.flash(), Machine::powered())?;
        let mut board = Self { garbage: Garbage::new(1), cpu };
        board.reboot(Reset::PowerOn)?;
        Ok(board)
    }

    /// The chip resets and the firmware starts over; what was recorded stays. The flash is kept, an erase or program in
    /// its midst torn; RAM is kept but for a loss of power, which leaves garbage.
    ///
    /// # Errors
    /// The CPU emulator failed.
    pub fn reboot(&mut self, cause: Reset) -> Result<()> {
        let tear = Tear::Midst(self.garbage.word());
        self.machine_mut().reset(cause, tear);
        if cause == Reset::PowerOn {
            let ram: Vec<u8> = (0..RAM_SIZE / 8).flat_map(|_| self.garbage.word().to_le_bytes()).collect();
            self.cpu.chip.mem_write(RAM, &ram)?;
        }
        self.cpu.restart()
    }

    /// Runs for `seconds` of the board's time, or until something ends the run.
    ///
    /// # Errors
    /// The firmware did what a model cannot follow, or what is wrong on the chip as well; or the run before
    /// ended for good.
    pub fn run(&mut self, seconds: f64) -> Result<Stop> {
        self.run_until(seconds, |_| false)
    }

    /// Runs until `condition` holds, which is looked at after every exception and every sleep, but for no longer than
    /// `seconds`.
    ///
    /// # Errors
    /// As [`Board::run`].
    pub fn run_until(&mut self, seconds: f64, mut condition: impl FnMut(&Self) -> bool) -> Result<Stop> {
        let machine = self.machine_mut();
        machine.deadline = machine.clock + (seconds * f64::from(CORE_HZ)) as u64;
        machine.look_at = 0;
        loop {
            match &self.machine().end {
                Some(Ok(stop)) => return Ok(*stop),
                Some(Err(refusal)) => bail!("{}: {refusal}", self.place()),
                None if condition(self) => return Ok(Stop::Condition),
                None if self.machine().clock >= self.machine().deadline => return Ok(Stop::Time),
                None => {}
            }
            if let Err(error) = self.cpu.step() {
                self.machine_mut().refuse(&error);
            }
        }
    }

    /// Where the firmware is, for messages.
    fn place(&self) -> String {
        let at = self.machine().clock as f64 / f64::from(CORE_HZ);
        format!("the firmware at {:#x}, {at:.6} s after power-on", self.cpu.pc)
    }

    pub(crate) fn machine(&self) -> &Machine {
        self.cpu.machine()
    }

    pub(crate) fn machine_mut(&mut self) -> &mut Machine {
        self.cpu.machine_mut()
    }

    /// Core clocks since power-on.
    #[must_use]
    pub fn clock(&self) -> u64 {
        self.machine().clock
    }

    /// From now on, through resets, an instruction takes so many clocks on average, 1 or more. What a core of the kind
    /// takes with wait states lies between 1.3 and 2.2.
    ///
    /// # Panics
    /// It would take less than a clock.
    pub fn slow(&mut self, clocks: f64) {
        assert!(clocks >= 1.0, "{clocks} clocks an instruction");
        self.machine_mut().bench.slowness = ((clocks - 1.0) * PARTS as f64).round() as u64;
    }

    /// Of [`Board::clock`], those in which no instruction ran, or one went on that had begun before: sleep, waiting for
    /// the flash, exception entry and return, and what [`Board::slow`] adds.
    #[must_use]
    pub fn skipped(&self) -> u64 {
        self.machine().skipped
    }

    /// What happened since power-on.
    #[must_use]
    pub fn record(&self) -> &Record {
        &self.machine().bench.record
    }

    /// Puts bytes on the serial line to the board, behind those still on their way.
    pub fn send(&mut self, bytes: &[u8]) {
        let machine = self.machine_mut();
        machine.bench.wire.sent.extend(bytes.iter().map(|&byte| (byte, true)));
        machine.listen();
    }

    /// As [`Board::send`], of bytes whose stop bit is missing.
    pub fn send_broken(&mut self, bytes: &[u8]) {
        let machine = self.machine_mut();
        machine.bench.wire.sent.extend(bytes.iter().map(|&byte| (byte, false)));
        machine.listen();
    }

    /// Bytes that are still on their way to the board.
    #[must_use]
    pub fn on_the_way(&self) -> usize {
        self.machine().bench.wire.sent.len()
    }

    /// The bytes that have come from the board since the last call.
    pub fn take_received(&mut self) -> Vec<u8> {
        mem::take(&mut self.machine_mut().bench.wire.received)
    }

    /// The number of bytes that [`Board::take_received`] would give.
    #[must_use]
    pub fn received(&self) -> usize {
        self.machine().bench.wire.received.len()
    }

    /// From now on, the n-th injected sequence, counted from 0, reads `codes(n)` at the amplifier's channel.
    pub fn feed(&mut self, mut codes: impl FnMut(u64) -> u16 + 'static) {
        self.connect(move |n, _| codes(n));
    }

    /// As [`Board::feed`], of what the DAC's pin shows when the conversion ends; nothing where it is not driven.
    pub fn connect(&mut self, codes: impl FnMut(u64, Option<u16>) -> u16 + 'static) {
        let inputs = &mut self.machine_mut().bench.inputs;
        inputs.codes = Box::new(codes);
        inputs.converted = 0;
    }

    /// From now on, the n-th injected sequence, counted from the last [`Board::feed`] or [`Board::connect`], reads
    /// `codes(n)` at the sensor's channel; before, it reads 0.
    pub fn feed_sensor(&mut self, codes: impl FnMut(u64) -> u16 + 'static) {
        self.machine_mut().bench.inputs.sensor = Box::new(codes);
    }

    /// As [`Board::feed_sensor`], at the set-point's channel.
    pub fn feed_setpoint(&mut self, codes: impl FnMut(u64) -> u16 + 'static) {
        self.machine_mut().bench.inputs.setpoint = Box::new(codes);
    }

    /// Sets ADC1's code of the internal reference: 16 × 1650 × 3.0 V / supply.
    pub fn set_reference(&mut self, code: u16) {
        self.machine_mut().bench.inputs.reference = code;
    }

    /// Whether ADC1's conversions of the internal reference end; they go on where they do not.
    pub fn end_measurements(&mut self, measures: bool) {
        self.machine_mut().bench.inputs.measures = measures;
    }

    /// Ratio and right shift that ADC1's injected conversions are oversampled with.
    #[must_use]
    pub fn oversampling(&self) -> (u32, u32) {
        self.machine().adc.injected_oversampling()
    }

    /// Drives a pin from outside; nobody does before.
    pub fn drive(&mut self, pin: Pin, high: bool) {
        self.machine_mut().bench.levels.insert(pin, high);
    }

    /// What a pin is set to by MODER: 0 input, 1 output, 2 alternate function, 3 analogue.
    #[must_use]
    pub fn mode(&self, pin: Pin) -> u32 {
        self.machine().gpio[pin.port as usize].mode(pin.number)
    }

    /// The code at the pin of DAC1's channel 1, if it is driven.
    #[must_use]
    pub fn output(&self) -> Option<u16> {
        self.machine().dac.output()
    }

    /// Power will go during the `nth` flash operation from now, counted from 1, which leaves `tear`.
    pub fn cut_power(&mut self, nth: usize, tear: Tear) {
        let bench = &mut self.machine_mut().bench;
        bench.cut = Some((bench.record.flash.len() + nth, tear));
    }

    /// From now on FLASH_ECCR says that there is a flash error, and neither where nor in which bank, as an erratum
    /// may have it.
    pub fn corrupt_eccr(&mut self) {
        let machine = self.machine_mut();
        (machine.bench.corrupt, machine.flash.corrupt) = (true, true);
    }

    /// The crystal stops, and does not start again before [`Board::mend_crystal`] and a reset.
    pub fn break_crystal(&mut self) {
        self.machine_mut().break_crystal();
    }

    /// From the next reset on the crystal starts again.
    pub fn mend_crystal(&mut self) {
        self.machine_mut().bench.no_crystal = false;
    }

    /// The level of the brown-out reset (BOR_LEV) is another from the next start on, as if a probe had written
    /// the option bytes.
    pub fn set_brown_out_level(&mut self, level: u8) {
        let machine = self.machine_mut();
        machine.bench.options =
            Some(machine.flash.options & !BOR_LEV | u32::from(level) << BOR_LEV.trailing_zeros() & BOR_LEV);
    }

    /// The flash is in one bank or in two (DBANK) from the next start on, as if a probe had written the option bytes.
    /// What lies where is as with two: in one nothing but the code is to be read, and nothing to be written.
    pub fn set_two_banks(&mut self, two: bool) {
        let machine = self.machine_mut();
        machine.bench.options = Some(machine.flash.options & !DBANK | if two { DBANK } else { 0 });
    }

    /// Bank 2 of the flash.
    #[must_use]
    pub fn contents(&self) -> &Contents {
        &self.machine().flash.contents
    }

    /// Changes bank 2 behind the firmware's back.
    pub fn contents_mut(&mut self) -> &mut Contents {
        &mut self.machine_mut().flash.contents
    }

    /// What the firmware has written to a register that no model has a rule for.
    #[must_use]
    pub fn plain(&self, address: u32) -> u32 {
        self.machine().plain.get(&address).copied().unwrap_or(0)
    }

    /// Changes a word of the RAM or a register, as the core's own store would.
    ///
    /// # Errors
    /// There is neither at the address.
    pub fn poke(&mut self, address: u32, value: u32) -> Result<()> {
        self.cpu
            .chip
            .mem_write(address.into(), &value.to_le_bytes())
            .with_context(|| format!("neither memory nor register at {address:#x}"))
    }

    /// A word of the RAM, or of the image.
    ///
    /// # Errors
    /// There is no memory at the address.
    pub fn peek(&self, address: u32) -> Result<u32> {
        self.cpu.word(address).with_context(|| format!("no memory at {address:#x}"))
    }

    /// Leads the core astray: it goes on at `address`, whatever it was about to do.
    pub fn jump(&mut self, address: u32) {
        self.cpu.pc = address & !1;
        self.cpu.asleep = false;
    }

    /// Instructions of every finished run of a handler, without handlers nested in it,
    /// by [exception](crate::exception) number.
    pub fn instructions(&self, exception: u8) -> impl Iterator<Item = u64> {
        self.record().services.get(&exception).into_iter().flatten().filter_map(|service| service.instructions)
    }
}
