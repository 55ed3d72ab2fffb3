//! Bringing samples to the tick.
//!
//! A log faster than the tick loses samples: every n-th stays (the thesis took every fifth), or the mean of
//! each n. Where the rates are no multiples, what stays is interpolated linearly. A log slower than the tick
//! keeps as many displacements as it has, each brought to the nearest tick, and has its voltage at every tick;
//! both are interpolated linearly.

use serde::{Deserialize, Serialize};

/// How a log faster than the tick is reduced.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decimation {
    /// The sample at each tick: every n-th, or between two where the rates are no multiples. Tables called the latter
    /// `interpolate`.
    #[serde(alias = "interpolate")]
    Every,
    /// The mean of each n samples; the rates must be multiples.
    Average,
}

/// Samples at the tick.
pub struct AtTick {
    /// Voltage at every tick.
    pub voltage: Vec<f64>,
    /// Ticks of the displacements.
    pub instants: Vec<u32>,
    /// Displacements at those ticks, µm.
    pub displacement: Vec<f64>,
}

/// `ratio` is the log's sample period over the tick. `None` when the log is faster than the tick by no whole number, of
/// which there is no mean.
pub fn to_tick(voltage: &[f64], displacement: &[f64], ratio: f64, decimation: Decimation) -> Option<AtTick> {
    let rows = voltage.len();
    // Half a sample of drift over the whole log is what "a multiple" may hide.
    let close = 0.5 / rows as f64;
    if ratio > 1.0 - close {
        return Some(slower(voltage, displacement, ratio));
    }
    let every = |voltage, displacement: Vec<f64>| AtTick {
        voltage,
        instants: (0..displacement.len() as u32).collect(),
        displacement,
    };
    let n = (1.0 / ratio).round();
    if (n * ratio - 1.0).abs() > close {
        let ticks = ((rows - 1) as f64 * ratio) as usize;
        let at = |samples: &[f64]| (0..=ticks).map(|tick| interpolated(samples, tick as f64 / ratio)).collect();
        return (decimation == Decimation::Every).then(|| every(at(voltage), at(displacement)));
    }
    let n = n as usize;
    let reduced = |samples: &[f64]| -> Vec<f64> {
        match decimation {
            Decimation::Average => samples.chunks_exact(n).map(|chunk| chunk.iter().sum::<f64>() / n as f64).collect(),
            Decimation::Every => samples.iter().step_by(n).copied().collect(),
        }
    };
    Some(every(reduced(voltage), reduced(displacement)))
}

fn slower(voltage: &[f64], displacement: &[f64], ratio: f64) -> AtTick {
    let instants: Vec<u32> = (0..displacement.len()).map(|row| (row as f64 * ratio).round() as u32).collect();
    let last = instants.last().copied().unwrap_or(0);
    AtTick {
        voltage: (0..=last).map(|tick| interpolated(voltage, f64::from(tick) / ratio)).collect(),
        displacement: instants.iter().map(|&tick| interpolated(displacement, f64::from(tick) / ratio)).collect(),
        instants,
    }
}

/// Linear interpolation at a fractional row, limited to the first and last.
fn interpolated(samples: &[f64], row: f64) -> f64 {
    let last = samples.len() - 1;
    let left = (row as usize).min(last);
    let right = (left + 1).min(last);
    let weight = (row - left as f64).clamp(0.0, 1.0);
    samples[left] + weight * (samples[right] - samples[left])
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    fn ramp(rows: u32) -> Vec<f64> {
        (0..rows).map(f64::from).collect()
    }

    #[test]
    fn every_fifth_sample_or_the_mean_of_five() {
        let rows = ramp(23);
        let every = to_tick(&rows, &rows, 0.2, Decimation::Every).unwrap();
        assert_eq!(every.displacement, [0.0, 5.0, 10.0, 15.0, 20.0]);
        let average = to_tick(&rows, &rows, 0.2, Decimation::Average).unwrap();
        assert_eq!(average.voltage, [2.0, 7.0, 12.0, 17.0]);
        assert_eq!(average.instants, [0, 1, 2, 3]);
    }

    #[test]
    fn odd_rates_are_interpolated_and_have_no_mean() {
        let rows = ramp(100);
        assert!(to_tick(&rows, &rows, 2.0 / 3.0, Decimation::Average).is_none());
        let at_tick = to_tick(&rows, &rows, 2.0 / 3.0, Decimation::Every).unwrap();
        assert_eq!(at_tick.displacement.len(), 67);
        assert!((at_tick.displacement[2] - 3.0).abs() < 1e-12 && (at_tick.voltage[1] - 1.5).abs() < 1e-12);
    }

    #[test]
    fn both_columns_of_a_slower_log_are_those_of_the_same_tick() {
        let rows = ramp(100);
        for ratio in [1.953, 2.0, 10.0, 2.5] {
            let at_tick = to_tick(&rows, &rows, ratio, Decimation::Every).unwrap();
            assert_eq!(at_tick.displacement.len(), 100);
            for (&instant, displacement) in at_tick.instants.iter().zip(&at_tick.displacement) {
                assert!((at_tick.voltage[instant as usize] - displacement).abs() < 1e-9, "{ratio}: tick {instant}");
            }
        }
    }

    #[test]
    fn a_table_that_says_interpolate_is_read() {
        let named = |name: &'static str| {
            let name: StrDeserializer<'_, Error> = name.into_deserializer();
            Decimation::deserialize(name)
        };
        assert_eq!(named("interpolate"), Ok(Decimation::Every));
        assert!(named("some").is_err());
    }

    #[test]
    fn a_sample_rate_a_little_off_is_still_a_multiple() {
        let rows = ramp(1000);
        assert_eq!(to_tick(&rows, &rows, 1.0 + 1e-5, Decimation::Every).unwrap().instants.len(), 1000);
        assert_eq!(to_tick(&rows, &rows, 1.0 - 1e-5, Decimation::Every).unwrap().instants.len(), 1000);
        assert_eq!(to_tick(&rows, &rows, 0.200_001, Decimation::Every).unwrap().instants.len(), 200);
    }
}
