//! The estimator: a raw ADC code in, a displacement, a DAC code and a status out, each tick.
//!
//! It never returns NaN and never leaves the table's displacement limits (plus the bias, where one was told), whatever
//! codes come in. The displacement that `tick` k returns is the one predicted for tick k + 1, when the DAC's trigger
//! puts it out (Eq. 4.8: `y(k+1)` from `V(k)` and `y(k)`).
//!
//! A sensorless estimate starts somewhere: at the first tick it is assumed that the actuator has rested at that tick's
//! voltage, with a memory in the middle of all that it may have. [`Estimator::start_at`] states something better where
//! it is known. Until what the start left is wiped out ([`crate::settling`]), the status says [`Status::NOT_SETTLED`].
//! What a larger swing would wipe out, and slow creep, may still be the start's.
//!
//! Beyond the table's range, and at an end of the converter's, the model is fed another voltage than the actuator has.
//! What it remembers is then as wrong as after a start, and the status says so until swings have wiped that out, too.
//! There is no interval meanwhile, and a wider one until then.

use crate::calibration::{AdcCalibration, AdcCode, DacCalibration, DacCode, Line};
use crate::interval::{Interval, IntervalState, Width};
use crate::math::Real;
use crate::model::{Engine, Process};
use crate::range::Range;
use crate::settling::Settling;
use crate::table::Admitted;
use serde::{Deserialize, Serialize};

bitflags::bitflags! {
    /// What a tick has to report.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
    pub struct Status: u8 {
        /// The ADC stands at an end of its range: the voltage is at least that large.
        const ADC_SATURATED = 1 << 0;
        /// The voltage is beyond the range the model was identified on; the nearest end was taken.
        const VOLTAGE_OUT_OF_RANGE = 1 << 1;
        /// The displacement was clamped to the table's limits.
        const CLAMPED = 1 << 2;
        /// The DAC stands at an end of its range: the displacement is at least that far.
        const DAC_SATURATED = 1 << 3;
        /// The voltage has not turned yet at both ends of a swing of half the table's voltage range, since the start or
        /// since it was last another than the model was fed, by more than the deadband: the estimate still depends on
        /// what was assumed then.
        const NOT_SETTLED = 1 << 4;
        /// The wanted displacement, or voltage, cannot be had at this tick: the voltage or its slew rate is at a limit.
        const OUT_OF_REACH = 1 << 5;
        /// The voltage has gone as it never went in the training: what the estimate says here was not learnt.
        const UNTRAINED = 1 << 6;
        /// The voltage has leapt as the amplifier cannot, and the last one before was taken; or it has just come back,
        /// and the estimate catches up. A device says so, the estimator never.
        const SLEW_EXCEEDED = 1 << 7;
    }
}

/// Of one tick: the displacement predicted for the next one, how far it may be off, and what speaks against it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Estimate<T> {
    /// Displacement at the next tick, µm: the model's, relative to its zero, plus [`Estimator::bias`].
    pub displacement: T,
    /// Half the width of its 95 % interval ([`interval`](crate::interval)), µm, at most the span of the table's limits,
    /// within which the model and the actuator are both taken to be; `None` where the table has none, or the
    /// displacement was not told since the start, or the voltage is beyond what the model was fed.
    pub half_width: Option<T>,
    /// The same as the DAC takes it.
    pub dac: DacCode,
    /// What to know about it.
    pub status: Status,
}

/// A running estimator. Made from an [`Admitted`] table only.
#[derive(Clone, Debug)]
pub struct Estimator<T: Real> {
    adc: AdcCalibration,
    dac: DacCalibration,
    /// Of codes, relative to the model's zero, V: an `f32` in every number type, so that the reference sees the very
    /// voltages that the target sees.
    voltage: Line<f32>,
    voltage_zero: T,
    voltage_range: Range<T>,
    limits: Range<T>,
    deadband: T,
    engine: Engine<T>,
    /// Until it is settled, since the start or since the model was last fed another voltage than the actuator had.
    settling: Option<Settling<T>>,
    /// Displacement at the next tick, or where it was told to start, µm; `None` before.
    displacement: Option<T>,
    /// What is added to the model's displacement, µm.
    bias: T,
    interval: Option<Interval<T>>,
    /// From the first tick on.
    interval_state: Option<IntervalState<T>>,
}

