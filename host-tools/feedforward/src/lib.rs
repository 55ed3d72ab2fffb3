//! Feedforward: a wanted trajectory through a model's inverse, tick by tick, and back through the whole model.
//!
//! The inverse gives at tick k the voltage whose displacement comes at tick k + 1, later by the model's delay. Here the
//! trajectory is known ahead of time, so that the inverse is asked for what is wanted then.

mod approach;

pub use approach::approach;

use estimator_core::{Admitted, DriveLimits, Estimator, Inverse, NoInverse, Range};
use recordings::log::Log;
use serde::Serialize;

/// Where the displacement is wanted, µm relative to the model's zero, a value a tick.
#[derive(Clone, PartialEq, Debug)]
pub struct Trajectory(pub Vec<f64>);

impl Trajectory {
    /// A log's displacement at the ticks, straight between its samples.
    pub fn of(log: &Log, tick_s: f64) -> Self {
        let wanted = log.displacement.as_deref().unwrap_or_default();
        let seconds = wanted.len().saturating_sub(1) as f64 * log.sample_period;
        // A whole number of ticks may come out a rounding short.
        let ticks = (seconds / tick_s + 1e-6).floor() as usize;
        Self((0..=ticks).map(|tick| between(wanted, tick as f64 * tick_s / log.sample_period)).collect())
    }

    /// At a time in ticks; the ends hold before and after.
    pub fn at(&self, ticks: f64) -> f64 {
        between(&self.0, ticks)
    }
}

/// A series between its values; 0 where there are none.
fn between(series: &[f64], at: f64) -> f64 {
    let last = series.len().saturating_sub(1);
    let whole = (at.max(0.0).floor() as usize).min(last);
    let value = |index: usize| series.get(index.min(last)).copied().unwrap_or(0.0);
    let part = (at.max(0.0) - whole as f64).min(1.0);
    value(whole) + part * (value(whole + 1) - value(whole))
}

/// What the amplifier is to do, and what the model makes of it; a value a tick each.
#[derive(Clone, PartialEq, Debug)]
pub struct Plan {
    /// Amplifier voltage, V.
    pub voltage: Vec<f64>,
    /// Displacement at the tick, µm relative to the model's zero, by the whole model.
    pub displacement: Vec<f64>,
    /// What was wanted at the tick, µm.
    pub wanted: Vec<f64>,
    /// Ticks on which a limit was in the way.
    pub out_of_reach: usize,
    /// Whether one was, a value a tick.
    pub limited: Vec<bool>,
    /// Amplifier voltage before, V.
    pub rest: f64,
}

/// How well the model of the inverse meets the trajectory.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct RoundTrip {
    /// Mean absolute error, µm.
    pub mae_um: f64,
    /// Largest absolute error, µm.
    pub max_um: f64,
    /// Largest width of the trajectory, µm.
    pub stroke_um: f64,
}

/// How far a limit keeps the displacement from the trajectory.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Shortfall {
    /// The first tick on which it is not there.
    pub tick: usize,
    /// The largest distance from there on, µm.
    pub most_um: f64,
}

/// A voltage that leaves a range.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Beyond {
    /// On so many ticks.
    pub ticks: usize,
    /// The first of them.
    pub from_tick: usize,
    /// How far at most, V.
    pub most_v: f64,
}

/// What a voltage may be beyond a range's end by rounding, of the range.
const ROUNDING: f64 = 1e-4;

/// Displacements (µm) long at rest at the lowest and the highest voltage: what can be held.
pub fn reach(table: &Admitted, limits: &DriveLimits) -> [f64; 2] {
    [limits.range_v.min, limits.range_v.max].map(|voltage| {
        let mut model = Estimator::<f64>::new(table);
        model.tick_volts(voltage.into()).displacement
    })
}

/// How near to what is wanted (µm) counts as there, once.
pub fn near(table: &Admitted) -> f64 {
    1e-3 * f64::from(table.displacement_limits_um.span())
}

