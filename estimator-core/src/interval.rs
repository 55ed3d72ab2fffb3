//! How far the estimate may be off: a 95 % prediction interval of the displacement, relative to where it was last told.
//!
//! ```text
//! w = |m(S) − m(S₀)| + √( misfit² + (rate·r)² + d² + (gain·(y − y₀))² + (drift·A)² )       half-width, µm
//! d = min( |Lᵀ(p − p₀)|, n(p) + n(p₀) ),   n(p) = min_k |Lᵀp − c_k|
//! ```
//!
//! | | |
//! |---|---|
//! | S, S₀ | span of the voltage since the start, now and when the displacement was told, V |
//! | m(S) | half of what two starts can still differ by after that span: memory of the start, which a swing wipes out |
//! | r | fastest change of the estimate in a tick, forgotten in 5 ms, µm: what lag and ringing make of a small delay |
//! | p, p₀ | six plays of the voltage, now and when the displacement was told |
//! | c_k | prototypes (centres of a k-means) of where those of the training stood: n is how far plays stand from all that was learnt, and d the way from p₀ to p of which every part that the training has been at costs nothing |
//! | y, y₀ | the estimate, now and when the displacement was told: sensitivity differs from day to day |
//! | A | decades of time since the start that have gone by since the displacement was told: creep and drift |
//!
//! The numbers come from simulated devices that were driven by the training's own voltages and learnt as the actuator was
//! (`piezo identify`). 95 % holds over time, averaged over recordings and devices like those; it says nothing of the
//! absolute displacement, of load, or of temperature beyond drift, and there is none before the displacement was told.

use crate::math::Real;
use crate::model::play;
use crate::range::Range;
use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// Plays that tell where the voltage has been.
pub const PLAYS: usize = 6;
/// Their half-widths, of half the table's voltage range.
pub const HALF_WIDTHS: [f32; PLAYS] = [0.04, 0.075, 0.14, 0.26, 0.48, 0.9];
/// Spans at which the memory of the start is given: eighths of the table's voltage range, from 0 to all of it.
pub const SPANS: usize = 9;
/// Prototypes of where the training's plays stood.
pub const PROTOTYPES: usize = 24;
/// None of a table's numbers may be larger: their squares are then numbers of an `f32`, too, whatever the voltage does.
pub const LARGEST: f32 = 1e6;
/// Numbers of a lower triangle of that many rows.
pub const TRIANGLE: usize = PLAYS * (PLAYS + 1) / 2;

/// The fastest change is forgotten in this time, s.
const FORGOTTEN_S: f32 = 5e-3;
/// The age counts from this long before the start, s: creep begins somewhere.
const BEGINNING_S: f32 = 0.05;
/// The age is stepped on when the time since then has grown by this factor, and by its decimal logarithm.
const STEP: f32 = 65.0 / 64.0;
const STEP_DECADES: f32 = 0.006_733_383;

/// What a table says of its interval.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntervalParameters {
    /// m, µm: half of the most that two starts can still differ by once the voltage has swept so many eighths of its range.
    pub memory_um: [f32; SPANS],
    /// Half-width where nothing else counts, µm.
    pub misfit_um: f32,
    /// Ticks of the estimate's fastest change that the half-width has.
    pub rate_ticks: f32,
    /// L, µm for plays in half voltage ranges, row by row of its lower triangle.
    pub spread_um: [f32; TRIANGLE],
    /// c_k: Lᵀp of the training, in units of `prototype_um`.
    pub prototypes: [[i8; PLAYS]; PROTOTYPES],
    /// The unit of the prototypes, µm.
    pub prototype_um: f32,
    /// n beyond which [`Status::UNTRAINED`](crate::Status::UNTRAINED) is raised, µm.
    pub untrained_um: f32,
    /// Half-width for each µm that the estimate has gone since the displacement was told.
    pub gain: f32,
    /// Half-width for each decade of time since the start, µm.
    pub drift_um: f32,
    /// Least time from the start to where a displacement may be told, s: earlier, an actuator that moves is still on its way.
    pub earliest_s: f32,
}

