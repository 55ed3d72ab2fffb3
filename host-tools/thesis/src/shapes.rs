//! Trajectories that the rig is driven along.

use std::f64::consts::TAU;

/// A trajectory: its name and its value at a time in s, −1 … 1 of half the training stroke about its middle.
pub type Shape = (&'static str, fn(f64) -> f64);

/// Those that no model has been identified on.
pub const SHAPES: [Shape; 6] = [
    ("sine 1 Hz", |t| 0.7 * libm::sin(TAU * t)),
    ("sine 10 Hz", |t| 0.7 * libm::sin(TAU * 10.0 * t)),
    ("sine 50 Hz", |t| 0.4 * libm::sin(TAU * 50.0 * t)),
    ("triangle 5 Hz", |t| 0.7 * triangle(5.0 * t)),
    ("staircase", staircase),
    ("shrinking 5 Hz", |t| 0.8 * (1.0 - 0.45 * t) * libm::sin(TAU * 5.0 * t)),
];

/// −1 … 1, period 1, from 0 upwards.
fn triangle(phase: f64) -> f64 {
    let phase = (phase + 0.25).fract();
    1.0 - 4.0 * (phase - 0.5).abs()
}

/// Steps of a fifth of a second, up and down, each taken in 10 ms.
fn staircase(t: f64) -> f64 {
    const LEVELS: [f64; 11] = [0.0, 0.3, 0.6, 0.2, -0.4, -0.7, -0.1, 0.5, 0.1, -0.3, 0.0];
    let step = (t / 0.2).floor();
    let level = |index: f64| LEVELS.get(index as usize).copied().unwrap_or(0.0);
    let (from, to) = (level(step - 1.0), level(step));
    let part = ((t - 0.2 * step) / 0.01).clamp(0.0, 1.0);
    from + (to - from) * 0.5 * (1.0 - libm::cos(TAU * 0.5 * part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_stay_within_the_stroke_and_do_not_jump() {
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(triangle), [0.0, 1.0, 0.0, -1.0, 0.0]);
        for (name, shape) in SHAPES {
            let values: Vec<f64> = (0..4000).map(|k| shape(f64::from(k) * 5e-4)).collect();
            assert!(values.iter().all(|value| value.abs() <= 0.81), "{name}");
            assert!(values.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.08), "{name}");
        }
    }
}
