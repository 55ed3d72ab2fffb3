//! Mains hum: what a sensor's or a monitor's cable picks up, and no actuator's motion.

use crate::noise::noise_of;
use crate::signal::range;
use serde::Serialize;
use std::f64::consts::TAU;

/// Frequencies of the mains and what a rectifier makes of them, Hz.
const MAINS: [u32; 4] = [50, 60, 100, 120];
/// Lines are looked for at whole Hz from here; below is what a drive and its harmonics leave.
const LOWEST: u32 = 10;
/// The highest, of the readings' frequency.
const HIGHEST: f64 = 0.45;
/// Readings of so many seconds are transformed at once, so that mains that are 0.2 Hz off still add up.
const BLOCK_S: f64 = 1.0;
/// Blocks that are transformed at least, and at most.
const BLOCKS: [usize; 2] = [5, 60];
/// A block is whole where no more of its readings than this part are missing.
const MISSING: f64 = 0.02;
/// The window's line is this many Hz wide to either side, and what stands up to
const WIDE: u32 = 2;
/// so many Hz beside it is what it has to be
const BESIDE: u32 = 6;
/// so many times as strong as, in power.
const ABOVE: f64 = 16.0;
/// Least part of the mean square that a hum is worth mentioning at, %.
const WORTH: f64 = 10.0;

/// A line of the readings is none of the voltage's where it has so many times the power of that.
const UNEXPLAINED: f64 = 4.0;

/// A voltage is driven at a frequency that has this part of its mean square; harmonics are looked at up to this one.
const DRIVEN: f64 = 0.01;
const FRACTIONS: u32 = 15;

/// A hum in what a model leaves of a log.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Hum {
    /// Its frequency, Hz.
    pub hertz: u32,
    /// Its amplitude, µm.
    pub amplitude_um: f64,
    /// What it is of the error's mean square, %.
    pub percent: f64,
}

/// A hum in what a sensor read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HumRead {
    /// Its frequency, Hz.
    pub hertz: u32,
    /// Its amplitude, µm.
    pub amplitude_um: f64,
}

/// The hum in the errors (µm) of a log's readings at these times (s) and voltages (V): a line at a frequency of the
/// mains that stands out from what is beside it, and than which no other from 10 Hz on is stronger, in more than half
/// of the log. Where the voltage is driven at that frequency, or at a whole fraction of it, it is the model's own.
pub fn hum(times_s: &[f64], voltage: &[f64], errors_um: &[f64]) -> Option<Hum> {
    let (driven, errors) = lines(times_s, voltage, errors_um)?;
    let mean_square = median(&errors.blocks, |block| block.mean_square);
    errors.mains().filter(|&hertz| errors.stands_out(hertz)).find_map(|hertz| {
        let power = errors.at(hertz);
        let others =
            (LOWEST..=errors.highest).filter(|other| !other.is_multiple_of(hertz) && other.abs_diff(hertz) > WIDE);
        let strongest = others.map(|hertz| errors.at(hertz)).fold(0.0, f64::max);
        let percent = 100.0 * power / mean_square;
        let fractions = (1..=FRACTIONS).filter(|of| hertz.is_multiple_of(*of)).map(|of| f64::from(hertz / of));
        let found = power > strongest && percent > WORTH && !driven.drives(fractions);
        found.then(|| Hum { hertz, amplitude_um: (2.0 * power).sqrt(), percent })
    })
}