/// Plans a trajectory from rest at the limits' rest voltage.
pub fn plan(table: &Admitted, limits: &DriveLimits, trajectory: &Trajectory) -> Result<Plan, NoInverse> {
    let mut inverse: Inverse<f64> = table.inverse(limits)?;
    let mut model = Estimator::<f64>::new(table).of_held_voltage();
    let ahead = 1.0 + f64::from(table.parameters.delay_ticks());
    let mut now = model.tick_volts(limits.rest_v.into()).displacement;
    let count = trajectory.0.len();
    let series = || Vec::with_capacity(count);
    let mut plan = Plan {
        voltage: series(),
        displacement: series(),
        wanted: trajectory.0.clone(),
        out_of_reach: 0,
        limited: Vec::with_capacity(count),
        rest: limits.rest_v.into(),
    };
    for tick in 0..count {
        let commanded = inverse.tick(trajectory.at(tick as f64 + ahead));
        plan.out_of_reach += usize::from(!commanded.reached);
        plan.limited.push(!commanded.reached);
        plan.voltage.push(commanded.voltage);
        plan.displacement.push(now);
        now = model.tick_volts(commanded.voltage).displacement;
    }
    Ok(plan)
}

impl Plan {
    /// How far and when the voltage leaves a range, V; `None` where it does not.
    pub fn beyond(&self, range: Range) -> Option<Beyond> {
        let (min, max) = (f64::from(range.min), f64::from(range.max));
        let over: Vec<f64> = self.voltage.iter().map(|volts| (min - volts).max(volts - max)).collect();
        let outside = |over: &f64| *over > ROUNDING * (max - min);
        let from_tick = over.iter().position(outside)?;
        let ticks = over.iter().filter(|over| outside(over)).count();
        Some(Beyond { ticks, from_tick, most_v: over.into_iter().fold(0.0, f64::max) })
    }

    /// The errors from a tick on; `None` where there is none.
    pub fn round_trip(&self, from: usize) -> Option<RoundTrip> {
        let count = self.wanted.len().checked_sub(from).filter(|&count| count > 0)?;
        let hull = |better: fn(f64, f64) -> f64| self.wanted.iter().copied().reduce(better).unwrap_or(0.0);
        Some(RoundTrip {
            mae_um: self.errors(from).sum::<f64>() / count as f64,
            max_um: self.errors(from).fold(0.0, f64::max),
            stroke_um: hull(f64::max) - hull(f64::min),
        })
    }

    /// Fastest change of the voltage, from its rest on, V a tick.
    pub fn fastest(&self) -> f64 {
        let from = std::iter::once(&self.rest).chain(&self.voltage);
        from.zip(&self.voltage).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max)
    }

    /// The first tick from one on, on which the displacement is within `near` µm of what is wanted.
    pub fn met(&self, from: usize, near: f64) -> Option<usize> {
        let there = self.errors(from).position(|error| error < near);
        there.map(|after| from + after)
    }

    /// How far the displacement stays from what is wanted, where that is `near` µm or more after a limit was in the way
    /// at a tick from one on.
    pub fn shortfall(&self, from: usize, near: f64) -> Option<Shortfall> {
        let limited = from + self.limited.iter().skip(from).position(|&limited| limited)?;
        let tick = limited + self.errors(limited).position(|error| error >= near)?;
        Some(Shortfall { tick, most_um: self.errors(tick).fold(0.0, f64::max) })
    }

    /// The largest distance from what is wanted on some ticks, µm.
    pub fn off(&self, ticks: std::ops::Range<usize>) -> f64 {
        self.errors(ticks.start).take(ticks.len()).fold(0.0, f64::max)
    }

    /// What the displacement is off from a tick on, µm.
    fn errors(&self, from: usize) -> impl Iterator<Item = f64> {
        self.displacement.iter().zip(&self.wanted).skip(from).map(|(y, r)| (y - r).abs())
    }
}
