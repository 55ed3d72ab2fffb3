//! A few samples of a recording, by which it is known again where another program has exported it: with other
//! names, units or digits, or cut. Noise makes them its own: another recording of the same drive differs from them
//! by more than rounding.

use crate::log::Log;
use serde::{Deserialize, Serialize};

/// How many stretches of consecutive samples are kept, and how long each is.
const STRETCHES: usize = 4;
const LENGTH: usize = 8;
/// Fewest samples that must be in what is left of it.
const FEWEST: usize = 2 * LENGTH;
/// By how much a rounded value may be off: of the smallest step; of the span, where the step is finer than that; and of
/// itself, where five significant digits were kept.
const ROUNDING: f64 = 0.51;
const FINEST: f64 = 1e-6;
const OF_ITSELF: f64 = 5.1e-5;
/// Relative difference up to which two sample periods are the same, or one a multiple of the other.
const PERIOD: f64 = 1e-4;
/// Most samples of a recording of which a thinned copy may have kept one.
const MOST: f64 = 1000.0;

/// Samples of a log or of a part of one.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Content {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// The first sample of each stretch, counted from the part's first.
    pub at: Vec<usize>,
    /// The voltages of the stretches, one after the other, V.
    pub voltage_v: Vec<f64>,
    /// The displacements, µm.
    pub displacement_um: Vec<f64>,
    /// By how much the recording's voltages may be off by rounding, V.
    #[serde(default)]
    pub rounding_v: f64,
    /// By how much its displacements may be, µm.
    #[serde(default)]
    pub rounding_um: f64,
}

impl Content {
    /// Of a log; `None` where it is too short, or has no displacement.
    pub fn of(log: &Log) -> Option<Self> {
        let displacement = log.displacement.as_deref()?;
        let count = log.voltage.len().min(displacement.len());
        let at: Vec<usize> = (0..STRETCHES).map(|k| (2 * k + 1) * count / (2 * STRETCHES)).collect();
        if count < 2 * STRETCHES * LENGTH {
            return None;
        }
        let kept = |series: &[f64]| at.iter().flat_map(|&at| series[at..at + LENGTH].to_vec()).collect();
        Some(Self {
            sample_period_s: log.sample_period,
            voltage_v: kept(&log.voltage),
            displacement_um: kept(displacement),
            rounding_v: rounding(&log.voltage),
            rounding_um: rounding(displacement),
            at,
        })
    }

    /// Where the part begins in a log that holds the same samples, s from the log's first, which may be negative;
    /// `None` in any other. Of either only every n-th sample may have been kept, of the log every second.
    pub fn begins_in(&self, log: &Log) -> Option<f64> {
        let displacement = log.displacement.as_deref()?;
        if self.displacement_um.len() != self.voltage_v.len() {
            return None;
        }
        let strides = Strides::of(log.sample_period, self.sample_period_s)?;
        // Of too few kept samples that are left nothing need be sought.
        if strides.samples * FEWEST as i128 > (self.at.len() * LENGTH) as i128 {
            return None;
        }
        // Either side may be the one that was rounded.
        let series = [
            (&log.voltage[..], &self.voltage_v, self.rounding_v.max(rounding(&log.voltage))),
            (displacement, &self.displacement_um, self.rounding_um.max(rounding(displacement))),
        ];
        let count = log.voltage.len().min(displacement.len());
        let alike = |row: usize, kept: usize| {
            series.iter().all(|(values, of, rounding)| {
                of.get(kept).is_some_and(|of| (values[row] - of).abs() <= rounding + OF_ITSELF * of.abs())
            })
        };
        // How many samples of a stretch are the log's, too, 0 of one that is not wholly within it; `None` of another's.
        let same = |stretch: usize, shift: i128| {
            let row = |k: usize| strides.row(self.at[stretch] as i128 + k as i128, shift, count);
            if [0, LENGTH - 1].map(row).contains(&None) {
                return Some(0);
            }
            let mut shared = (0..LENGTH).filter_map(|k| Some((row(k)??, stretch * LENGTH + k)));
            shared.try_fold(0, |same, (row, kept)| alike(row, kept).then_some(same + 1))
        };
        let begins = |shift: i128| {
            let same: Option<usize> = (0..self.at.len()).map(|stretch| same(stretch, shift)).sum();
            same.is_some_and(|same| same >= FEWEST)
        };
        for (stretch, &at) in self.at.iter().enumerate() {
            for first in at as i128..at as i128 + strides.samples {
                let shifts = (0..count).map(|row| row as i128 * strides.samples - first * strides.rows);
                let found =
                    shifts.filter(|&shift| same(stretch, shift).is_some_and(|same| same > 0)).find(|&of| begins(of));
                if let Some(shift) = found {
                    return Some(shift as f64 / strides.samples as f64 * log.sample_period);
                }
            }
        }
        None
    }
}

/// Which rows of a log are which kept samples: so many rows take as long as so many samples, one of them 1.
#[derive(Clone, Copy)]
struct Strides {
    rows: i128,
    samples: i128,
}

impl Strides {
    /// Of two sample periods, one of which is a multiple of the other.
    fn of(row_s: f64, sample_s: f64) -> Option<Self> {
        let multiple = |of: f64| {
            let whole = of.round();
            ((1.0..=MOST).contains(&whole) && (of / whole - 1.0).abs() <= PERIOD).then_some(whole as i128)
        };
        let coarser = multiple(row_s / sample_s).map(|samples| Self { rows: 1, samples });
        coarser.or_else(|| multiple(sample_s / row_s).map(|rows| Self { rows, samples: 1 }))
    }

