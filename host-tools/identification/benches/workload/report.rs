//! What was measured, for machines as JSON and for people as text.

use identification::cost::Feedback;
use serde::Serialize;
use std::fmt;

/// Everything of one run.
#[derive(Serialize)]
pub struct Report {
    /// What each kernel did.
    pub workload: Workload,
    /// The widest vector instructions that the machine has.
    pub instructions: &'static str,
    /// The kernels side by side, for each cost.
    pub costs: Vec<Race>,
    /// How the engine's time grows.
    pub scaling: Vec<Scaling>,
}

/// What each kernel did, in numbers.
#[derive(Serialize)]
pub struct Workload {
    /// Candidates of a generation.
    pub candidates: usize,
    /// Generations that were run.
    pub generations: usize,
    /// Logs that are fitted to.
    pub logs: usize,
    /// Samples of all logs together.
    pub samples: usize,
    /// Parameters of a candidate.
    pub parameters: usize,
    /// Samples times candidates times generations.
    pub sample_evaluations: usize,
}

/// The kernels by one cost.
#[derive(Serialize)]
pub struct Race {
    /// The cost that they compute.
    pub cost: Feedback,
    /// The plain loop first.
    pub kernels: Vec<Row>,
}

/// How one kernel did.
#[derive(Serialize)]
pub struct Row {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Threads that it ran on.
    pub threads: usize,
    /// In its quickest generation.
    pub sample_evaluations_per_s: f64,
    /// Times as fast as the plain loop.
    pub of_the_plain_loop: f64,
    /// By what part of itself its cost of a candidate differs from the plain loop's.
    pub cost_off_by_at_most: f64,
}

/// How the time of a generation grows with something.
#[derive(Serialize)]
pub struct Scaling {
    /// Name of what grows.
    pub of: &'static str,
    /// From the smallest to the largest.
    pub points: Vec<Point>,
    /// Of the logarithm of the time over that of the size.
    pub slope: f64,
}

/// The time of a generation of some size.
#[derive(Serialize)]
pub struct Point {
    /// How much there was of what grows.
    pub size: usize,
    /// Seconds that the quickest generation took.
    pub seconds: f64,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Workload { candidates, generations, logs, samples, parameters, sample_evaluations } = &self.workload;
        let (millions, instructions) = (1e-6 * *sample_evaluations as f64, self.instructions);
        writeln!(
            f,
            "{candidates} candidates × {generations} generations × {samples} samples of {logs} logs = {millions:.0} million \
             sample-evaluations, {parameters} parameters; {instructions}"
        )?;
        self.costs.iter().try_for_each(|race| write!(f, "\n{race}"))?;
        self.scaling.iter().try_for_each(|scaling| write!(f, "\n{scaling}"))
    }
}

impl fmt::Display for Race {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cost = format!("{:?}", self.cost);
        writeln!(f, "{cost:34}{:>8}{:>16}{:>16}{:>14}", "threads", "million/s", "of plain loop", "cost off by")?;
        self.kernels.iter().try_for_each(|row| {
            let Row { kernel, threads, sample_evaluations_per_s, of_the_plain_loop, cost_off_by_at_most } = row;
            let millions = 1e-6 * sample_evaluations_per_s;
            writeln!(f, "{kernel:34}{threads:>8}{millions:>16.1}{of_the_plain_loop:>16.2}{cost_off_by_at_most:>14.1e}")
        })
    }
}

impl fmt::Display for Scaling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:34}{:>24}", self.of, "ms a generation")?;
        self.points.iter().try_for_each(|Point { size, seconds }| writeln!(f, "{size:<34}{:>24.2}", 1e3 * seconds))?;
        writeln!(f, "{:<34}{:>24.2}", "slope", self.slope)
    }
}
