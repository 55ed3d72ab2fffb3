//! Whether time stamps keep one sample period: none missing, none misplaced.
//!
//! A step may differ from the sample period by 1 % of it. Beyond that only the rounding of printed stamps is tolerated:
//! in a step to one unit of the last decimal shown, and in the distance of a stamp from the straight line through all
//! to [`ROUNDING`] of it. So 0.0005 s printed with three decimals (0, 0.001, 0.001, 0.002, …) passes, and a missing or
//! misplaced sample does not.

use super::fault::Fault;
use super::holes::MOST_HOLES;
use super::number::Number;
use super::resolution::coarsest;

/// Tolerated deviation of a step from the sample period, as a part of it.
const JITTER: f64 = 0.01;
/// Tolerated deviation of a rounded time stamp from the line through all, in units of the last decimal: half for its
/// own rounding, the rest for what the rounding of the others tilts the line.
const ROUNDING: f64 = 0.85;

/// How far a mean period may be off by rounding, as a part of it.
const FINE: f64 = 1e-4;

/// A stamp may lie so many periods before the last one for a clock that jitters to be why, and not another recording.
const BACKWARDS: f64 = 10.0;
/// So many steps back are its doing; fewer may be rows in a wrong place.
const OFTEN: usize = 3;

/// Time stamps (s) held against a sample period (s).
struct Steps<'a> {
    time: &'a [f64],
    resolution: &'a [f64],
    period: f64,
    /// How many steps are off by more than the jitter.
    off: usize,
}

/// Refuses time stamps (s) that do not increase, miss samples, or stand off the clock of `period` (s), with the row.
pub(super) fn check(time: &[f64], resolution: &[f64], period: f64) -> Result<(), (usize, Fault)> {
    let steps = Steps::of(time, resolution, period);
    check_increasing(time, |k| steps.explains(k)).map_err(|(k, fault)| {
        if steps.jitters_back() { steps.irregular(k, steps.step(k) - period) } else { (k, fault) }
    })?;
    let mut unexplained = (1..time.len()).filter(|&k| !steps.explains(k));
    if let Some(k) = unexplained.next() {
        let Some(missing) = steps.missing(k) else {
            return Err(steps.irregular(k, steps.step(k) - period));
        };
        let gaps = 1 + unexplained.filter(|&k| steps.missing(k).is_some()).count();
        let few = !steps.few_gaps().is_empty();
        return Err((k, Fault::Gap { missing, after: Number(time[k - 1]), gaps, few }));
    }
    let allowed = match steps.off {
        0 => period / 2.0,
        _ => ROUNDING * coarsest(resolution) + JITTER * period,
    };
    match farthest_stray(time, allowed) {
        Some((k, deviation)) => Err(steps.irregular(k, deviation)),
        None => Ok(()),
    }
}

/// Before which rows how many samples are missing of such time stamps; none where they are too many to be holes
/// of a log.
pub(super) fn few_gaps(time: &[f64], resolution: &[f64], period: f64) -> Vec<(usize, usize)> {
    Steps::of(time, resolution, period).few_gaps()
}

impl<'a> Steps<'a> {
    fn of(time: &'a [f64], resolution: &'a [f64], period: f64) -> Self {
        let mut steps = Self { time, resolution, period, off: 0 };
        steps.off = (1..time.len()).filter(|&k| (steps.step(k) - period).abs() > JITTER * period).count();
        steps
    }

    /// Before which rows how many samples are missing; none where they are too many to be holes of a log.
    fn few_gaps(&self) -> Vec<(usize, usize)> {
        let most = (MOST_HOLES * self.time.len() as f64) as u64;
        let mut all = 0_u64;
        let unexplained = (1..self.time.len()).filter(|&k| !self.explains(k));
        let few = unexplained.filter_map(|k| Some((k, self.missing(k)?))).map(|(k, missing)| {
            all = all.saturating_add(missing);
            (all <= most).then_some((k, missing as usize))
        });
        few.collect::<Option<Vec<_>>>().unwrap_or_default()
    }

    /// The step from the row before to row `k`, s.
    fn step(&self, k: usize) -> f64 {
        self.time[k] - self.time[k - 1]
    }

    /// What rounding may add to or take from the step to row `k`, s. Rounding to more than half a period could hide a
    /// missing sample, but it shows in many steps and a gap in few.
    fn slack(&self, k: usize) -> f64 {
        let rounding = self.resolution[k].max(self.resolution[k - 1]);
        if self.off_in_many() || rounding <= self.period / 2.0 { rounding } else { 0.0 }
    }

    fn off_in_many(&self) -> bool {
        self.off * 20 > self.time.len()
    }

    /// Whether the stamps stand still or go back now and then, and a little, as those of a clock do that jitters; once
    /// is enough where that makes up for a step of two periods.
    fn jitters_back(&self) -> bool {
        let back = (1..self.time.len()).map(|k| self.step(k)).filter(|step| *step <= 0.0);
        let (count, farthest) = back.fold((0, 0.0_f64), |(count, farthest), step| (count + 1, farthest.min(step)));
        let near = |step: f64, periods: f64| (step - periods * self.period).abs() <= 0.1 * self.period;
        let made_up = |k: usize| near(self.step(k - 1), 2.0) && near(self.step(k), 0.0);
        let often = count >= OFTEN || (count > 0 && self.off_in_many());
        farthest > -BACKWARDS * self.period && (often || (2..self.time.len()).any(made_up))
    }

