//! The gains of an interval's parts, by which it covers 95 % both where the training was and elsewhere.
//!
//! ```text
//! x = max(0, |e| − memory),   σ² = Σ (a_i·part_i)²      a by maximum likelihood of x/σ as Student's t, recordings weighing alike
//! w² = own² + f²·Σ' (a_i·part_i)² + g²·(a·moved)²      Σ' over the parts but the moved plays
//! ```
//!
//! One factor for all would be too wide on voltages as the training's and too narrow on others. So there are two: f makes
//! x ≤ w for 95 % of the time on recordings with the training's voltages, g on the others. They are found in turn. The likelihood
//! weighs the parts, and a quantile of devices of several classes decides how wide they are.

use crate::trial::{MOVED, PARTS, Recording, Sample};
use minimisation::{Budget, Gene, Optimiser, each, minimise};

/// Degrees of freedom.
const FREEDOM: f64 = 4.0;
/// What is to be covered.
const COVERED: f64 = 0.95;
const EVALUATIONS: usize = 600;
/// Rounds in which the two factors are found; each halves the logarithm of what is missing.
const ROUNDS: usize = 30;
/// Neither factor is so many times the one that would cover all recordings, nor its inverse.
const APART: f64 = 3.0;

/// Gains of misfit, rate, moved plays, displacement gone and drift, times their factors.
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
    factored(recordings, gains(&best.at))
}

/// The gains times factors by which the half-width covers the recordings.
fn factored(recordings: &[Recording], gains: [f64; PARTS]) -> [f64; PARTS] {
    let squares = |sample: &Sample| {
        let square = |part: usize| (gains[part] * sample.parts[part]) * (gains[part] * sample.parts[part]);
        let always = (0..PARTS).filter(|part| *part != MOVED).map(square).sum::<f64>();
        (always.max(f64::MIN_POSITIVE), square(MOVED).max(f64::MIN_POSITIVE))
    };
    // Square of what is off beyond the memory of the start and the device's own logs.
    let left = |recording: &Recording, sample: &Sample| {
        let beyond = beyond(sample.error, sample.memory);
        beyond * beyond - recording.own_um * recording.own_um
    };
    let all = |_: &Recording| true;
    let common = quantile(recordings, all, |recording, sample| {
        let (always, moved) = squares(sample);
        left(recording, sample) / (always + moved)
    });
    // Without a recording, or where the devices' own logs account for all, the parts stay as likely as they are.
    let Some(common) = common.filter(|common| *common > 0.0) else { return gains };
    let within = |factor: f64| factor.clamp(common / APART, common * APART);
    let (mut f, mut g) = (common, common);
    for _ in 0..ROUNDS {
        let trained = quantile(
            recordings,
            |of| of.as_trained,
            |recording, sample| {
                let (always, moved) = squares(sample);
                (left(recording, sample) - g * g * moved) / always
            },
        );
        f = trained.map_or(f, |wanted| (f * within(wanted)).sqrt());
        let elsewhere = quantile(
            recordings,
            |of| !of.as_trained,
            |recording, sample| {
                let (always, moved) = squares(sample);
                (left(recording, sample) - f * f * always) / moved
            },
        );
        g = elsewhere.map_or(g, |wanted| (g * within(wanted)).sqrt());
    }
    // Where the factors end at their bounds, all together are covered still.
    let missing = quantile(recordings, all, |recording, sample| {
        let (always, moved) = squares(sample);
        left(recording, sample) / (f * f * always + g * g * moved)
    });
    let more = missing.unwrap_or(1.0).max(1.0);
    std::array::from_fn(|part| more * if part == MOVED { g } else { f } * gains[part])
}

/// Minus the mean logarithm of the likelihood, but for a constant.
fn unlikely(recording: &Recording, gains: &[f64; PARTS]) -> f64 {
    let of = recording.samples.iter().map(|sample| {
        let sigma = deviation(&sample.parts, gains);
        let x = beyond(sample.error, sample.memory) / sigma;
        libm::log(sigma) + 0.5 * (FREEDOM + 1.0) * libm::log1p(x * x / FREEDOM)
    });
    of.sum::<f64>() / recording.samples.len().max(1) as f64
}

fn beyond(error: f64, memory: f64) -> f64 {
    (error - memory).max(0.0)
}

fn deviation(parts: &[f64; PARTS], gains: &[f64; PARTS]) -> f64 {
    let square = |(part, gain): (&f64, &f64)| (part * gain) * (part * gain);
    parts.iter().zip(gains).map(square).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)
}