impl IntervalParameters {
    /// Whether every number is finite, none is negative that may not be, and none is beyond [`LARGEST`].
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check(&self) -> Result<(), Rule> {
        let positive = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite() && *number >= 0.0);
        let finite = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite());
        let small = |numbers: &[f32]| numbers.iter().all(|number| number.abs() <= LARGEST);
        let Self { misfit_um, rate_ticks, prototype_um, untrained_um, gain, drift_um, earliest_s, .. } = *self;
        rule::check([
            ("interval.memory_um must be 0 or positive", positive(&self.memory_um)),
            ("interval.misfit_um must be positive", positive(&[self.misfit_um]) && self.misfit_um > 0.0),
            ("interval.rate_ticks must be 0 or positive", positive(&[self.rate_ticks])),
            ("interval.spread_um must be finite", finite(&self.spread_um)),
            ("interval.prototype_um must be 0 or positive", positive(&[self.prototype_um])),
            ("interval.untrained_um must be 0 or positive", positive(&[self.untrained_um])),
            ("interval.gain must be 0 or positive", positive(&[self.gain])),
            ("interval.drift_um must be 0 or positive", positive(&[self.drift_um])),
            ("interval.earliest_s must be 0 or positive", positive(&[self.earliest_s])),
            ("interval: no number may lie beyond a million", {
                small(&self.memory_um)
                    && small(&self.spread_um)
                    && small(&[misfit_um, rate_ticks, prototype_um, untrained_um, gain, drift_um, earliest_s])
            }),
        ])
    }
}

/// Where the plays stand, as the interval sees it: Lᵀp, µm.
pub type Place<T> = [T; PLAYS];

/// The per-tick coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interval<T> {
    voltages: Range<T>,
    memory: [T; SPANS],
    misfit: T,
    rate: T,
    spread: [T; TRIANGLE],
    prototypes: [Place<T>; PROTOTYPES],
    untrained: T,
    gain: T,
    drift: T,
    /// What a tick leaves of the fastest change.
    keep: T,
    /// Ticks that lie before the start.
    before: T,
    earliest: T,
}

/// What it remembers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct IntervalState<T> {
    plays: [T; PLAYS],
    swept: Range<T>,
    displacement: T,
    fastest: T,
    ticks: u32,
    /// Ticks since the beginning at which the age is stepped on.
    next: T,
    place: Place<T>,
    /// n of that place, µm.
    off: T,
    told: Option<Told<T>>,
}

/// When the displacement was told, and since.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Told<T> {
    memory: T,
    place: Place<T>,
    off: T,
    displacement: T,
    decades: T,
}

/// What a half-width is made of, µm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Parts<T> {
    /// Memory of the start.
    pub memory: T,
    /// What is there always, on voltages as the training had them.
    pub misfit: T,
    /// Fastest change of the estimate in the last 5 ms.
    pub rate: T,
    /// Plays that stand elsewhere than when the displacement was told, and as they never stood in the training.
    pub moved: T,
    /// Displacement since it was told.
    pub gain: T,
    /// Time since the displacement was told.
    pub drift: T,
}

impl<T: Real> Parts<T> {
    /// The half-width, µm.
    #[inline]
    pub fn half(&self) -> T {
        let square = |part: T| part * part;
        let always = square(self.misfit) + square(self.rate);
        self.memory + (always + square(self.moved) + square(self.gain) + square(self.drift)).sqrt()
    }
}

/// What a tick gives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Width<T> {
    /// Half the interval's width, µm; `None` where no displacement was told.
    pub half: Option<T>,
    /// The plays stand where the training has not been.
    pub untrained: bool,
}

impl<T: Real> Interval<T> {
    /// The coefficients for a table's voltages (V, relative to the model's zero) and ticks of `sample_period` seconds.
    pub fn build(parameters: &IntervalParameters, voltages: Range<T>, sample_period: T) -> Self {
        let p = parameters;
        Self {
            voltages,
            memory: p.memory_um.map(T::of),
            misfit: T::of(p.misfit_um),
            rate: T::of(p.rate_ticks),
            spread: p.spread_um.map(T::of),
            prototypes: p.prototypes.map(|place| place.map(|at| T::of(p.prototype_um * f32::from(at)))),
            untrained: T::of(p.untrained_um),
            gain: T::of(p.gain),
            drift: T::of(p.drift_um),
            keep: (-sample_period / T::of(FORGOTTEN_S)).exp(),
            before: T::of(BEGINNING_S) / sample_period,
            earliest: T::of(p.earliest_s) / sample_period,
        }
    }

    /// The start, at a voltage (V), where the estimate is this displacement (µm).
    pub fn begin(&self, voltage: T, displacement: T) -> IntervalState<T> {
        let plays = HALF_WIDTHS.map(|part| play(self.voltages.middle(), voltage, self.half_width(part)));
        let place = self.place(&plays);
        IntervalState {
            plays,
            swept: Range::point(voltage),
            displacement,
            fastest: T::zero(),
            ticks: 0,
            next: self.before * T::of(STEP),
            off: self.off(&place),
            place,
            told: None,
        }
    }