impl<T: Real> Estimator<T> {
    /// An estimator for a table, at rest.
    pub fn new(table: &Admitted) -> Self {
        let voltage_zero = T::of(table.voltage_zero_v);
        let voltage_range = table.voltage_range_v.of();
        let deadband = T::of(table.retreat_v());
        Self {
            adc: table.adc,
            dac: table.dac,
            voltage: table.adc.line(table.voltage_zero_v),
            voltage_zero,
            voltage_range,
            limits: table.displacement_limits_um.of(),
            deadband,
            engine: table.engine(),
            settling: Some(Settling::new(voltage_range, deadband)),
            displacement: None,
            bias: T::zero(),
            interval: table.interval.map(|of| Interval::build(&of, voltage_range, table.sample_period())),
            interval_state: None,
        }
    }

    /// The same estimator, at rest, for voltages that stand for a tick, as those of an [`Inverse`](crate::Inverse) do:
    /// see [`Recursion::of_held_voltage`](crate::Recursion::of_held_voltage).
    #[must_use]
    pub fn of_held_voltage(mut self) -> Self {
        self.restart();
        Self { engine: self.engine.of_held_voltage(), ..self }
    }

    /// Starts anew from a known displacement (µm relative to the model's zero), with no reversal seen. Returns whether
    /// it lay within the limits; beyond, the start is at the nearest, as it is where no memory of the model gives it.
    pub fn start_at(&mut self, displacement: T) -> bool {
        self.restart();
        self.displacement = Some(self.limits.clamp(displacement));
        self.limits.contains(displacement)
    }

    /// Starts anew, from rest at the next tick's voltage, with the model's zero: the bias is 0 again.
    pub fn restart(&mut self) {
        self.engine.forget();
        self.settling = Some(Settling::new(self.voltage_range, self.deadband));
        self.displacement = None;
        self.bias = T::zero();
        self.interval_state = None;
    }

    /// Calls the displacement of now `at` (µm), where a stop, a gauge or rest tells it: the bias becomes `at` less
    /// the model's displacement. Returns whether it did: only where it [may be told](Self::may_be_told), and where
    /// `at` is finite.
    pub fn set_zero(&mut self, at: T) -> bool {
        self.displacement.is_some_and(|displacement| self.set_bias(at - displacement))
    }

    /// Adds `by` (µm) to the bias, and so to every displacement from now on. Returns whether it did, as
    /// [`set_zero`](Self::set_zero) does.
    pub fn shift(&mut self, by: T) -> bool {
        self.set_bias(self.bias + by)
    }

    /// What is added to the model's displacement, µm: what the model is too low by, as [`Self::set_zero`] and
    /// [`Self::shift`] have told. 0 from each start on.
    pub fn bias(&self) -> T {
        self.bias
    }

    /// Whether a displacement may be told now: not before the first tick (of a table without an interval, nor before
    /// [`start_at`](Self::start_at)), nor so soon after it that an actuator which moved
    /// then is still on its way ([`IntervalParameters::earliest_s`](crate::IntervalParameters::earliest_s)).
    pub fn may_be_told(&self) -> bool {
        match (&self.interval, &self.interval_state) {
            (Some(interval), Some(state)) => interval.may_be_told(state),
            (Some(_), None) => false,
            (None, _) => self.displacement.is_some(),
        }
    }

    fn set_bias(&mut self, bias: T) -> bool {
        let told = bias.is_finite() && self.may_be_told();
        if told {
            self.bias = bias;
            self.tell();
        }
        told
    }

