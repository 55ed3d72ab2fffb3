//! What the equations of the Voigt family come to at a voltage: rate, drive, extremum terms and the affine map
//! of a tick.

use super::parameters::VoigtParameters;
use crate::extremum::Extremum;
use crate::math::Real;
use crate::model::published::{Discretisation, Scheme};

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
    /// The displacement (µm) a tick later; `ext` is the extremum term, µm/s.
    #[inline]
    pub fn apply(self, displacement: T, ext: T) -> T {
        self.a * displacement + (self.c + self.m * ext)
    }
}

/// What the equation comes to at a voltage without the extremum terms.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoigtPoint<T> {
    /// The voltage, V.
    pub voltage: T,
    /// What [`Voigt::rate`] is here, 1/s.
    pub rate: T,
    /// What [`Voigt::drive`] is here, µm/s.
    pub drive: T,
}

/// Per-tick coefficients of the Voigt family: one `exp` and one power a tick. They can be read by whoever computes
/// [points](VoigtPoint) and extremum terms of many sets at once.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Voigt<T> {
    pub(super) scheme: Scheme,
    sample_period: T,
    /// Retreat that counts as a reversal, V.
    pub(super) deadband: T,
    /// The scale 1e6/(α·λ·b) of the rate, 1/s.
    pub rate_scale: T,
    /// The slope λ of the sigmoid, 1/V.
    pub lambda: T,
    /// λ·β, no unit.
    pub lambda_beta: T,
    /// P, no unit.
    pub p: T,
    /// ln(1e6·b^−P): what the logarithm of the drive (µm/s) is at 1 V.
    pub ln_drive_scale: T,
    /// g, µm/s per V^h.
    pub g: T,
    /// h, no unit.
    pub h: T,
    /// e, µm/s per µm^f.
    pub e_um: T,
    /// f, no unit.
    pub f: T,
}

impl<T: Real> Voigt<T> {
    /// The coefficients. Checks nothing: see [`Recursion::bound`](crate::model::Recursion::bound).
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

    /// Rate and drive at this voltage (V).
    #[inline]
    pub fn point(&self, voltage: T) -> VoigtPoint<T> {
        VoigtPoint { voltage, rate: self.rate(voltage), drive: self.drive(voltage) }
    }

    /// The affine map of a tick at this voltage (V).
    #[inline]
    pub fn terms(&self, voltage: T) -> VoigtTerms<T> {
        self.terms_at(self.point(voltage))
    }

    /// The affine map of a tick at a point.
    #[inline]
    pub fn terms_at(&self, VoigtPoint { rate, drive, .. }: VoigtPoint<T>) -> VoigtTerms<T> {
        let (a, m) = match self.scheme {
            Scheme::ForwardEuler => (T::one() - self.sample_period * rate, self.sample_period),
            Scheme::ZeroOrderHold => {
                let decay = -(-self.sample_period * rate).exp_m1();
                (T::one() - decay, decay / rate)
            }
        };
        VoigtTerms { a, c: m * drive, m }
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
}
