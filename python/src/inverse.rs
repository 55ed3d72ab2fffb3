//! The inverse over arrays: the board's own ticks.

use crate::arrays::{Numbers, finite};
use crate::error::{PiezoError, refused};
use crate::table::Table;
use calibration::drive::planned;
use calibration::span::Span;
use estimator_core::{Commanded, DriveLimits};
use numpy::PyArray1;
use pyo3::prelude::*;

/// A running inverse in f32, as the board has it: from rest at the rest voltage. What it has given stays from one run to the next.
#[pyclass(module = "piezo_estimator")]
pub struct Inverse {
    inverse: estimator_core::Inverse<f32>,
    limits: DriveLimits,
}

/// Voltage (V), displacement (µm) and whether it is what was wanted, of each tick.
type Run<'py> = (Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<bool>>);

#[pymethods]
impl Inverse {
    /// The inverse of a table's model within limits of the amplifier voltage (V) and of its change (V/s), which are the table's
    /// drive's where they are not stated; else all voltages that the model was identified on, and rest at 0 V or next to it.
    #[new]
    #[pyo3(signature = (table, *, range_v=None, rest_v=None, slew_v_per_s=None))]
    fn new(
        table: &Table,
        range_v: Option<(f64, f64)>,
        rest_v: Option<f64>,
        slew_v_per_s: Option<f64>,
    ) -> PyResult<Self> {
        let range = range_v.map(|(zero, full)| Span { zero, full });
        let Some(limits) = planned(&table.admitted, range, rest_v, slew_v_per_s) else {
            let words = "how fast may the voltage change? State slew_v_per_s: the table has no drive that says it";
            return Err(PiezoError::new_err(words));
        };
        Ok(Self { inverse: table.admitted.inverse(&limits).map_err(refused)?, limits })
    }

    /// One tick for each displacement (µm relative to the model's zero) that is wanted a tick after the voltage stands: the
    /// amplifier voltage from the next tick on (V), the displacement that the model gives for it (µm), and whether that is what
    /// was wanted.
    fn run<'py>(&mut self, py: Python<'py>, displacement_um: Numbers<'py>) -> PyResult<Run<'py>> {
        let wanted = finite(&displacement_um, "displacement_um")?;
        Ok(self.ticks(py, wanted.len(), |inverse, tick| inverse.tick(wanted[tick])))
    }

    /// So many ticks towards the rest voltage, as fast as the limits allow.
    fn release<'py>(&mut self, py: Python<'py>, ticks: usize) -> Run<'py> {
        self.ticks(py, ticks, |inverse, _| inverse.release())
    }

    /// Starts anew, long at rest at the rest voltage.
    fn restart(&mut self) {
        self.inverse.restart();
    }

    /// Amplifier voltages within which it stays, V.
    #[getter]
    fn range_v(&self) -> (f64, f64) {
        (self.limits.range_v.min.into(), self.limits.range_v.max.into())
    }

    /// Amplifier voltage at which it rests, V.
    #[getter]
    fn rest_v(&self) -> f64 {
        self.limits.rest_v.into()
    }

    /// Fastest change of the voltage, V/s.
    #[getter]
    fn slew_v_per_s(&self) -> f64 {
        self.limits.slew_v_per_s.into()
    }
}

impl Inverse {
    /// So many ticks, while other threads of Python run.
    fn ticks<'py>(
        &mut self,
        py: Python<'py>,
        count: usize,
        tick: impl Fn(&mut estimator_core::Inverse<f32>, usize) -> Commanded<f32> + Sync,
    ) -> Run<'py> {
        let inverse = &mut self.inverse;
        let (voltage, displacement, reached) = py.detach(|| {
            let commanded = (0..count).map(|at| tick(inverse, at));
            let (numbers, reached): (Vec<(f32, f32)>, Vec<bool>) =
                commanded.map(|of| ((of.voltage, of.displacement), of.reached)).unzip();
            let (voltage, displacement): (Vec<f32>, Vec<f32>) = numbers.into_iter().unzip();
            (voltage, displacement, reached)
        });
        (PyArray1::from_vec(py, voltage), PyArray1::from_vec(py, displacement), PyArray1::from_vec(py, reached))
    }
}
