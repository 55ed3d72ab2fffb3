//! A closed interval of voltages or displacements.

use crate::math::Real;
use serde::{Deserialize, Serialize};

/// A closed interval.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range<T = f32> {
    /// Lower end.
    pub min: T,
    /// Upper end.
    pub max: T,
}

impl<T: Real> Range<T> {
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
