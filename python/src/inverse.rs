//! The inverse over arrays: the board's own ticks.

use crate::arrays::Numbers;
use crate::error::{PiezoError, refused, require};
use crate::table::Table;
use crate::ticks::{Run, ticks};
use calibration::drive::planned;
use calibration::span::Span;
use estimator_core::{Commanded, DriveLimits};
use pyo3::prelude::*;

/// A running inverse in f32, as the board has it: from rest at the rest voltage. What it has given stays from one run
/// to the next.
#[pyclass(module = "piezo_estimator")]
pub struct Inverse {
    inverse: estimator_core::Inverse<f32>,
    limits: DriveLimits,
}

/// More ticks than anybody waits for, fourteen hours of them at 2 kHz: what they give has 900 MB.
const MOST_TICKS: usize = 100_000_000;

#[pymethods]
impl Inverse {
    /// The inverse of a table's model within limits of the amplifier voltage (V) and of its change (V/s), which are the
    /// table's drive's where they are not stated; else all voltages that the training went over, and rest at 0 V or
    /// next to it.
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

    /// One tick for each displacement (µm relative to the model's zero) that is wanted a tick after the voltage stands:
    /// the amplifier voltage from the next tick on (V), the displacement that the model gives for it (µm), and whether
    /// that is what was wanted.
    fn run<'py>(&mut self, py: Python<'py>, displacement_um: Numbers) -> PyResult<Run<'py, bool>> {
        let wanted = displacement_um.finite("displacement_um")?;
        ticks(py, &mut self.inverse, wanted.len(), |inverse, tick| given(inverse.tick(wanted[tick])))
    }

    /// So many ticks, at most 100 000 000, towards the rest voltage, as fast as the limits allow.
    fn release<'py>(&mut self, py: Python<'py>, ticks: usize) -> PyResult<Run<'py, bool>> {
        require(ticks <= MOST_TICKS, &format!("ticks must be at most {MOST_TICKS}"))?;
        crate::ticks::ticks(py, &mut self.inverse, ticks, |inverse, _| given(inverse.release()))
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

/// What a tick gives, as Python has it.
fn given(of: Commanded<f32>) -> (f32, f32, bool) {
    (of.voltage, of.displacement, of.reached)
}
