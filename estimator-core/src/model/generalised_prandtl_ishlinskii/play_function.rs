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

    /// What [`function`](Self::function) is with one weight of 1 and the others 0.
    pub fn of_weight(&self, index: usize, play: T, degree: usize) -> T {
        let weights = core::array::from_fn(|other| if other == index { T::one() } else { T::zero() });
        Self { weights, ..*self }.function(play, degree)
    }
}

/// Limited to 0 … 1.
#[inline]
fn unit<T: Real>(s: T) -> T {
    Range { min: T::zero(), max: T::one() }.clamp(s)
}
