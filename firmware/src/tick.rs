//! The tick: what happens between a conversion and the next trigger, the same on every board and in every test.
//!
//! Contract. The timer's trigger starts the conversion and latches the DAC, both in hardware. The end of the conversion
//! raises the highest-priority interrupt, which calls [`Tick::sample`] and writes the code it returns to the DAC, to be
//! latched by the *next* trigger: whatever the tick's duration, the output has no jitter, as long as it is done in time.
//! One tick is 500 µs, 85,000 cycles at 170 MHz. A tick that comes late or not at all, or is not done in time for its output,
//! is counted, and the sample says so; the numbers of the samples skip ticks that did not come. No lock, no log, no allocation,
//! no `f64`. Where the DAC drives the amplifier ([`Drive`]), the same holds of its voltage: the reference of tick k moves
//! it at tick k + 1, and the displacement a tick after that.

use crate::drive::Drive;
use crate::peripherals::Converters;
use crate::telemetry::{Telemetry, add};
use crate::watch::{Lasting, Watch};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, DacCode, Estimate, Estimator, Status};
use heapless::spsc::{Consumer, Producer};
use protocol::{Faults, Mode, Sample};

/// What the link tells the tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Command {
    /// Change the mode and start anew.
    SetMode(Mode),
    /// Call the displacement of now 0.
    SetZero,
    /// Follow the references that wait and those that come, and stay at the last one, or not for long.
    Go {
        /// For good.
        stay: bool,
    },
}

/// A sample and its tick, counted from 0 when the mode was set.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Numbered {
    /// The tick.
    pub tick: u32,
    /// Its sample.
    pub sample: Sample,
}

/// Where the tick's commands and fed codes come from and its samples go.
pub struct Queues<'q> {
    /// From the link; one a tick is taken.
    pub commands: Consumer<'q, Command>,
    /// From the link, in [`Mode::Pil`]; one a tick is taken.
    pub fed: Consumer<'q, AdcCode>,
    /// From the link, in [`Mode::Follow`], µm; one a tick is taken.
    pub references: Consumer<'q, f32>,
    /// To the link, while it streams.
    pub samples: Producer<'q, Numbered>,
}

/// Everything the interrupt owns.
pub struct Tick<'q> {
    estimator: Option<Estimator<f32>>,
    /// Where the DAC drives the amplifier.
    drive: Option<Drive>,
    queues: Queues<'q>,
    telemetry: &'q Telemetry,
    period: u32,
    /// Faults that last until the next reset.
    standing: Faults,
    safe: DacCode,
    mode: Mode,
    converters: Converters,
    watch: Watch,
    number: u32,
    /// Cycle counter at the last tick.
    last: Option<u32>,
}

impl<'q> Tick<'q> {
    /// `period`: counts of the cycle counter from tick to tick. `standing`: faults known since boot. Without an estimator
    /// the DAC stays at `safe`.
    #[expect(clippy::too_many_arguments, reason = "called once, and each is another thing")]
    pub fn new(
        estimator: Option<Estimator<f32>>,
        drive: Option<Drive>,
        safe: DacCode,
        converters: Converters,
        queues: Queues<'q>,
        telemetry: &'q Telemetry,
        period: u32,
        standing: Faults,
    ) -> Self {
        telemetry.safe.store(safe.0, Relaxed);
        let standing = if estimator.is_some() { standing } else { standing | Faults::NO_TABLE };
        let (mode, watch) = (Mode::default(), Watch::new(converters.adc_full_scale));
        let (number, last) = (0, None);
        Self { estimator, drive, queues, telemetry, period, standing, safe, mode, converters, watch, number, last }
    }

    /// One tick: the code just converted in, the code for the DAC's next trigger out. `now` is the cycle counter.
    pub fn sample(&mut self, code: AdcCode, now: u32) -> DacCode {
        add(&self.telemetry.ticks, 1);
        let missed = self.missed(now);
        if let Some(command) = self.queues.commands.dequeue() {
            self.obey(command);
        }
        let code = match self.mode {
            Mode::Estimate | Mode::Follow => Some(code),
            Mode::Pil => self.queues.fed.dequeue(),
            Mode::Pause => None,
        };
        let mut faults = self.standing;
        faults.set(Faults::MISSED_DEADLINE, missed.is_some());
        let (dac, faults) = match code {
            Some(code) => self.estimate(code, missed, faults),
            None => (self.safe_output(), faults | Faults::SAFE_OUTPUT),
        };
        self.telemetry.set_faults(faults);
        dac
    }