/// The hum in the readings (µm) themselves, at these times (s) and voltages (V): a line at a frequency of the mains
/// that stands out from what is beside it, of more than the readings' noise, and that the voltage does not have.
pub fn hum_read(times_s: &[f64], voltage: &[f64], read_um: &[f64]) -> Option<HumRead> {
    let (driven, read) = lines(times_s, voltage, read_um)?;
    let (volts, noise_um) = (range(voltage), noise_of(read_um)?);
    let um_per_v = if volts > 0.0 { range(read_um) / volts } else { 0.0 };
    read.mains().filter(|&hertz| read.stands_out(hertz)).find_map(|hertz| {
        let (power, of_voltage) = (read.at(hertz), um_per_v * um_per_v * driven.at(hertz));
        let amplitude_um = (2.0 * power).sqrt();
        // A harmonic beside it looks like it.
        let fractions = (1..=FRACTIONS).map(|of| f64::from(hertz) / f64::from(of));
        let found = power > UNEXPLAINED * of_voltage && amplitude_um > noise_um && !driven.drives(fractions);
        found.then_some(HumRead { hertz, amplitude_um })
    })
}

/// The lines of a log's voltages and of some of its readings; `None` where no frequency of the mains can be seen.
fn lines<'a>(times_s: &'a [f64], voltage: &[f64], readings: &[f64]) -> Option<(Lines<'a>, Lines<'a>)> {
    let count = times_s.len().min(readings.len());
    let period = (times_s.get(count.checked_sub(1)?)? - times_s[0]) / (count.max(2) - 1) as f64;
    if !(period.is_finite() && period > 0.0) {
        return None;
    }
    let highest = (HIGHEST / period).min(f64::from(MAINS[3] + BESIDE)) as u32;
    let of = |values: &[f64]| Lines {
        blocks: blocks(times_s, values, (BLOCK_S / period).round() as usize, period),
        highest,
    };
    (MAINS[0] + BESIDE <= highest).then(|| (of(voltage), of(readings)))
}

/// The parts of a series at whole frequencies.
struct Lines<'a> {
    blocks: Vec<Block<'a>>,
    /// The highest frequency, Hz.
    highest: u32,
}

impl Lines<'_> {
    /// Frequencies of the mains that can be seen, Hz.
    fn mains(&self) -> impl Iterator<Item = u32> {
        let highest = self.highest;
        MAINS.into_iter().filter(move |hertz| hertz + BESIDE <= highest)
    }

    /// The mean square of the part at a frequency, in more than half of the blocks.
    fn at(&self, hertz: u32) -> f64 {
        self.near(hertz.into())
    }

    fn near(&self, hertz: f64) -> f64 {
        median(&self.blocks, |block| block.power(hertz))
    }

    /// Whether there is a line at this frequency, and not at one beside it.
    fn stands_out(&self, hertz: u32) -> bool {
        let beside = (WIDE + 1..=BESIDE).flat_map(|by| [hertz - by, hertz + by]).map(|hertz| self.at(hertz));
        let power = self.at(hertz);
        power > ABOVE * beside.fold(0.0, f64::max) && [hertz - 1, hertz + 1].iter().all(|next| self.at(*next) <= power)
    }

    /// Whether much of a voltage is within a Hz of one of these frequencies.
    fn drives(&self, mut hertz: impl Iterator<Item = f64>) -> bool {
        let mean_square = median(&self.blocks, |block| block.mean_square);
        hertz.any(|hertz| self.near(hertz) > DRIVEN * mean_square)
    }
}

/// Readings of a second without a gap, their mean taken away, under Hann's window.
struct Block<'a> {
    times_s: &'a [f64],
    windowed: Vec<f64>,
    /// Of the values about their mean.
    mean_square: f64,
}

impl Block<'_> {
    /// The mean square of the part at a frequency.
    fn power(&self, hertz: f64) -> f64 {
        let (cos, sin) = self.times_s.iter().zip(&self.windowed).fold((0.0, 0.0), |(cos, sin), (time, value)| {
            let (s, c) = (TAU * hertz * (time - self.times_s[0])).sin_cos();
            (cos + value * c, sin + value * s)
        });
        // Half of the amplitude's square; the mean of the window is a half.
        2.0 * (cos * cos + sin * sin) / (0.5 * self.windowed.len() as f64).powi(2)
    }
}

