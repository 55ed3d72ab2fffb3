//! A few samples of a recording, by which it is known again where another program has exported it: with other
//! names, units or digits, thinned, or cut. They are taken where the displacement moves most: at rest every recording
//! is like every other, and where it moves, noise and drift make even the next recording of the same drive another.

use crate::log::Log;
use crate::rounding::{Rounding, step};
use serde::{Deserialize, Serialize};

/// How many stretches of consecutive samples are kept, and how long each is.
const STRETCHES: usize = 4;
const LENGTH: usize = 8;
/// Fewest stretches that must be in what is left of it.
const WHOLE: usize = 2;
/// Fewest samples of these whose displacement is further from that of the sample before than rounding may move it.
const MOVED: usize = 6;
/// Relative difference up to which two sample periods are the same, or one a multiple of the other.
const PERIOD: f64 = 1e-4;
/// Most samples of a log of which the part may have kept one.
const MOST_ROWS: f64 = 1000.0;
/// Most samples of the part of which the log may have kept one: of more, too few of a stretch are left.
const MOST_SAMPLES: f64 = 2.0;

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
        let (voltage, displacement) = (without_holes(&log.voltage, log), without_holes(displacement, log));
        let quarter = displacement.len().min(voltage.len()) / STRETCHES;
        if quarter < 2 * LENGTH {
            return None;
        }
        let at: Vec<usize> = (0..STRETCHES).filter_map(|k| liveliest(&displacement, k * quarter, quarter)).collect();
        if at.len() < WHOLE {
            return None;
        }
        let kept = |series: &[f64]| at.iter().flat_map(|&at| series[at..at + LENGTH].to_vec()).collect();
        Some(Self {
            sample_period_s: log.sample_period,
            voltage_v: kept(&voltage),
            displacement_um: kept(&displacement),
            rounding_v: step(&voltage),
            rounding_um: step(&displacement),
            at,
        })
    }

    /// Where the part begins in a log that holds the same samples, s from the log's first, which may be negative;
    /// `None` in any other. The part may have kept one sample of up to a thousand of the log, the log one of two.
    pub fn begins_in(&self, log: &Log) -> Option<f64> {
        let (rows, samples) = ratio(log.sample_period, self.sample_period_s)?;
        let own = [without_holes(&log.voltage, log), without_holes(log.displacement.as_deref()?, log)];
        let rounding = [
            Rounding::of(&own[0], &self.voltage_v, self.rounding_v),
            Rounding::of(&own[1], &self.displacement_um, self.rounding_um),
        ];
        let searched = Searched { own, rounding };
        (0..samples).find_map(|before| {
            let begins = searched.begins(&self.stretches(rows, samples, before))?;
            Some(begins as f64 * log.sample_period - before as f64 * self.sample_period_s)
        })
    }

    /// What a log has kept of each stretch, where `rows` of its rows take as long as `samples` of the part and it left
    /// out the first `before` of those.
    fn stretches(&self, rows: usize, samples: usize, before: usize) -> Vec<Vec<Sample>> {
        let values = self.voltage_v.chunks(LENGTH).zip(self.displacement_um.chunks(LENGTH));
        let kept = |at: usize, (voltage, displacement): (&[f64], &[f64])| {
            let stretch = voltage.iter().zip(displacement).enumerate();
            let of_log = stretch.filter_map(|(k, (&voltage, &displacement))| {
                let number = at.checked_add(k)?.checked_sub(before)?;
                let row = i64::try_from((number / samples).checked_mul(rows)?).ok()?;
                (number % samples == 0).then_some(Sample { row, values: [voltage, displacement] })
            });
            of_log.collect()
        };
        self.at.iter().zip(values).map(|(&at, values)| kept(at, values)).collect()
    }
}

/// A sample of a stretch.
struct Sample {
    /// Its row in a log, counted from the row where the part begins.
    row: i64,
    /// Voltage, V, and displacement, µm.
    values: [f64; 2],
}

/// A log in which samples are looked for.
struct Searched {
    /// Its voltages, V, and displacements, µm; none (NaN) where it has no number.
    own: [Vec<f64>; 2],
    rounding: [Rounding; 2],
}

impl Searched {
    /// The row where the part begins whose stretches these are; it may lie before the first.
    fn begins(&self, stretches: &[Vec<Sample>]) -> Option<i64> {
        let count = i64::try_from(self.own[0].len()).ok()?;
        stretches.iter().filter_map(|stretch| stretch.first()).find_map(|first| {
            let mut begins = (0..count).filter_map(|row| row.checked_sub(first.row));
            begins.find(|&row| self.has(first, row) == Some(true) && self.holds(stretches, row))
        })
    }

    /// Whether a part that begins in this row is the log's: all stretches that lie wholly within the log are.
    fn holds(&self, stretches: &[Vec<Sample>], begins: i64) -> bool {
        let (mut whole, mut moved) = (0, 0);
        for stretch in stretches.iter().filter(|stretch| stretch.len() >= LENGTH / 2) {
            let Some(has) = stretch.iter().map(|sample| self.has(sample, begins)).collect::<Option<Vec<bool>>>() else {
                continue;
            };
            if has.contains(&false) {
                return false;
            }
            let [_, rounding] = &self.rounding;
            whole += 1;
            moved += stretch.windows(2).filter(|pair| !rounding.allows(pair[0].values[1], pair[1].values[1])).count();
        }
        whole >= WHOLE && moved >= MOVED
    }

    /// Whether a sample is the log's; `None` where the log has none.
    fn has(&self, sample: &Sample, begins: i64) -> Option<bool> {
        let row = usize::try_from(sample.row.checked_add(begins)?).ok()?;
        let mut same = true;
        for ((own, rounding), value) in self.own.iter().zip(&self.rounding).zip(sample.values) {
            let own = own.get(row).copied().filter(|own| own.is_finite())?;
            same &= rounding.allows(own, value);
        }
        Some(same)
    }
}

/// So many rows of a log take as long as so many samples of the part, one of them 1; `None` where neither period is a
/// multiple of the other, or too large a one.
fn ratio(row_s: f64, sample_s: f64) -> Option<(usize, usize)> {
    let multiple = |of: f64, most: f64| {
        let whole = of.round();
        ((1.0..=most).contains(&whole) && (of / whole - 1.0).abs() <= PERIOD).then_some(whole as usize)
    };
    let thinned = multiple(row_s / sample_s, MOST_SAMPLES).map(|samples| (1, samples));
    thinned.or_else(|| Some((multiple(sample_s / row_s, MOST_ROWS)?, 1)))
}

/// The first sample of the stretch along which the displacement goes furthest, among `count` samples from `from` on;
/// `None` where each has a hole.
fn liveliest(displacement: &[f64], from: usize, count: usize) -> Option<usize> {
    let travelled =
        |at: &usize| -> f64 { displacement[*at..*at + LENGTH].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum() };
    let whole = (from..=from + count - LENGTH).filter(|at| travelled(at).is_finite());
    whole.max_by(|a, b| travelled(a).total_cmp(&travelled(b)))
}

/// The values that the log's file has, and none (NaN) where it has no number.
fn without_holes(values: &[f64], log: &Log) -> Vec<f64> {
    let mut own = values.to_vec();
    log.holes.iter().for_each(|hole| own.get_mut(hole.clone()).unwrap_or_default().fill(f64::NAN));
    own
}
