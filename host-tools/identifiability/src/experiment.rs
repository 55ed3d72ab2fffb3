//! Experiments with the actuator that a table describes, to say in a user's terms what is known of it.

use estimator_core::{Admitted, Estimator, Range};
use serde::Serialize;
use std::f64::consts::PI;

/// An experiment, from rest at the lower end of the training's voltages.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Experiment {
    /// A sine over the whole range at 1 Hz: how far the displacement goes.
    Stroke,
    /// A sine from the lower end: how far apart the two branches are at its middle voltage.
    Width {
        /// How far it goes, as a part of the range.
        part: f64,
        /// Its frequency, Hz.
        hz: f64,
    },
    /// Over the range and back, and a hold; then the whole range in a tenth of a second, and a hold: how far the
    /// displacement goes from 0.1 to 10 s after it.
    Creep,
}

/// Of the loops, Hz; of the ramp before a hold, until creep is counted, and until it no longer is, s.
const SLOW_HZ: f64 = 1.0;
const FAST_HZ: f64 = 10.0;
const RAMP_S: f64 = 0.1;
const FROM_S: f64 = 0.1;
const TO_S: f64 = 10.0;

impl Experiment {
    /// Every experiment, the stroke first.
    pub fn all() -> [Self; 6] {
        let width = |part, hz| Self::Width { part, hz };
        [Self::Stroke, width(1.0, SLOW_HZ), width(0.5, SLOW_HZ), width(0.25, SLOW_HZ), width(1.0, FAST_HZ), Self::Creep]
    }

    /// How far a loop's voltage goes (V) over a range of this span, and its period (s); `None` of what is not read
    /// off a loop.
    pub(crate) fn swing(self, span: f64) -> Option<(f64, f64)> {
        match self {
            Self::Width { part, hz } => Some((part * span, 1.0 / hz)),
            Self::Stroke | Self::Creep => None,
        }
    }

    /// How far the voltage of a loop that is smaller than the range goes, V.
    pub(crate) fn smaller(self, span: f64) -> Option<f64> {
        self.swing(span).map(|(swing_v, _)| swing_v).filter(|&swing_v| swing_v < span)
    }

    /// How fast a loop's voltage is at most, V/s, over a range of this span; 0 of what is not read off a loop.
    pub(crate) fn steepest(self, span: f64) -> f64 {
        self.swing(span).map_or(0.0, |(swing_v, period_s)| PI * swing_v / period_s)
    }

    /// From when to when after a move its voltage rests, s; `None` of one that does not.
    pub(crate) fn rest_s(self) -> Option<(f64, f64)> {
        (self == Self::Creep).then_some((FROM_S, TO_S))
    }

    /// What is read off it, µm, by a table, over voltages relative to the model's zero.
    pub(crate) fn run(self, table: &Admitted, voltages: Range<f64>) -> f64 {
        let mut actuator = Actuator::at_rest(table, voltages.min);
        match self {
            Self::Stroke => actuator.period(voltages, SLOW_HZ).0.span(),
            Self::Width { part, hz } => {
                let voltages = Range { max: voltages.min + part * voltages.span(), ..voltages };
                let (_, [up, down]) = actuator.period(voltages, hz);
                down - up
            }
            Self::Creep => {
                // What is not known of the start is wiped out, and what creeps since is over.
                actuator.period(voltages, SLOW_HZ);
                actuator.ramp(voltages.min, voltages.min, TO_S);
                actuator.ramp(voltages.min, voltages.max, RAMP_S);
                let there = actuator.ramp(voltages.max, voltages.max, FROM_S);
                actuator.ramp(voltages.max, voltages.max, TO_S - FROM_S) - there
            }
        }
    }
}

/// An actuator that is driven.
struct Actuator {
    estimator: Estimator<f64>,
    /// Displacement at the next tick, µm: what a tick returns is that of the one after it.
    next: f64,
    voltage_zero: f64,
    tick_s: f64,
}

impl Actuator {
    fn at_rest(table: &Admitted, voltage: f64) -> Self {
        let mut actuator = Self {
            estimator: Estimator::new(table),
            next: 0.0,
            voltage_zero: table.voltage_zero_v.into(),
            tick_s: table.sample_period(),
        };
        actuator.ramp(voltage, voltage, 0.0);
        actuator
    }

    /// Displacements in the second period of a sine from its lower end: all, and at the middle of the rise and of the
    /// fall. The first period wipes out the start.
    fn period(&mut self, voltages: Range<f64>, hz: f64) -> (Range<f64>, [f64; 2]) {
        let ticks = (0.5 / hz / self.tick_s).round().max(2.0) as u32;
        let mut half = |begin: f64| {
            let (mut passed, mut at_middle) = (Range::empty(), 0.0);
            for tick in 1..=ticks {
                let phase = PI * (begin + f64::from(tick) / f64::from(ticks));
                let displacement = self.tick(voltages.middle() - 0.5 * voltages.span() * phase.cos());
                passed = passed.include(displacement);
                if tick == ticks / 2 {
                    at_middle = displacement;
                }
            }
            (passed, at_middle)
        };
        half(0.0);
        half(1.0);
        let ((rise, up), (fall, down)) = (half(0.0), half(1.0));
        (rise.hull(fall), [up, down])
    }

    /// Goes from a voltage to another; returns the displacement at the last tick, µm. At least one tick.
    fn ramp(&mut self, from: f64, to: f64, duration_s: f64) -> f64 {
        let ticks = (duration_s / self.tick_s).round().max(1.0) as u32;
        let mut displacement = 0.0;
        for tick in 1..=ticks {
            displacement = self.tick(from + (to - from) * f64::from(tick) / f64::from(ticks));
        }
        displacement
    }

    /// Takes a tick's voltage, V; returns the displacement at the same tick, µm, as a log has them in one row.
    fn tick(&mut self, voltage: f64) -> f64 {
        let next = self.estimator.tick_volts(voltage + self.voltage_zero).displacement;
        std::mem::replace(&mut self.next, next)
    }
}
