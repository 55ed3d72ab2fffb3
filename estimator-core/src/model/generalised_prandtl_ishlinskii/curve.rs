//! A rising function of a voltage, tabulated: what stands behind the play operators.

use super::parameters::KNOTS;
use crate::list::List;
use crate::math::Real;
use crate::range::Range;

/// A function whose slope is given at knots that lie evenly over a span, and runs straight between two of them:
/// the function itself is a parabola from knot to knot, without a kink. Beyond the span it goes on with the slope
/// at the end.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Curve<T> {
    first: T,
    knots_per_volt: T,
    /// The knot that the last parabola begins at.
    last: u32,
    /// The function at each knot, and its slope, µm from one knot to the next.
    knots: [(T, T); KNOTS],
}

impl<T: Real> Curve<T> {
    /// A function that is 0 at the lower end of the span (V), from its slopes (µm/V) at two to [`KNOTS`] knots. One of
    /// no slopes is 0 everywhere.
    pub fn build(span: Range<T>, slopes: &List<KNOTS>) -> Self {
        let intervals = slopes.len().saturating_sub(1).max(1);
        let spacing = span.span() / T::of(intervals as f32);
        let mut knots = [(T::zero(), T::zero()); KNOTS];
        let mut before = None;
        for (knot, &slope) in knots.iter_mut().zip(slopes.iter()) {
            let slope = T::of(slope) * spacing;
            let value = before.map_or(T::zero(), |(value, steep)| value + (steep + slope) * T::of(0.5));
            *knot = (value, slope);
            before = Some(*knot);
        }
        Self { first: span.min, knots_per_volt: T::one() / spacing, last: intervals as u32 - 1, knots }
    }

    /// The function at a voltage, µm.
    #[inline]
    pub fn at(&self, voltage: T) -> T {
        let place = Place::of(voltage, self.first, self.knots_per_volt, self.last);
        let (value, steep) = self.knots.get(place.knot).copied().unwrap_or((T::zero(), T::zero()));
        let (_, next) = self.knots.get(place.knot + 1).copied().unwrap_or((T::zero(), T::zero()));
        let slope = steep + (next - steep) * place.part;
        value + place.part * (steep + slope) * T::of(0.5) + place.beyond * slope
    }
}

/// Where a voltage lies among the knots.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Place<T> {
    /// The knot below it.
    knot: usize,
    /// The part of the way to the next, 0 … 1.
    part: T,
    /// How far beyond the span it lies, in knots.
    beyond: T,
}

impl<T: Real> Place<T> {
    #[inline]
    fn of(voltage: T, first: T, knots_per_volt: T, last: u32) -> Self {
        let at = (voltage - first) * knots_per_volt;
        let inside = Range { min: T::zero(), max: T::of((last + 1) as f32) }.clamp(at);
        let knot = inside.to_u32_saturating().min(last);
        Self { knot: knot as usize, part: inside - T::of(knot as f32), beyond: at - inside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_the_integral_of_its_slopes() {
        let span = Range { min: -10.0f64, max: 30.0 };
        let curve = Curve::build(span, &List::of([1.0, 2.0, 0.0, 0.5, 3.0]));
        assert_eq!([-10.0, 0.0, 10.0, 20.0, 30.0].map(|v| curve.at(v)), [0.0, 15.0, 25.0, 27.5, 45.0]);
        let slope = |v: f64| (curve.at(v + 1e-6) - curve.at(v - 1e-6)) / 2e-6;
        for (v, expected) in [(-25.0, 1.0), (-5.0, 1.5), (0.0, 2.0), (12.5, 0.125), (29.0, 2.75), (80.0, 3.0)] {
            assert!((slope(v) - expected).abs() < 1e-4, "{v} V: {} instead of {expected}", slope(v));
        }
        assert_eq!(Curve::<f64>::build(span, &List::of([])).at(7.0), 0.0);
    }
}