    fn explains(&self, k: usize) -> bool {
        const ARITHMETIC: f64 = 1e-6;
        let slack = self.slack(k) * (1.0 + ARITHMETIC);
        (self.step(k) - self.period).abs() <= JITTER * self.period + slack
    }

    /// How many samples are missing before row `k`, if the step to it is a whole number of periods, and what follows is
    /// as late: one stamp that comes late leaves the next step as much shorter.
    fn missing(&self, k: usize) -> Option<u64> {
        let caught_up = |next: usize| {
            self.step(next) + self.slack(next) < 0.5 * self.period && self.step(k) + self.step(next) < 2.5 * self.period
        };
        if k + 1 < self.time.len() && caught_up(k + 1) {
            return None;
        }
        let samples = (self.step(k) / self.period).round();
        let near = (self.step(k) - samples * self.period).abs() <= 0.1 * self.period + self.slack(k);
        (samples >= 2.0 && near).then(|| samples as u64 - 1)
    }

    fn irregular(&self, k: usize, deviation: f64) -> (usize, Fault) {
        let percent = Number((100.0 * deviation / self.period).abs().round());
        let (value, period, example) = (Number(self.time[k]), Number(self.period), String::new());
        let fault = Fault::IrregularTime { value, percent, period, example };
        (k, fault)
    }
}

/// Refuses a step back, and a step of nothing that `explained` does not allow.
pub(super) fn check_increasing(time: &[f64], explained: impl Fn(usize) -> bool) -> Result<(), (usize, Fault)> {
    let falls = |&k: &usize| time[k] < time[k - 1] || (time[k] == time[k - 1] && !explained(k));
    match (1..time.len()).find(falls) {
        Some(k) => Err((k, Fault::TimeNotIncreasing { value: Number(time[k]), previous: Number(time[k - 1]) })),
        None => Ok(()),
    }
}

/// The time stamp farthest off the line of least squares, with its deviation, unless some shift of the line passes
/// within `allowed` of every stamp.
fn farthest_stray(time: &[f64], allowed: f64) -> Option<(usize, f64)> {
    let line = Line::fit(time);
    let (mut lowest, mut highest, mut farthest) = (0.0_f64, 0.0_f64, 0);
    for (k, t) in time.iter().enumerate() {
        let deviation = t - line.at(k);
        if deviation.abs() > highest.max(-lowest) {
            farthest = k;
        }
        lowest = lowest.min(deviation);
        highest = highest.max(deviation);
    }
    (highest - lowest > 2.0 * allowed).then(|| (farthest, time[farthest] - line.at(farthest)))
}

/// The period that most of the log keeps, gaps or not: the mean of the steps that are about as long as the median is.
pub(super) fn rough_period(time: &[f64], resolution: &[f64]) -> f64 {
    let median = median_period(time, resolution);
    let steps = Steps::of(time, resolution, median);
    let usual: Vec<f64> = (1..time.len()).filter(|&k| steps.explains(k)).map(|k| steps.step(k)).collect();
    let sum: f64 = usual.iter().sum();
    // The rounding of its ends would tell in the mean of few.
    match 2 * usual.len() > time.len() && 2.0 * coarsest(resolution) < FINE * sum {
        true => sum / usual.len() as f64,
        false => median,
    }
}

/// The median step over so many rows that rounding is small.
fn median_period(time: &[f64], resolution: &[f64]) -> f64 {
    let last = time.len() - 1;
    let mean = (time[last] - time[0]) / last as f64;
    // `as` saturates, and takes NaN to 0.
    let lag = ((coarsest(resolution) / mean * 200.0).ceil() as usize).clamp(1, (time.len() / 4).max(1));
    let mut steps: Vec<f64> = (lag..time.len()).map(|k| (time[k] - time[k - lag]) / lag as f64).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Least-squares line through the time stamps, relative to their middle.
pub(super) struct Line {
    middle: f64,
    mean: f64,
    /// Its slope: time per sample, s.
    pub period: f64,
}

impl Line {
    /// The line of `time`, which is not empty.
    pub fn fit(time: &[f64]) -> Self {
        let middle = (time.len() - 1) as f64 / 2.0;
        let first = time[0];
        let mean = time.iter().map(|t| t - first).sum::<f64>() / time.len() as f64 + first;
        let (mut products, mut squares) = (0.0, 0.0);
        for (k, t) in time.iter().enumerate() {
            let offset = k as f64 - middle;
            products += offset * (t - mean);
            squares += offset * offset;
        }
        Self { middle, mean, period: products / squares }
    }

    fn at(&self, index: usize) -> f64 {
        self.mean + self.period * (index as f64 - self.middle)
    }
}
