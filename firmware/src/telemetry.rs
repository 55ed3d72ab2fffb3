//! What the tick leaves for others to read, and the little that they leave for it: the supply, and whether samples are streamed.
//! Of each value either the tick is the only writer, but for [`Telemetry::forget`], or the main loop is; and nothing interrupts the
//! tick, so plain loads and stores are enough.

use crate::correction::Given;
use crate::facts::Facts;
use crate::ramp::{Ramp, Stride};
use crate::rate::ticks_in;
use crate::supply::Supply;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, Ordering::Relaxed};
use estimator_core::{AdcCode, DacCode, Status};
use protocol::{Faults, Mode};

/// Counters and latches of the tick.
#[derive(Debug, Default)]
pub struct Telemetry {
    /// Ticks since start.
    pub ticks: AtomicU32,
    /// What that was when the main loop said last that it goes on, and one more; 0 where it never did.
    beaten: AtomicU32,
    /// Cycles that the last tick took.
    pub cycles_last: AtomicU32,
    /// The most that one took.
    pub cycles_max: AtomicU32,
    /// Ticks that came late or not at all, or were not done in time for their output.
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
    /// The last tick was not done in time for its output.
    pub overdue: AtomicBool,
    /// The DAC's code of the last tick.
    dac: AtomicU16,
    /// Its safe one, and how fast it may go there.
    safe: AtomicU16,
    stride: AtomicU32,
    connected: AtomicBool,
    /// Whether samples are wanted; written by the link.
    pub streaming: AtomicBool,
    /// How often the mode has been set; even the same again counts.
    pub epoch: AtomicU32,
    /// Whether the estimator may be told a displacement.
    pub may_be_told: AtomicBool,
    /// Whether the last voltage is not to be believed: what was estimated of it is no displacement to be told by.
    pub(crate) doubtful: AtomicBool,
    /// Whether a reference is followed that is to be held for ever.
    pub holding: AtomicBool,
    /// Whether, in a mode that drives, nothing is followed until a mode is set.
    pub(crate) stopped: AtomicBool,
    /// The analogue supply.
    pub supply: Supply,
    /// What the DAC is given for its codes, which is another than they are where the supply is off.
    pub given: Given,
    /// The set-point's code, and one more; 0 where there is none.
    setpoint: AtomicU32,
    /// Bits of the bias, µm.
    bias: AtomicU32,
    /// Ticks since the bias was told, and one more; 0 where it was not since the estimate began.
    told: AtomicU32,
    faults: AtomicU16,
    faults_seen: AtomicU16,
    mode: AtomicU8,
}

/// Ticks without a word of the main loop after which it is taken to stand still: 60 ms, three times as long as it lets pass, and less
/// than a third of what the watchdog does.
pub const STALLED: u32 = ticks_in(60);

/// Adds to a counter that only the tick writes.
#[inline]
pub fn add(counter: &AtomicU32, more: u32) {
    counter.store(counter.load(Relaxed).wrapping_add(more), Relaxed);
}

