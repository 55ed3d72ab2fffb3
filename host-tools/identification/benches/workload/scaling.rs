//! How the engine's time grows with the samples, with the population, and with the threads.

use crate::report::{Point, Scaling};
use crate::thesis::{self, LENGTH_S, POPULATION};
use identification::Problem;
use identification::cost::Feedback;
use identification::family::voigt::Kernel;
use rayon::ThreadPool;
use std::hint::black_box;
use std::time::Instant;

/// Times of one generation that the shortest is taken of.
const TIMES: usize = 25;

/// Seconds of a generation of this many candidates.
fn generation_s(problem: &Problem, population: usize, pool: &ThreadPool) -> f64 {
    let kernel = Kernel::new(problem, Feedback::Simulation.into());
    let (candidates, _) = thesis::candidates(problem, population);
    let once = || {
        let start = Instant::now();
        black_box(kernel.costs(black_box(&candidates)));
        start.elapsed().as_secs_f64()
    };
    pool.install(|| (0..TIMES).map(|_| once()).fold(f64::INFINITY, f64::min))
}

/// Sizes with the seconds of a generation of each, and the slope of the one over the other, both as logarithms.
fn grown(of: &'static str, points: &[(usize, f64)]) -> Scaling {
    let logarithms = points.iter().map(|&(size, seconds)| ((size as f64).ln(), seconds.ln()));
    let count = points.len() as f64;
    let (x, y) = logarithms.clone().fold((0.0, 0.0), |(x, y), (size, seconds)| (x + size / count, y + seconds / count));
    let (xx, xy) = logarithms
        .fold((0.0, 0.0), |(xx, xy), (size, seconds)| (xx + (size - x) * (size - x), xy + (size - x) * (seconds - y)));
    let points = points.iter().map(|&(size, seconds)| Point { size, seconds }).collect();
    Scaling { of, points, slope: xy / xx }
}

/// The three tables: samples and population on one thread, and pools of threads.
pub fn measure(pools: &[ThreadPool]) -> Vec<Scaling> {
    let one = &pools[0];
    let samples = [0.5, 1.0, 4.0, 16.0].map(|times| {
        let problem = thesis::problem(times * LENGTH_S);
        (thesis::samples(&problem), generation_s(&problem, POPULATION, one))
    });
    let problem = thesis::problem(LENGTH_S);
    let population = [1, 4, 16].map(|times| (times * POPULATION, generation_s(&problem, times * POPULATION, one)));
    let threads: Vec<(usize, f64)> =
        pools.iter().map(|pool| (pool.current_num_threads(), generation_s(&problem, 4 * POPULATION, pool))).collect();
    let mut tables = vec![grown("samples of all logs", &samples), grown("candidates", &population)];
    if threads.len() > 1 {
        tables.push(grown("threads", &threads));
    }
    tables
}
