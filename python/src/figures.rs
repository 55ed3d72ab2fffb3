//! Errors of an estimate in numbers.

use crate::error::{PiezoError, refused};
use crate::log::Log;
use crate::table::Table;
use identification::validate::{Scope, Told, compare_within};
use pyo3::prelude::*;

/// Errors of an estimate, µm or % of the measured stroke, at the measured instants that are scored.
#[pyclass(frozen, get_all, module = "piezo_estimator")]
#[derive(Clone, Copy)]
pub struct Figures {
    /// Mean absolute error, µm.
    mae_um: f64,
    /// Largest absolute error, µm.
    max_um: f64,
    /// Root mean square error, µm.
    rmse_um: f64,
    /// Measured displacement, peak to peak without spikes, µm.
    stroke_um: f64,
    /// Median of estimate − measurement, µm.
    offset_um: f64,
    /// Mean absolute error without that offset, µm.
    mae_without_offset_um: f64,
    /// Root mean square error without the mean of estimate − measurement, µm.
    rmse_without_offset_um: f64,
    /// Mean absolute error in % of the stroke.
    mae_percent: f64,
    /// Largest absolute error in % of the stroke.
    max_percent: f64,
}

impl From<identification::validate::Figures> for Figures {
    fn from(of: identification::validate::Figures) -> Self {
        Self {
            mae_um: of.mae_um,
            max_um: of.max_um,
            rmse_um: of.rmse_um,
            stroke_um: of.stroke_um,
            offset_um: of.offset_um,
            mae_without_offset_um: of.mae_without_offset_um,
            rmse_without_offset_um: of.rmse_without_offset_um,
            mae_percent: of.mae_percent,
            max_percent: of.max_percent,
        }
    }
}

#[pymethods]
impl Figures {
    fn __repr__(&self) -> String {
        let Self { mae_um, max_um, mae_percent, stroke_um, .. } = self;
        format!("<Figures {mae_um:.4} µm on average, {max_um:.4} µm at most, {mae_percent:.2} % of {stroke_um:.2} µm>")
    }
}

/// Errors of a table's estimate on a log, as `piezo validate` has them: by what the estimator is told ("nothing",
/// "first-reading", "one-cycle" or "offset"), over the part of the log that is scored, s since its first sample.
#[pyfunction]
#[pyo3(signature = (table, log, *, told="first-reading", from_s=None, to_s=None, zero_at_s=None))]
pub fn validate(
    py: Python<'_>,
    table: &Table,
    log: &Log,
    told: &str,
    from_s: Option<f64>,
    to_s: Option<f64>,
    zero_at_s: Option<f64>,
) -> PyResult<Figures> {
    let Some(told) = Told::ALL.into_iter().find(|of| of.name() == told) else {
        let names = Told::ALL.map(Told::name).join(", ");
        return Err(PiezoError::new_err(format!("told is one of {names}, not {told:?}")));
    };
    let session = table.prepare(log)?.session;
    let scope = Scope { from_s, to_s, zero_at_s };
    let comparison = py.detach(|| compare_within(&table.admitted, &session, &scope)).map_err(refused)?;
    let figures = comparison
        .told
        .get(told.before(zero_at_s.is_some()))
        .ok_or_else(|| refused(identification::validate::ScopeError::NoCycle))?;
    Ok((*figures).into())
}
