//! How far the estimate may be off: a 95 % prediction interval of the displacement, relative to where it was last told.
//!
//! ```text
//! w = √( misfit² + (b·(m(S) − m(S₀)))² + (rate·r)² + d² + (gain·(y − y₀))² + (drift·A)² )       half-width, µm
//! b = e + (1 − e)·4·(V_b − V_min)·(V_max − V_b)/(V_max − V_min)²
//! d = min( |Lᵀ(p − p₀)|, n(p) + n(p₀) ),   n(p) = min_k |Lᵀp − c_k|
//! ```
//!
//! | | |
//! |---|---|
//! | S, S₀ | span of the voltage since the start, or since it was last beyond the range, now and when the displacement was told, V |
//! | m(S) | what the memory of a start in the middle of the range may still be off by after that span: a swing wipes it out |
//! | b | how much of that a start at V_b leaves open: e at an end of the range V_min … V_max, which is come to from one side only unless it was driven beyond it; 1 where it was, since that counts as a start |
//! | r | fastest change of the estimate in a tick, forgotten in 5 ms, µm: what lag and ringing make of a small delay |
//! | p, p₀ | six plays of the voltage, now and when the displacement was told |
//! | c_k | prototypes (centres of a k-means) of where those of the training stood: n is how far plays stand from all that was learnt, and d the way from p₀ to p of which every part that the training has been at costs nothing |
//! | y, y₀ | the estimate, now and when the displacement was told: sensitivity differs from day to day |
//! | A | decades of time since the start that have gone by since the displacement was told: creep and drift |
//!
//! No estimate and no actuator is taken to be beyond the table's limits, so the estimator gives at most their span.
//! The numbers come from simulated devices that were driven by the training's own voltages and learnt as the
//! actuator was, and from what was held out of the training (`piezo identify`). 95 % holds over time, averaged over
//! recordings and devices like those; it says nothing of the absolute displacement, of load, or of temperature beyond
//! drift, and there is none before the displacement was told.

mod age;
mod parameters;

pub use parameters::{IntervalParameters, LARGEST, PLAYS, PROTOTYPES, SPANS, TRIANGLE};

use age::{Age, BEGINNING_S};

use crate::math::Real;
use crate::model::play;
use crate::range::Range;

/// Half-widths of the plays, of half the table's voltage range.
pub const HALF_WIDTHS: [f32; PLAYS] = [0.04, 0.075, 0.14, 0.26, 0.48, 0.9];

/// The fastest change is forgotten in this time, s.
const FORGOTTEN_S: f32 = 5e-3;

/// Where the plays stand, as the interval sees it: Lᵀp, µm.
pub type Place<T> = [T; PLAYS];

/// Coefficients of w and its parts, built from [`IntervalParameters`] for one tick and one range of voltages.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interval<T> {
    voltages: Range<T>,
    memory: [T; SPANS],
    at_ends: T,
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
    /// Ticks after it from which on a displacement may be told.
    earliest: u32,
}

/// Plays, swept span, age and where the displacement was told: all that w depends on beside its coefficients.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct IntervalState<T> {
    plays: [T; PLAYS],
    swept: Range<T>,
    /// b of the start's voltage.
    open: T,
    displacement: T,
    fastest: T,
    age: Age<T>,
    place: Place<T>,
    /// n of that place, µm.
    off: T,
    told: Option<Told<T>>,
}

/// When the displacement was told, and since.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Told<T> {
    /// m(S₀), of the span that the voltage had gone over until then, µm.
    memory: T,
    /// b·m(S₀) of starts that count no more, since the voltage was beyond the range after them, µm.
    kept: T,
    place: Place<T>,
    off: T,
    displacement: T,
    decades: T,
}

/// What a half-width is made of, µm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Parts<T> {
    /// `b·(m(S) − m(S₀))`: what swings since the telling have wiped out of the start's unknown memory.
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
    /// w, µm: the root of the sum of the parts' squares.
    #[inline]
    pub fn half(&self) -> T {
        let square = |part: T| part * part;
        let always = square(self.misfit) + square(self.memory) + square(self.rate);
        (always + square(self.moved) + square(self.gain) + square(self.drift)).sqrt()
    }
}

/// w of one tick, and whether the training has been where the voltage is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Width<T> {
    /// Half the interval's width, µm; `None` where no displacement was told.
    pub half: Option<T>,
    /// The plays stand where the training has not been.
    pub untrained: bool,
}

