//! Whether two models differ on recordings that both have estimated: a paired bootstrap over recordings and,
//! within each, over blocks (H. R. Künsch, *The jackknife and the bootstrap for general stationary
//! observations*, Ann. Statist. 17, 1989): errors of neighbouring instants are nearly one number, so that blocks
//! are drawn and not instants.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// Blocks of a recording.
pub const BLOCKS: usize = 20;
/// Resamplings of the blocks.
const DRAWS: usize = 2_000;
/// Outside of the middle 95 % of them 0 must lie.
const TAIL: f64 = 0.025;

/// Mean absolute errors (µm) of a recording's blocks.
pub fn blocks(errors: &[f64]) -> Vec<f64> {
    let mean = |block: &[f64]| block.iter().map(|error| error.abs()).sum::<f64>() / block.len() as f64;
    errors.chunks(errors.len().div_ceil(BLOCKS).max(1)).map(mean).collect()
}

/// Whether the mean differences of two models' errors, a row of blocks a recording, are not 0 by the 95 % of their
/// resamplings. Rows stand for the same recordings in both.
pub fn differ(one: &[&[f64]], other: &[&[f64]]) -> bool {
    let differences: Vec<Vec<f64>> =
        one.iter().zip(other).map(|(a, b)| a.iter().zip(*b).map(|(a, b)| a - b).collect()).collect();
    let recordings: Vec<&Vec<f64>> = differences.iter().filter(|blocks| !blocks.is_empty()).collect();
    if recordings.is_empty() {
        return false;
    }
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut draw = |count: usize| {
        // At least one, so that the range is not empty.
        Uniform::new(0, count.max(1)).map_or(0, |range| range.sample(&mut random))
    };
    let mut means: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let of_recordings = (0..recordings.len()).map(|_| {
                let blocks = recordings[draw(recordings.len())];
                (0..blocks.len()).map(|_| blocks[draw(blocks.len())]).sum::<f64>() / blocks.len() as f64
            });
            of_recordings.sum::<f64>() / recordings.len() as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let outside = (TAIL * DRAWS as f64) as usize;
    means[outside] > 0.0 || means[DRAWS - 1 - outside] < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(level: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let range = Uniform::new(-0.02, 0.02).unwrap();
        (0..BLOCKS).map(|_| level + range.sample(&mut random)).collect()
    }

    #[test]
    fn what_differs_is_told_from_what_does_not() {
        let recordings =
            |levels: [f64; 3], seed| levels.into_iter().zip(seed..).map(|(level, seed)| noisy(level, seed));
        let one: Vec<Vec<f64>> = recordings([0.10, 0.11, 0.10], 1).collect();
        let same: Vec<Vec<f64>> = recordings([0.10, 0.11, 0.10], 4).collect();
        let worse: Vec<Vec<f64>> = recordings([0.14, 0.15, 0.14], 7).collect();
        let [one, same, worse] = [&one, &same, &worse].map(|of| of.iter().map(Vec::as_slice).collect::<Vec<_>>());
        assert!(!differ(&one, &same) && differ(&one, &worse) && differ(&worse, &one));
    }

    #[test]
    fn one_recording_that_is_far_off_does_not_make_a_difference_of_many() {
        let (even, off) = (vec![0.1; BLOCKS], vec![1.0; BLOCKS]);
        let one: Vec<&[f64]> = vec![&even; 6];
        let mut other = one.clone();
        other[0] = &off;
        assert!(!differ(&one, &other));
        assert!(!differ(&[], &[]));
    }

    #[test]
    fn blocks_are_means_of_sizes() {
        assert_eq!(blocks(&[1.0; 40]), [1.0; BLOCKS]);
        assert_eq!(blocks(&[-2.0, 2.0]), [2.0, 2.0]);
        assert!(blocks(&[]).is_empty());
    }
}