/// The root of the 95 % quantile of the squares of the recordings that are `wanted`, which weigh alike; 0 where it is negative,
/// and `None` where there are none.
fn quantile(
    recordings: &[Recording],
    wanted: impl Fn(&Recording) -> bool,
    square: impl Fn(&Recording, &Sample) -> f64,
) -> Option<f64> {
    let mut squares: Vec<(f64, f64)> = Vec::new();
    let mut weights = 0.0;
    for recording in recordings.iter().filter(|recording| wanted(recording) && !recording.samples.is_empty()) {
        let weight = 1.0 / recording.samples.len() as f64;
        squares.extend(recording.samples.iter().map(|sample| (square(recording, sample), weight)));
        weights += 1.0;
    }
    squares.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let reached = squares.iter().find(|(_, weight)| {
        sum += weight;
        sum >= COVERED * weights
    });
    reached.or(squares.last()).map(|(square, _)| square.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sample;

    /// Recordings whose half-width depends on one part alone, 19 of 20 errors within 2 of it.
    fn of_one_part(part: usize, as_trained: bool, own_um: f64) -> Vec<Recording> {
        let sample = |k: u32| {
            let size = 0.1 * f64::from(k % 7 + 1);
            let beyond = if k.is_multiple_of(20) { 2.5 * size } else { 2.0 * size * f64::from(k % 20) / 19.0 };
            let mut parts = [1e-3; PARTS];
            parts[part] = size;
            Sample { error: beyond.hypot(own_um) + 0.3, memory: 0.3, parts }
        };
        let recording = |n: u32| Recording { as_trained, own_um, samples: (0..140).map(|k| sample(k + n)).collect() };
        (0..10).map(recording).collect()
    }

    fn covered(recordings: &[Recording], gains: &[f64; PARTS]) -> f64 {
        let within = recordings.iter().flat_map(|recording| {
            let half = move |sample: &Sample| deviation(&sample.parts, gains).hypot(recording.own_um);
            recording.samples.iter().map(move |sample| sample.error - sample.memory <= 1.001 * half(sample))
        });
        let within: Vec<bool> = within.collect();
        within.iter().filter(|within| **within).count() as f64 / within.len() as f64
    }

    #[test]
    fn what_the_errors_go_with_is_found() {
        let recordings = of_one_part(MOVED, false, 0.0);
        let gains = gains(&recordings);
        assert!((1.8..2.3).contains(&gains[MOVED]), "{gains:?}");
        let covered = covered(&recordings, &gains);
        assert!((0.945..0.99).contains(&covered), "{covered}");
    }

    #[test]
    fn what_own_logs_account_for_is_not_counted_again() {
        let recordings = of_one_part(MOVED, false, 0.5);
        let gains = factored(&recordings, [1.0; PARTS]);
        assert!((1.8..2.2).contains(&gains[MOVED]), "{gains:?}");
        let covered = covered(&recordings, &gains);
        assert!((0.945..0.99).contains(&covered), "{covered}");
    }

    /// Elsewhere a device is off by twice as many times the moved plays as where the training was by its misfit.
    #[test]
    fn both_the_training_s_voltages_and_others_are_covered_and_neither_more() {
        let (trained, elsewhere) = (of_one_part(0, true, 0.1), of_one_part(MOVED, false, 0.1));
        let gains = factored(&[trained.clone(), elsewhere.clone()].concat(), [1.0, 1.0, 0.5, 1.0, 1.0]);
        for (which, recordings) in [("trained", trained), ("elsewhere", elsewhere)] {
            let covered = covered(&recordings, &gains);
            assert!((0.94..0.99).contains(&covered), "{which}: {covered}, {gains:?}");
        }
    }

    #[test]
    fn errors_that_moved_plays_do_not_explain_are_covered_still() {
        let mut recordings = of_one_part(0, true, 0.1);
        recordings.extend(of_one_part(1, false, 0.1));
        // Elsewhere the misfit is all that there is, and it is too little.
        recordings.iter_mut().flat_map(|of| &mut of.samples).for_each(|sample| sample.parts[1] = 1e-3);
        let gains = factored(&recordings, [1.0; PARTS]);
        assert!(covered(&recordings, &gains) >= 0.95, "{gains:?}");
    }

    #[test]
    fn without_recordings_gains_stay_as_they_are() {
        assert_eq!(factored(&[], [2.0; PARTS]), [2.0; PARTS]);
    }
}
