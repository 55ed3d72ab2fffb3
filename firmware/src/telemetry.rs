//! What the tick leaves for others to read, and the little that they leave for it: the supply, whether samples are
//! streamed, and when the main loop was last round. Each value has one writer, the tick or the main loop
//! ([`Telemetry::forget`] excepted), and nothing interrupts the tick: plain loads and stores are enough.

mod bias;
mod maybe;
mod rest;

use crate::correction::Given;
use crate::drive::Following;
use crate::facts::Facts;
use crate::ramp::Stride;
use crate::rate::ticks_in;
use crate::supply::{Measured, Supply};
use bias::Bias;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, Ordering::Relaxed};
use estimator_core::{AdcCode, Status};
use maybe::Maybe;
use protocol::{Faults, Mode};

/// Counters and latches of the tick.
#[derive(Debug)]
pub struct Telemetry {
    /// Ticks since start.
    pub ticks: AtomicU32,
    /// What that was when the main loop said last that it goes on; none where it never did.
    beaten: Maybe,
    /// Cycles that the last tick took.
    pub cycles_last: AtomicU32,
    /// The most that one took.
    pub cycles_max: AtomicU32,
    /// Ticks that came late or not at all, or whose output was not ready in time.
    pub missed: AtomicU32,
    /// Ticks with the ADC at an end of its range.
    pub adc_saturated: AtomicU32,
    /// Ticks with the voltage beyond the table's range.
    pub voltage_out_of_range: AtomicU32,
    /// Ticks with the displacement clamped.
    pub clamped: AtomicU32,
    /// Ticks with the DAC at an end of its range.
    pub dac_saturated: AtomicU32,
    /// Ticks with the wanted displacement, or voltage, out of reach.
    pub out_of_reach: AtomicU32,
    /// Ticks, since the mode was set, that found no reference after the first.
    pub starved: AtomicU32,
    /// Lines begun of the waveform that is played, or was last.
    pub lines: AtomicU32,
    /// Triggers since it was begun that began no line: on the way to the first point, or during a line.
    pub triggers_ignored: AtomicU32,
    /// Samples that found the queue full.
    pub dropped: AtomicU32,
    /// The last tick's output was not ready in time.
    pub(crate) output_late: AtomicBool,
    /// Ticks come so late, or so seldom, that the output is the safe one.
    pub(crate) deadline_missed: AtomicBool,
    /// The DAC's code of the last tick.
    dac: AtomicU16,
    /// Its safe one, and how fast it may go there.
    safe: AtomicU16,
    stride: AtomicU32,
    /// Whether the DAC drives the amplifier, and whether it is put on its pin.
    drives: AtomicBool,
    connected: AtomicBool,
    /// Whether samples are wanted; written by the link.
    pub streaming: AtomicBool,
    /// How often the mode has been set; even the same again counts.
    pub epoch: AtomicU32,
    /// Whether the estimator may be told a displacement.
    pub may_be_told: AtomicBool,
    /// How often it has been told one, taken or not.
    tellings: AtomicU32,
    /// Whether the last one was taken.
    taken: AtomicBool,
    /// Whether the last voltage is not to be believed: what was estimated of it is no displacement to be told by.
    pub(crate) doubtful: AtomicBool,
    /// What the drive does, by its number.
    following: AtomicU8,
    /// The analogue supply.
    pub supply: Supply,
    /// What the DAC is given for its codes, which is another than they are where the supply is off.
    pub given: Given,
    /// The set-point's code, where there is one.
    setpoint: Maybe,
    /// What is added to the model's displacement, and since when.
    pub bias: Bias,
    faults: AtomicU16,
    faults_seen: AtomicU16,
    mode: AtomicU8,
}

/// Ticks without a word of the main loop after which it is taken to stand still: 60 ms, three times as long as it lets
/// pass, and less than a third of what the watchdog does.
pub const STALLED: u32 = ticks_in(60);

/// Adds to a counter that only the tick writes.
#[inline]
pub fn add(counter: &AtomicU32, more: u32) {
    counter.store(counter.load(Relaxed).wrapping_add(more), Relaxed);
}

impl Default for Telemetry {
    fn default() -> Self {
        Self::new()
    }
}

