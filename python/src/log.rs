//! Logs, and logs at the tick.

use crate::error::refused;
use numpy::PyArray1;
use pyo3::prelude::*;
use recordings::log::{Columns, Need, ReadOptions, Sensitivity, read};
use recordings::session;
use std::path::PathBuf;

/// One recorded session, as its file has it, in s, V and µm.
#[pyclass(frozen, module = "piezo_estimator")]
pub struct Log(pub recordings::log::Log);

/// Reads a log of any of the formats that `piezo look` reads.
///
/// `columns` says which column holds what ("time=1,voltage=2:mV,displacement=5:um"), `sensor` how far a volt of the
/// sensor is ("2.5um/V"), and `fs` the sample rate in Hz, where the file does not. Without `displacement_required` or
/// `voltage_required` a log without it is read, too. With `holes`, a voltage or displacement that is no number, and
/// samples that the time stamps leave out, are left out by `identify(..., repair=True)` instead of refused.
#[pyfunction]
#[pyo3(signature = (
    path, *, columns=None, sensor=None, fs=None, displacement_required=true, voltage_required=true, holes=false
))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword in Python")]
pub fn read_log(
    py: Python<'_>,
    path: PathBuf,
    columns: Option<&str>,
    sensor: Option<&str>,
    fs: Option<f64>,
    displacement_required: bool,
    voltage_required: bool,
    holes: bool,
) -> PyResult<Log> {
    let options = ReadOptions {
        columns: columns.map(str::parse::<Columns>).transpose().map_err(refused)?,
        sensor: sensor.map(str::parse::<Sensitivity>).transpose().map_err(refused)?,
        sample_rate: fs,
        holes,
        displacement: if displacement_required { Need::Required } else { Need::Optional },
        voltage_required,
    };
    py.detach(|| read(&path, &options)).map(Log).map_err(refused)
}

#[pymethods]
impl Log {
    /// File name without its extension.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// SHA-256 of the file's bytes, in hexadecimal.
    #[getter]
    fn sha256(&self) -> &str {
        &self.0.sha256
    }

    /// Sample period, s.
    #[getter]
    fn sample_period_s(&self) -> f64 {
        self.0.sample_period
    }

    /// Time of each sample since the first, s.
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, (0..self.samples()).map(|sample| sample as f64 * self.0.sample_period))
    }

    /// Voltage of each sample, V; empty where the log has none.
    #[getter]
    fn volts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.voltage)
    }

    /// Displacement of each sample, µm; None where the log has none.
    #[getter]
    fn displacement_um<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.displacement.as_deref().map(|displacement| PyArray1::from_slice(py, displacement))
    }

    /// Whether the displacement is a device's estimate, and no sensor's.
    #[getter]
    fn displacement_estimated(&self) -> bool {
        self.0.displacement_estimated
    }

    fn __repr__(&self) -> String {
        format!("<Log {}, {:.3} s>", self.0.name, self.samples() as f64 * self.0.sample_period)
    }
}

impl Log {
    /// Samples of either quantity.
    fn samples(&self) -> usize {
        self.0.voltage.len().max(self.0.displacement.as_ref().map_or(0, Vec::len))
    }
}

/// A log at the tick: a voltage at every tick, a displacement at the instants where it was measured.
#[pyclass(frozen, module = "piezo_estimator")]
pub struct Session {
    pub session: session::Session,
    /// Amplifier voltage that the model calls 0, V.
    pub voltage_zero_v: f64,
}

#[pymethods]
impl Session {
    /// Name of the log it comes from.
    #[getter]
    fn name(&self) -> &str {
        &self.session.name
    }

    /// Time of each tick since the log's first sample, s.
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let session::Session { start_s, tick_s, .. } = self.session;
        PyArray1::from_iter(py, (0..self.session.voltage.len()).map(|tick| start_s + tick as f64 * tick_s))
    }

    /// Amplifier voltage at each tick, V.
    #[getter]
    fn volts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.session.voltage.iter().map(|volts| volts + self.voltage_zero_v))
    }

    /// Ticks at which the displacement was measured, counted from 0.
    #[getter]
    fn instants<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.session.instants.iter().map(|&instant| instant.into()))
    }

    /// Measured displacement at the instants, µm relative to the model's zero.
    #[getter]
    fn displacement_um<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.session.displacement)
    }

    fn __repr__(&self) -> String {
        let session::Session { name, voltage, instants, tick_s, .. } = &self.session;
        format!(
            "<Session {name}, {} ticks of {} µs, {} instants>",
            voltage.len(),
            (1e6 * tick_s).round(),
            instants.len()
        )
    }
}
