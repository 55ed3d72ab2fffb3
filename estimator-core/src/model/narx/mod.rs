//! Polynomial NARX: a black box that goes on from its own last displacements, with or without the voltage and
//! displacement at the last reversal as further inputs (thesis Section 5.1.2, Table 5.1).
//!
//! ```text
//! v = (V − voltage_centre)/voltage_scale,  y likewise, v_ext and y_ext likewise         no unit
//! y(k+1) = Σ coefficient_j·monomial_j(k), clamped to the limits
//! ```
//!
//! **Monomials, in the order of the coefficients** (r_y output order, r_u input order; what is not asked for is left
//! out):
//!
//! 1. `y(k)` … `y(k−r_y+1)`, `v(k)` … `v(k−r_u+1)`, `v_ext`, `y_ext`;
//! 2. degree 2 and 3: `a·b` of the letters `v(k), y(k), v_ext, y_ext` in this order, b not before a:
//!    `v·v, v·y, v·v_ext, v·y_ext, y·y, …, y_ext·y_ext`;
//! 3. degree 3: `a·b·c` likewise, c fastest: `v·v·v, v·v·y, …, y_ext·y_ext·y_ext`;
//! 4. 1.
//!
//! No more than 3 + 3 + 2 + 10 + 20 + 1 = 39. `v_ext` and `y_ext` are the tracker's; before the first reversal they are
//! at the centres (0).
//!
//! **Bound.** The clamp, so that a run is bounded whatever the coefficients. A table must also have a stable linear
//! part, and be proven to contract (`contraction.rs`): what two runs of the same voltages differ by dies out; with
//! y_ext among the inputs it never grows, and shrinks where the voltage goes on to reverse.

mod contraction;
mod parameters;

pub use parameters::NarxParameters;

use super::recursion::solve_in_time;
use super::{Discretisation, Published, Recursion};
use crate::admissible::{Inadmissible, within};
use crate::extremum::{Tracker, between_codes};
use crate::list::List;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use parameters::{COEFFICIENTS, ORDER};

impl Published for NarxParameters {
    type Coefficients<T: Real> = Narx<T>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Narx<T> {
        Narx::build(self, discretisation.sample_period)
    }

    fn between_codes(self, step: f32) -> Self {
        Self { deadband_v: between_codes(self.deadband_v, step), ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        self.check_numbers()
    }
}

/// Per-tick coefficients of the NARX model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Narx<T> {
    output_order: usize,
    input_order: usize,
    degree: u8,
    with_voltage_extremum: bool,
    with_displacement_extremum: bool,
    voltage_centre: T,
    voltage_per: T,
    displacement_centre: T,
    displacement_scale: T,
    displacement_per: T,
    deadband: T,
    coefficients: List<COEFFICIENTS, T>,
    limits: Range<T>,
    normalised_limits: Range<T>,
}

/// Histories, newest first, in normalised units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NarxState<T> {
    voltages: [T; ORDER],
    displacements: [T; ORDER],
    tracker: Tracker<T>,
    /// The displacement at the next tick.
    next: T,
}

impl<T: Real> NarxState<T> {
    fn push(&mut self, voltage: T, displacement: T) {
        let ([v0, v1, _], [y0, y1, _]) = (self.voltages, self.displacements);
        self.voltages = [voltage, v0, v1];
        self.displacements = [displacement, y0, y1];
        self.tracker.update(voltage, displacement);
    }
}

impl<T: Real> Narx<T> {
    /// The model; its ticks are those of the log it was fitted to. Checks
    /// nothing: see [`Published::check`](crate::Published::check).
    pub fn build(parameters: &NarxParameters, _sample_period: T) -> Self {
        let p = parameters;
        let voltage_per = T::one() / T::of(p.voltage_scale_v);
        let displacement_per = T::one() / T::of(p.displacement_scale_um);
        let displacement_centre = T::of(p.displacement_centre_um);
        let limits = p.limits_um.of::<T>();
        Self {
            output_order: p.output_order.into(),
            input_order: p.input_order.into(),
            degree: p.degree,
            with_voltage_extremum: p.with_voltage_extremum,
            with_displacement_extremum: p.with_displacement_extremum,
            voltage_centre: T::of(p.voltage_centre_v),
            voltage_per,
            displacement_centre,
            displacement_scale: T::of(p.displacement_scale_um),
            displacement_per,
            deadband: T::of(p.deadband_v) * voltage_per,
            coefficients: p.coefficients.map(T::of),
            limits,
            normalised_limits: Range {
                min: (limits.min - displacement_centre) * displacement_per,
                max: (limits.max - displacement_centre) * displacement_per,
            },
        }
    }

