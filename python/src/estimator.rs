//! The estimator over arrays: the board's own ticks.

use crate::arrays::{Codes, Numbers, finite_number};
use crate::error::require;
use crate::table::Table;
use crate::ticks::{Run, ticks};
use estimator_core::{AdcCode, Estimate};
use pyo3::prelude::*;

/// A running estimator in f32, as the board has it. What it has seen stays from one run to the next.
#[pyclass(module = "piezo_estimator")]
pub struct Estimator {
    estimator: estimator_core::Estimator<f32>,
    /// Span of the table's displacement limits, µm.
    span_um: f32,
}

#[pymethods]
impl Estimator {
    /// An estimator at rest at the first tick's voltage.
    #[new]
    fn new(table: &Table) -> Self {
        let table = &table.admitted;
        Self { estimator: estimator_core::Estimator::new(table), span_um: table.displacement_limits_um.span() }
    }

    /// One tick for each amplifier voltage, V: the displacement at the tick after it (µm relative to the model's zero,
    /// plus the bias), half the width of its 95 % interval (µm; NaN where there is none), and the status.
    fn run<'py>(&mut self, py: Python<'py>, volts: Numbers) -> PyResult<Run<'py, u8>> {
        let volts = volts.finite("volts")?;
        ticks(py, &mut self.estimator, volts.len(), |estimator, tick| given(estimator.tick_volts(volts[tick])))
    }

    /// The same for the codes of an ADC with the table's calibration; an array of uint16.
    fn run_codes<'py>(&mut self, py: Python<'py>, codes: Codes) -> PyResult<Run<'py, u8>> {
        let codes = codes.0;
        ticks(py, &mut self.estimator, codes.len(), |estimator, tick| given(estimator.tick(AdcCode(codes[tick]))))
    }

    /// Calls the displacement of now `at_um`, where a stop, a gauge or rest tells it; the interval is relative to it.
    /// Refused as a device does: beyond the span of the table's limits, before the first tick, and while an actuator
    /// that moved then is on its way.
    #[pyo3(signature = (at_um=0.0))]
    fn set_zero(&mut self, at_um: f64) -> PyResult<()> {
        let (at_um, span_um) = (finite_number(at_um, "at_um")?, self.span_um);
        let words = format!("at_um is {at_um} µm, more than {span_um} µm, the span of the table's displacement limits");
        require(at_um.abs() <= span_um, &words)?;
        let words = "the displacement may not be told yet: too few ticks have gone by since the start";
        require(self.estimator.set_zero(at_um), words)
    }

    /// Starts anew from a known displacement, µm relative to the model's zero; whether it lay within the table's
    /// limits, the nearest of which it becomes where it did not.
    fn start_at(&mut self, displacement_um: f64) -> PyResult<bool> {
        Ok(self.estimator.start_at(finite_number(displacement_um, "displacement_um")?))
    }

    /// Starts anew, from rest at the next tick's voltage; what was told is forgotten.
    fn restart(&mut self) {
        self.estimator.restart();
    }

    /// What is added to the model's displacement, as it was told, µm.
    #[getter]
    fn bias_um(&self) -> f32 {
        self.estimator.bias()
    }
}

/// What a tick gives, as Python has it.
fn given(of: Estimate<f32>) -> (f32, f32, u8) {
    (of.displacement, of.half_width.unwrap_or(f32::NAN), of.status.bits())
}