impl Telemetry {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        Self {
            ticks: AtomicU32::new(0),
            beaten: AtomicU32::new(0),
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
            overdue: AtomicBool::new(false),
            dac: AtomicU16::new(0),
            safe: AtomicU16::new(0),
            stride: AtomicU32::new(Stride::JUMP.0),
            connected: AtomicBool::new(false),
            streaming: AtomicBool::new(false),
            epoch: AtomicU32::new(0),
            may_be_told: AtomicBool::new(false),
            doubtful: AtomicBool::new(false),
            holding: AtomicBool::new(false),
            stopped: AtomicBool::new(false),
            supply: Supply::new(),
            given: Given::new(),
            setpoint: AtomicU32::new(0),
            bias: AtomicU32::new(0),
            told: AtomicU32::new(0),
            faults: AtomicU16::new(0),
            faults_seen: AtomicU16::new(0),
            mode: AtomicU8::new(0),
        }
    }

    /// Before the first tick: takes the supply at boot, from which on the DAC is given what it is to be at that.
    pub fn begin(&self, facts: &Facts) {
        self.supply.take(facts.supply_mv, facts.supply_good);
        self.given.begin(facts, &self.supply);
    }

    /// The main loop goes on. Once it has said so, it must go on saying so.
    pub fn beat(&self) {
        self.beaten.store(self.ticks.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Whether the main loop has stood still for [`STALLED`], seen by a tick, which has been counted.
    #[inline]
    pub(crate) fn stalled(&self) -> bool {
        let beaten = self.beaten.load(Relaxed);
        beaten != 0 && self.ticks.load(Relaxed).wrapping_sub(beaten) >= STALLED
    }

    /// How long a tick took, entry to exit, and how long it might have, cycles. The board's interrupt handler says so when
    /// it is done, and learns whether it was in time.
    #[inline]
    pub fn took(&self, cycles: u32, allowed: u32) -> bool {
        let in_time = cycles <= allowed;
        if !in_time {
            self.overdue.store(true, Relaxed);
        }
        self.cycles_last.store(cycles, Relaxed);
        if cycles > self.cycles_max.load(Relaxed) {
            self.cycles_max.store(cycles, Relaxed);
        }
        in_time
    }

    /// The DAC's safe code.
    pub fn safe(&self) -> DacCode {
        DacCode(self.safe.load(Relaxed))
    }

    /// Whether the output is put on its pin at all: where nobody knows what is wired to it, it is not.
    pub fn connected(&self) -> bool {
        self.connected.load(Relaxed)
    }

    /// What the DAC is to be given for it, at the supply of now, in the board's parts of a code.
    pub fn safe_given(&self) -> DacCode {
        self.given.of(self.safe())
    }

    /// The way from what the DAC has been given to what it is given for its safe code, in the board's parts of a code.
    pub fn ramp(&self, from: DacCode) -> Ramp {
        Ramp::new(from, self.safe_given(), self.stride_given())
    }

    /// Most that what the DAC is given may change in a tick, at the supply of now, in the board's parts of a code.
    #[inline]
    pub fn stride_given(&self) -> Stride {
        match self.stride() {
            Stride::JUMP => Stride::JUMP,
            stride => self.given.stride(stride),
        }
    }

    /// Whether the DAC drives something, so that its code may not jump.
    pub fn drives(&self) -> bool {
        self.stride() != Stride::JUMP
    }

    /// Ticks from the DAC's last code to the safe one.
    pub fn ticks_to_safe(&self) -> u32 {
        Ramp::new(DacCode(self.dac.load(Relaxed)), self.safe(), self.stride()).ticks()
    }

    fn stride(&self) -> Stride {
        Stride(self.stride.load(Relaxed))
    }

    /// The code that was read last at the set-point, corrected for the supply; `None` where the board has no such channel.
    pub fn setpoint(&self) -> Option<AdcCode> {
        // The code of a u16.
        self.setpoint.load(Relaxed).checked_sub(1).map(|code| AdcCode(code as u16))
    }

    #[inline]
    pub(crate) fn set_setpoint(&self, code: Option<AdcCode>) {
        self.setpoint.store(code.map_or(0, |AdcCode(code)| u32::from(code) + 1), Relaxed);
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

    /// Whether the set-point is followed, or will be as soon as everything is sound.
    pub fn linearises(&self) -> bool {
        self.mode() == Mode::Linearise && !self.stopped.load(Relaxed)
    }

    /// Whether no zero may be told now. Of fed codes whoever feeds them knows.
    pub(crate) fn doubts(&self) -> bool {
        self.doubtful.load(Relaxed) && self.mode() != Mode::Pil
    }

    /// Whether a waveform is played.
    pub fn plays(&self) -> bool {
        self.mode() == Mode::Waveform && !self.stopped.load(Relaxed)
    }

    /// What is added to the model's displacement, µm; 0 where nothing was told.
    pub fn bias_um(&self) -> f32 {
        f32::from_bits(self.bias.load(Relaxed))
    }

    /// Ticks since the bias was told, at most [`protocol::Health::OLDEST_BIAS_TICKS`]; `None` where it was not since the
    /// estimate began.
    pub fn bias_age_ticks(&self) -> Option<u32> {
        self.told.load(Relaxed).checked_sub(1)
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

    pub(crate) fn set_safe(&self, safe: DacCode, stride: Stride, connected: bool) {
        self.connected.store(connected, Relaxed);
        self.dac.store(safe.0, Relaxed);
        self.safe.store(safe.0, Relaxed);
        self.stride.store(stride.0, Relaxed);
    }

    #[inline]
    pub(crate) fn set_dac(&self, code: DacCode) {
        self.dac.store(code.0, Relaxed);
    }

    pub(crate) fn set_mode(&self, mode: Mode) {
        self.mode.store(mode as u8, Relaxed);
        self.starved.store(0, Relaxed);
        self.epoch.store(self.epoch.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// The bias (µm) was told at this tick; without one, the estimate has begun anew.
    pub(crate) fn set_bias(&self, told_um: Option<f32>) {
        self.bias.store(told_um.unwrap_or(0.0).to_bits(), Relaxed);
        self.told.store(u32::from(told_um.is_some()), Relaxed);
    }

    /// A tick has passed since the bias was told, where it was.
    #[inline]
    pub(crate) fn age_bias(&self) {
        let told = self.told.load(Relaxed);
        if told > 0 {
            self.told.store(told.saturating_add(1), Relaxed);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Health;

    #[test]
    fn a_bias_grows_no_older_than_can_be_said() {
        let telemetry = Telemetry::new();
        telemetry.age_bias();
        assert_eq!(telemetry.bias_age_ticks(), None, "what was never told does not age");
        telemetry.set_bias(Some(0.5));
        telemetry.told.store(u32::MAX - 1, Relaxed);
        for _ in 0..3 {
            telemetry.age_bias();
            assert_eq!(telemetry.bias_age_ticks(), Some(Health::OLDEST_BIAS_TICKS));
        }
    }
}
