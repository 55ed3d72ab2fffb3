//! Exact inverse of the Prandtl-Ishlinskii model: the voltage that gives a wanted displacement (Kuhnen 2003).
//!
//! ```text
//! V    = Σ w'_i·play(S⁻¹(y) − offset, r'_i)
//! r'_i = Σ_{j<i} w_j·(r_i − r_j)                                         µm
//! w'_0 = 1/w_0,   w'_i = −w_i/((w_0+…+w_i)·(w_0+…+w_{i−1}))              V/µm
//! p'_i = p_i·Σ_{j≤i} w_j + Σ_{j>i} w_j·p_j                               µm    memory that belongs to the plays p
//! ```
//!
//! It exists where `w_0 > 0`. It is exact: a displacement that the model gave leads back to the voltage, to within
//! rounding.

use super::dead_zone::Superposition;
use super::play::play;
use super::prandtl_ishlinskii::{PLAYS, PrandtlIshlinskii, PrandtlIshlinskiiState};
use super::recursion::Recursion;
use crate::math::Real;

/// Coefficients of the inverse.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PrandtlIshlinskiiInverse<T> {
    forward: PrandtlIshlinskii<T>,
    thresholds: [T; PLAYS],
    weights: [T; PLAYS],
    superposition: Superposition<T>,
}

/// The inverse's plays, µm.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PrandtlIshlinskiiInverseState<T> {
    plays: [T; PLAYS],
}

impl<T: Real> PrandtlIshlinskiiInverse<T> {
    /// The inverse of a model; `None` where its first weight is not positive, so that a reversal does not move it at
    /// once.
    pub fn build(forward: &PrandtlIshlinskii<T>) -> Option<Self> {
        let mut inverse = Self {
            forward: *forward,
            thresholds: [T::zero(); PLAYS],
            weights: [T::zero(); PLAYS],
            superposition: forward.superposition.inverse(),
        };
        // Σ w_j and Σ w_j·r_j of the plays before this one.
        let (mut slope, mut moment) = (T::zero(), T::zero());
        let from = forward.thresholds.iter().zip(&forward.weights).take(forward.count);
        let to = inverse.thresholds.iter_mut().zip(inverse.weights.iter_mut());
        for (index, ((&threshold, &weight), (inverse_threshold, inverse_weight))) in from.zip(to).enumerate() {
            let next = slope + weight;
            *inverse_threshold = slope * threshold - moment;
            *inverse_weight = if index == 0 { T::one() / next } else { -weight / (next * slope) };
            slope = next;
            moment = moment + weight * threshold;
        }
        forward.weights.first().is_some_and(|first| *first > T::zero()).then_some(inverse)
    }

    /// The memory that belongs to the forward model's after the same [`begin`](super::Recursion::begin): an actuator at
    /// rest at this voltage (V), with this displacement (µm) if known.
    pub fn begin(&self, voltage: T, displacement: Option<T>) -> PrandtlIshlinskiiInverseState<T> {
        self.follow(&self.forward.begin(voltage, displacement))
    }

    /// The memory that belongs to a memory of the forward model.
    pub fn follow(&self, forward: &PrandtlIshlinskiiState<T>) -> PrandtlIshlinskiiInverseState<T> {
        let mut state = PrandtlIshlinskiiInverseState { plays: [T::zero(); PLAYS] };
        let plays = || forward.plays.iter().zip(&self.forward.weights).take(self.forward.count);
        for (index, (to, &own)) in state.plays.iter_mut().zip(&forward.plays).take(self.forward.count).enumerate() {
            let terms = plays().enumerate();
            *to = terms
                .fold(T::zero(), |sum, (j, (&other, &weight))| sum + weight * if j <= index { own } else { other });
        }
        state
    }

    /// One tick: takes the wanted displacement (µm), returns the voltage (V) that gives it. The voltage may be one that
    /// the amplifier does not have.
    #[inline]
    pub fn step(&self, state: &mut PrandtlIshlinskiiInverseState<T>, reference_um: T) -> T {
        let input = self.superposition.apply(reference_um) - self.forward.offset;
        let plays = state.plays.iter_mut().zip(&self.thresholds).zip(&self.weights).take(self.forward.count);
        let mut voltage = T::zero();
        for ((memory, &threshold), &weight) in plays {
            *memory = play(*memory, input, threshold);
            voltage = voltage + weight * *memory;
        }
        voltage
    }
}
