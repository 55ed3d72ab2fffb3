//! The estimator: a raw ADC code in, a displacement, a DAC code and a status out, each tick.
//!
//! It never returns NaN and never leaves the table's displacement limits, whatever codes come in. The displacement
//! that `tick` k returns is the one predicted for tick k + 1, when the DAC's trigger puts it out (Eq. 4.8: `y(k+1)`
//! from `V(k)` and `y(k)`).
//!
//! A sensorless estimate starts somewhere: at the first tick it is assumed that the actuator has rested at that tick's
//! voltage (the static displacement, no reversal seen). [`Estimator::start_at`] states something better where it is known.

use crate::calibration::{AdcCode, DacCode};
use crate::extremum::Extremum;
use crate::lookup::Lookup;
use crate::math::Real;
use crate::model::{State, Terms, Voigt};
use crate::range::Range;
use crate::table::{Admitted, Form, Table};

bitflags::bitflags! {
    /// What a tick has to report.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct Status: u8 {
        /// The ADC stands at an end of its range: the voltage is at least that large.
        const ADC_SATURATED = 1 << 0;
        /// The voltage is beyond the range the model was identified on; the nearest end was taken.
        const VOLTAGE_OUT_OF_RANGE = 1 << 1;
        /// The displacement was clamped to the table's limits.
        const CLAMPED = 1 << 2;
        /// The DAC stands at an end of its range: the displacement is at least that far.
        const DAC_SATURATED = 1 << 3;
    }
}

/// What a tick gives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Estimate<T> {
    /// Displacement at the next tick, µm relative to the model's zero.
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

/// A running estimator. Made from an [`Admitted`] table only.
#[derive(Clone, Debug)]
pub struct Estimator<'l, T> {
    table: Table,
    voltage_zero: T,
    voltage_range: Range<T>,
    limits: Range<T>,
    model: Voigt<T>,
    lookup: Option<&'l Lookup<T>>,
    state: Option<State<T>>,
}

impl<'l, T: Real> Estimator<'l, T> {
    /// An estimator for a table. `lookup` must be what [`Table::lookup`] makes where its form is tabulated,
    /// and `None` where it is direct.
    pub fn new(table: &Admitted, lookup: Option<&'l Lookup<T>>) -> Result<Self, LookupMismatch> {
        let fits = match (table.form, lookup) {
            (Form::Direct, None) => true,
            (Form::Tabulated { .. }, Some(lookup)) => *lookup == table.lookup(),
            _ => false,
        };
        if !fits {
            return Err(LookupMismatch);
        }
        Ok(Self {
            table: **table,
            voltage_zero: T::of(table.voltage_zero_v),
            voltage_range: table.voltage_range_v.of(),
            limits: table.displacement_limits_um.of(),
            model: table.coefficients(),
            lookup,
            state: None,
        })
    }

    /// Starts anew from a known displacement (µm relative to the model's zero), with no reversal seen. Returns whether it
    /// lay within the limits; beyond, the start is at the nearest.
    pub fn start_at(&mut self, displacement: T) -> bool {
        self.state = Some(self.state_at(displacement));
        self.limits.contains(displacement)
    }

    /// The last reversal; zeros before the first.
    pub fn last_extremum(&self) -> Extremum<T> {
        let zero = Extremum { voltage: T::zero(), displacement: T::zero() };
        self.state.map_or(zero, |state| state.last_extremum())
    }

    /// One tick: the code of this tick's conversion in, the displacement at the next tick out.
    #[inline]
    pub fn tick(&mut self, code: AdcCode) -> Estimate<T> {
        let mut estimate = self.tick_volts(self.table.adc.voltage(code));
        if self.table.adc.saturated(code) {
            estimate.status |= Status::ADC_SATURATED;
        }
        estimate
    }

    /// One tick with the amplifier's voltage in V.
    #[inline]
    pub fn tick_volts(&mut self, amplifier: T) -> Estimate<T> {
        let mut status = Status::empty();
        let wanted = amplifier - self.voltage_zero;
        let voltage = self.voltage_range.clamp(wanted);
        if voltage != wanted {
            status |= Status::VOLTAGE_OUT_OF_RANGE;
        }
        let terms = self.terms(voltage);
        let mut state = match self.state {
            Some(state) => state,
            // a < 1 in every admitted table.
            None => self.state_at(terms.c / (T::one() - terms.a)),
        };
        let free = self.model.step_with(&mut state, voltage, terms);
        state.displacement = self.limits.clamp(free);
        if state.displacement != free {
            status |= Status::CLAMPED;
        }
        self.state = Some(state);
        let dac = self.table.dac.code(state.displacement);
        if dac.0 == 0 || dac.0 >= self.table.dac.full_scale {
            status |= Status::DAC_SATURATED;
        }
        Estimate { displacement: state.displacement, dac, status }
    }

    #[inline]
    fn terms(&self, voltage: T) -> Terms<T> {
        match self.lookup {
            Some(lookup) => lookup.terms(voltage),
            None => self.model.terms(voltage),
        }
    }

    fn state_at(&self, displacement: T) -> State<T> {
        State::new(self.limits.clamp(displacement), T::of(self.table.deadband_v))
    }
}