impl<T: Real> IntervalState<T> {
    /// The actuator was driven beyond a voltage (V) while the model was not: what it remembers is as open as after a
    /// start in the middle of the range, until swings have wiped that out.
    pub fn mislead(&mut self, voltage: T) {
        if let Some(told) = &mut self.told {
            // What was told was off by this, and stays so when nothing of the start is left.
            told.kept = told.kept + self.open * told.memory;
            told.memory = T::zero();
        }
        self.swept = Range::point(voltage);
        self.open = T::one();
    }
}

impl<T: Real> Interval<T> {
    /// The coefficients for a table's voltages (V, relative to the model's zero) and ticks of `sample_period` seconds.
    pub fn build(parameters: &IntervalParameters, voltages: Range<T>, sample_period: T) -> Self {
        let p = parameters;
        Self {
            voltages,
            memory: p.memory_um.map(T::of),
            at_ends: T::of(p.memory_at_ends),
            misfit: T::of(p.misfit_um),
            rate: T::of(p.rate_ticks),
            spread: p.spread_um.map(T::of),
            prototypes: p.prototypes.map(|place| place.map(|at| T::of(p.prototype_um * f32::from(at)))),
            untrained: T::of(p.untrained_um),
            gain: T::of(p.gain),
            drift: T::of(p.drift_um),
            keep: (-sample_period / T::of(FORGOTTEN_S)).exp(),
            before: T::of(BEGINNING_S) / sample_period,
            // To the nearest tick.
            earliest: (T::of(p.earliest_s) / sample_period + T::of(0.5)).to_u32_saturating(),
        }
    }

    /// The start, at a voltage (V), where the estimate is this displacement (µm).
    pub fn begin(&self, voltage: T, displacement: T) -> IntervalState<T> {
        let plays = HALF_WIDTHS.map(|part| play(self.voltages.middle(), voltage, self.half_width(part)));
        let place = self.place(&plays);
        IntervalState {
            plays,
            swept: Range::point(voltage),
            open: self.open(voltage),
            displacement,
            fastest: T::zero(),
            age: Age::start(self.before),
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
        if let Some(decades) = state.age.tick()
            && let Some(told) = &mut state.told
        {
            told.decades = told.decades + decades;
        }
        state.place = self.place(&state.plays);
        state.off = self.off(&state.place);
        Width { half: self.parts(state).map(|parts| parts.half()), untrained: state.off > self.untrained }
    }

    /// The displacement is told: from now on the interval is relative to this tick. Returns whether it is late enough
    /// for that; if not, nothing changes.
    pub fn tell(&self, state: &mut IntervalState<T>) -> bool {
        let told = self.may_be_told(state);
        if told {
            self.tell_at_rest(state);
        }
        told
    }

    /// Whether it is late enough after the start for a displacement to be told.
    pub fn may_be_told(&self, state: &IntervalState<T>) -> bool {
        state.age.reaches(self.earliest)
    }

    /// As [`tell`](Self::tell), of an actuator that is known to rest, however early.
    pub fn tell_at_rest(&self, state: &mut IntervalState<T>) {
        let memory = self.remembered(state.swept.span());
        let IntervalState { place, off, displacement, .. } = *state;
        state.told = Some(Told { memory, kept: T::zero(), place, off, displacement, decades: T::zero() });
    }

    /// What the half-width of the last tick is made of; `None` where no displacement was told.
    #[inline]
    pub fn parts(&self, state: &IntervalState<T>) -> Option<Parts<T>> {
        state.told.as_ref().map(|told| Parts {
            memory: told.kept + state.open * (self.remembered(state.swept.span()) - told.memory).abs(),
            misfit: self.misfit,
            rate: self.rate * state.fastest,
            moved: least(square_distance(&state.place, &told.place).sqrt(), state.off + told.off),
            gain: self.gain * (state.displacement - told.displacement).abs(),
            drift: self.drift * told.decades,
        })
    }

    /// b of a start at a voltage, 0 … 1.
    fn open(&self, voltage: T) -> T {
        let part = (voltage - self.voltages.min) / self.voltages.span();
        let between = T::of(4.0) * part * (T::one() - part);
        let between = if between > T::zero() { between } else { T::zero() };
        self.at_ends + (T::one() - self.at_ends) * between
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
