//! The estimator: a raw ADC code in, a displacement, a DAC code and a status out, each tick.
//!
//! It never returns NaN and never leaves the table's displacement limits (less the zero, where one was set), whatever
//! codes come in. The displacement
//! that `tick` k returns is the one predicted for tick k + 1, when the DAC's trigger puts it out (Eq. 4.8: `y(k+1)`
//! from `V(k)` and `y(k)`).
//!
//! A sensorless estimate starts somewhere: at the first tick it is assumed that the actuator has rested at that tick's
//! voltage, with a memory in the middle of all that it may have. [`Estimator::start_at`] states something better where it is
//! known. Hysteresis forgets what lies within a full swing of the voltage, and so does the estimate: until the voltage has
//! turned at either end of a swing of [`SETTLED_SWING`] of its range, the status says [`Status::NOT_SETTLED`]. What a larger
//! swing would wipe out, and slow creep, may still be the start's.

use crate::calibration::{AdcCalibration, AdcCode, DacCalibration, DacCode, Line};
use crate::extremum::Extremum;
use crate::lookup::Lookup;
use crate::math::Real;
use crate::model::{Engine, State, Terms};
use crate::range::Range;
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
        /// The voltage has not turned at either end of a full swing yet: the estimate still depends on where it was assumed to
        /// start.
        const NOT_SETTLED = 1 << 4;
        /// The wanted displacement cannot be had at this tick: the voltage or its slew rate is at a limit.
        const OUT_OF_REACH = 1 << 5;
    }
}

/// What a tick gives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Estimate<T> {
    /// Displacement at the next tick, µm relative to the model's zero, or to where [`Estimator::set_zero`] was called.
    pub displacement: T,
    /// The same as the DAC takes it.
    pub dac: DacCode,
    /// What to know about it.
    pub status: Status,
}

/// A [`Lookup`] that was not built from the table it is used with (by the same math backend), or is missing, or is not
/// wanted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LookupMismatch;

impl core::fmt::Display for LookupMismatch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the lookup does not belong to this table and form, or was computed with another math backend")
    }
}

impl core::error::Error for LookupMismatch {}

/// Part of the table's voltage range that must lie between reversals for the estimate to count as settled.
pub const SETTLED_SWING: f32 = 0.5;

/// A running estimator. Made from an [`Admitted`] table only.
#[derive(Clone, Debug)]
pub struct Estimator<'l, T: Real> {
    adc: AdcCalibration,
    dac: DacCalibration,
    /// Of codes, relative to the model's zero, V.
    voltage: Line<T>,
    voltage_zero: T,
    voltage_range: Range<T>,
    limits: Range<T>,
    deadband: T,
    engine: Engine<T>,
    /// Of a Voigt model in tabulated form.
    lookup: Option<&'l Lookup<T>>,
    /// Of use once the estimator has started.
    state: State<T>,
    started: bool,
    /// [`Status::NOT_SETTLED`], or nothing.
    settling: Status,
    /// Voltages of the reversals so far; inside out before the first.
    turned: Range<T>,
    /// [`SETTLED_SWING`] of the voltage range, V.
    swing: T,
    zero: T,
}

impl<'l, T: Real> Estimator<'l, T> {
    /// An estimator for a table. `lookup` must be what [`Table::lookup`](crate::Table::lookup) makes where its form is
    /// tabulated, and `None` where it is direct.
    pub fn new(table: &Admitted, lookup: Option<&'l Lookup<T>>) -> Result<Self, LookupMismatch> {
        if table.lookup().as_ref() != lookup {
            return Err(LookupMismatch);
        }
        let voltage_zero = T::of(table.voltage_zero_v);
        Ok(Self {
            adc: table.adc,
            dac: table.dac,
            voltage: table.adc.line(voltage_zero),
            voltage_zero,
            voltage_range: table.voltage_range_v.of(),
            limits: table.displacement_limits_um.of(),
            deadband: T::of(table.deadband_v),
            engine: table.engine(),
            lookup,
            state: State::new(T::zero(), T::of(table.deadband_v)),
            started: false,
            settling: Status::NOT_SETTLED,
            turned: Range { min: T::infinity(), max: T::neg_infinity() },
            swing: T::of(SETTLED_SWING * table.voltage_range_v.span()),
            zero: T::zero(),
        })
    }

    /// Starts anew from a known displacement (µm relative to the model's zero), with no reversal seen. Returns whether it
    /// lay within the limits; beyond, the start is at the nearest, as it is where no memory of the model gives it.
    pub fn start_at(&mut self, displacement: T) -> bool {
        self.restart();
        self.start(displacement);
        self.limits.contains(displacement)
    }

    /// Starts anew, from rest at the next tick's voltage, with the model's zero.
    pub fn restart(&mut self) {
        self.state = State::new(T::zero(), self.deadband);
        self.started = false;
        self.settling = Status::NOT_SETTLED;
        self.turned = Range { min: T::infinity(), max: T::neg_infinity() };
        self.zero = T::zero();
        if let Engine::Other(model) = &mut self.engine {
            model.forget();
        }
    }

