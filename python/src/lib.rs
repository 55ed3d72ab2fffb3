//! The estimator, its inverse and the identification for programs in Python: the module `piezo_estimator`.
//!
//! A thin face: `estimator-core` in `f32` over arrays of numpy, so that the numbers are those of the board bit for bit;
//! the logs, the identification and the figures of the libraries that `piezo` calls. What is refused is an exception,
//! `PiezoError`, in the library's own words; what takes long lets other threads of Python run.
//!
//! `piezo_estimator.pyi` says the same with types, and is what an editor shows.

mod arrays;
mod error;
mod estimator;
mod figures;
mod identify;
mod inverse;
mod log;
mod table;
mod ticks;

use pyo3::prelude::*;

/// Displacement of piezo actuators without a sensor: tables, estimator, inverse, logs, identification.
#[pymodule]
mod piezo_estimator {
    use super::*;
    use estimator_core::Status;

    #[pymodule_export]
    use super::error::PiezoError;
    #[pymodule_export]
    use super::estimator::Estimator;
    #[pymodule_export]
    use super::figures::{Figures, validate};
    #[pymodule_export]
    use super::identify::{Identified, identify};
    #[pymodule_export]
    use super::inverse::Inverse;
    #[pymodule_export]
    use super::log::{Log, Session, read_log};
    #[pymodule_export]
    use super::table::Table;

    /// The bits of a status by their names, and the version.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        Status::all().iter_names().try_for_each(|(name, bit)| module.add(name, bit.bits()))?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
