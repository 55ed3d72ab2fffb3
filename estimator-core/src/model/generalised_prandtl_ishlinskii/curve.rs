//! A rising function of a voltage, tabulated: what stands behind the play operators.

use super::parameters::KNOTS;
use crate::math::Real;
use crate::range::Range;

/// Where knots lie evenly over a span.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Layout<T> {
    first: T,
    knots_per_volt: T,
    /// The knot that the last interval begins at.
    last: u32,
}

impl<T: Real> Layout<T> {
    /// So many knots, two at least, from one end of a span (V) to the other.
    pub fn build(span: Range<T>, knots: usize) -> Self {
        let intervals = knots.saturating_sub(1).max(1);
        Self {
            first: span.min,
            knots_per_volt: T::one() / (span.span() / T::of(intervals as f32)),
            last: intervals as u32 - 1,
        }
    }

    /// Where a voltage lies among the knots.
    #[inline]
    pub fn place(&self, voltage: T) -> Place<T> {
        let at = (voltage - self.first) * self.knots_per_volt;
        let inside = Range { min: T::zero(), max: T::of((self.last + 1) as f32) }.clamp(at);
        let knot = inside.to_u32_saturating().min(self.last);
        Place { knot: knot as usize, part: inside - T::of(knot as f32), beyond: at - inside }
    }
}

/// A function whose slope is given at the knots of a [`Layout`], and runs straight between two of them: the function
/// itself is a parabola from knot to knot, without a kink. Beyond the span it goes on with the slope at the end.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Curve<T> {
    /// The function at each knot, and its slope, µm from one knot to the next.
    knots: [(T, T); KNOTS],
}

impl<T: Real> Curve<T> {
    /// A function that is 0 at the lower end of the span, from its slopes (µm/V) at the layout's knots. One of no
    /// slopes is 0 everywhere.
    pub fn build(layout: &Layout<T>, slopes: impl Iterator<Item = T>) -> Self {
        let mut knots = [(T::zero(), T::zero()); KNOTS];
        let mut before = None;
        for (knot, slope) in knots.iter_mut().zip(slopes) {
            let slope = slope / layout.knots_per_volt;
            let value = before.map_or(T::zero(), |(value, steep)| value + (steep + slope) * T::of(0.5));
            *knot = (value, slope);
            before = Some(*knot);
        }
        Self { knots }
    }

    /// The function at a place, µm.
    #[inline]
    pub fn at(&self, place: Place<T>) -> T {
        let (value, steep) = self.knots.get(place.knot).copied().unwrap_or((T::zero(), T::zero()));
        let (_, next) = self.knots.get(place.knot + 1).copied().unwrap_or((T::zero(), T::zero()));
        let slope = steep + (next - steep) * place.part;
        value + place.part * (steep + slope) * T::of(0.5) + place.beyond * slope
    }
}

/// Where a voltage lies among the knots.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Place<T> {
    /// The knot below it.
    knot: usize,
    /// The part of the way to the next, 0 … 1.
    part: T,
    /// How far beyond the span it lies, in knots.
    beyond: T,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_the_integral_of_its_slopes() {
        let span = Range { min: -10.0f64, max: 30.0 };
        let layout = Layout::build(span, 5);
        let curve = Curve::build(&layout, [1.0, 2.0, 0.0, 0.5, 3.0].into_iter());
        let at = |v: f64| curve.at(layout.place(v));
        assert_eq!([-10.0, 0.0, 10.0, 20.0, 30.0].map(at), [0.0, 15.0, 25.0, 27.5, 45.0]);
        let slope = |v: f64| (at(v + 1e-6) - at(v - 1e-6)) / 2e-6;
        for (v, expected) in [(-25.0, 1.0), (-5.0, 1.5), (0.0, 2.0), (12.5, 0.125), (29.0, 2.75), (80.0, 3.0)] {
            assert!((slope(v) - expected).abs() < 1e-4, "{v} V: {} instead of {expected}", slope(v));
        }
        assert_eq!(Curve::build(&layout, [].into_iter()).at(layout.place(7.0)), 0.0);
    }
}