    /// A displacement (µm) as the polynomial counts it: what a [`row`](Self::row) is to give.
    #[inline]
    pub fn normalise(&self, displacement: T) -> T {
        (displacement - self.displacement_centre) * self.displacement_per
    }

    /// Takes a measured voltage (V) and displacement (µm) of one tick, as one-step prediction does. The
    /// [`row`](Self::row) then belongs to the displacement of the next tick, the [`prediction`](Self::prediction) is of
    /// it.
    pub fn observe(&self, state: &mut NarxState<T>, voltage: T, displacement: T) {
        state.push((voltage - self.voltage_centre) * self.voltage_per, self.normalise(displacement));
        state.next = self.polynomial(state);
    }

    /// The displacement (µm) expected at the next tick.
    #[inline]
    pub fn prediction(&self, state: &NarxState<T>) -> T {
        // Once more, because the way back to µm rounds.
        self.limits.clamp(self.displacement_centre + self.displacement_scale * state.next)
    }

    /// Hands over the monomials, in the order of the coefficients.
    #[inline]
    pub fn row(&self, state: &NarxState<T>, mut each: impl FnMut(T)) {
        let extremum = state.tracker.last();
        let ([v, ..], [y, ..]) = (state.voltages, state.displacements);
        state.displacements.iter().take(self.output_order).for_each(|y| each(*y));
        state.voltages.iter().take(self.input_order).for_each(|v| each(*v));
        let mut letters = [v, y, T::zero(), T::zero()];
        let mut count = 2;
        let extrema =
            [(self.with_voltage_extremum, extremum.voltage), (self.with_displacement_extremum, extremum.displacement)];
        for (asked, value) in extrema {
            if asked && let Some(letter) = letters.get_mut(count) {
                *letter = value;
                count += 1;
                each(value);
            }
        }
        let letters = letters.get(..count).unwrap_or(&letters);
        let from = |start: usize| letters.iter().enumerate().skip(start);
        if self.degree >= 2 {
            from(0).for_each(|(i, a)| from(i).for_each(|(_, b)| each(*a * *b)));
        }
        if self.degree >= 3 {
            for (i, a) in from(0) {
                for (j, b) in from(i) {
                    let product = *a * *b;
                    from(j).for_each(|(_, c)| each(product * *c));
                }
            }
        }
        each(T::one());
    }

    fn polynomial(&self, state: &NarxState<T>) -> T {
        let mut coefficients = self.coefficients.iter();
        let mut sum = T::zero();
        self.row(state, |monomial| {
            if let Some(coefficient) = coefficients.next() {
                sum = sum + *coefficient * monomial;
            }
        });
        self.normalised_limits.clamp(sum)
    }

    fn rested(&self, voltage: T, displacement: T) -> NarxState<T> {
        NarxState {
            voltages: [voltage; ORDER],
            displacements: [displacement; ORDER],
            tracker: Tracker::new(self.deadband),
            next: displacement,
        }
    }

    /// What the displacement (µm) can be for voltages of this range (V); `None` without a bound.
    ///
    /// The limits of the clamp, whatever the voltages.
    pub fn reach(&self, _voltage: Range<T>) -> Option<Range<T>> {
        (self.limits.min <= self.limits.max).then_some(self.limits)
    }
}

impl<T: Real> Recursion<T> for Narx<T> {
    type State = NarxState<T>;

    /// Histories that never changed, no reversal seen. An unknown displacement is the one that the polynomial keeps at
    /// this voltage, by bisection between the limits; the nearest limit where it keeps none.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State {
        let voltage = (voltage - self.voltage_centre) * self.voltage_per;
        let limits = self.normalised_limits;
        let displacement = match displacement {
            Some(displacement) => limits.clamp(self.normalise(displacement)),
            None => solve_in_time(T::zero(), limits.min, limits.max, |y| y - self.polynomial(&self.rested(voltage, y))),
        };
        self.rested(voltage, displacement)
    }

    #[inline]
    fn step(&self, state: &mut Self::State, voltage: T) -> T {
        state.push((voltage - self.voltage_centre) * self.voltage_per, state.next);
        state.next = self.polynomial(state);
        self.prediction(state)
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        let reach = within(self.reach(voltage).ok_or(Inadmissible::NoBound)?, limits)?;
        if self.contracts(voltage) { Ok(reach) } else { Err(Inadmissible::Spreads { by: self.contraction(voltage) }) }
    }

    /// None: the polynomial need neither rise with the newest voltage nor have stable zeros.
    fn monotone_part(&self) -> Option<Self> {
        None
    }
}
