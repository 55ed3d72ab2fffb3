//! The gains of an interval's parts, of which devices that were simulated say how large they are.
//!
//! ```text
//! w = √( own² + (own/own₀)^2γ · Σ (a_i·part_i)² )     own: what the device's own logs say that it is off by, own₀ its geometric mean over devices;
//!                                                     an own beyond the devices' counts as the nearest of theirs, and (own/nearest)^0.7 more;
//!                                                     below theirs that only where the logs have several amplitudes
//! a, γ: least mean of w + max(0, |e| − w)/0.05         e: error since the displacement was told; recordings weighing alike
//! ```
//!
//! That mean is least where 5 % of the errors are larger, wherever the parts are the same (Gneiting and Raftery's
//! interval score, 2007, eq. 43), so that one kind of recording does not pay for another. The errors that follow one
//! telling of one recording go together, and an average of 95 % is one of recordings that are held all the time and of
//! others that are held for half of it. So all a_i are then scaled, never down, until 95 % of all errors are held, and
//! of what follows a telling nine tenths of the time at least, in nine cases of ten. γ, from 0 to 1, says how much more
//! a device is off elsewhere whose own logs are fitted worse: not at all where they have a single amplitude, about in
//! proportion where they have several. One of several amplitudes that is fitted better than every one of them is made
//! as the model is, and one that is fitted worse is like none of them: either is off elsewhere by less, or more, than
//! they are, about in proportion (but for the memory of its start, which nothing that was fitted has seen). On two
//! Bouc–Wen devices, one of plays and Coleman and Hodgdon's, the ± became 1.2 to 5 times narrower and held at least
//! 99.9 % of the errors, as before; in full proportion one recording was held 85 % of the time. A single amplitude's
//! loop is fitted as well by weights that are wrong at every other amplitude: a device of Rayleigh's loops, learnt to
//! 0.01 % of its stroke from one sine, was held 54 % of the time on random steps.

use crate::told::{PARTS, Recording, Sample};
use estimator_core::Range;
use minimisation::{Budget, Gene, Optimiser, each, minimise};

/// What the score asks for, of all errors.
pub const COVERED: f64 = 0.95;
/// What is to be held of a recording at least, and of how many recordings.
const HELD: f64 = 0.9;
const RECORDINGS: f64 = 0.9;
/// How much better or worse than every device that was tried one may be fitted for its errors to go with that.
const BEYOND: f64 = 10.0;
/// The exponent of that.
const BEYOND_EXPONENT: f64 = 0.7;
/// Of an interval's parts, the memory of the start.
const MEMORY: usize = 1;
/// Evaluations of the score: enough to leave its local minima.
const EVALUATIONS: usize = 5000;

/// A simulated device: what its table is off by on recordings that it was not learnt from.
pub struct Tried {
    /// What its own logs say that it is off by, µm, as a half-width.
    pub own_um: f64,
    /// The errors on each recording, beside the interval's parts.
    pub recordings: Vec<Recording>,
}

/// The factors of a half-width's parts.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    parts: [f64; PARTS],
    /// The exponent γ of `own_um` in the half-width.
    exponent: f64,
    /// From the least to the largest `own_um` of the devices, as natural logarithms.
    own: Range<f64>,
    /// Their mean, as a natural logarithm.
    mean: f64,
    /// How much better than every device one may be fitted for its errors to be smaller, at most.
    better: f64,
}

