//! The step in which plants are computed, and what every kind of hysteresis answers to one.

/// Internal step, s.
pub const STEP_S: f64 = 1e-4;

/// A hysteresis operator from normalised voltage (1 at full voltage) to normalised strain, virgin and at rest at 0.
pub(crate) trait Hysteresis: Send {
    /// The strain after a step of so many s to a voltage.
    fn step(&mut self, u: f64, seconds: f64) -> f64;
}
