//! Noise of a series, as what its sixth differences scatter: a slow course has next to none of them, and of a fast one
//! they are told by the twelfth.

/// Most differences of an order that are kept of a stream; at more, every second goes.
const MOST: usize = 1 << 16;
/// Coefficients of the sixth difference. It takes 99.9 % off a sine of 100 Hz that is sampled at 2 kHz, and white noise
/// of deviation 1 gives it the root of the sum of their squares.
const SIXTH: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
/// Those of the twelfth: a sine of eight samples a period adds as little to its white noise as one of twenty to that of
/// the sixth.
const TWELFTH: [f64; 13] = [1.0, -12.0, 66.0, -220.0, 495.0, -792.0, 924.0, -792.0, 495.0, -220.0, 66.0, -12.0, 1.0];
/// White noise gives both the same deviation, and what a converter has averaged gives the twelfth somewhat less; where
/// that has less than this part, the sixth have the course.
const COURSE: f64 = 0.25;
/// Fewest twelfth differences that are believed.
const FEWEST: usize = 50;
/// A normal distribution's median of absolute values, in standard deviations.
const MEDIAN: f64 = 0.674_489_75;

/// One standard deviation of the noise of readings that were taken evenly in time, in their unit: by the median of
/// their sixth differences, or of their twelfth where the sixth still have the course; `None` of too few.
pub fn noise_of(read: &[f64]) -> Option<f64> {
    let sixth = read.windows(SIXTH.len()).map(|window| difference(window, &SIXTH)).collect();
    let twelfth = read.windows(TWELFTH.len()).map(|window| difference(window, &TWELFTH)).collect();
    of_differences(sixth, twelfth)
}

fn difference(window: &[f64], coefficients: &[f64]) -> f64 {
    window.iter().zip(coefficients).map(|(value, factor)| value * factor).sum::<f64>().abs()
}

fn of_differences(sixth: Vec<f64>, twelfth: Vec<f64>) -> Option<f64> {
    let believed = twelfth.len() >= FEWEST;
    let sixth = deviation(sixth, &SIXTH)?;
    let twelfth = believed.then(|| deviation(twelfth, &TWELFTH)).flatten();
    Some(twelfth.filter(|twelfth| *twelfth < COURSE * sixth).unwrap_or(sixth))
}

/// The standard deviation of white noise whose differences have this median: outliers do not count. `None` of none.
fn deviation(mut differences: Vec<f64>, coefficients: &[f64]) -> Option<f64> {
    let middle = differences.len() / 2;
    (!differences.is_empty()).then(|| {
        let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
        median / MEDIAN / coefficients.iter().map(|factor| factor * factor).sum::<f64>().sqrt()
    })
}

/// The differences of a stream so far.
#[derive(Default)]
pub(crate) struct Noise {
    last: [f64; TWELFTH.len()],
    rows: u64,
    every: u32,
    sixth: Vec<f64>,
    twelfth: Vec<f64>,
}

impl Noise {
    pub fn add(&mut self, value: f64) {
        self.last.rotate_left(1);
        self.last[TWELFTH.len() - 1] = value;
        self.rows += 1;
        if !self.rows.is_multiple_of(1 << self.every) {
            return;
        }
        if self.rows >= SIXTH.len() as u64 {
            self.sixth.push(difference(&self.last[TWELFTH.len() - SIXTH.len()..], &SIXTH));
        }
        if self.rows >= TWELFTH.len() as u64 {
            self.twelfth.push(difference(&self.last, &TWELFTH));
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
        for samples in [400.0, 20.3, 10.1, 8.3] {
            let read = sine(samples, 1e-3);
            let found = noise_of(&read).unwrap();
            assert!((found / 1e-3 - 1.0).abs() < 0.15, "{samples} samples a period: {found}");
            assert_eq!(streamed(&read), found);
        }
        assert_eq!((noise_of(&[0.0; 6]), streamed(&[1.0; 6])), (None, 0.0));
    }

    #[test]
    fn what_was_averaged_is_noise_all_the_same() {
        let averaged: Vec<f64> = sine(400.0, 0.05).windows(4).map(|of| of.iter().sum::<f64>() / 4.0).collect();
        let sixth = averaged.windows(SIXTH.len()).map(|window| difference(window, &SIXTH)).collect();
        assert_eq!(noise_of(&averaged), deviation(sixth, &SIXTH));
    }
}