impl Gains {
    /// The gains of misfit, memory, rate, moved plays, displacement gone and drift that suit the devices that were
    /// tried; of one at least. They and the actuator have logs of a single amplitude, or of `several`.
    pub fn of(tried: &[Tried], several: bool) -> Self {
        let logarithms = || tried.iter().map(|device| libm::log(device.own_um));
        let own = Range::of_values(logarithms());
        let mean = logarithms().sum::<f64>() / tried.len().max(1) as f64;
        let genes = [(1e-4, 0.1), (1e-2, 10.0), (1e-3, 30.0), (0.1, 3e3), (1e-5, 0.3), (1e-6, 0.1)]
            .map(|(min, max)| Gene::logarithmic("", "", "", min, max));
        let gains = |at: &[f64]| {
            let parts = std::array::from_fn(|i| genes[i].value(at[i]));
            Self { parts, exponent: at[PARTS], own, mean, better: if several { BEYOND } else { 1.0 } }
        };
        let cost = |at: &[f64]| score(tried, &gains(at));
        let budget = Budget { evaluations: EVALUATIONS, seed: 1 };
        let start = vec![0.5; PARTS + 1];
        let best = minimise(Optimiser::CmaEs, PARTS + 1, budget, &[start], &each(cost), &mut |_, _| ());
        let found = gains(&best.at);
        let factor = factor(tried, &found);
        Self { parts: found.parts.map(|gain| factor * gain), ..found }
    }

    /// Those of a device whose own logs say that it is off by `own_um`.
    pub fn at(&self, own_um: f64) -> [f64; PARTS] {
        let own = libm::log(own_um);
        let within = self.own.clamp(own);
        let beyond = (own - within).clamp(-libm::log(self.better), libm::log(BEYOND));
        let factor = libm::exp(self.exponent * (within - self.mean));
        let beyond = libm::exp(BEYOND_EXPONENT * beyond);
        let of = |part: usize| factor * if part == MEMORY { 1.0 } else { beyond };
        std::array::from_fn(|part| of(part) * self.parts[part])
    }
}

/// The interval score, summed over recordings.
fn score(tried: &[Tried], gains: &Gains) -> f64 {
    let of = |sample: &Sample, own_um: f64, gains: &[f64; PARTS]| {
        let half_width = (own_um * own_um + variance(&sample.parts, gains)).sqrt();
        half_width + (sample.error - half_width).max(0.0) / (1.0 - COVERED)
    };
    each_of(tried, gains, &of).map(|costs| costs.clone().sum::<f64>() / costs.count() as f64).sum()
}

/// What the deviations have to be times so that of all errors enough are held, and of enough recordings enough; 1 at
/// least: a device that is never off by more than on its own logs is known no better elsewhere for that.
fn factor(tried: &[Tried], gains: &Gains) -> f64 {
    let of = |sample: &Sample, own_um: f64, gains: &[f64; PARTS]| {
        let other = (sample.error.powi(2) - own_um.powi(2)).max(0.0).sqrt();
        other / variance(&sample.parts, gains).sqrt().max(f64::MIN_POSITIVE)
    };
    let of_all = quantile(each_of(tried, gains, &of).flatten(), COVERED);
    let of_each = each_of(tried, gains, &of).filter_map(|ratios| quantile(ratios, HELD));
    [of_all, quantile(of_each, RECORDINGS)].into_iter().flatten().fold(1.0, f64::max)
}

/// A number of every sample of each recording, by its device's own half-width and gains.
fn each_of<'a>(
    tried: &'a [Tried],
    gains: &'a Gains,
    number: &'a impl Fn(&Sample, f64, &[f64; PARTS]) -> f64,
) -> impl Iterator<Item = impl Iterator<Item = f64> + Clone + 'a> + 'a {
    tried.iter().flat_map(move |device| {
        let gains = gains.at(device.own_um);
        let of = move |sample: &'a Sample| number(sample, device.own_um, &gains);
        device.recordings.iter().map(move |recording| recording.iter().map(of))
    })
}

/// The least of some numbers that this part of them does not exceed; `None` of none.
pub fn quantile(numbers: impl Iterator<Item = f64>, part: f64) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    let index = libm::ceil(part * numbers.len() as f64) as usize;
    numbers.get(index.saturating_sub(1)).copied()
}

