//! An axis: its range, and ticks at round numbers.

use super::number::tick_label;
use super::thin::extent;

/// Range and ticks of an axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Axis {
    min: f64,
    max: f64,
    logarithmic: bool,
    /// Position (0 … 1) and label of each tick.
    pub ticks: Vec<(f64, String)>,
}

/// Room beyond the data, as a fraction of their span.
const MARGIN: f64 = 0.06;

impl Axis {
    /// An axis for values, with some room at both ends and at least `ticks` ticks.
    pub fn linear(values: impl IntoIterator<Item = f64>, ticks: usize) -> Self {
        let (min, max) = widened(extent(values));
        let margin = MARGIN * (max - min);
        Self::over(min - margin, max + margin, ticks)
    }

    /// An axis that ends where the values end.
    pub fn tight(values: impl IntoIterator<Item = f64>, ticks: usize) -> Self {
        let (min, max) = widened(extent(values));
        Self::over(min, max, ticks)
    }

    /// A logarithmic axis for the positive ones of the values.
    pub fn logarithmic(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = extent(values.into_iter().filter(|&x| x > 1e-12)).unwrap_or((1.0, 10.0));
        // Less than this is no picture of a change.
        let (min, max) = (low / 1.1, (high * 1.1).max(low * 1.5));
        let decades = || (min.log10().floor() as i32..=max.log10().ceil() as i32).map(|n| 10f64.powi(n));
        let candidates = [&[1.0][..], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]]
            .map(|parts| decades().flat_map(|decade| parts.iter().map(move |part| (part * decade, *part, decade))));
        let inside = candidates.map(|ticks| ticks.filter(|(x, ..)| (min..=max).contains(x)).collect::<Vec<_>>());
        let mut axis = Self { min, max, logarithmic: true, ticks: Vec::new() };
        axis.ticks = match inside.into_iter().find(|ticks| ticks.len() >= 3) {
            Some(ticks) => {
                let step = |part: f64, decade: f64| if part.fract() > 0.0 { decade / 10.0 } else { decade };
                ticks
                    .into_iter()
                    .map(|(x, part, decade)| (axis.position(x), tick_label(x, step(part, decade))))
                    .collect()
            }
            None => axis.even_ticks(3),
        };
        axis
    }

    fn over(min: f64, max: f64, ticks: usize) -> Self {
        let mut axis = Self { min, max, logarithmic: false, ticks: Vec::new() };
        axis.ticks = axis.even_ticks(ticks);
        axis
    }

    /// Ticks at a constant distance.
    fn even_ticks(&self, at_least: usize) -> Vec<(f64, String)> {
        let (first, last, step) = multiples(self.min, self.max, at_least);
        let values = (0..=(last - first) as u32).map(|n| (first + f64::from(n)) * step);
        values.map(|x| (self.position(x), tick_label(x, step))).collect()
    }

    /// Where a value lies, 0 … 1 within the range.
    pub fn position(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.min).ln() / (self.max / self.min).ln()
        } else {
            (value - self.min) / (self.max - self.min)
        }
    }

    /// Whether a value can be drawn on this axis.
    pub fn contains(&self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }
}

/// A range that has a width: none becomes 0 … 1, a single value gets room on both sides.
fn widened(range: Option<(f64, f64)>) -> (f64, f64) {
    let (min, max) = range.unwrap_or((0.0, 1.0));
    let size = min.abs().max(max.abs());
    if max - min > 1e-6 * size {
        (min, max)
    } else {
        let margin = if size > 0.0 { size / 2.0 } else { 1.0 };
        (min - margin, max + margin)
    }
}

/// The largest of 1, 2, 5 times a power of ten of which at least `count` multiples lie in the range: the first and last
/// multiple, and it.
fn multiples(min: f64, max: f64, count: usize) -> (f64, f64, f64) {
    let decade = 10f64.powf((max - min).log10().ceil());
    let within = |step: f64| ((min / step - 1e-9).ceil(), (max / step + 1e-9).floor(), step);
    let steps = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].map(|part| within(part * decade));
    let enough = |(first, last, _): &(f64, f64, f64)| last - first + 1.0 >= count as f64;
    // The finest has at least nine.
    steps.into_iter().find(enough).unwrap_or(steps[6])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(&Axis::linear([-20.0, 20.0], 4)), ["−20", "−10", "0", "10", "20"]);
        assert_eq!(labels(&Axis::tight([0.0, 2.0], 4)), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(labels(&Axis::linear([-0.36, 0.35], 2)), ["−0.4", "−0.2", "0.0", "0.2"]);
        assert_eq!(labels(&Axis::logarithmic([0.1, 3.0])), ["0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(labels(&Axis::logarithmic([0.01, 1.0])), ["0.01", "0.1", "1"]);
        assert_eq!(labels(&Axis::logarithmic([0.12, 0.125])), ["0.12", "0.14", "0.16", "0.18"]);
    }

    #[test]
    fn any_values_make_a_finite_axis() {
        let cases: [&[f64]; 8] = [
            &[],
            &[0.0],
            &[-3.0, -3.0],
            &[1.0, 1.0 + 1e-15],
            &[f64::NAN, f64::INFINITY],
            &[f64::MAX, f64::MIN],
            &[f64::MIN_POSITIVE, 1.0],
            &[1e-300, 2e-300],
        ];
        for values in cases {
            let make: [fn(Vec<f64>) -> Axis; 3] =
                [|v| Axis::linear(v, 4), |v| Axis::tight(v, 4), |v| Axis::logarithmic(v)];
            for axis in make.map(|make| make(values.to_vec())) {
                assert!(axis.ticks.len() < 20, "{values:?} {axis:?}");
                assert!(axis.ticks.iter().all(|(at, _)| (-1e-6..=1.000_001).contains(at)), "{values:?} {axis:?}");
            }
        }
    }
}
