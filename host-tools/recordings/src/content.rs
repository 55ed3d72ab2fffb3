//! A few samples of a recording, by which it is known again where another program has exported it: with other
//! names, units or digits, or cut. Noise makes them its own: another recording of the same drive differs from them
//! by more than rounding.

use crate::log::Log;
use serde::{Deserialize, Serialize};

/// How many stretches of consecutive samples are kept, and how long each is.
const STRETCHES: usize = 4;
const LENGTH: usize = 8;
/// Fewest stretches that must be in what is left of it.
const FEWEST: usize = 2;
/// By how much a rounded value may be off: of the smallest step; of the span, where the step is finer than that; and of
/// itself, where five significant digits were kept.
const ROUNDING: f64 = 0.51;
const FINEST: f64 = 1e-6;
const OF_ITSELF: f64 = 5.1e-5;
/// Relative difference of the sample periods up to which two are the same.
const PERIOD: f64 = 1e-4;

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
    /// `None` in any other.
    pub fn begins_in(&self, log: &Log) -> Option<f64> {
        let displacement = log.displacement.as_deref()?;
        if (log.sample_period / self.sample_period_s - 1.0).abs() > PERIOD
            || self.displacement_um.len() != self.voltage_v.len()
        {
            return None;
        }
        // Either side may be the one that was rounded.
        let series = [
            (&log.voltage[..], &self.voltage_v, self.rounding_v.max(rounding(&log.voltage))),
            (displacement, &self.displacement_um, self.rounding_um.max(rounding(displacement))),
        ];
        let count = log.voltage.len().min(displacement.len());
        let same = |stretch: usize, from: usize| {
            let alike = |(values, kept, rounding): &(&[f64], &Vec<f64>, f64), k: usize| {
                let kept = kept.get(stretch * LENGTH + k);
                kept.is_some_and(|kept| (values[from + k] - kept).abs() <= rounding + OF_ITSELF * kept.abs())
            };
            (0..LENGTH).all(|k| series.iter().all(|series| alike(series, k)))
        };
        let last = count.checked_sub(LENGTH)?;
        // Where a stretch of the part would begin, if one of its others begins here.
        let inside = |part: isize, at: usize| at.checked_add_signed(part).filter(|from| *from <= last);
        let begins = |anchor: usize, from: usize| {
            let part = isize::try_from(from).ok()?.checked_sub(isize::try_from(self.at[anchor]).ok()?)?;
            let left: Vec<(usize, usize)> =
                self.at.iter().enumerate().filter_map(|(stretch, &at)| Some((stretch, inside(part, at)?))).collect();
            (left.len() >= FEWEST && left.iter().all(|&(stretch, from)| same(stretch, from))).then_some(part)
        };
        let anchors = (0..self.at.len()).flat_map(|anchor| (0..=last).map(move |from| (anchor, from)));
        let part =
            anchors.filter(|&(anchor, from)| same(anchor, from)).find_map(|(anchor, from)| begins(anchor, from))?;
        Some(part as f64 * log.sample_period)
    }
}

/// By how much values that were rounded to one step may be off.
fn rounding(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &x| (low.min(x), high.max(x)));
    ROUNDING * steps.fold(high - low, f64::min) + FINEST * (high - low)
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

    #[test]
    fn a_stretch_that_is_nowhere_is_no_reason_to_fail() {
        let mut content = Content::of(&log(1).trimmed(0.1, 0.0)).unwrap();
        content.at[3] = i64::MAX as usize;
        assert!((content.begins_in(&log(1)).unwrap() - 0.1).abs() < 1e-9);
        content.at = vec![usize::MAX; 4];
        assert_eq!(content.begins_in(&log(1)), None);
    }
}