/// Of everything but what the device's own logs say, µm².
fn variance(parts: &[f64; PARTS], gains: &[f64; PARTS]) -> f64 {
    let square = |(part, gain): (&f64, &f64)| (part * gain) * (part * gain);
    parts.iter().zip(gains).map(square).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device whose errors go with how far its plays moved alone, 19 of 20 within so many times that.
    fn tried(own_um: f64, times: f64) -> Tried {
        let sample = |k: u32| {
            let moved = 0.1 * f64::from(k % 7 + 1);
            let part = if k.is_multiple_of(20) { 1.25 } else { f64::from(k % 20) / 19.0 };
            Sample { error: times * moved * part, parts: [1.0, 1.0, 1.0, moved, 1.0, 1.0] }
        };
        Tried { own_um, recordings: (0..10).map(|n| (0..140).map(|k| sample(k + n)).collect()).collect() }
    }

    #[test]
    fn what_the_errors_go_with_is_found() {
        let tried = [tried(1e-3, 2.0), tried(1e-3, 2.0)];
        let gains = Gains::of(&tried, true).at(1e-3);
        assert!((1.8..2.3).contains(&gains[3]), "{gains:?}");
        let others = gains[0].max(gains[1]).max(gains[2]).max(gains[4]).max(gains[5]);
        assert!(others < 0.1, "{gains:?}");
    }

    #[test]
    fn nine_recordings_of_ten_are_held_for_nine_tenths_of_their_time() {
        let held = |worse: usize| {
            let mut tried = tried(1e-3, 1.0);
            tried.recordings.iter_mut().take(worse).flatten().for_each(|sample| sample.error *= 4.0);
            let tried = [tried];
            let gains = Gains::of(&tried, true);
            let of = |sample: &Sample, own_um: f64, gains: &[f64; PARTS]| {
                f64::from(sample.error <= 1.001 * own_um.hypot(variance(&sample.parts, gains).sqrt()))
            };
            let each: Vec<f64> = each_of(&tried, &gains, &of).map(|held| held.sum::<f64>() / 140.0).collect();
            assert!(each.iter().sum::<f64>() / 10.0 >= 0.945, "{worse} worse: {each:?}");
            each.iter().filter(|held| **held >= 0.9).count()
        };
        assert!([0, 1, 2, 3].map(held).iter().all(|held| *held >= 9), "{:?}", [0, 1, 2, 3].map(held));
    }

    #[test]
    fn what_is_never_off_by_more_than_its_own_logs_say_is_not_certain_elsewhere() {
        let gains = Gains::of(&[tried(100.0, 1e-3), tried(100.0, 1e-3)], true);
        assert!(gains.at(100.0).iter().all(|gain| *gain > 0.0), "{gains:?}");
    }

    #[test]
    fn a_device_that_its_own_logs_fit_worse_is_trusted_less_where_that_is_so_of_the_others() {
        let devices = [tried(0.01, 1.0), tried(0.02, 2.0), tried(0.04, 4.0)];
        let worse = Gains::of(&devices, true);
        let twice = worse.at(0.03)[3] / worse.at(0.015)[3];
        assert!((1.8..2.1).contains(&twice), "{worse:?}");
        for (own_um, nearest_um, ratio) in [(0.08, 0.04, 2.0), (0.005, 0.01, 0.5), (1e-9, 0.01, 0.1), (9.0, 0.04, 10.0)]
        {
            let times = f64::powf(ratio, BEYOND_EXPONENT);
            let (gains, nearest) = (worse.at(own_um), worse.at(nearest_um));
            assert!((gains[3] / nearest[3] - times).abs() < 1e-9, "{own_um}: none was like it");
            assert_eq!(gains[MEMORY], nearest[MEMORY], "{own_um}: its start is as unknown as theirs");
        }
        let single = Gains::of(&devices, false);
        assert_eq!(single.at(0.005), single.at(0.01), "of one amplitude a better fit than theirs says nothing");
        assert!(single.at(0.08)[3] > single.at(0.04)[3]);
        let alike = Gains::of(&[tried(0.01, 2.0), tried(0.02, 2.0), tried(0.04, 2.0)], true);
        let twice = alike.at(0.03)[3] / alike.at(0.015)[3];
        assert!((1.0..1.1).contains(&twice), "{alike:?}");
    }
}
