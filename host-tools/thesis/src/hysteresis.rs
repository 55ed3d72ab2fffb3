//! What a loop measures: amplitude (V), frequency (Hz), stroke (µm), hysteresis width (% of the stroke).
//!
//! The width is the largest distance of the falling from the rising branch at the same voltage, between 5 and 95 % of
//! the swing, each branch averaged over all periods whose swing is at least 90 % of the log's. A branch of many samples
//! is first averaged in stretches, so that the sensor's noise does not widen the loop.

use report::turns;
use serde::Serialize;

/// Measures of a log's loop.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Loop {
    /// Half the voltage's span, V.
    pub amplitude_v: f64,
    /// Of the voltage, from its reversals, Hz; `None` with fewer than two.
    pub frequency_hz: Option<f64>,
    /// Span of the displacement, µm.
    pub stroke_um: f64,
    /// Largest width, % of the stroke; `None` without a whole period.
    pub width_percent: Option<f64>,
}

/// Stretches that a branch is averaged in, at most.
const STRETCHES: usize = 64;
/// Voltages at which branches are compared.
const LEVELS: usize = 31;
/// A branch must have this fraction of the whole swing.
const WHOLE: f64 = 0.9;
/// This fraction of the swing is left out at either end.
const ENDS: f64 = 0.05;

impl Loop {
    /// Measures a log.
    pub fn of(time_s: &[f64], voltage: &[f64], displacement: &[f64]) -> Self {
        let turns = turns(voltage);
        let frequency_hz = turns.first().zip(turns.last()).and_then(|(first, last)| {
            let seconds = time_s.get(*last)? - time_s.get(*first)?;
            (seconds > 0.0).then(|| (turns.len() - 1) as f64 / (2.0 * seconds))
        });
        let (low, high) = ends(voltage);
        let (least, most) = ends(displacement);
        let stroke_um = most - least;
        let width = width(&turns, voltage, displacement, low, high);
        Self {
            amplitude_v: 0.5 * (high - low),
            frequency_hz,
            stroke_um,
            width_percent: width.filter(|_| stroke_um > 0.0).map(|width| 100.0 * width / stroke_um),
        }
    }
}

/// Smallest and largest.
fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
}

fn width(turns: &[usize], voltage: &[f64], displacement: &[f64], low: f64, high: f64) -> Option<f64> {
    let (mut rising, mut falling) = (Mean::new(), Mean::new());
    for pair in turns.windows(2) {
        let &[from, to] = pair else { continue };
        let (Some(v), Some(y)) = (voltage.get(from..=to), displacement.get(from..=to)) else { continue };
        let (start, end) = (*v.first()?, *v.last()?);
        if (end - start).abs() < WHOLE * (high - low) {
            continue;
        }
        let branch = averaged(v, y);
        if end > start { rising.add(&branch, low, high) } else { falling.add(&branch, low, high) }
    }
    let distances = rising.levels().zip(falling.levels()).filter_map(|(up, down)| Some((down? - up?).abs()));
    distances.reduce(f64::max)
}

/// A branch in no more than [`STRETCHES`] points, its ends kept.
fn averaged(voltage: &[f64], displacement: &[f64]) -> Vec<(f64, f64)> {
    let of_each = voltage.len().div_ceil(STRETCHES).max(1);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    voltage.chunks(of_each).zip(displacement.chunks(of_each)).map(|(v, y)| (mean(v), mean(y))).collect()
}

/// Mean displacement of some branches at each level of the voltage.
struct Mean {
    sums: [f64; LEVELS],
    counts: [u32; LEVELS],
}

impl Mean {
    fn new() -> Self {
        Self { sums: [0.0; LEVELS], counts: [0; LEVELS] }
    }

    fn add(&mut self, branch: &[(f64, f64)], low: f64, high: f64) {
        for (level, (sum, count)) in self.sums.iter_mut().zip(&mut self.counts).enumerate() {
            let part = ENDS + (1.0 - 2.0 * ENDS) * level as f64 / (LEVELS - 1) as f64;
            if let Some(y) = interpolated(branch, low + part * (high - low)) {
                *sum += y;
                *count += 1;
            }
        }
    }

    fn levels(&self) -> impl Iterator<Item = Option<f64>> {
        self.sums.iter().zip(&self.counts).map(|(sum, &count)| (count > 0).then(|| sum / f64::from(count)))
    }
}

/// The displacement at a voltage where a branch first crosses it.
fn interpolated(branch: &[(f64, f64)], voltage: f64) -> Option<f64> {
    let crosses = |pair: &&[(f64, f64)]| match pair {
        [(a, _), (b, _)] => (a - voltage) * (b - voltage) <= 0.0 && a != b,
        _ => false,
    };
    match branch.windows(2).find(crosses)? {
        [(a, from), (b, to)] => Some(from + (to - from) * (voltage - a) / (b - a)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// An ellipse: displacement late by an angle, with noise.
    fn ellipse(hertz: f64, late: f64, noise: f64) -> Loop {
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * 5e-4).collect();
        let voltage: Vec<f64> = time.iter().map(|t| 20.0 * (TAU * hertz * t).sin()).collect();
        let shaken = |k: usize| noise * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let y: Vec<f64> =
            time.iter().enumerate().map(|(k, t)| 4.0 * (TAU * hertz * t - late).sin() + shaken(k)).collect();
        Loop::of(&time, &voltage, &y)
    }

    #[test]
    fn an_ellipse_is_twice_the_sine_of_its_angle_wide() {
        for (hertz, late) in [(1.0, 0.1), (10.0, 0.2), (50.0, 0.0)] {
            let measured = ellipse(hertz, late, 0.0);
            assert!((measured.amplitude_v - 20.0).abs() < 0.2 && (measured.stroke_um - 8.0).abs() < 0.1);
            assert!((measured.frequency_hz.unwrap() / hertz - 1.0).abs() < 1e-2, "{measured:?}");
            let width = measured.width_percent.unwrap();
            assert!((width - 100.0 * late.sin()).abs() < 1.0, "{width} at {hertz} Hz");
        }
    }

    #[test]
    fn noise_does_not_widen_a_loop_of_many_samples() {
        let (still, shaken) = (ellipse(1.0, 0.1, 0.0), ellipse(1.0, 0.1, 0.05));
        assert!((still.width_percent.unwrap() - shaken.width_percent.unwrap()).abs() < 0.5, "{shaken:?}");
    }

    #[test]
    fn a_ramp_has_no_loop() {
        let ramp: Vec<f64> = (0..100).map(f64::from).collect();
        let measured = Loop::of(&ramp, &ramp, &ramp);
        assert_eq!((measured.frequency_hz, measured.width_percent), (None, None));
    }
}
