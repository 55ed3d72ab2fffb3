//! The gains of an interval's parts, and the factor that makes it cover 95 %.
//!
//! ```text
//! x = max(0, |e| − memory),   σ² = Σ (a_i·part_i)²      a by maximum likelihood of x/σ as Student's t, recordings weighing alike
//! q = 95 % quantile of x/σ                             recordings weighing alike
//! ```

use crate::trial::{PARTS, Recording};
use minimisation::{Budget, Gene, Optimiser, each, minimise};

/// Degrees of freedom.
const FREEDOM: f64 = 4.0;
/// What is to be covered.
const COVERED: f64 = 0.95;
const EVALUATIONS: usize = 600;

/// Gains of misfit, rate, moved plays, displacement gone and drift, times the factor.
pub fn gains(recordings: &[Recording]) -> [f64; PARTS] {
    let genes = [(1e-4, 0.03), (1e-3, 10.0), (0.1, 1e3), (1e-5, 0.1), (1e-6, 0.03)]
        .map(|(min, max)| Gene::logarithmic("", "", "", min, max));
    let gains = |at: &[f64]| -> [f64; PARTS] { std::array::from_fn(|i| genes[i].value(at[i])) };
    let cost = |at: &[f64]| {
        let gains = gains(at);
        recordings.iter().map(|recording| unlikely(recording, &gains)).sum::<f64>()
    };
    let budget = Budget { evaluations: EVALUATIONS, seed: 1 };
    let best = minimise(Optimiser::CmaEs, genes.len(), budget, &[vec![0.5; PARTS]], &each(cost), &mut |_, _| ());
    let found = gains(&best.at);
    let factor = quantile(recordings, &found);
    found.map(|gain| factor * gain)
}

/// Minus the mean logarithm of the likelihood, but for a constant.
fn unlikely(recording: &Recording, gains: &[f64; PARTS]) -> f64 {
    let of = recording.iter().map(|sample| {
        let sigma = deviation(&sample.parts, gains);
        let x = beyond(sample.error, sample.memory) / sigma;
        libm::log(sigma) + 0.5 * (FREEDOM + 1.0) * libm::log1p(x * x / FREEDOM)
    });
    of.sum::<f64>() / recording.len().max(1) as f64
}

fn beyond(error: f64, memory: f64) -> f64 {
    (error - memory).max(0.0)
}

fn deviation(parts: &[f64; PARTS], gains: &[f64; PARTS]) -> f64 {
    let square = |(part, gain): (&f64, &f64)| (part * gain) * (part * gain);
    parts.iter().zip(gains).map(square).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)
}

fn quantile(recordings: &[Recording], gains: &[f64; PARTS]) -> f64 {
    let mut ratios: Vec<(f64, f64)> = Vec::new();
    for recording in recordings {
        let weight = 1.0 / recording.len().max(1) as f64;
        let ratio =
            |sample: &crate::trial::Sample| beyond(sample.error, sample.memory) / deviation(&sample.parts, gains);
        ratios.extend(recording.iter().map(|sample| (ratio(sample), weight)));
    }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = COVERED * recordings.len() as f64;
    let mut sum = 0.0;
    let reached = ratios.iter().find(|(_, weight)| {
        sum += weight;
        sum >= wanted
    });
    reached.or(ratios.last()).map_or(1.0, |(ratio, _)| *ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sample;

    /// Errors that grow with one part alone, 19 of 20 within 2 of it.
    #[test]
    fn what_the_errors_go_with_is_found() {
        let sample = |k: u32| {
            let moved = 0.1 * f64::from(k % 7 + 1);
            let error = if k.is_multiple_of(20) { 2.5 * moved } else { 2.0 * moved * f64::from(k % 20) / 19.0 };
            Sample { error: error + 0.3, memory: 0.3, parts: [1.0, 1.0, moved, 1.0, 1.0] }
        };
        let recordings: Vec<Recording> = (0..10).map(|n| (0..140).map(|k| sample(k + n)).collect()).collect();
        let gains = gains(&recordings);
        assert!((1.8..2.3).contains(&gains[2]), "{gains:?}");
        let others = gains[0].max(gains[1]).max(gains[3]).max(gains[4]);
        assert!(others < 0.1, "{gains:?}");
        let within =
            recordings.iter().flatten().filter(|of| of.error - of.memory <= 1.001 * deviation(&of.parts, &gains));
        let covered = within.count() as f64 / 1400.0;
        assert!((0.945..0.99).contains(&covered), "{covered}");
    }
}
