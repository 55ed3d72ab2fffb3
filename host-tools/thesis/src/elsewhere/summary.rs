//! From single recordings to rows of a table.

use super::bootstrap::differ;
use super::judge::{Errors, Judged};
use estimator_core::Model;
use identification::StraightLine;
use serde::Serialize;

/// A median and the range about it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Range {
    /// The median of the seeds.
    pub median: f64,
    /// The least of the seeds.
    pub min: f64,
    /// The largest of the seeds.
    pub max: f64,
}

impl Range {
    /// Of some values; `None` of none.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let (min, max) = (*values.first()?, *values.last()?);
        let middle = values.len() / 2;
        let median = if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 };
        Some(Self { median, min, max })
    }

    /// As it is written: the median, and the range where there is one.
    pub fn told(&self, decimals: usize) -> String {
        let Self { median, min, max } = self;
        if min == max {
            format!("{median:.decimals$}")
        } else {
            format!("{median:.decimals$} ({min:.decimals$}–{max:.decimals$})")
        }
    }
}

/// A model under a condition.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Whose recordings they are.
    pub subject: String,
    /// Which condition it is.
    pub condition: String,
    /// `None`: the straight line.
    pub model: Option<Model>,
    /// Name of the model.
    pub name: String,
    /// Searches of it, and those with an admissible candidate.
    pub searched: usize,
    pub found: usize,
    /// Recordings of the condition; a search of another seed on the same recording is none.
    pub recordings: usize,
    /// Measured displacement, peak to peak, µm.
    pub stroke_um: Option<Range>,
    /// Of the sensor, the median over the recordings, µm rms.
    pub noise_floor_um: Option<f64>,
    /// MAE, told nothing, µm.
    pub told_nothing_um: Option<Range>,
    /// MAE, told the sensor's first reading, µm.
    pub told_first_reading_um: Option<Range>,
    /// MAE, told one cycle, µm.
    pub told_one_cycle_um: Option<Range>,
    /// MAE without the mean error, µm.
    pub without_offset_um: Option<Range>,
    /// RMS without the mean error, µm.
    pub rms_without_offset_um: Option<Range>,
    /// Half-width of the interval, µm, relative to the first reading or the zero; of the model that a user gets.
    pub interval_um: Option<Range>,
    /// Part of the time for which it held the sensor, %.
    pub coverage_percent: Option<Range>,
    /// Half-width of the interval once one cycle was told, µm.
    pub interval_one_cycle_um: Option<Range>,
    /// Part of the time for which that held the sensor, %.
    pub coverage_one_cycle_percent: Option<Range>,
    /// The least median without offset.
    pub best: bool,
    /// By the paired bootstrap, at 95 %; `None` of the best and where there is nothing to compare.
    pub different_from_best: Option<bool>,
}

/// A row for each model that was learnt under each condition, in the order of the subjects and conditions, the
/// nearest model first.
pub fn rows(judged: &[Judged]) -> Vec<Row> {
    let mut conditions: Vec<(&str, &str)> = Vec::new();
    for one in judged {
        let condition = (one.subject, one.condition);
        if !conditions.contains(&condition) {
            conditions.push(condition);
        }
    }
    // Subjects together, each in the order in which it was met first.
    let mut subjects: Vec<&str> = Vec::new();
    for (subject, _) in &conditions {
        if !subjects.contains(subject) {
            subjects.push(subject);
        }
    }
    conditions.sort_by_key(|(subject, _)| subjects.iter().position(|other| other == subject));
    conditions.into_iter().flat_map(|condition| of_condition(judged, condition)).collect()
}

fn of_condition(judged: &[Judged], (subject, condition): (&str, &str)) -> Vec<Row> {
    let here = || judged.iter().filter(move |one| one.subject == subject && one.condition == condition);
    let of_model = |model: Option<Model>| here().filter(|one| one.model == model).collect::<Vec<_>>();
    let models = Model::ALL.into_iter().map(Some).chain([None]);
    let mut all: Vec<(Row, Vec<&Judged>)> = models
        .map(|model| (of_model(model), model))
        .filter(|(of, _)| !of.is_empty())
        .map(|(of, model)| (row(&of, model), of))
        .collect();
    let median = |row: &Row| row.without_offset_um.map_or(f64::INFINITY, |range| range.median);
    all.sort_by(|a, b| median(&a.0).total_cmp(&median(&b.0)));
    if let Some(((best, its), others)) = all.split_first_mut() {
        best.best = best.without_offset_um.is_some();
        for (row, of) in others {
            row.different_from_best = (row.found > 0 && best.best).then(|| different(its, of));
        }
    }
    all.into_iter().map(|(row, _)| row).collect()
}

