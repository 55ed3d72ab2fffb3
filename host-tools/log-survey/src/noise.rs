//! Noise of a series, as what its sixth differences scatter: a slow course has next to none of them, and of a fast one
//! that is smooth, as a sine is, they are told by the twelfth.

/// Most differences of an order that are kept of a stream; at more, every second goes.
const MOST: usize = 1 << 16;
/// Coefficients of the sixth difference. It takes 99.9 % off a sine of 100 Hz that is sampled at 2 kHz. The sixth of
/// the sixth is the twelfth: a sine of eight samples a period adds as little to that as one of twenty to the sixth.
const SIXTH: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
const ORDER: usize = SIXTH.len();
/// Variances that the sixth and the twelfth have of white noise of deviation 1: their coefficients' squares, summed.
const OF_SIXTH: f64 = 924.0;
const OF_TWELFTH: f64 = 2_704_156.0;
/// In these units white noise has the same deviation by both, and noise that was averaged, or filtered by up to the
/// third order, by the twelfth from a quarter as much to about as much; where that is less, the sixth have the course.
/// So a course of eight samples a period or more may make the noise four times as large as it is, and more only where
/// the noise is less than some 1e-4 of its amplitude; what a steeper filter leaves is stated too small.
const COURSE: f64 = 0.25;
/// Fewest twelfth differences that are believed.
const FEWEST: usize = 50;
/// A normal distribution's median of absolute values, in standard deviations.
const MEDIAN: f64 = 0.674_489_75;

/// One standard deviation of the noise of readings that were taken evenly in time, in their unit: by the median of
/// their sixth differences, or of their twelfth where the sixth still have the course; `None` of too few.
pub fn noise_of(read: &[f64]) -> Option<f64> {
    let sixth: Vec<f64> = read.windows(ORDER).map(difference).collect();
    let twelfth = sixth.windows(ORDER).map(difference).collect();
    of_differences(sixth, twelfth)
}

fn difference(window: &[f64]) -> f64 {
    window.iter().zip(SIXTH).map(|(value, factor)| value * factor).sum()
}

fn of_differences(sixth: Vec<f64>, twelfth: Vec<f64>) -> Option<f64> {
    let believed = twelfth.len() >= FEWEST;
    let sixth = deviation(sixth, OF_SIXTH)?;
    let twelfth = believed.then(|| deviation(twelfth, OF_TWELFTH)).flatten();
    Some(twelfth.filter(|twelfth| *twelfth < COURSE * sixth).unwrap_or(sixth))
}

/// The standard deviation of white noise whose differences, of this variance for a deviation of 1, have this median
/// size: outliers do not count. `None` of none.
fn deviation(mut differences: Vec<f64>, variance: f64) -> Option<f64> {
    let middle = differences.len() / 2;
    (!differences.is_empty()).then(|| {
        let by_size = |a: &f64, b: &f64| a.abs().total_cmp(&b.abs());
        let median = differences.select_nth_unstable_by(middle, by_size).1.abs();
        median / MEDIAN / variance.sqrt()
    })
}

/// The differences of a stream so far.
#[derive(Default)]
pub(crate) struct Noise {
    /// The last values, and the last sixth differences.
    last: [f64; ORDER],
    last_sixth: [f64; ORDER],
    rows: usize,
    every: u32,
    sixth: Vec<f64>,
    twelfth: Vec<f64>,
}

impl Noise {
    pub fn add(&mut self, value: f64) {
        push(&mut self.last, value);
        push(&mut self.last_sixth, difference(&self.last));
        self.rows += 1;
        if !self.rows.is_multiple_of(1 << self.every) {
            return;
        }
        if self.rows >= ORDER {
            self.sixth.push(self.last_sixth[ORDER - 1]);
        }
        if self.rows >= 2 * ORDER - 1 {
            self.twelfth.push(difference(&self.last_sixth));
        }
        if self.sixth.len() >= MOST {
            for kept in [&mut self.sixth, &mut self.twelfth] {
                let mut index = 0;
                kept.retain(|_| {
                    index += 1;
                    index % 2 == 0
                });
            }
            self.every += 1;
        }
    }

    /// One standard deviation; 0 of too few.
    pub fn deviation(&self) -> f64 {
        of_differences(self.sixth.clone(), self.twelfth.clone()).unwrap_or(0.0)
    }
}

fn push(last: &mut [f64; ORDER], value: f64) {
    last.rotate_left(1);
    last[ORDER - 1] = value;
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use std::f64::consts::TAU;

    /// 4000 readings of a sine of ±20 with so many samples a period, read with noise.
    fn sine(samples: f64, noise: f64) -> Vec<f64> {
        let mut draw = ChaCha8Rng::seed_from_u64(3);
        let noise = Normal::new(0.0, noise).unwrap();
        (0..4000).map(|k| 20.0 * libm::sin(TAU * f64::from(k) / samples) + noise.sample(&mut draw)).collect()
    }

    fn streamed(read: &[f64]) -> f64 {
        let mut noise = Noise::default();
        read.iter().for_each(|&value| noise.add(value));
        noise.deviation()
    }

    #[test]
    fn a_fast_course_is_not_taken_for_noise() {
        for (samples, most) in
            [(400.0, 1.15), (20.3, 1.15), (18.0, 4.2), (16.0, 4.2), (15.1, 4.2), (10.1, 1.15), (8.3, 1.15)]
        {
            let read = sine(samples, 1e-3);
            let found = noise_of(&read).unwrap();
            assert!((0.85..most).contains(&(found / 1e-3)), "{samples} samples a period: {found}");
            assert_eq!(streamed(&read), found);
        }
        assert_eq!((noise_of(&[0.0; 6]), streamed(&[1.0; 6])), (None, 0.0));
    }

    #[test]
    fn what_was_averaged_is_noise_all_the_same() {
        let averaged: Vec<f64> = sine(400.0, 0.05).windows(4).map(|of| of.iter().sum::<f64>() / 4.0).collect();
        let sixth = averaged.windows(ORDER).map(difference).collect();
        assert_eq!(noise_of(&averaged), deviation(sixth, OF_SIXTH));
    }

    /// Of more readings than are kept every second difference, or every fourth.
    #[test]
    fn a_long_stream_has_the_noise_of_its_readings() {
        let readings: Vec<f64> = (0..80).flat_map(|_| sine(20.3, 1e-3)).collect();
        let (found, whole) = (streamed(&readings), noise_of(&readings).unwrap());
        assert!((found / whole - 1.0).abs() < 0.02, "{found} of {whole}");
    }
}
