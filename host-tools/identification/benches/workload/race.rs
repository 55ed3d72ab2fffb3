//! Kernels side by side: each takes its turn in every round, so that a machine that is busy for a while slows all of them.

use std::hint::black_box;
use std::time::Instant;

/// Rounds that the whole is cut into.
pub const ROUNDS: usize = 8;

/// Something that costs a generation of candidates.
pub struct Kernel<'a> {
    /// What it is.
    pub name: &'static str,
    /// Threads that it runs on.
    pub threads: usize,
    /// Costs one generation, µm.
    pub costs: Box<dyn Fn() -> Vec<f64> + 'a>,
}

/// How fast a kernel was.
pub struct Speed {
    /// Sample-evaluations a second, the middle one of all rounds.
    pub per_s: f64,
    /// Of the first kernel's in the same round, the middle one of all rounds.
    pub ratio: f64,
}

/// Runs so many generations of so many sample-evaluations on each kernel.
pub fn run(kernels: &[Kernel<'_>], generations: usize, of_each: usize) -> Vec<Speed> {
    let share = generations.div_ceil(ROUNDS);
    let mut rounds: Vec<Vec<f64>> = vec![Vec::new(); kernels.len()];
    for _ in 0..ROUNDS {
        for (kernel, speeds) in kernels.iter().zip(&mut rounds) {
            let start = Instant::now();
            (0..share).for_each(|_| {
                black_box((kernel.costs)());
            });
            speeds.push((share * of_each) as f64 / start.elapsed().as_secs_f64());
        }
    }
    let first = rounds.first().cloned().unwrap_or_default();
    let speed = |speeds: Vec<f64>| Speed {
        ratio: middle(speeds.iter().zip(&first).map(|(speed, first)| speed / first).collect()),
        per_s: middle(speeds),
    };
    rounds.into_iter().map(speed).collect()
}

/// The middle one of some numbers.
pub fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
