//! A series of a log: its range, noise and resolution, and how long it stands at its ends.

use serde::Serialize;

use crate::noise::Noise;

/// One series of a log.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Series {
    /// The smallest value that was recorded.
    pub low: f64,
    /// The largest value that was recorded.
    pub high: f64,
    /// Scatter from row to row that no slow course explains, one standard deviation.
    pub noise: f64,
    /// Smallest change from a row to the next that is none.
    pub resolution: f64,
    /// Rows of the longest stretch at the smallest value.
    pub longest_at_low: u64,
    /// Rows of the longest stretch at the largest value.
    pub longest_at_high: u64,
}

/// What is known of a series so far.
#[derive(Default)]
pub(crate) struct SeriesTally {
    last: Option<f64>,
    low: Extreme,
    high: Extreme,
    resolution: Option<f64>,
    noise: Noise,
}

/// A largest value, and how long the series stood there.
#[derive(Default)]
struct Extreme {
    value: Option<f64>,
    run: u64,
    longest: u64,
}

impl Extreme {
    fn add(&mut self, value: f64) {
        match self.value {
            Some(most) if value < most => self.run = 0,
            Some(most) if value == most => self.run += 1,
            _ => (self.value, self.run, self.longest) = (Some(value), 1, 1),
        }
        self.longest = self.longest.max(self.run);
    }
}

impl SeriesTally {
    /// The next value; none (NaN) where a row has none.
    pub fn add(&mut self, value: Option<f64>) {
        let Some(value) = value.filter(|value| !value.is_nan()) else { return };
        self.low.add(-value);
        self.high.add(value);
        let step = self.last.map(|last| (value - last).abs()).filter(|step| *step > 0.0);
        self.resolution = self.resolution.into_iter().chain(step).reduce(f64::min);
        self.noise.add(value);
        self.last = Some(value);
    }

    pub fn result(&self) -> Option<Series> {
        Some(Series {
            low: -self.low.value?,
            high: self.high.value?,
            noise: self.noise.deviation(),
            resolution: self.resolution.unwrap_or(0.0),
            longest_at_low: self.low.longest,
            longest_at_high: self.high.longest,
        })
    }
}
