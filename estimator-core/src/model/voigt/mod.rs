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
//! `ext` changes only at a reversal. The two power terms of it are signed: with both positive (as Table 5.2 prints them)
//! the recursion cannot reproduce the thesis's own strokes. `V_ext` keeps its own sign (Eq. 5.3; Eq. 5.2 prints `sgn(V)`).

mod parameters;
mod proof;

pub use parameters::VoigtParameters;
pub use proof::LEAST_DECAY;

use super::Recursion;
use super::published::{Discretisation, Scheme};
use crate::admissible::Inadmissible;
use crate::extremum::{Extremum, Tracker};
use crate::math::Real;
use crate::range::Range;

/// The affine map of one tick: `y ← a·y + c + m·ext`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoigtTerms<T> {
    /// What remains of the displacement.
    pub a: T,
    /// What the voltage drives, µm.
    pub c: T,
    /// What a unit of the extremum term adds, s.
    pub m: T,
}

impl<T: Real> VoigtTerms<T> {
    /// The displacement (µm) a tick later.
    #[inline]
    pub fn apply(self, displacement: T, ext: T) -> T {
        self.a * displacement + (self.c + self.m * ext)
    }
}

/// Per-tick coefficients of the Voigt family: one `exp` and one power a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Voigt<T> {
    scheme: Scheme,
    sample_period: T,
    /// Retreat that counts as a reversal, V.
    deadband: T,
    rate_scale: T,
    lambda: T,
    lambda_beta: T,
    p: T,
    ln_drive_scale: T,
    g: T,
    h: T,
    e_um: T,
    f: T,
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
    /// The coefficients. Checks nothing: see [`Recursion::bound`].
    pub fn build(parameters: &VoigtParameters<T>, discretisation: &Discretisation<T>) -> Self {
        let micro = T::of(1e6);
        let ln_micro = micro.ln();
        let p = parameters;
        Self {
            scheme: discretisation.scheme,
            sample_period: discretisation.sample_period,
            deadband: discretisation.deadband,
            rate_scale: micro / (p.alpha_um * p.lambda_per_v * p.b_ohm),
            lambda: p.lambda_per_v,
            lambda_beta: p.lambda_per_v * p.beta_v,
            p: p.p,
            ln_drive_scale: ln_micro - p.p * p.b_ohm.ln(),
            g: p.g_um_per_s,
            h: p.h,
            // e·(1e-6)^f m/s for a displacement of 1 µm is 1e6 times that in µm/s.
            e_um: p.e_m_per_s * (ln_micro * (T::one() - p.f)).exp(),
            f: p.f,
        }
    }

    /// 1/(d(V)·b) of Eq. (4.8), 1/s, at this voltage (V): how fast the displacement relaxes.
    pub fn rate(&self, voltage: T) -> T {
        let x = (self.lambda_beta - self.lambda * voltage).exp();
        self.rate_scale * (T::of(2.0) + x + T::one() / x)
    }

    /// The voltage at which `rate` is least, V (β).
    pub fn slowest_voltage(&self) -> T {
        self.lambda_beta / self.lambda
    }

    /// `sgn(V)·(|V|/b)^P` of Eq. (4.8), µm/s: what this voltage (V) drives the displacement by.
    #[inline]
    pub fn drive(&self, voltage: T) -> T {
        if voltage == T::zero() {
            return T::zero();
        }
        let magnitude = (self.p * voltage.abs().ln() + self.ln_drive_scale).exp();
        if voltage < T::zero() { -magnitude } else { magnitude }
    }

    /// The affine map of a tick at this voltage (V).
    #[inline]
    pub fn terms(&self, voltage: T) -> VoigtTerms<T> {
        let rate = self.rate(voltage);
        let (a, m) = match self.scheme {
            Scheme::ForwardEuler => (T::one() - self.sample_period * rate, self.sample_period),
            Scheme::ZeroOrderHold => {
                let decay = -(-self.sample_period * rate).exp_m1();
                (T::one() - decay, decay / rate)
            }
        };
        VoigtTerms { a, c: m * self.drive(voltage), m }
    }

    /// `g·sgn(V_ext)·|V_ext|^h` of Eq. (5.4), µm/s, of the voltage at a reversal (V); 0 where g is.
    pub fn voltage_term(&self, voltage: T) -> T {
        if self.g == T::zero() { T::zero() } else { self.g * voltage.signed_pow(self.h) }
    }

    /// `e_µm·sgn(y_ext)·|y_ext|^f` of Eq. (5.5), µm/s, of a displacement at a reversal (µm); 0 where e is.
    pub fn displacement_term(&self, displacement: T) -> T {
        if self.e_um == T::zero() { T::zero() } else { self.e_um * displacement.signed_pow(self.f) }
    }

    /// Both extremum terms of Eq. (5.3), µm/s; 0 where the model has neither.
    pub fn extremum_input(&self, extremum: Extremum<T>) -> T {
        self.voltage_term(extremum.voltage) + self.displacement_term(extremum.displacement)
    }

    /// One tick with the affine map given, as an interpolated one is.
    #[inline]
    pub fn step_with(&self, state: &mut VoigtState<T>, voltage: T, terms: VoigtTerms<T>) -> T {
        if state.tracker.update(voltage, state.displacement) {
            state.ext = self.extremum_input(state.tracker.last());
        }
        state.displacement = terms.apply(state.displacement, state.ext);
        state.displacement
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
