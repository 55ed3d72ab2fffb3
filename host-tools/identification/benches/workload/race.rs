//! Kernels side by side: each costs one generation in its turn, so that a machine that is busy for a while slows all of
//! them. What counts is each one's quickest generation: other programs can only slow it.

use std::hint::black_box;
use std::time::Instant;

/// Something that costs a generation of candidates.
pub struct Kernel<'a> {
    /// What it is.
    pub name: &'static str,
    /// Threads that it runs on.
    pub threads: usize,
    /// By what part of itself a cost may differ from the first kernel's.
    pub bound: f64,
    /// Costs one generation, µm.
    pub costs: Box<dyn Fn() -> Vec<f64> + 'a>,
}

/// How fast a kernel was.
pub struct Speed {
    /// Sample-evaluations a second, in the quickest generation.
    pub per_s: f64,
    /// Of the first kernel's.
    pub ratio: f64,
}

/// Runs so many generations of so many sample-evaluations on each kernel.
pub fn run(kernels: &[Kernel<'_>], generations: usize, of_each: usize) -> Vec<Speed> {
    let mut best = vec![0.0_f64; kernels.len()];
    for _ in 0..generations {
        for (kernel, best) in kernels.iter().zip(&mut best) {
            let start = Instant::now();
            black_box((kernel.costs)());
            *best = best.max(of_each as f64 / start.elapsed().as_secs_f64());
        }
    }
    let first = best.first().copied().unwrap_or(f64::NAN);
    best.into_iter().map(|per_s| Speed { per_s, ratio: per_s / first }).collect()
}
