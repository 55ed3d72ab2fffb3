//! Noise of a series, as what its fourth differences scatter: a slow course has next to none of them.

/// Most differences that are kept; at more, every second goes.
const MOST: usize = 1 << 16;
/// Coefficients of the fourth difference; white noise of deviation 1 gives it the root of the sum of their squares.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
/// A normal distribution's median of absolute values, in standard deviations.
const MEDIAN: f64 = 0.674_489_75;

/// The differences so far.
#[derive(Default)]
pub(crate) struct Noise {
    last: [f64; 5],
    rows: u64,
    every: u32,
    kept: Vec<f64>,
}

impl Noise {
    pub fn add(&mut self, value: f64) {
        self.last.rotate_left(1);
        self.last[4] = value;
        self.rows += 1;
        if self.rows >= 5 && self.rows.is_multiple_of(1 << self.every) {
            let difference: f64 = self.last.iter().zip(FOURTH).map(|(value, factor)| value * factor).sum();
            self.kept.push(difference.abs());
        }
        if self.kept.len() >= MOST {
            let mut index = 0;
            self.kept.retain(|_| {
                index += 1;
                index % 2 == 0
            });
            self.every += 1;
        }
    }

    /// One standard deviation, of the middle half of the differences: outliers do not count.
    pub fn deviation(&self) -> f64 {
        let mut kept = self.kept.clone();
        if kept.is_empty() {
            return 0.0;
        }
        let middle = kept.len() / 2;
        let median = *kept.select_nth_unstable_by(middle, f64::total_cmp).1;
        median / MEDIAN / FOURTH.iter().map(|factor| factor * factor).sum::<f64>().sqrt()
    }
}