impl Telemetry {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Self {
            ticks: AtomicU32::new(0),
            beaten: Maybe::none(),
            cycles_last: AtomicU32::new(0),
            cycles_max: AtomicU32::new(0),
            missed: AtomicU32::new(0),
            adc_saturated: AtomicU32::new(0),
            voltage_out_of_range: AtomicU32::new(0),
            clamped: AtomicU32::new(0),
            dac_saturated: AtomicU32::new(0),
            out_of_reach: AtomicU32::new(0),
            starved: AtomicU32::new(0),
            lines: AtomicU32::new(0),
            triggers_ignored: AtomicU32::new(0),
            dropped: AtomicU32::new(0),
            output_late: AtomicBool::new(false),
            deadline_missed: AtomicBool::new(false),
            dac: AtomicU16::new(0),
            safe: AtomicU16::new(0),
            stride: AtomicU32::new(Stride::JUMP.get()),
            drives: AtomicBool::new(false),
            connected: AtomicBool::new(false),
            streaming: AtomicBool::new(false),
            epoch: AtomicU32::new(0),
            may_be_told: AtomicBool::new(false),
            tellings: AtomicU32::new(0),
            taken: AtomicBool::new(false),
            doubtful: AtomicBool::new(false),
            following: AtomicU8::new(Following::NotYet as u8),
            supply: Supply::new(),
            given: Given::new(),
            setpoint: Maybe::none(),
            bias: Bias::new(),
            faults: AtomicU16::new(0),
            faults_seen: AtomicU16::new(0),
            mode: AtomicU8::new(0),
        }
    }

    /// Before the first tick: publishes the supply at boot, from which on the DAC is given what it is to be at that.
    pub fn begin(&self, facts: &Facts, supply: &Measured) {
        self.supply.publish(supply);
        self.given.begin(facts, &self.supply);
    }

    /// The main loop goes on. Once it has said so, it must go on saying so.
    pub fn beat(&self) {
        self.beaten.set(Some(self.ticks.load(Relaxed)));
    }

    /// Whether the main loop has stood still for [`STALLED`], seen by a tick, which has been counted.
    #[inline]
    pub(crate) fn stalled(&self) -> bool {
        self.beaten.get().is_some_and(|beaten| self.ticks.load(Relaxed).wrapping_sub(beaten) > STALLED)
    }

    /// How many cycles a tick took, entry to exit, and whether its output was ready in time. The board's
    /// interrupt handler says so when it is done.
    #[inline]
    pub fn took(&self, cycles: u32, in_time: bool) {
        if !in_time {
            self.output_late.store(true, Relaxed);
        }
        self.cycles_last.store(cycles, Relaxed);
        if cycles > self.cycles_max.load(Relaxed) {
            self.cycles_max.store(cycles, Relaxed);
        }
    }

    /// The code that was read last at the set-point, corrected for the supply; `None` where the board has
    /// no such channel.
    pub fn setpoint(&self) -> Option<AdcCode> {
        // The code of a u16.
        self.setpoint.get().map(|code| AdcCode(code as u16))
    }

    #[inline]
    pub(crate) fn set_setpoint(&self, code: Option<AdcCode>) {
        self.setpoint.set(code.map(|AdcCode(code)| code.into()));
    }

    /// What is wrong now.
    pub fn faults(&self) -> Faults {
        Faults::from_bits_retain(self.faults.load(Relaxed))
    }

    /// What has been wrong.
    pub fn faults_seen(&self) -> Faults {
        Faults::from_bits_retain(self.faults_seen.load(Relaxed))
    }

    /// What the tick does.
    pub fn mode(&self) -> Mode {
        // Nothing but `set_mode` writes the number.
        Mode::from_number(self.mode.load(Relaxed)).unwrap_or_default()
    }

    /// What the drive does with references. A mode of voltages the link ends 5 s after the host's last word
    /// ([`crate::link::LEASE`]), one of displacements that holds its last one never.
    pub fn following(&self) -> Following {
        Following::of_number(self.following.load(Relaxed))
    }

    #[inline]
    pub(crate) fn set_following(&self, following: Following) {
        self.following.store(following as u8, Relaxed);
    }

    /// Whether the set-point is followed, or will be as soon as everything is sound.
    pub fn linearises(&self) -> bool {
        self.mode() == Mode::Linearise && self.following() != Following::NoMore
    }

    /// Whether no zero may be told now. Of fed codes whoever feeds them knows.
    pub(crate) fn doubts(&self) -> bool {
        self.doubtful.load(Relaxed) && self.mode() != Mode::Pil
    }

    /// The tick was told a displacement, and has taken it or not.
    pub(crate) fn was_told(&self, taken: bool) {
        self.taken.store(taken, Relaxed);
        add(&self.tellings, 1);
    }

    /// How often the tick has been told a displacement, and whether it has taken the last one.
    pub fn told(&self) -> (u32, bool) {
        (self.tellings.load(Relaxed), self.taken.load(Relaxed))
    }

    /// Whether a waveform is played.
    pub fn plays(&self) -> bool {
        self.mode() == Mode::Waveform && self.following() != Following::NoMore
    }

    /// Forgets counts and faults seen.
    pub fn forget(&self) {
        let counters = [
            &self.cycles_max,
            &self.missed,
            &self.adc_saturated,
            &self.voltage_out_of_range,
            &self.clamped,
            &self.dac_saturated,
            &self.out_of_reach,
            &self.triggers_ignored,
            &self.dropped,
        ];
        counters.iter().for_each(|counter| counter.store(0, Relaxed));
        self.faults_seen.store(0, Relaxed);
    }

    pub(crate) fn set_mode(&self, mode: Mode) {
        self.mode.store(mode as u8, Relaxed);
        self.starved.store(0, Relaxed);
        self.epoch.store(self.epoch.load(Relaxed).wrapping_add(1), Relaxed);
    }

    #[inline]
    pub(crate) fn set_faults(&self, faults: Faults) {
        self.faults.store(faults.bits(), Relaxed);
        let wrong = faults.difference(Faults::SAFE_OUTPUT).bits();
        self.faults_seen.store(self.faults_seen.load(Relaxed) | wrong, Relaxed);
    }

    /// Counts what an estimate's status says; what is fed says nothing of the actuator.
    #[inline]
    pub(crate) fn count(&self, status: Status) {
        let none_that_is_counted = Status::NOT_SETTLED.union(Status::UNTRAINED).union(Status::SLEW_EXCEEDED);
        if !none_that_is_counted.contains(status) {
            self.count_unless_fed(status);
        }
    }

    /// (A function of its own: most ticks do without it.)
    #[cold]
    #[inline(never)]
    fn count_unless_fed(&self, status: Status) {
        if self.mode() == Mode::Pil {
            return;
        }
        let counters = [
            (Status::ADC_SATURATED, &self.adc_saturated),
            (Status::VOLTAGE_OUT_OF_RANGE, &self.voltage_out_of_range),
            (Status::CLAMPED, &self.clamped),
            (Status::DAC_SATURATED, &self.dac_saturated),
            (Status::OUT_OF_REACH, &self.out_of_reach),
        ];
        for (bit, counter) in counters {
            if status.contains(bit) {
                add(counter, 1);
            }
        }
    }
}