    /// The row of a kept sample in a log of so many, by how much that is shifted: `None` outside it, and no row where
    /// the sample lies between two.
    fn row(self, sample: i128, shift: i128, count: usize) -> Option<Option<usize>> {
        let at = sample * self.rows + shift;
        let row = usize::try_from(at.div_euclid(self.samples)).ok().filter(|row| *row < count)?;
        Some((at.rem_euclid(self.samples) == 0).then_some(row))
    }
}

/// By how much values that were rounded to one step may be off: of a few that are far from each other, too.
fn rounding(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let span = sorted.last().zip(sorted.first()).map_or(0.0, |(high, low)| high - low);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    ROUNDING * steps.fold(span, f64::min) + FINEST * span
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swing with noise, whose seed makes it another recording of the same drive.
    fn log(seed: u64) -> Log {
        let mut state = seed;
        let mut noise = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
        };
        let phase = |k: usize| k as f64 * 0.0625;
        Log {
            name: "swing".into(),
            path: "swing.csv".into(),
            sha256: seed.to_string(),
            start_s: 0.0,
            sample_period: 5e-4,
            voltage: (0..2000).map(|k| 50.0 - 50.0 * phase(k).cos() + 0.01 * noise()).collect(),
            displacement: Some((0..2000).map(|k| 7.0 - 7.0 * (phase(k) - 0.1).cos() + 0.01 * noise()).collect()),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    /// As another program writes it.
    fn rounded(log: &Log) -> Log {
        let to = |digit: f64| move |x: &f64| (x / digit).round() * digit;
        let displacement = log.displacement.as_ref().map(|series| series.iter().map(to(1e-3)).collect());
        Log { voltage: log.voltage.iter().map(to(1e-3)).collect(), displacement, ..log.clone() }
    }

    #[test]
    fn a_recording_is_known_again_rounded_and_cut_and_no_other_is() {
        let (trained, _) = log(1).trimmed(0.1, 0.0).split(0.5);
        let content = Content::of(&trained).unwrap();
        let begins = content.begins_in(&rounded(&log(1))).unwrap();
        assert!((begins - 0.1).abs() < 1e-9, "{begins}");
        let cut = content.begins_in(&rounded(&log(1).trimmed(0.25, 0.1))).unwrap();
        assert!((cut + 0.15).abs() < 1e-9, "{cut}");
        assert_eq!(content.begins_in(&log(2)), None, "the same drive on another day");
        assert_eq!(content.begins_in(&rounded(&log(2))), None);
        let (_, rest) = log(1).split(0.3);
        assert_eq!(content.begins_in(&rest), None, "what it was not trained on");
        assert_eq!(content.begins_in(&Log { sample_period: 1e-3, ..log(1) }), None);
        assert_eq!(Content::of(&log(1).trimmed(0.98, 0.0)), None, "too short to be known by");
    }

    /// As a program writes it that keeps five significant digits: finer near 0 than elsewhere.
    fn to_five_digits(log: &Log) -> Log {
        let to = |series: &[f64]| series.iter().map(|x| format!("{x:.4e}").parse().unwrap()).collect();
        Log { voltage: to(&log.voltage), displacement: log.displacement.as_deref().map(to), ..log.clone() }
    }

    #[test]
    fn digits_may_be_lost_on_either_side_and_each_in_its_own_way() {
        let fine = Content::of(&log(1)).unwrap();
        assert_eq!(fine.begins_in(&to_five_digits(&log(1))), Some(0.0));
        assert_eq!(fine.begins_in(&to_five_digits(&log(2))), None);
        for coarse in [rounded(&log(1)), to_five_digits(&log(1))].map(|log| Content::of(&log).unwrap()) {
            assert_eq!(coarse.begins_in(&log(1)), Some(0.0));
            assert_eq!(coarse.begins_in(&log(2)), None);
        }
    }

    /// Every n-th sample of a log, from the second on.
    fn thinned(log: &Log, n: usize) -> Log {
        let every = |series: &[f64]| series[1..].iter().step_by(n).copied().collect::<Vec<f64>>();
        let displacement = log.displacement.as_deref().map(every);
        Log { voltage: every(&log.voltage), displacement, sample_period: n as f64 * log.sample_period, ..log.clone() }
    }

    #[test]
    fn a_recording_is_known_again_thinned() {
        let content = Content::of(&log(1)).unwrap();
        let begins = content.begins_in(&thinned(&log(1), 2)).unwrap();
        assert!((begins + 5e-4).abs() < 1e-9, "{begins}");
        assert_eq!(content.begins_in(&thinned(&log(1), 4)), None, "too few of the kept samples are left");
        for n in [2, 5, 20] {
            let content = Content::of(&thinned(&log(1), n)).unwrap();
            let begins = content.begins_in(&rounded(&log(1))).unwrap();
            assert!((begins - 5e-4).abs() < 1e-9, "every {n}: {begins}");
            assert_eq!(content.begins_in(&log(2)), None);
            assert_eq!(Content::of(&log(2)).unwrap().begins_in(&thinned(&log(1), n)), None);
        }
    }

    #[test]
    fn a_stretch_that_is_nowhere_is_no_reason_to_fail() {
        let mut content = Content::of(&log(1).trimmed(0.1, 0.0)).unwrap();
        content.at[3] = i64::MAX as usize;
        assert!((content.begins_in(&log(1)).unwrap() - 0.1).abs() < 1e-9);
        content.at = vec![usize::MAX; 4];
        assert_eq!(content.begins_in(&log(1)), None);
    }
}
