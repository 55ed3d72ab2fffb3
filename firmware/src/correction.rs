//! Codes as they would be at the supply that everything is made for, whatever it is ([`crate::supply`]), so that every
//! calibration holds as at that.
//!
//! The monitor comes through a divider that adds a part of the supply, so that both signs of a voltage fit. That part's
//! code is the same at every supply; what the voltage adds to it goes down as the supply goes up. So the distance from
//! the code of 0 V is what is scaled. The table knows that code. Of a set-point it knows the code of the displacement
//! 0, which is where a controller has its 0 V. Of a sensor it knows nothing: its 0 V is where the wiring for one of 0 V
//! and more puts it.
//!
//! What the DAC is given is scaled whole and the other way round: its pin has the voltage that its code would give.

use crate::ramp::Stride;
use crate::shaping::DacParts;
use crate::supply::Supply;
use crate::{Conversion, Facts};
use core::sync::atomic::{AtomicI32, AtomicU16, Ordering::Relaxed};
use estimator_core::{AdcCode, Admitted, DacCode};

/// Furthest that the code of 0 V is taken to be from the range, in ranges: far enough for any divider, and a code's
/// distance times what is off still fits 32 bits.
const BEYOND: f32 = 3.0;
/// The part of the range at which a sensor's 0 V are read: 0.15 V of 3.3 V. One of both signs has it at a half.
const SENSOR_ZERO: f32 = 0.15 / 3.3;

/// What the converters gave, and what they would have given were the supply not off.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Read {
    /// The codes as they are.
    pub conversion: Conversion,
    /// The codes at the supply that everything is made for.
    pub corrected: Conversion,
}

/// Of codes that no converter gave: they are what they are.
impl From<Conversion> for Read {
    fn from(conversion: Conversion) -> Self {
        Self { conversion, corrected: conversion }
    }
}

/// A code plus a part of its distance from one that stays, in 65,536ths.
#[inline]
fn scaled(code: u16, stays: i32, part: i32) -> i32 {
    let code = i32::from(code);
    code + (((code - stays) * part + (1 << 15)) >> 16)
}

/// The code; the range's end, where it is beyond.
#[inline]
fn within(code: i32, full_scale: u16) -> u16 {
    // Between 0 and a code.
    code.clamp(0, full_scale.into()) as u16
}

/// A step towards what a supply is off by: a 65,536th. By it a code moves by no more than one, if the code of 0 V is
/// within the converter's range, and by up to four, if that lies as far beyond it as is admitted.
#[inline]
fn towards(now: i32, off: i32) -> i32 {
    now + (off - now).signum()
}

/// What the ADC reads, as it would read it at the supply it is made for.
#[derive(Clone, Debug)]
pub struct Correction {
    full_scale: u16,
    /// The codes of 0 V, which may lie beyond the range. Where no table says which they are, codes stay as they are.
    monitor: Option<i32>,
    sensor: i32,
    setpoint: Option<i32>,
    /// How far off the supply is taken to be, in 65,536ths; `None` before the first tick of an estimate.
    off: Option<i32>,
}

impl Correction {
    /// For codes of an ADC with this largest one, and of this table.
    pub fn new(adc_full_scale: u16, table: Option<&Admitted>) -> Self {
        let range = f32::from(adc_full_scale);
        let code = |zero: f32| zero.clamp(-BEYOND * range, (1.0 + BEYOND) * range) as i32;
        let monitor = table.map(|table| {
            let adc = &table.adc;
            code(-adc.offset_v / if adc.invert { -adc.gain_v_per_code } else { adc.gain_v_per_code })
        });
        let setpoint = table.and_then(|table| table.drive?.setpoint);
        let setpoint = setpoint.map(|setpoint| code(-setpoint.offset_um / setpoint.gain_um_per_code));
        let sensor = code(SENSOR_ZERO * range);
        Self { full_scale: adc_full_scale, monitor, sensor, setpoint, off: None }
    }

    /// The estimate begins anew: the next tick may scale as it likes.
    pub fn restart(&mut self) {
        self.off = None;
    }

    /// One tick: goes towards what the supply is off by (65,536ths), and corrects the codes.
    #[inline]
    pub fn tick(&mut self, off: i32, conversion: Conversion) -> Read {
        let off = self.off.map_or(off, |before| towards(before, off));
        self.off = Some(off);
        let at = |zero: i32, AdcCode(code): AdcCode| AdcCode(within(scaled(code, zero, off), self.full_scale));
        let Conversion { monitor, sensor, setpoint } = conversion;
        let corrected = Conversion {
            monitor: self.monitor.map_or(monitor, |zero| at(zero, monitor)),
            sensor: sensor.map(|code| at(self.sensor, code)),
            setpoint: setpoint.map(|code| self.setpoint.map_or(code, |zero| at(zero, code))),
        };
        Read { conversion, corrected }
    }
}

/// What the DAC is given for its codes. The tick is the only writer, but for the boot, before the first one.
#[derive(Debug)]
pub struct Given {
    /// The most that it is given, in parts of a code.
    full_scale: AtomicU16,
    /// Parts of a code.
    parts: AtomicU16,
    /// How far the supply is taken to be short, in 65,536ths of itself.
    short: AtomicI32,
}

impl Default for Given {
    fn default() -> Self {
        Self::new()
    }
}

impl Given {
    /// Codes are given as they are, up to any.
    pub const fn new() -> Self {
        Self { full_scale: AtomicU16::new(u16::MAX), parts: AtomicU16::new(1), short: AtomicI32::new(0) }
    }

    /// Of a board's DAC, at a supply that has just been measured for the first time; before the first tick.
    pub(crate) fn begin(&self, facts: &Facts, supply: &Supply) {
        self.parts.store(facts.dac_parts, Relaxed);
        self.full_scale.store(facts.interface.dac_full_scale.saturating_mul(facts.dac_parts), Relaxed);
        self.short.store(supply.short(), Relaxed);
    }

    /// One tick: steps the correction towards the supply, and returns what the DAC is given so that its pin has what
    /// these parts are at the nominal supply, and whether the supply is too low for that.
    #[inline]
    pub(crate) fn tick(&self, supply: &Supply, DacParts(parts): DacParts) -> (DacParts, bool) {
        let (short, full_scale) = (towards(self.short.load(Relaxed), supply.short()), self.full_scale.load(Relaxed));
        self.short.store(short, Relaxed);
        let given = scaled(parts, 0, short);
        (DacParts(within(given, full_scale)), given > full_scale.into())
    }

    /// What the DAC is given for a code at the last tick: what its pin then has is what the code stands for.
    pub fn of(&self, DacCode(code): DacCode) -> DacParts {
        let parts = code.saturating_mul(self.parts.load(Relaxed));
        DacParts(within(scaled(parts, 0, self.short.load(Relaxed)), self.full_scale.load(Relaxed)))
    }

    /// How fast that may change, in parts of a code, where codes may change so fast.
    #[inline]
    pub(crate) fn stride(&self, codes: Stride) -> Stride {
        let parts = codes.get().saturating_mul(self.parts.load(Relaxed).into());
        // Positive: no supply is off by as much as itself.
        let supply = (65_536 + self.short.load(Relaxed)) as u32;
        let given = (u64::from(parts) * u64::from(supply)) >> 16;
        Stride::new(u32::try_from(given).unwrap_or(u32::MAX))
    }
}
