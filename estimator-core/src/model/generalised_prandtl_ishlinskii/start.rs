//! The memory that a run of the generalised Prandtl-Ishlinskii operator begins with: of an actuator at rest, with a
//! displacement that is known or not.
//!
//! An actuator at rest remembers the way that it came there, or has forgotten it
//! ([`rested`](GeneralisedPrandtlIshlinskii::rested)). A known displacement says how far towards an end of that all
//! plays stand, as after a rise or after a fall.

use super::parameters::{CREEPS, PLAYS};
use super::{Element, GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiState, LINE};
use crate::math::Real;
use crate::model::play::play;
use crate::model::relaxation::{RampLagged, Relaxed};
use crate::model::resonance::ResonanceState;
use crate::model::solve;
use crate::range::Range;

impl<T: Real> GeneralisedPrandtlIshlinskii<T> {
    /// At rest at a voltage, each play `bias` of the way from where long rest leaves it to an end of its memory: −1 as
    /// after a rise, 1 as after a fall from an end of the span. An actuator that has never left an end of the span has
    /// the memory of neither.
    fn branch(&self, voltage: T, bias: T) -> GeneralisedPrandtlIshlinskiiState<T> {
        let mut plays = self.rested(voltage);
        for (at, &Element { half_width, .. }) in plays.iter_mut().zip(&self.elements) {
            let left = Range { min: self.span.min + half_width, max: self.span.max - half_width };
            let swept = |towards: T| play(left.clamp(voltage + towards * half_width), voltage, half_width);
            let end = if bias < T::zero() { swept(-T::one()).min(*at) } else { swept(T::one()).max(*at) };
            *at = *at + bias.abs() * (end - *at);
        }
        self.resting(voltage, plays)
    }

    /// The plays of an actuator that has rested at a voltage.
    pub(super) fn rested(&self, voltage: T) -> [T; PLAYS] {
        let (memory, low, one) = (self.rest_memory, self.span.min, T::one());
        let between = |first: T, second: T, part: T| first + part * (second - first);
        let mut plays = [voltage; PLAYS];
        for (at, element) in plays.iter_mut().zip(&self.elements).take(self.plays) {
            let come_from = |from: T| play(from, voltage, element.half_width);
            *at = if memory < -one {
                between(come_from(low), come_from(low + element.half_width), -one - memory)
            } else {
                let from = if memory < T::zero() { low } else { self.span.middle() };
                between(voltage, come_from(from), memory.abs())
            };
        }
        plays
    }

    /// At rest at a voltage with these plays. Creep takes decades to forget what the
    /// plays forget in a swing, and is where an actuator has it that has rested there whatever is known of the plays.
    pub(super) fn resting(&self, voltage: T, plays: [T; PLAYS]) -> GeneralisedPrandtlIshlinskiiState<T> {
        let crept = self.hysteretic(&self.rested(voltage), voltage);
        let state = GeneralisedPrandtlIshlinskiiState {
            line: [voltage; LINE],
            newest: 0,
            input: RampLagged::at(voltage),
            plays,
            creep: [Relaxed::at(crept); CREEPS],
            resonance: ResonanceState::rest(T::zero()),
        };
        GeneralisedPrandtlIshlinskiiState { resonance: ResonanceState::rest(self.at_rest(&state, voltage)), ..state }
    }

    /// At a known displacement. What no memory can have left is a lag's: the actuator is still on its way
    /// to this voltage.
    pub(super) fn arrive(&self, voltage: T, known: T) -> GeneralisedPrandtlIshlinskiiState<T> {
        let one = T::one();
        let at = |voltage: T, bias: T| self.at_rest(&self.branch(voltage, bias), voltage);
        if known < at(voltage, -one) {
            let lowest = self.span.include(voltage).min;
            self.branch(solve(known, lowest, voltage, |voltage| at(voltage, -one)), -one)
        } else if known > at(voltage, one) {
            let highest = self.span.include(voltage).max;
            self.branch(solve(known, voltage, highest, |voltage| at(voltage, one)), one)
        } else {
            self.branch(voltage, solve(known, -one, one, |bias| at(voltage, bias)))
        }
    }
}
