//! What is asked of the preparation, and how what is left to the logs becomes a number.
//!
//! Zeros, from the training logs only. The models are at rest at (0 V, 0 µm), so:
//!
//! - voltage: 0 where the logs' swing includes it or comes within 2 % of it, else the middle of the swing;
//! - displacement: the mean sensor reading while the voltage passes or touches its zero, rising and falling passes
//!   weighing the same. A sensor's zero is arbitrary; the model's is where the voltage's is.

use super::recipe::Recipe;
use super::resample::Decimation;
use crate::log::Log;
use std::borrow::{Borrow, Cow};

/// A number, or what the logs say.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum AutoOr {
    /// To be found from the training logs.
    Auto,
    /// The value that was given.
    Given(f64),
}

/// How logs are prepared.
#[derive(Clone, PartialEq, Debug)]
pub struct PrepareOptions {
    /// Tick, µs; 500 is the thesis's 2 kHz.
    pub tick_us: u32,
    /// Factor on the recorded voltage, e.g. the amplifier's gain where its input was recorded.
    pub voltage_scale: f64,
    /// Factor on the recorded displacement.
    pub displacement_scale: f64,
    /// Voltage (V, scaled) that the model calls 0, or where it is left to the logs: 0 where the logs reach it, else the
    /// middle of their swing.
    pub voltage_zero: AutoOr,
    /// Displacement (µm, scaled) that the model calls 0, or where it is left to the logs: where the sensor stands when
    /// the voltage is at its zero.
    pub displacement_zero: AutoOr,
    /// How much later the sensor shows a displacement than it happens, ms, or what the logs tell from a lag.
    pub delay: AutoOr,
    /// Largest delay that is taken where it is to be found, ms: what the sensor can have.
    pub max_delay: f64,
    /// Cut off the start of each log, s (a start-up transient).
    pub skip_start: f64,
    /// Cut off the end of each log, s.
    pub skip_end: f64,
    /// What becomes of a log faster than the tick.
    pub decimate: Decimation,
}

impl Default for PrepareOptions {
    /// A tick of 500 µs, the thesis's 2 kHz; zeros from the logs; nothing else done.
    fn default() -> Self {
        Self {
            tick_us: 500,
            voltage_scale: 1.0,
            displacement_scale: 1.0,
            voltage_zero: AutoOr::Auto,
            displacement_zero: AutoOr::Auto,
            delay: AutoOr::Given(0.0),
            max_delay: 5.0,
            skip_start: 0.0,
            skip_end: 0.0,
            decimate: Decimation::Every,
        }
    }
}

impl PrepareOptions {
    /// The log without what `skip_start` and `skip_end` take.
    pub fn cut<'l>(&self, log: &'l Log) -> Cow<'l, Log> {
        log.trimmed(self.skip_start, self.skip_end)
    }

    /// The recipe for these training logs, cut by [`PrepareOptions::cut`]. A delay to be found is 0 in it.
    pub fn resolve(&self, logs: &[impl Borrow<Log>]) -> Recipe {
        let logs: Vec<&Log> = logs.iter().map(Borrow::borrow).collect();
        let mut recipe = Recipe {
            voltage_scale: self.voltage_scale,
            displacement_scale: self.displacement_scale,
            voltage_zero_v: 0.0,
            displacement_zero_um: 0.0,
            skip_start_s: self.skip_start,
            skip_end_s: self.skip_end,
            decimation: self.decimate,
            ..Recipe::at_tick(self.tick_us)
        };
        if let AutoOr::Given(ms) = self.delay {
            recipe.delay_ticks = recipe.ticks_of(ms);
        }
        let scaled = |samples: &[f64], scale: f64| -> Vec<f64> { samples.iter().map(|x| x * scale).collect() };
        let voltages: Vec<_> = logs.iter().map(|log| scaled(&log.voltage, self.voltage_scale)).collect();
        let displacements: Vec<_> =
            logs.iter().filter_map(|log| Some(scaled(log.displacement.as_ref()?, self.displacement_scale))).collect();
        recipe.voltage_zero_v = match self.voltage_zero {
            AutoOr::Given(v) => v,
            AutoOr::Auto => {
                let (middle, half) = middle(&voltages);
                if middle.abs() <= (1.0 + 2.0 * TOUCHES) * half { 0.0 } else { middle }
            }
        };
        recipe.displacement_zero_um = match self.displacement_zero {
            AutoOr::Given(y) => y,
            AutoOr::Auto => mean_at_zero(&voltages, &displacements, recipe.voltage_zero_v)
                .unwrap_or_else(|| middle(&displacements).0),
        };
        recipe
    }
}

/// A swing touches zero when it comes this close, as a fraction of the swing.
const TOUCHES: f64 = 0.02;