fn row(of: &[&Judged], model: Option<Model>) -> Row {
    let errors = || of.iter().filter_map(|one| one.errors.as_ref());
    let range = |value: &dyn Fn(&Errors) -> Option<f64>| Range::of(errors().filter_map(value));
    let first = of.first();
    let floors = Range::of(of.iter().filter_map(|one| one.noise_floor_um));
    Row {
        subject: first.map_or(String::new(), |one| one.subject.to_owned()),
        condition: first.map_or(String::new(), |one| one.condition.to_owned()),
        model,
        name: model.map_or(StraightLine::NAME.to_owned(), |model| model.to_string()),
        searched: of.len(),
        found: errors().count(),
        recordings: devices(of).len(),
        stroke_um: range(&|errors| Some(errors.told.nothing.stroke_um)),
        noise_floor_um: floors.map(|floor| floor.median),
        told_nothing_um: range(&|errors| Some(errors.told.nothing.mae_um)),
        told_first_reading_um: range(&|errors| Some(errors.told.first_reading.mae_um)),
        told_one_cycle_um: range(&|errors| errors.told.one_cycle.map(|figures| figures.mae_um)),
        without_offset_um: range(&|errors| Some(errors.told.offset.mae_um)),
        rms_without_offset_um: range(&|errors| Some(errors.told.nothing.rmse_without_offset_um)),
        interval_um: range(&|errors| errors.interval.map(|interval| interval.half_width_um)),
        coverage_percent: range(&|errors| errors.interval.map(|interval| interval.covered_percent)),
        interval_one_cycle_um: range(&|errors| errors.interval_one_cycle.map(|interval| interval.half_width_um)),
        coverage_one_cycle_percent: range(&|errors| errors.interval_one_cycle.map(|interval| interval.covered_percent)),
        best: false,
        different_from_best: None,
    }
}

fn devices<'j>(of: &[&'j Judged]) -> Vec<&'j str> {
    let mut devices: Vec<&str> = of.iter().map(|one| one.device.as_str()).collect();
    devices.sort_unstable();
    devices.dedup();
    devices
}

/// Whether two models differ on the devices on which both were found.
fn different(one: &[&Judged], other: &[&Judged]) -> bool {
    let pairs: Vec<(Vec<f64>, Vec<f64>)> = devices(one)
        .into_iter()
        .filter_map(|device| Some((over_seeds(one, device)?, over_seeds(other, device)?)))
        .collect();
    let one: Vec<&[f64]> = pairs.iter().map(|(one, _)| one.as_slice()).collect();
    let other: Vec<&[f64]> = pairs.iter().map(|(_, other)| other.as_slice()).collect();
    differ(&one, &other)
}

/// Blocks of a device's recording, the mean over the searches of it; `None` where none found anything.
fn over_seeds(of: &[&Judged], device: &str) -> Option<Vec<f64>> {
    let searches: Vec<&Vec<f64>> =
        of.iter().filter(|one| one.device == device).filter_map(|one| Some(&one.errors.as_ref()?.blocks)).collect();
    let count = searches.first()?.len();
    let mean =
        |block: usize| searches.iter().filter_map(|blocks| blocks.get(block)).sum::<f64>() / searches.len() as f64;
    Some((0..count).map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_told_with_its_ends_where_they_differ() {
        let told = |values: &[f64]| Range::of(values.iter().copied()).map(|range| range.told(2));
        assert_eq!(told(&[0.1, 0.4, 0.2]).as_deref(), Some("0.20 (0.10–0.40)"));
        assert_eq!(told(&[0.1, 0.2]).as_deref(), Some("0.15 (0.10–0.20)"));
        assert_eq!(told(&[0.3]).as_deref(), Some("0.30"));
        assert_eq!(told(&[]), None);
    }
}