/// Blocks of so many readings, evenly over the log; none where there are too few.
fn blocks<'a>(times_s: &'a [f64], values: &[f64], readings: usize, period: f64) -> Vec<Block<'a>> {
    let whole = |times: &[f64]| {
        let long = times[times.len() - 1] - times[0];
        long <= (1.0 + MISSING) * (times.len() - 1) as f64 * period
    };
    let pairs = times_s.chunks_exact(readings).zip(values.chunks_exact(readings));
    let all: Vec<_> = pairs.filter(|(times, _)| whole(times)).collect();
    if all.len() < BLOCKS[0] {
        return Vec::new();
    }
    let every = all.len().div_ceil(BLOCKS[1]);
    let block = |(times_s, values): (&'a [f64], &[f64])| {
        let mean = values.iter().sum::<f64>() / readings as f64;
        let about = || values.iter().map(move |value| value - mean);
        let hann = |at: usize| 0.5 - 0.5 * (TAU * at as f64 / readings as f64).cos();
        Block {
            times_s,
            windowed: about().enumerate().map(|(at, value)| hann(at) * value).collect(),
            mean_square: about().map(|value| value * value).sum::<f64>() / readings as f64,
        }
    };
    all.into_iter().step_by(every).map(block).collect()
}

/// The median of what is asked of each block; 0 of none.
fn median(blocks: &[Block<'_>], of: impl Fn(&Block<'_>) -> f64) -> f64 {
    let mut all: Vec<f64> = blocks.iter().map(of).collect();
    let middle = all.len() / 2;
    if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// Ten seconds of noise of 1 nm at a rate, and a sum of sines (Hz, µm).
    fn recorded(hertz: f64, sines: &[(f64, f64)]) -> (Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let times: Vec<f64> = (0..(10.0 * hertz) as u32).map(|index| f64::from(index) / hertz).collect();
        let error = |time: &f64| {
            let noise: f64 = StandardNormal.sample(&mut random);
            1e-3 * noise + sines.iter().map(|(hertz, um)| um * (TAU * hertz * time + 1.0).sin()).sum::<f64>()
        };
        let errors = times.iter().map(error).collect();
        (times, errors)
    }

    /// Of a drive of 1 Hz.
    fn found(hertz: f64, sines: &[(f64, f64)]) -> Option<Hum> {
        found_at(1.0, hertz, sines)
    }

    fn found_at(drive_hz: f64, hertz: f64, sines: &[(f64, f64)]) -> Option<Hum> {
        let (times, errors) = recorded(hertz, sines);
        hum(&times, &driven(&times, drive_hz), &errors)
    }

    fn driven(times: &[f64], hertz: f64) -> Vec<f64> {
        times.iter().map(|time| 20.0 * (TAU * hertz * time).sin()).collect()
    }

    #[test]
    fn a_hum_is_found_at_its_frequency_with_its_amplitude() {
        for hertz in [49.8, 50.0, 60.1, 100.0] {
            let hum = found(1000.0, &[(1.0, 0.002), (hertz, 0.003)]).unwrap();
            assert_eq!(f64::from(hum.hertz), hertz.round());
            assert!((hum.amplitude_um - 0.003).abs() < 2e-4, "{hum:?}");
            // Of 4.5 beside 1 of the noise and 2 of the slow error.
            assert!((hum.percent - 60.0).abs() < 6.0, "{hum:?}");
        }
        let both = found(1000.0, &[(50.0, 0.003), (100.0, 0.004)]).unwrap();
        assert_eq!(both.hertz, 50, "the mains, and what a rectifier makes of it");
    }

    #[test]
    fn neither_noise_nor_a_drive_s_harmonics_nor_what_cannot_be_seen_is_a_hum() {
        assert_eq!(found(1000.0, &[]), None);
        for drive in [1.0, 2.0, 5.0, 10.0, 20.0, 25.0] {
            let odd: Vec<(f64, f64)> = (0..10).map(|k| f64::from(2 * k + 1)).map(|k| (k * drive, 0.02 / k)).collect();
            let all: Vec<(f64, f64)> = (1..20).map(f64::from).map(|k| (k * drive, 0.02 / k)).collect();
            assert_eq!((found_at(drive, 1000.0, &odd), found_at(drive, 1000.0, &all)), (None, None), "{drive} Hz");
        }
        assert_eq!(found_at(50.0, 1000.0, &[(50.0, 0.02), (150.0, 0.007)]), None, "a drive of 50 Hz");
        assert_eq!(found_at(20.0, 1000.0, &[(20.0, 0.005), (60.0, 0.02)]), None, "its third harmonic");
        assert_eq!(found(1000.0, &[(50.0, 0.003), (37.0, 0.004)]), None, "another line is stronger");
        assert_eq!(found(1000.0, &[(1.0, 0.05), (50.0, 0.003)]), None, "a little of the error");
        assert_eq!(found(100.0, &[(50.0, 0.003)]), None, "too near half the readings' frequency");
        let (times, errors) = recorded(1000.0, &[(50.0, 0.003)]);
        assert!(hum(&times[..4500], &driven(&times, 1.0), &errors[..4500]).is_none(), "too short");
        assert_eq!(hum(&[], &[], &[]), None);
        assert_eq!(hum(&[0.0], &[0.0], &[0.0]), None);
    }

    #[test]
    fn a_hum_that_the_voltage_does_not_have_is_seen_in_the_readings() {
        let read = |volts_at_mains: f64, drive: f64| {
            let (times, picked_up) = recorded(1000.0, &[(50.0, 0.03)]);
            let volts = |(time, volt): (&f64, f64)| volt + volts_at_mains * (TAU * 50.0 * time).sin();
            let voltage: Vec<f64> = times.iter().zip(driven(&times, drive)).map(volts).collect();
            let read: Vec<f64> = voltage.iter().zip(&picked_up).map(|(volt, um)| 0.1 * volt + um).collect();
            hum_read(&times, &voltage, &read)
        };
        let hum = read(0.0, 1.0).unwrap();
        assert_eq!(hum.hertz, 50);
        assert!((hum.amplitude_um - 0.03).abs() < 2e-3, "{hum:?}");
        assert_eq!(read(1.0, 1.0), None, "the voltage has three times as much there");
        assert_eq!(read(0.0, 10.0), None, "it may be a drive's harmonic");
        for drive in [5.0, 7.0, 8.0, 12.5, 16.7, 17.0, 33.3] {
            let harmonics: Vec<(f64, f64)> = (1..=15).map(f64::from).map(|k| (k * drive, 0.5 / k)).collect();
            let (times, read) = recorded(1000.0, &harmonics);
            assert_eq!(hum_read(&times, &driven(&times, drive), &read), None, "{drive} Hz");
        }
        let (times, held) = recorded(1000.0, &[(50.0, 0.03)]);
        assert_eq!(hum_read(&times, &vec![20.0; times.len()], &held).map(|hum| hum.hertz), Some(50), "at rest");
        let (times, small) = recorded(1000.0, &[(50.0, 5e-4)]);
        assert_eq!(hum_read(&times, &driven(&times, 1.0), &small), None, "less than the noise");
        assert_eq!(hum_read(&[f64::NAN; 9], &[0.0; 9], &[0.0; 9]), None, "a clock that is none");
        let (times, quiet) = recorded(1000.0, &[]);
        assert_eq!(hum_read(&times, &driven(&times, 1.0), &quiet), None);
    }

    #[test]
    fn gaps_leave_blocks_out() {
        let (times, errors) = recorded(1000.0, &[(50.0, 0.003)]);
        let kept = |at: usize| !(at / 1000).is_multiple_of(4) || at % 1000 < 500;
        let of = |values: Vec<f64>| {
            values.into_iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, x)| x).collect::<Vec<_>>()
        };
        let hum = hum(&of(times.clone()), &of(driven(&times, 1.0)), &of(errors)).unwrap();
        assert_eq!(hum.hertz, 50);
    }
}
