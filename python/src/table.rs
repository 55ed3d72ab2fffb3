//! Parameter tables.

use crate::error::{PiezoError, refused, require};
use crate::log::{Log, Session};
use estimator_core::{Admitted, Range};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use result_files::{Held, may_be_replaced};
use std::ffi::CString;
use std::path::PathBuf;
use table_files::{FACES, TableFile};

/// A parameter table that was admitted: stable, and proven to stay within its limits.
#[pyclass(frozen, module = "piezo_estimator")]
pub struct Table {
    pub admitted: Admitted,
    /// What table.toml says besides; a record has none of it.
    pub file: Option<TableFile>,
}

/// A range as Python has it.
fn pair(range: Range, shift: f32) -> (f64, f64) {
    (f64::from(range.min + shift), f64::from(range.max + shift))
}

#[pymethods]
impl Table {
    /// Reads and admits a table.toml, or the record in a table.bin. Warns where it lies beside a face of another table.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let (file, admitted) = table_files::read(&path).map_err(refused)?;
        if let Err(other) = table_files::agree(&path, &admitted) {
            let words = other.to_string().replace('\0', "?");
            // Cannot fail: there is no NUL in it.
            let words = CString::new(words).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &words, 1)?;
        }
        Ok(Self { admitted, file })
    }

    /// Writes table.toml, table.rs and table.bin into a folder, all or none; the folder is made where there is none. A
    /// file of such a name that is no former face of a table is refused, or lost with `force`.
    #[pyo3(signature = (folder, *, force=false))]
    fn write(&self, folder: PathBuf, force: bool) -> PyResult<()> {
        let faces = self.toml("all that table.toml says")?.faces().map_err(refused)?;
        let held = Held::of(&folder).map_err(refused)?;
        for (name, known_by) in FACES {
            let path = folder.join(name);
            let unreadable = |error| PiezoError::new_err(format!("{}: cannot be read ({error})", path.display()));
            let free = force || may_be_replaced(&path, known_by).map_err(unreadable)?;
            let words =
                "is there already, and no former face of a table: name another folder, or lose it with force=True";
            require(free, &format!("{}: {words}", path.display()))?;
        }
        held.write_all(faces).map_err(refused)
    }

    /// The record, as table.bin and the board's flash hold it.
    fn record(&self) -> Vec<u8> {
        table_files::record(&self.admitted)
    }

    /// A log at the table's tick, prepared by its recipe.
    pub fn prepare(&self, log: &Log) -> PyResult<Session> {
        let recipe = self.toml("how logs are prepared")?.recipe.of(&log.0);
        let session = recipe.session(&recipe.cut(&log.0)).map_err(refused)?;
        Ok(Session { session, voltage_zero_v: self.admitted.voltage_zero_v.into() })
    }

    /// Name of the model.
    #[getter]
    fn model(&self) -> &'static str {
        self.admitted.model().name()
    }

    /// Checksum of the record, by which programs and boards name the table.
    #[getter]
    fn checksum(&self) -> String {
        table_files::name(&self.admitted)
    }

    /// Time between two ticks, s.
    #[getter]
    fn sample_period_s(&self) -> f64 {
        self.admitted.sample_period()
    }

    /// Amplifier voltages that the model was identified on, V.
    #[getter]
    fn voltage_range_v(&self) -> (f64, f64) {
        pair(self.admitted.voltage_range_v, self.admitted.voltage_zero_v)
    }

    /// The estimate never leaves these but by what it was told, µm relative to the model's zero.
    #[getter]
    fn displacement_limits_um(&self) -> (f64, f64) {
        pair(self.admitted.displacement_limits_um, 0.0)
    }

    /// Reading of the sensor that the model calls 0, µm.
    #[getter]
    fn displacement_zero_um(&self) -> f64 {
        self.admitted.displacement_zero_um.into()
    }

    /// Whether it states how far the estimate may be off.
    #[getter]
    fn has_interval(&self) -> bool {
        self.admitted.interval.is_some()
    }

    /// Whether it states limits within which an amplifier may be driven.
    #[getter]
    fn has_drive(&self) -> bool {
        self.admitted.drive.is_some()
    }

    /// Reasons not to trust it, in words; none are known of a record.
    #[getter]
    fn doubts(&self) -> Vec<String> {
        self.file.as_ref().map_or(Vec::new(), |file| file.doubts.clone())
    }

    /// What the training determined of the actuator, in words; nothing is known of a record.
    #[getter]
    fn determined(&self) -> Vec<String> {
        self.file.as_ref().map_or(Vec::new(), |file| file.determined.clone())
    }

    fn __repr__(&self) -> String {
        format!("<Table {}, {}>", self.model(), self.checksum())
    }
}

impl Table {
    /// What table.toml says.
    fn toml(&self, what: &str) -> PyResult<&TableFile> {
        self.file
            .as_ref()
            .ok_or_else(|| PiezoError::new_err(format!("a record does not hold {what}: read the table.toml beside it")))
    }
}
