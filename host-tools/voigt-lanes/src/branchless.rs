//! Exponential, logarithm and power without a branch: of neighbouring numbers the compiler makes vector instructions of
//! them, where a library's function is called for one number after the other.
//!
//! ```text
//! exp x = 2^k·exp r,      k = round(x/ln 2), |r| ≤ ln 2/2      exp r by its Taylor polynomial
//! ln x  = k·ln 2 + ln m,  √½ ≤ m < √2      ln m = 2·artanh s = 2·(s + s³/3 + s⁵/5 + …),  s = (m − 1)/(m + 1)
//! ```
//!
//! Nothing but `+ − × ÷` and bits, never fused, so that every machine has the same bits. `ln 2` is in two parts, the
//! first of which k multiplies exactly (Cody and Waite, Software Manual for the Elementary Functions, 1980).

/// Bits of a mantissa.
const MANTISSA: u32 = f64::MANTISSA_DIGITS - 1;
/// What is added to an exponent of 2 that is stored.
const BIAS: u64 = f64::MAX_EXP as u64 - 1;
/// Upper part of ln 2, with 21 bits fewer than a mantissa.
const LN2_UPPER: f64 = 0.693_147_180_369_123_8;
/// What is left of it.
const LN2_LOWER: f64 = 1.908_214_929_270_587_7e-10;
/// 1/n! from n = 0 on: the next is less than 10⁻¹⁷ of the sum.
const EXP: [f64; 14] = reciprocal_factorials();
/// 1/(2n + 3) from n = 0 on: likewise.
const LN: [f64; 10] = reciprocals_of_odd();

/// e to the power of x, to 5·10⁻¹⁶ of itself where that is a normal number. Below, the smallest normal number; above,
/// and from √½ of the largest on, infinite; of NaN, NaN.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    // Added to a number below 2⁵⁰, it leaves the nearest integer in the lowest bits.
    const ROUNDING: f64 = 1.5 * (1_u64 << MANTISSA) as f64;
    const LOWEST: f64 = (f64::MIN_EXP - 1) as f64 * std::f64::consts::LN_2;
    const HIGHEST: f64 = (f64::MAX_EXP as f64 + 0.25) * std::f64::consts::LN_2;
    // Comparisons that a NaN passes.
    let x = if x < LOWEST { LOWEST } else { x };
    let x = if x > HIGHEST { HIGHEST } else { x };
    let rounded = x * std::f64::consts::LOG2_E + ROUNDING;
    let k = rounded - ROUNDING;
    let r = (x - k * LN2_UPPER) - k * LN2_LOWER;
    let polynomial = EXP.iter().rev().fold(0.0, |sum, coefficient| sum * r + coefficient);
    let power = rounded.to_bits().wrapping_sub(ROUNDING.to_bits()).wrapping_add(BIAS) << MANTISSA;
    polynomial * f64::from_bits(power)
}

/// Natural logarithm of a normal number above 0, to 5·10⁻¹⁶ of itself or of 1, whichever is larger; of anything
/// else, some number.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    const ONE: u64 = 1.0_f64.to_bits();
    const ROOT: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    // An integer below 2⁵², in the lowest bits of this number, is added to it.
    const INTEGER: f64 = (1_u64 << MANTISSA) as f64;
    let shifted = x.to_bits().wrapping_add(ONE - ROOT);
    let k = (f64::from_bits((shifted >> MANTISSA) | INTEGER.to_bits()) - INTEGER) - BIAS as f64;
    let m = f64::from_bits((shifted & ((1 << MANTISSA) - 1)) + ROOT);
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = LN.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient);
    k * LN2_UPPER + ((2.0 * s + 2.0 * s * (square * series)) + k * LN2_LOWER)
}

/// `sgn(x)·|x|^exponent`, 0 at 0.
#[inline(always)]
pub fn signed_pow(x: f64, exponent: f64) -> f64 {
    let magnitude = exp(exponent * ln(x.abs()));
    let signed = if x < 0.0 { -magnitude } else { magnitude };
    if x == 0.0 { 0.0 } else { signed }
}

const fn reciprocal_factorials<const N: usize>() -> [f64; N] {
    let mut found = [1.0; N];
    let mut n = 1;
    while n < N {
        found[n] = found[n - 1] / n as f64;
        n += 1;
    }
    found
}

const fn reciprocals_of_odd<const N: usize>() -> [f64; N] {
    let mut found = [0.0; N];
    let mut n = 0;
    while n < N {
        found[n] = 1.0 / (2 * n + 3) as f64;
        n += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATED: f64 = 5e-16;

    #[test]
    fn exponential_and_logarithm_are_as_accurate_as_stated() {
        let mut worst = [0.0f64; 2];
        for step in 0..=400_000 {
            let x = -708.0 + (709.4 + 708.0) * f64::from(step) / 400_000.0;
            let exact = libm::exp(x);
            let exact_ln = libm::log(exact);
            let off = [(exp(x) / exact - 1.0).abs(), (ln(exact) - exact_ln).abs() / exact_ln.abs().max(1.0)];
            assert!(off.iter().all(|off| *off <= STATED), "{x}: {off:?}");
            worst = std::array::from_fn(|of| worst[of].max(off[of]));
        }
        assert!(worst.iter().all(|of| *of > STATED / 5.0), "stated too loosely: {worst:?}");
    }

    /// Near 1, where the logarithm is small, it is accurate by its own size.
    #[test]
    fn the_logarithm_near_one_is_accurate_relative_to_itself() {
        for step in (1..=10_000).filter(|step| *step != 5_000) {
            let x = 1.0 + 1e-5 * f64::from(step - 5_000);
            assert!((ln(x) / libm::log(x) - 1.0).abs() < 1e-15, "{x}");
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn what_leaves_the_range_is_infinite_or_nearly_nothing_and_nan_stays() {
        assert_eq!([710.0, f64::INFINITY].map(exp), [f64::INFINITY; 2]);
        assert_eq!([-709.0, f64::NEG_INFINITY].map(|x| exp(x) < 3e-308), [true; 2]);
        assert!(exp(f64::NAN).is_nan());
        assert_eq!(exp(0.0), 1.0);
    }

    #[test]
    fn powers_keep_the_sign_and_vanish_at_zero() {
        assert_eq!([signed_pow(0.0, 0.0), signed_pow(-0.0, 0.5)], [0.0; 2]);
        assert!((signed_pow(-4.0, 0.5) + 2.0).abs() < 1e-15);
        assert!((signed_pow(6.5, 1.3) - libm::pow(6.5, 1.3)).abs() < 1e-14);
    }
}