    fn estimate(&mut self, code: AdcCode, missed: Option<u32>, mut faults: Faults) -> (DacCode, Faults) {
        let Estimate { displacement, dac, mut status } = match &mut self.estimator {
            Some(estimator) => tick_sample(estimator, code),
            None => Estimate { displacement: 0.0, dac: self.safe, status: Status::empty() },
        };
        let mut safe = true;
        // Fed codes are not the ADC's: they say nothing of its health, and their ticks come when they are fed.
        if self.mode != Mode::Pil {
            self.number = self.number.wrapping_add(missed.unwrap_or(0));
            match self.watch.look(code, status, missed.is_some()) {
                Lasting::None => safe = faults.intersects(Faults::UNSAFE),
                // What it has made of the bad codes is forgotten.
                Lasting::Passed => self.restart(),
                Lasting::Faults(lasting) => faults |= lasting,
            }
        }
        let dac = match &mut self.drive {
            Some(drive) if self.mode == Mode::Follow => {
                if safe {
                    drive.stop();
                }
                let next = if drive.going() { self.queues.references.dequeue() } else { None };
                if next.is_none() && drive.following() {
                    add(&self.telemetry.starved, 1);
                }
                let (dac, reached) = drive.follow(next);
                safe = !drive.following();
                status |= reached;
                dac
            }
            Some(_) => {
                safe = true;
                self.safe_output()
            }
            None if safe => self.safe,
            None => dac,
        };
        if self.drive.is_some() {
            // The DAC shows no displacement.
            status.remove(Status::DAC_SATURATED);
        }
        self.telemetry.count(status);
        faults.set(Faults::SAFE_OUTPUT, safe);
        if self.telemetry.streaming.load(Relaxed) {
            let sample = Sample { code: code.0, displacement, dac: dac.0, status, faults };
            if self.queues.samples.enqueue(Numbered { tick: self.number, sample }).is_err() {
                add(&self.telemetry.dropped, 1);
            }
        }
        self.number = self.number.wrapping_add(1);
        (dac, faults)
    }

    /// How many ticks did not come since the last one, if this one is late or the last one was not done in time.
    fn missed(&mut self, now: u32) -> Option<u32> {
        let last = self.last.replace(now)?;
        let elapsed = now.wrapping_sub(last);
        let overdue = self.telemetry.overdue.load(Relaxed);
        if elapsed <= self.period + self.period / 8 && !overdue {
            return None;
        }
        self.telemetry.overdue.store(false, Relaxed);
        let lost = ((elapsed + self.period / 2) / self.period).saturating_sub(1);
        add(&self.telemetry.missed, lost.max(1));
        Some(lost)
    }

    /// The safe value, or a tick on the way to it.
    fn safe_output(&mut self) -> DacCode {
        self.drive.as_mut().map_or(self.safe, Drive::release)
    }

    fn restart(&mut self) {
        if let Some(estimator) = &mut self.estimator {
            tick_restart(estimator);
        }
    }

    fn obey(&mut self, command: Command) {
        match command {
            Command::SetMode(mode) => {
                self.mode = mode;
                self.number = 0;
                self.watch = Watch::new(self.converters.adc_full_scale);
                while self.queues.fed.dequeue().is_some() {}
                while self.queues.references.dequeue().is_some() {}
                self.restart();
                if let Some(drive) = &mut self.drive {
                    drive.restart();
                }
                self.telemetry.set_mode(mode);
            }
            Command::Go { stay } => {
                if let Some(drive) = &mut self.drive {
                    drive.go(stay);
                }
            }
            Command::SetZero => {
                if let Some(estimator) = &mut self.estimator {
                    estimator.set_zero();
                }
            }
        }
    }
}

/// The estimator's tick as a function of its own, so that its instructions can be counted in an image.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_sample(estimator: &mut Estimator<f32>, code: AdcCode) -> Estimate<f32> {
    estimator.tick(code)
}

/// Marks the start of a measurement, for whoever counts instructions.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_restart(estimator: &mut Estimator<f32>) {
    estimator.restart();
}