    /// Calls the displacement of now 0, as at rest, where creep has carried the actuator from what the model knows.
    pub fn set_zero(&mut self) {
        self.zero = if self.started { self.state.displacement } else { T::zero() };
    }

    /// The last reversal; zeros before the first.
    pub fn last_extremum(&self) -> Extremum<T> {
        self.state.last_extremum()
    }

    /// One tick: the code of this tick's conversion in, the displacement at the next tick out.
    ///
    /// What is rare, and the direct form, is compiled apart: the ordinary tabulated tick calls nothing.
    #[inline]
    pub fn tick(&mut self, code: AdcCode) -> Estimate<T> {
        let voltage = self.voltage.at(code);
        match self.lookup {
            Some(lookup) if self.voltage_range.contains(voltage) && !self.adc.saturated(code) => {
                self.step(voltage, lookup.terms(voltage), self.settling)
            }
            _ => self.advance(voltage, self.adc.saturated(code)),
        }
    }

    /// One tick with the amplifier's voltage in V.
    pub fn tick_volts(&mut self, amplifier: T) -> Estimate<T> {
        self.advance(amplifier - self.voltage_zero, false)
    }

    #[inline(never)]
    fn advance(&mut self, wanted: T, saturated: bool) -> Estimate<T> {
        let voltage = self.voltage_range.clamp(wanted);
        let mut status = self.settling;
        status.set(Status::ADC_SATURATED, saturated);
        status.set(Status::VOLTAGE_OUT_OF_RANGE, voltage != wanted);
        match (&mut self.engine, self.lookup) {
            (Engine::Voigt(_), Some(lookup)) => self.step(voltage, lookup.terms(voltage), status),
            (Engine::Voigt(model), None) => {
                let terms = model.terms(voltage);
                self.step(voltage, terms, status)
            }
            (Engine::Other(model), _) => {
                let known = self.started.then_some(self.state.displacement);
                let free = model.step(voltage, known);
                if self.state.track(voltage) {
                    self.settle(&mut status);
                }
                self.state.displacement = free;
                self.started = true;
                self.finish(free, status)
            }
        }
    }

    #[inline(always)]
    fn step(&mut self, voltage: T, terms: Terms<T>, status: Status) -> Estimate<T> {
        let Terms { a, c, m } = terms;
        if !self.started {
            self.begin(voltage, a, c, m, status)
        } else if self.state.track(voltage) {
            self.turn(a, c, m, status)
        } else {
            let free = self.state.apply(terms);
            self.finish(free, status)
        }
    }

    /// The first tick: the actuator is taken to have rested at this voltage. The terms come apart, in registers.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, voltage: T, a: T, c: T, m: T, status: Status) -> Estimate<T> {
        // a < 1 in every admitted table.
        self.start(c / (T::one() - a));
        self.state.track(voltage);
        let free = self.state.apply(Terms { a, c, m });
        self.finish(free, status)
    }

    fn start(&mut self, displacement: T) {
        self.state = State::new(self.limits.clamp(displacement), self.deadband);
        self.started = true;
    }

    /// A tick that reveals a reversal.
    #[cold]
    #[inline(never)]
    fn turn(&mut self, a: T, c: T, m: T, mut status: Status) -> Estimate<T> {
        if let Engine::Voigt(model) = &self.engine {
            model.turn(&mut self.state);
        }
        self.settle(&mut status);
        let free = self.state.apply(Terms { a, c, m });
        self.finish(free, status)
    }

    /// After a reversal.
    fn settle(&mut self, status: &mut Status) {
        let at = self.state.last_extremum().voltage;
        if at < self.turned.min {
            self.turned.min = at;
        }
        if at > self.turned.max {
            self.turned.max = at;
        }
        if self.turned.span() >= self.swing {
            self.settling = Status::empty();
            status.remove(Status::NOT_SETTLED);
        }
    }

    #[inline(always)]
    fn finish(&mut self, free: T, status: Status) -> Estimate<T> {
        let displacement = free - self.zero;
        let dac = self.dac.code(displacement);
        if self.limits.contains(free) && !self.dac.saturated(dac) {
            Estimate { displacement, dac, status }
        } else {
            self.limited(free, status)
        }
    }

    /// A displacement beyond the limits or the DAC's range.
    #[cold]
    #[inline(never)]
    fn limited(&mut self, free: T, mut status: Status) -> Estimate<T> {
        let limited = self.limits.clamp(free);
        self.state.displacement = limited;
        let displacement = limited - self.zero;
        let dac = self.dac.code(displacement);
        status.set(Status::CLAMPED, limited != free);
        status.set(Status::DAC_SATURATED, self.dac.saturated(dac));
        Estimate { displacement, dac, status }
    }
}
