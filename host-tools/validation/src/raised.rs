//! How often an estimator raised each of its status bits.

use estimator_core::Status;

/// A status bit, and how often it was raised from a log's beginning on.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Raised {
    /// What was raised: one bit of the status.
    pub bit: Status,
    /// At how many of the measured instants, %.
    pub percent: f64,
    /// When first, s since the log's first sample.
    pub first_s: f64,
}

/// The bits of a run's statuses, the first instant of each at a time, s.
pub fn raised(statuses: &[Status], time_s: impl Fn(usize) -> f64) -> Vec<Raised> {
    let of = |bit: Status| {
        let first = statuses.iter().position(|status| status.contains(bit))?;
        let count = statuses.iter().filter(|status| status.contains(bit)).count();
        Some(Raised { bit, percent: 100.0 * count as f64 / statuses.len() as f64, first_s: time_s(first) })
    };
    Status::all().iter().filter_map(of).collect()
}
