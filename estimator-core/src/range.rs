//! A closed interval of voltages or displacements.

use crate::math::Real;
use serde::{Deserialize, Serialize};

/// A closed interval, both ends in one unit that whoever holds it names; empty where `min` exceeds `max`.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range<T = f32> {
    /// Lower end, in the interval.
    pub min: T,
    /// Upper end, in the interval.
    pub max: T,
}

impl<T: Real> Range<T> {
    /// The interval without a value, inside out, to [`include`](Self::include) values in.
    pub fn empty() -> Self {
        Self { min: T::infinity(), max: T::neg_infinity() }
    }

    /// The interval of one value.
    pub fn point(value: T) -> Self {
        Self { min: value, max: value }
    }

    /// The smallest interval with these values; empty where there are none.
    pub fn of_values(values: impl IntoIterator<Item = T>) -> Self {
        values.into_iter().fold(Self::empty(), Self::include)
    }

    /// The smallest interval that has this value, too; NaN changes nothing.
    #[inline]
    #[must_use]
    pub fn include(self, value: T) -> Self {
        Self {
            min: if value < self.min { value } else { self.min },
            max: if value > self.max { value } else { self.max },
        }
    }

    /// The smallest interval that has the other one, too.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        self.include(other.min).include(other.max)
    }

    /// What lies in both; inside out where nothing does.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The value in the middle.
    pub fn middle(self) -> T {
        self.min + self.span() * T::of(0.5)
    }

    /// The nearest value of the interval; its lower end for NaN.
    #[inline]
    pub fn clamp(self, value: T) -> T {
        // Comparisons, because `max` and `min` of an f32 are library calls on the target. A NaN fails both.
        let raised = if value >= self.min { value } else { self.min };
        if raised <= self.max { raised } else { self.max }
    }

    /// Upper end less lower end.
    pub fn span(self) -> T {
        self.max - self.min
    }

    /// Whether the value lies in the interval.
    #[inline]
    pub fn contains(self, value: T) -> bool {
        self.min <= value && value <= self.max
    }
}

impl Range {
    /// The interval in the estimator's number type.
    pub fn of<T: Real>(self) -> Range<T> {
        Range { min: T::of(self.min), max: T::of(self.max) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_included_and_nan_is_not() {
        assert_eq!(Range::of_values([3.0, -1.0, f32::NAN, 2.0]), Range { min: -1.0, max: 3.0 });
        assert_eq!(Range::point(1.0).hull(Range { min: -2.0, max: 0.5 }), Range { min: -2.0, max: 1.0 });
        assert!(Range::<f64>::empty().span() < 0.0 && Range::<f64>::of_values([]) == Range::empty());
        assert_eq!(Range { min: -1.0, max: 4.0 }.middle(), 1.5);
    }
}