/// Middle and half width of the values.
fn middle(logs: &[Vec<f64>]) -> (f64, f64) {
    let values = || logs.iter().flatten().copied();
    let (min, max) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if min <= max { ((max + min) / 2.0, (max - min) / 2.0) } else { (0.0, 0.0) }
}

/// Mean displacement where the voltage crosses `zero`, rising and falling crossings weighing the same; where it only
/// touches it, the displacement at `zero` of a straight line through the samples within reach.
fn mean_at_zero(voltages: &[Vec<f64>], displacements: &[Vec<f64>], zero: f64) -> Option<f64> {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    for (voltage, displacement) in voltages.iter().zip(displacements) {
        for (v, y) in voltage.windows(2).zip(displacement.windows(2)) {
            let (before, after) = (v[0] - zero, v[1] - zero);
            if (before < 0.0) == (after < 0.0) {
                continue;
            }
            let crossing = y[0] + (y[1] - y[0]) * before / (before - after);
            if after > before { rising.push(crossing) } else { falling.push(crossing) }
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    match (rising.is_empty(), falling.is_empty()) {
        (false, false) => Some((mean(&rising) + mean(&falling)) / 2.0),
        (false, true) => Some(mean(&rising)),
        (true, false) => Some(mean(&falling)),
        (true, true) => {
            let reach = 2.0 * TOUCHES * middle(voltages).1;
            let samples = voltages.iter().flatten().map(|v| v - zero).zip(displacements.iter().flatten().copied());
            line_at_zero(samples.filter(|(v, _)| v.abs() <= reach).collect())
        }
    }
}

/// Where a least-squares line through (x, y) meets x = 0; the mean of y where x does not vary.
fn line_at_zero(samples: Vec<(f64, f64)>) -> Option<f64> {
    let count = samples.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| samples.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|s| s.0), mean(|s| s.1));
    let variance: f64 = samples.iter().map(|s| (s.0 - x) * (s.0 - x)).sum();
    let covariance: f64 = samples.iter().map(|s| (s.0 - x) * (s.1 - y)).sum();
    let slope = if variance > 0.0 { covariance / variance } else { 0.0 };
    (count > 0.0).then_some(y - slope * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two periods of a sine with a loop, offset in voltage and displacement.
    fn log(offset_v: f64, offset_um: f64) -> Log {
        let phase = |k: u32| std::f64::consts::TAU * f64::from(k) / 100.0;
        Log {
            name: "sine".into(),
            path: "sine.csv".into(),
            sha256: String::new(),
            start_s: 0.0,
            sample_period: 5e-4,
            voltage: (0..200).map(|k| offset_v + 2.0 * phase(k).sin()).collect(),
            displacement: Some((0..200).map(|k| offset_um + 10.0 * (phase(k) - 0.2).sin()).collect()),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    #[test]
    fn a_bipolar_log_is_zeroed_where_its_voltage_crosses_0() {
        let recipe = PrepareOptions::default().resolve(&[log(0.0, 1.0)]);
        assert_eq!(recipe.voltage_zero_v, 0.0);
        assert!((recipe.displacement_zero_um - 1.0).abs() < 0.01, "{recipe:?}");
    }

    #[test]
    fn a_log_that_touches_zero_is_zeroed_there() {
        let recipe = PrepareOptions::default().resolve(&[log(2.01, -90.0)]);
        assert_eq!(recipe.voltage_zero_v, 0.0);
        // At its lowest the sine stands 0.01 V above 0 V, and lags: 10·sin(−π/2 − 0.2) − 90, a little below.
        assert!((recipe.displacement_zero_um + 99.85).abs() < 0.05, "{recipe:?}");
    }

    #[test]
    fn the_sensor_s_own_zero_does_not_matter_in_a_unipolar_log() {
        let zeros = [-90.0, 0.0, 10.0, 500.0]
            .map(|um| PrepareOptions::default().resolve(&[log(2.01, um)]).displacement_zero_um - um);
        assert!(zeros.iter().all(|zero| (zero - zeros[0]).abs() < 1e-9), "{zeros:?}");
    }

    #[test]
    fn a_log_far_from_zero_is_zeroed_in_the_middle_of_its_swing() {
        let recipe = PrepareOptions::default().resolve(&[log(60.0, -90.0)]);
        assert!((recipe.voltage_zero_v - 60.0).abs() < 1e-9);
        assert!((recipe.displacement_zero_um + 90.0).abs() < 0.1, "{recipe:?}");
    }

    #[test]
    fn what_is_given_is_taken() {
        let given = PrepareOptions {
            voltage_zero: AutoOr::Given(-1.5),
            displacement_zero: AutoOr::Given(7.0),
            voltage_scale: 10.0,
            delay: AutoOr::Given(2.5),
            ..PrepareOptions::default()
        };
        let recipe = given.resolve(&[log(1.8, -90.0)]);
        assert_eq!((recipe.voltage_zero_v, recipe.displacement_zero_um, recipe.delay_ticks), (-1.5, 7.0, 5));
    }
}
