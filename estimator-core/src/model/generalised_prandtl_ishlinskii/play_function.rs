//! A play operator and the function g_i behind it.

use crate::math::Real;
use crate::range::Range;

/// One play operator and what stands behind it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Element<T> {
    pub half_width: T,
    /// Where its travel begins, and 1/its length.
    pub first: T,
    pub per_volt: T,
    pub weights: [T; 3],
}

impl<T: Real> Element<T> {
    /// g_i: a polynomial over the play's travel, and straight beyond.
    #[inline]
    pub fn function(&self, play: T, degree: usize) -> T {
        let s = (play - self.first) * self.per_volt;
        let inside = unit(s);
        let [a, b, c] = self.weights;
        let within = match degree {
            1 => a * inside,
            2 => (a * (T::of(2.0) - inside) + b * inside) * inside,
            _ => {
                let rest = T::one() - inside;
                let square = inside * inside;
                a * (T::one() - rest * rest * rest) + square * (b * (T::of(3.0) - T::of(2.0) * inside) + c * inside)
            }
        };
        let beyond = s - inside;
        if beyond == T::zero() { within } else { within + self.slope(degree, beyond < T::zero()) * beyond }
    }

    /// g_i' at an end of the travel.
    fn slope(&self, degree: usize, lower: bool) -> T {
        let [a, b, c] = self.weights;
        match degree {
            1 => a,
            2 => T::of(2.0) * if lower { a } else { b },
            _ => T::of(3.0) * if lower { a } else { c },
        }
    }

    /// What each weight weighs: [`function`](Self::function) with that weight of 1 and the others 0. Of the third degree at
    /// most; what is above `degree` is 0.
    #[inline]
    pub fn weighed(&self, play: T, degree: usize) -> [T; 3] {
        let s = (play - self.first) * self.per_volt;
        let inside = unit(s);
        let beyond = s - inside;
        let (zero, one, two, three) = (T::zero(), T::one(), T::of(2.0), T::of(3.0));
        let (lower, upper) = if beyond < zero { (beyond, zero) } else { (zero, beyond) };
        match degree {
            1 => [inside + beyond, zero, zero],
            2 => [(two - inside) * inside + two * lower, inside * inside + two * upper, zero],
            _ => {
                let rest = one - inside;
                let square = inside * inside;
                [
                    one - rest * rest * rest + three * lower,
                    square * (three - two * inside),
                    square * inside + three * upper,
                ]
            }
        }
    }
}

/// Limited to 0 … 1.
#[inline]
fn unit<T: Real>(s: T) -> T {
    Range { min: T::zero(), max: T::one() }.clamp(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_weighed_is_the_function_of_one_weight() {
        for degree in 1..=3 {
            for play in (-30..=130).map(|volts| f64::from(volts) * 0.5) {
                let element = Element { half_width: 1.0, first: 3.0, per_volt: 0.02, weights: [0.0; 3] };
                let weighed = element.weighed(play, degree);
                for (index, found) in weighed.into_iter().enumerate().take(degree) {
                    let mut weights = [0.0; 3];
                    weights[index] = 1.0;
                    let expected = Element { weights, ..element }.function(play, degree);
                    assert!((found - expected).abs() <= 1e-12, "{degree} {index} at {play} V: {found}, not {expected}");
                }
            }
        }
    }
}
