//! The proof that two runs of a NARX polynomial with the same voltages, from different displacements or in different
//! number types, do not part, and come together where no displacement at a reversal is among its inputs.
//!
//! ```text
//! |y'(k+1) − y(k+1)| ≤ Σ_i |∂f/∂y_i|·|y'(k−i) − y(k−i)| + |∂f/∂y_ext|·|y'_ext − y_ext|
//! ρ = contraction = most of Σ_i |∂f/∂y_i| + |∂f/∂y_ext| over the box of all voltages, reversals and displacements
//! ```
//!
//! The clamp brings two displacements no further apart. Without y_ext the difference is at most ρ times the largest of
//! the r_y before, and so after n ticks at most ρ^⌊n/r_y⌋ times the first. With y_ext, one of the displacements before
//! and however long ago, it is at most ρ times the largest ever: it never grows, and between two reversals it need not
//! shrink below what |∂f/∂y_ext| keeps of that at the last; every reversal takes in a smaller one. What every tick
//! rounds, δ, adds up to δ/(1 − ρ) at most in both cases. Each derivative is bounded by interval arithmetic, a monomial
//! at a time.

use super::{Narx, ORDER};
use crate::math::Real;
use crate::range::Range;

/// Part of a difference that a tick takes away at least.
const LEAST_LOSS: f32 = 1.0 / 4096.0;

/// v, y and the two at the reversal: the letters that monomials are made of.
const LETTERS: usize = 4;

impl<T: Real> Narx<T> {
    /// ρ of the equation above for voltages of this range (V), or a number that is none.
    pub fn contraction(&self, voltage: Range<T>) -> T {
        let normal = |voltage: T| (voltage - self.voltage_centre) * self.voltage_per;
        let v = Range { min: normal(voltage.min), max: normal(voltage.max) };
        let y = self.normalised_limits;
        // Before the first reversal both of its letters are 0.
        let (at_reversal_v, at_reversal_y) = (v.include(T::zero()), y.include(T::zero()));
        let mut letters = [v, y, at_reversal_y, at_reversal_y];
        let mut count = 2;
        for (asked, range) in
            [(self.with_voltage_extremum, at_reversal_v), (self.with_displacement_extremum, at_reversal_y)]
        {
            if asked && let Some(letter) = letters.get_mut(count) {
                *letter = range;
                count += 1;
            }
        }
        let coefficient = |index: usize| self.coefficients.get(index).copied().unwrap_or(T::zero());
        let lags = (1..ORDER.min(self.output_order)).map(coefficient).fold(T::zero(), |sum, a| sum + a.abs());
        let linear = self.output_order + self.input_order + count - 2;
        let slope = |letter: usize, of_linear: T| {
            let bent = self.slope(letters.get(..count).unwrap_or(&letters), letter, linear);
            largest(Range { min: of_linear + bent.min, max: of_linear + bent.max })
        };
        let own = lags + slope(1, coefficient(0));
        if self.with_displacement_extremum { own + slope(count - 1, coefficient(linear - 1)) } else { own }
    }

    /// Whether the contraction is far enough below 1 for an `f32` to see.
    pub(super) fn contracts(&self, voltage: Range<T>) -> bool {
        // False for a NaN.
        self.contraction(voltage) <= T::one() - T::of(LEAST_LOSS)
    }

    /// The derivative by one letter of the monomials of degree 2 and 3, whose coefficients begin at `first`.
    fn slope(&self, letters: &[Range<T>], by: usize, first: usize) -> Range<T> {
        let mut coefficients = self.coefficients.iter().skip(first);
        let mut sum = Range::point(T::zero());
        let mut add = |powers: [u8; LETTERS]| {
            let Some(&coefficient) = coefficients.next() else { return };
            let of_monomial = derivative(letters, powers, by);
            let (one, other) = (coefficient * of_monomial.min, coefficient * of_monomial.max);
            // Not `min` and `max`, which pass over a NaN.
            let (low, high) = if one <= other { (one, other) } else { (other, one) };
            sum = Range { min: sum.min + low, max: sum.max + high };
        };
        let count = letters.len();
        if self.degree >= 2 {
            (0..count).for_each(|a| (a..count).for_each(|b| add(powers(&[a, b]))));
        }
        if self.degree >= 3 {
            (0..count).for_each(|a| (a..count).for_each(|b| (b..count).for_each(|c| add(powers(&[a, b, c])))));
        }
        sum
    }
}

/// The larger magnitude of a range's ends; no number where one of them is none.
fn largest<T: Real>(range: Range<T>) -> T {
    let (low, high) = (range.min.abs(), range.max.abs());
    if low.is_nan() || low > high { low } else { high }
}

/// How often each letter is in a monomial.
fn powers(letters: &[usize]) -> [u8; LETTERS] {
    let mut powers = [0; LETTERS];
    for &letter in letters {
        if let Some(power) = powers.get_mut(letter) {
            *power += 1;
        }
    }
    powers
}

/// What the derivative by a letter of a monomial can be.
fn derivative<T: Real>(letters: &[Range<T>], mut powers: [u8; LETTERS], by: usize) -> Range<T> {
    let Some(power) = powers.get_mut(by).filter(|power| **power > 0) else { return Range::point(T::zero()) };
    let factor = T::of(f32::from(*power));
    *power -= 1;
    letters.iter().zip(powers).fold(Range::point(factor), |product, (letter, power)| {
        let raised = match power {
            0 => return product,
            1 => *letter,
            _ => square(*letter),
        };
        let ends =
            [product.min * raised.min, product.min * raised.max, product.max * raised.min, product.max * raised.max];
        if ends.iter().any(|end| end.is_nan()) { Range::point(T::nan()) } else { Range::of_values(ends) }
    })
}

/// The squares of a range: powers beyond 2 do not occur in a derivative of a monomial of degree 3.
fn square<T: Real>(range: Range<T>) -> Range<T> {
    let (low, high) = (range.min * range.min, range.max * range.max);
    let both = if low <= high { Range { min: low, max: high } } else { Range { min: high, max: low } };
    if range.contains(T::zero()) { Range { min: T::zero(), max: both.max } } else { both }
}
