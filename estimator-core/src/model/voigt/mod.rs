//! The Voigt family: Voigt (Eq. 4.8), its voltage-extremum (5.4) and displacement-extremum (5.5) variants, and the
//! enhanced model (5.3) that has both terms.
//!
//! ```text
//! d(V)    = α·λ·x/(1 + x)²,  x = exp(−λ(V−β))                          µm/V
//! rate(V) = 1/(1e-6·d(V)·b) = (2 + x + 1/x)·1e6/(α·λ·b)                1/s
//! drive(V) = 1e6·sgn(V)·(|V|/b)^P                                      µm/s
//! ext     = g·sgn(V_ext)·|V_ext|^h + e_µm·sgn(y_ext)·|y_ext|^f         µm/s
//! dy/dt   = drive(V) − rate(V)·y + ext
//! ```
//!
//! A tick is one affine map, `y ← a(V)·y + c(V) + m(V)·ext`, with
//!
//! | scheme | a | m | c |
//! |---|---|---|---|
//! | forward Euler (the thesis's, Eq. 4.7) | 1 − t_s·rate | t_s | m·drive |
//! | zero-order hold (exact for a voltage that stays for the tick) | exp(−t_s·rate) | (1 − a)/rate | m·drive |
//!
//! `ext` changes only at a reversal. The two power terms of it are signed: with both positive (as Table 5.2
//! prints them) the recursion cannot reproduce the thesis's own strokes. `V_ext` keeps its own sign (Eq. 5.3; Eq.
//! 5.2 prints `sgn(V)`).

mod coefficients;
mod parameters;
mod proof;

pub use coefficients::{Voigt, VoigtPoint, VoigtTerms};
pub use parameters::VoigtParameters;
pub use proof::LEAST_DECAY;

use super::{Discretisation, Published, Recursion};
use crate::admissible::Inadmissible;
use crate::extremum::Tracker;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;

impl Published for VoigtParameters {
    type Coefficients<T: Real> = Voigt<T>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Voigt<T> {
        Voigt::build(&self.map(T::of), discretisation)
    }

    fn check(&self) -> Result<(), Rule> {
        self.check_numbers()
    }
}

/// Displacement and reversal memory of a running recursion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoigtState<T> {
    /// Displacement now, µm.
    displacement: T,
    tracker: Tracker<T>,
    ext: T,
}

impl<T: Real> Voigt<T> {
    /// One tick with the affine map given, as an interpolated one is.
    #[inline]
    pub fn step_with(&self, state: &mut VoigtState<T>, voltage: T, terms: VoigtTerms<T>) -> T {
        if state.tracker.update(voltage, state.displacement) {
            state.ext = self.extremum_input(state.tracker.last());
        }
        state.displacement = terms.apply(state.displacement, state.ext);
        state.displacement
    }

    /// As [`Recursion::bound`], with the points given between which it is proven, from the lowest voltage (V) to the
    /// highest. The closer they stand, the less the proof refuses that is admissible.
    ///
    /// # Errors
    /// The displacement may leave the limits (µm), or a tick is not stable.
    pub fn bound_between(
        &self,
        points: impl Iterator<Item = VoigtPoint<T>>,
        voltage: Range<T>,
        limits: Range<T>,
    ) -> Result<Range<T>, Inadmissible<T>> {
        proof::check_between(self, points, voltage, limits)
    }

    /// Long at rest at the voltage of these terms, no reversal seen; at this displacement (µm) where it is known.
    pub fn rest(&self, terms: VoigtTerms<T>, displacement: Option<T>) -> VoigtState<T> {
        VoigtState {
            // a < 1 in every admitted table.
            displacement: displacement.unwrap_or(terms.c / (T::one() - terms.a)),
            tracker: Tracker::new(self.deadband),
            ext: T::zero(),
        }
    }
}

impl<T: Real> Recursion<T> for Voigt<T> {
    type State = VoigtState<T>;

    fn begin(&self, voltage: T, displacement: Option<T>) -> VoigtState<T> {
        self.rest(self.terms(voltage), displacement)
    }

    #[inline]
    fn first(&self, voltage: T, displacement: Option<T>) -> (VoigtState<T>, T) {
        let terms = self.terms(voltage);
        let mut state = self.rest(terms, displacement);
        let displacement = self.step_with(&mut state, voltage, terms);
        (state, displacement)
    }

    #[inline]
    fn step(&self, state: &mut VoigtState<T>, voltage: T) -> T {
        self.step_with(state, voltage, self.terms(voltage))
    }

    /// The limits, where the proof of `proof.rs` holds.
    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        proof::check(self, voltage, limits)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }

    fn set_displacement(&self, state: &mut VoigtState<T>, displacement: T) -> bool {
        state.displacement = displacement;
        true
    }
}