    /// One tick: takes the voltage (V) and the estimate (µm).
    #[inline]
    pub fn step(&self, state: &mut IntervalState<T>, voltage: T, displacement: T) -> Width<T> {
        state.swept = state.swept.include(voltage);
        for (at, part) in state.plays.iter_mut().zip(HALF_WIDTHS) {
            *at = play(*at, voltage, self.half_width(part));
        }
        let change = (displacement - state.displacement).abs();
        let before = self.keep * state.fastest;
        state.displacement = displacement;
        state.fastest = if change > before { change } else { before };
        self.age(state);
        state.place = self.place(&state.plays);
        state.off = self.off(&state.place);
        Width { half: self.parts(state).map(|parts| parts.half()), untrained: state.off > self.untrained }
    }

    /// The displacement is told: from now on the interval is relative to this tick. Returns whether it is late enough for
    /// that; if not, nothing changes.
    pub fn tell(&self, state: &mut IntervalState<T>) -> bool {
        let told = self.may_be_told(state);
        if told {
            self.tell_at_rest(state);
        }
        told
    }

    /// Whether it is late enough after the start for a displacement to be told.
    pub fn may_be_told(&self, state: &IntervalState<T>) -> bool {
        T::of(state.ticks as f32) >= self.earliest
    }

    /// As [`tell`](Self::tell), of an actuator that is known to rest, however early.
    pub fn tell_at_rest(&self, state: &mut IntervalState<T>) {
        let memory = self.remembered(state.swept.span());
        let IntervalState { place, off, displacement, .. } = *state;
        state.told = Some(Told { memory, place, off, displacement, decades: T::zero() });
    }

    /// What the half-width of the last tick is made of; `None` where no displacement was told.
    #[inline]
    pub fn parts(&self, state: &IntervalState<T>) -> Option<Parts<T>> {
        state.told.as_ref().map(|told| Parts {
            memory: (self.remembered(state.swept.span()) - told.memory).abs(),
            misfit: self.misfit,
            rate: self.rate * state.fastest,
            moved: least(square_distance(&state.place, &told.place).sqrt(), state.off + told.off),
            gain: self.gain * (state.displacement - told.displacement).abs(),
            drift: self.drift * told.decades,
        })
    }

    fn age(&self, state: &mut IntervalState<T>) {
        state.ticks = state.ticks.saturating_add(1);
        if self.before + T::of(state.ticks as f32) >= state.next {
            state.next = state.next * T::of(STEP);
            if let Some(told) = &mut state.told {
                told.decades = told.decades + T::of(STEP_DECADES);
            }
        }
    }

    fn half_width(&self, part: f32) -> T {
        T::of(0.5 * part) * self.voltages.span()
    }

    /// n of a place, µm.
    #[inline]
    fn off(&self, place: &Place<T>) -> T {
        let [first, rest @ ..] = &self.prototypes;
        let nearest = square_distance(place, first);
        rest.iter().fold(nearest, |nearest, prototype| least(nearest, square_distance(place, prototype))).sqrt()
    }

    /// m of a span, straight between the spans at which it is given.
    fn remembered(&self, span: T) -> T {
        let at = span / self.voltages.span() * T::of((SPANS - 1) as f32);
        let whole = (at.to_u32_saturating() as usize).min(SPANS - 2);
        match self.memory.get(whole..) {
            Some([low, high, ..]) => {
                let part = at - T::of(whole as f32);
                *low + (*high - *low) * if part < T::one() { part } else { T::one() }
            }
            _ => T::zero(),
        }
    }

    /// Lᵀp of plays in V.
    #[inline]
    fn place(&self, plays: &[T; PLAYS]) -> Place<T> {
        let (middle, unit) = (self.voltages.middle(), T::of(2.0) / self.voltages.span());
        let mut place = [T::zero(); PLAYS];
        let mut rest = self.spread.iter();
        for (row, at) in plays.iter().enumerate() {
            let at = (*at - middle) * unit;
            for (sum, factor) in place.iter_mut().take(row + 1).zip(&mut rest) {
                *sum = *sum + *factor * at;
            }
        }
        place
    }
}

#[inline]
fn least<T: Real>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// Square of the distance of two places, µm².
#[inline]
fn square_distance<T: Real>(a: &Place<T>, b: &Place<T>) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + (*a - *b) * (*a - *b))
}
