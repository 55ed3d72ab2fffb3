//! The few functions that the tick needs beyond `+ − × ÷`, behind one trait so that the backend is one decision.
//!
//! The backend is [`libm`] on every machine, host included: the standard library's `exp` differs from platform to
//! platform in the last bit, and the host must compute the bits that the target computes.
//!
//! | `f32` against `f64`, largest error | libm (default) | feature `micromath` |
//! |---|---|---|
//! | `exp` on −20…20, relative | 1.0e-7 | 2.5e-3 |
//! | `ln` on 1e-6…1e6, absolute | 6.0e-7 | 6.5e-5 |
//! | `pow` on 1e-3…1e3, exponent 0…2, relative | 1.5e-6 | 2.6e-3 |
//!
//! The test `accuracy_is_as_stated` asserts these figures for the backend it is built with. micromath's own `ln` is off
//! by up to 0.118 (and its `powf` by 18 %) below 1, because it inverts its argument with a one-step approximation; here
//! it is only ever called on arguments of at least 1, after an exact division.
//!
//! micromath's error of 2.5e-3 goes into the displacement almost undiminished, so it may serve only where a table
//! passes with it: admission runs in the target's own backend, and `piezo validate`, built with the feature
//! `micromath`, shows that `f32` core beside the `f64` reference.

use core::fmt::{Debug, Display};
use num_traits::float::FloatCore;

/// A floating-point type that the estimator runs in: `f32` or `f64`.
pub trait Real: FloatCore + Debug + Display + Send + Sync + 'static {
    /// e to the power of `self`.
    fn exp(self) -> Self;
    /// `exp(self) − 1` without cancellation near 0; libm in every build.
    fn exp_m1(self) -> Self;
    /// Natural logarithm; −∞ for 0. Call it with values of at least 0.
    fn ln(self) -> Self;
    /// Square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// The value of a number of the parameter table.
    fn of(value: f32) -> Self;
    /// The nearest `f32`: what the target would have.
    fn single(self) -> f32;
    /// The same number.
    fn double(self) -> f64;
    /// The number of this type that is nearest to one of either.
    fn nearest<U: Real>(value: U) -> Self;
    /// Towards zero, saturating at 0 and `u32::MAX`; 0 for NaN. One instruction of the target, unlike the
    /// same to `u16`.
    fn to_u32_saturating(self) -> u32;

    /// `sgn(self)·|self|^exponent`, 0 at 0 whatever the exponent: the shape of every power term of the models.
    ///
    /// Relative error: that of `exp` plus `exponent·|ln|self||` machine epsilons.
    fn signed_pow(self, exponent: Self) -> Self {
        if self == Self::zero() {
            return Self::zero();
        }
        let magnitude = (exponent * self.abs().ln()).exp();
        if self < Self::zero() { -magnitude } else { magnitude }
    }
}

impl Real for f32 {
    #[cfg(not(feature = "micromath"))]
    fn exp(self) -> Self {
        libm::expf(self)
    }

    #[cfg(not(feature = "micromath"))]
    fn ln(self) -> Self {
        libm::logf(self)
    }

    #[cfg(feature = "micromath")]
    fn exp(self) -> Self {
        micromath::F32(self).exp().0
    }

    #[cfg(feature = "micromath")]
    fn ln(self) -> Self {
        if self <= 0.0 {
            f32::NEG_INFINITY
        } else if self < 1.0 {
            -micromath::F32(1.0 / self).ln().0
        } else {
            micromath::F32(self).ln().0
        }
    }

    fn exp_m1(self) -> Self {
        libm::expm1f(self)
    }

    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }

    fn of(value: f32) -> Self {
        value
    }

    #[inline]
    fn single(self) -> f32 {
        self
    }

    #[inline]
    fn double(self) -> f64 {
        self.into()
    }

    #[inline]
    fn nearest<U: Real>(value: U) -> Self {
        value.single()
    }

    #[inline]
    fn to_u32_saturating(self) -> u32 {
        self as u32
    }
}

impl Real for f64 {
    fn exp(self) -> Self {
        libm::exp(self)
    }

    fn ln(self) -> Self {
        libm::log(self)
    }

    fn exp_m1(self) -> Self {
        libm::expm1(self)
    }

    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    #[inline]
    fn of(value: f32) -> Self {
        value.into()
    }

    #[inline]
    fn single(self) -> f32 {
        self as f32
    }

    #[inline]
    fn double(self) -> f64 {
        self
    }

    #[inline]
    fn nearest<U: Real>(value: U) -> Self {
        value.double()
    }

    #[inline]
    fn to_u32_saturating(self) -> u32 {
        self as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(not(feature = "micromath"))]
    const STATED: [f64; 3] = [1.0e-7, 6.0e-7, 1.5e-6];
    #[cfg(feature = "micromath")]
    const STATED: [f64; 3] = [2.5e-3, 6.5e-5, 2.6e-3];

    fn sweep(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..=count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count))
    }

    #[test]
    fn accuracy_is_as_stated() {
        let mut worst = [0.0f64; 3];
        for x in sweep(-20.0, 20.0, 400_000).map(|x| x as f32) {
            let exact = libm::exp(x.into());
            worst[0] = worst[0].max((f64::from(Real::exp(x)) / exact - 1.0).abs());
        }
        for ln in sweep(-13.8, 13.8, 400_000) {
            let x = libm::exp(ln) as f32;
            let exact = libm::log(x.into());
            worst[1] = worst[1].max((f64::from(Real::ln(x)) - exact).abs());
        }
        for exponent in sweep(0.0, 2.0, 40).map(|x| x as f32) {
            for ln in sweep(-6.9, 6.9, 10_000) {
                let x = libm::exp(ln) as f32;
                let exact = libm::pow(x.into(), exponent.into());
                worst[2] = worst[2].max((f64::from(x.signed_pow(exponent)) / exact - 1.0).abs());
            }
        }
        for (found, stated) in worst.into_iter().zip(STATED) {
            assert!(found <= stated, "{worst:?} beyond {STATED:?}");
            assert!(found > stated / 5.0, "stated too loosely: {worst:?} against {STATED:?}");
        }
    }

    #[test]
    fn signed_pow_keeps_the_sign_and_vanishes_at_zero() {
        assert_eq!(0.0f32.signed_pow(0.0), 0.0);
        assert_eq!((-0.0f32).signed_pow(0.5), 0.0);
        assert!((Real::signed_pow(-4.0f64, 0.5) + 2.0).abs() < 1e-12);
    }
}