    /// Takes the displacement of now to be told: the interval is relative to it. Returns whether there is one from now
    /// on; there is none where the table has none, or too soon after the start.
    pub fn tell(&mut self) -> bool {
        match (&self.interval, &mut self.interval_state) {
            (Some(interval), Some(state)) => interval.tell(state),
            _ => false,
        }
    }

    /// One tick: the code of this tick's conversion in, the displacement at the next tick out.
    #[inline]
    pub fn tick(&mut self, code: AdcCode) -> Estimate<T> {
        self.advance(T::of(self.voltage.at(code)), self.adc.saturated(code))
    }

    /// One tick with the amplifier's voltage in V.
    pub fn tick_volts(&mut self, amplifier: T) -> Estimate<T> {
        self.advance(amplifier - self.voltage_zero, false)
    }

    #[inline]
    fn advance(&mut self, wanted: T, saturated: bool) -> Estimate<T> {
        let voltage = self.voltage_range.clamp(wanted);
        let mut status = Status::empty();
        status.set(Status::ADC_SATURATED, saturated);
        status.set(Status::VOLTAGE_OUT_OF_RANGE, voltage != wanted);
        let misled = !status.is_empty() && self.mislead(wanted, saturated);
        let known = self.displacement;
        let free = self.engine.step(voltage, known);
        self.displacement = Some(free);
        let half_width = if self.interval.is_some() {
            let Width { half, untrained } = self.width(voltage, free, known.is_some());
            status.set(Status::UNTRAINED, untrained);
            if misled {
                self.widen(voltage);
                None
            } else {
                let most = self.limits.span();
                half.map(|half| if half < most { half } else { most })
            }
        } else {
            None
        };
        if let Some(settling) = &mut self.settling {
            if settling.settles(voltage) {
                self.settling = None;
            } else {
                status |= Status::NOT_SETTLED;
            }
        }
        let displacement = free + self.bias;
        let dac = self.dac.code(displacement);
        if self.limits.contains(free) && !self.dac.saturated(dac) {
            Estimate { displacement, half_width, dac, status }
        } else {
            Estimate { half_width, ..self.limited(free, status) }
        }
    }

    /// Whether the model is fed another voltage than the actuator has; what it remembers is then settled no more. Less
    /// than a deadband is noise, to the memory as well.
    #[cold]
    #[inline(never)]
    fn mislead(&mut self, wanted: T, saturated: bool) -> bool {
        let Range { min, max } = self.voltage_range;
        let as_good = Range { min: min - self.deadband, max: max + self.deadband };
        let misled = saturated || !as_good.contains(wanted);
        if misled {
            self.settling = Some(Settling::new(self.voltage_range, self.deadband));
        }
        misled
    }

    /// The interval counts a voltage that the model was misled by as a start.
    #[cold]
    #[inline(never)]
    fn widen(&mut self, voltage: T) {
        if let Some(state) = &mut self.interval_state {
            state.mislead(voltage);
        }
    }

    /// The interval of a tick. At the first one a displacement is `known` where the estimator was told it. A function
    /// of its own, so that a table without an interval pays nothing for it.
    #[inline(never)]
    fn width(&mut self, voltage: T, displacement: T, known: bool) -> Width<T> {
        let Some(interval) = &self.interval else { return Width { half: None, untrained: false } };
        let state = match &mut self.interval_state {
            Some(state) => state,
            none => {
                let state = none.insert(interval.begin(voltage, displacement));
                if known {
                    interval.tell_at_rest(state);
                }
                state
            }
        };
        interval.step(state, voltage, displacement)
    }

    /// A displacement beyond the limits or the DAC's range.
    #[cold]
    #[inline(never)]
    fn limited(&mut self, free: T, mut status: Status) -> Estimate<T> {
        let limited = self.limits.clamp(free);
        self.displacement = Some(limited);
        self.engine.set_displacement(limited);
        let displacement = limited + self.bias;
        let dac = self.dac.code(displacement);
        status.set(Status::CLAMPED, limited != free);
        status.set(Status::DAC_SATURATED, self.dac.saturated(dac));
        Estimate { displacement, half_width: None, dac, status }
    }
}
