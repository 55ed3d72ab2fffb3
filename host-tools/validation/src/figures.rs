//! Errors of an estimate in numbers.
//!
//! ```text
//! e(k) = estimate(k) − sensor(k)                 µm, k = 1 … n measured instants
//! MAE  = mean |e|     RMSE = √mean e²     MAX = max |e|
//! MAE without offset   mean |e − median e|       the least that any constant leaves of the MAE
//! RMS without offset   √mean (e − mean e)²       the least that any constant leaves of the RMSE
//! ```

use serde::Serialize;

/// Errors of an estimate, µm, at the measured instants that are scored.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Figures {
    /// Mean absolute error.
    pub mae_um: f64,
    /// Largest absolute error.
    pub max_um: f64,
    /// Root mean square error.
    pub rmse_um: f64,
    /// Measured displacement, peak to peak, without what is no measurement ([`stroke`](log_survey::stroke)).
    pub stroke_um: f64,
    /// Median of estimate − measurement: what drift, creep and the session's start leave, and re-zeroing removes.
    pub offset_um: f64,
    /// Mean absolute error without that offset.
    pub mae_without_offset_um: f64,
    /// Root mean square error without the mean of estimate − measurement.
    pub rmse_without_offset_um: f64,
    /// Mean absolute error in % of the stroke.
    pub mae_percent: f64,
    /// Largest absolute error in % of the stroke.
    pub max_percent: f64,
    /// Root mean square error in % of the stroke.
    pub rmse_percent: f64,
    /// Mean absolute error without the offset in % of the stroke.
    pub mae_without_offset_percent: f64,
    /// Root mean square error without the mean in % of the stroke.
    pub rmse_without_offset_percent: f64,
}

impl Figures {
    /// Of estimates beside what was measured at the same instants, µm, of a displacement
    /// of this [`stroke`](log_survey::stroke).
    pub fn of(estimated: &[f64], measured: &[f64], stroke_um: f64) -> Self {
        let errors: Vec<f64> = estimated.iter().zip(measured).map(|(e, m)| e - m).collect();
        let count = errors.len().max(1) as f64;
        let mean = |of: &dyn Fn(f64) -> f64| errors.iter().map(|&e| of(e)).sum::<f64>() / count;
        let (mut in_order, middle) = (errors.clone(), errors.len() / 2);
        let median = (!in_order.is_empty()).then(|| *in_order.select_nth_unstable_by(middle, f64::total_cmp).1);
        let offset_um = median.unwrap_or(0.0);
        let mae_um = mean(&f64::abs);
        let mae_without_offset_um = mean(&|e| (e - offset_um).abs());
        let mean_um = mean(&|e| e);
        let rmse_without_offset_um = mean(&|e| (e - mean_um) * (e - mean_um)).sqrt();
        let max_um = errors.iter().fold(0.0f64, |max, e| e.abs().max(max));
        let rmse_um = mean(&|e| e * e).sqrt();
        let percent = |um: f64| 100.0 * um / stroke_um;
        Self {
            mae_um,
            max_um,
            rmse_um,
            stroke_um,
            offset_um,
            mae_without_offset_um,
            rmse_without_offset_um,
            mae_percent: percent(mae_um),
            max_percent: percent(max_um),
            rmse_percent: percent(rmse_um),
            mae_without_offset_percent: percent(mae_without_offset_um),
            rmse_without_offset_percent: percent(rmse_without_offset_um),
        }
    }

    /// Several logs in one line: the means of MAE and of its percentages, the largest of MAX, the root of the mean
    /// squares of what is a root mean square, each log weighing the same.
    pub fn all<'a>(figures: impl ExactSizeIterator<Item = &'a Self> + Clone) -> Option<Self> {
        let count = figures.len() as f64;
        let mean = |of: fn(&Self) -> f64| figures.clone().map(of).sum::<f64>() / count;
        let max = |of: fn(&Self) -> f64| figures.clone().map(of).fold(0.0, f64::max);
        let square = |of: fn(&Self) -> f64| {
            let squares = figures.clone().map(of).map(|rms| rms * rms);
            (squares.sum::<f64>() / count).sqrt()
        };
        (count > 0.0).then(|| Self {
            mae_um: mean(|f| f.mae_um),
            max_um: max(|f| f.max_um),
            rmse_um: square(|f| f.rmse_um),
            stroke_um: max(|f| f.stroke_um),
            offset_um: mean(|f| f.offset_um),
            mae_without_offset_um: mean(|f| f.mae_without_offset_um),
            rmse_without_offset_um: square(|f| f.rmse_without_offset_um),
            mae_percent: mean(|f| f.mae_percent),
            max_percent: max(|f| f.max_percent),
            rmse_percent: square(|f| f.rmse_percent),
            mae_without_offset_percent: mean(|f| f.mae_without_offset_percent),
            rmse_without_offset_percent: square(|f| f.rmse_without_offset_percent),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rms_without_offset_is_the_standard_deviation_of_the_error() {
        let measured = [0.0, 10.0, 0.0, 10.0];
        let figures = Figures::of(&[1.0, 11.0, 1.0, 15.0], &measured, 10.0);
        // Errors 1, 1, 1, 5: mean 2, median 1.
        assert_eq!(figures.offset_um, 1.0);
        assert_eq!(figures.mae_without_offset_um, 1.0);
        assert!((figures.rmse_without_offset_um - 3f64.sqrt()).abs() < 1e-12);
        assert!((figures.rmse_without_offset_percent - 10.0 * 3f64.sqrt()).abs() < 1e-12);
        assert!((figures.rmse_um.powi(2) - (figures.rmse_without_offset_um.powi(2) + 4.0)).abs() < 1e-12);
    }

    #[test]
    fn over_several_logs_it_is_the_root_of_the_mean_square() {
        let measured = [0.0, 10.0];
        let logs = [Figures::of(&[1.0, 9.0], &measured, 10.0), Figures::of(&[7.0, 3.0], &measured, 10.0)];
        let all = Figures::all(logs.iter()).unwrap();
        assert!((all.rmse_without_offset_um - 25f64.sqrt()).abs() < 1e-12, "{all:?}");
    }
}
