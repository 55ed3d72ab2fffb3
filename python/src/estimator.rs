//! The estimator over arrays: the board's own ticks.

use crate::arrays::{Numbers, finite, finite_number};
use crate::error::PiezoError;
use crate::table::Table;
use estimator_core::{AdcCode, Estimate};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

/// A running estimator in f32, as the board has it. What it has seen stays from one run to the next.
#[pyclass(module = "piezo_estimator")]
pub struct Estimator(estimator_core::Estimator<f32>);

/// Displacement (µm), half-width of its interval (µm) and status of each tick.
type Run<'py> = (Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<u8>>);

#[pymethods]
impl Estimator {
    /// An estimator at rest at the first tick's voltage.
    #[new]
    fn new(table: &Table) -> Self {
        Self(estimator_core::Estimator::new(&table.admitted))
    }

    /// One tick for each amplifier voltage, V: the displacement at the tick after it (µm relative to the model's zero, plus the
    /// bias), half the width of its 95 % interval (µm; NaN where there is none), and the status.
    fn run<'py>(&mut self, py: Python<'py>, volts: Numbers<'py>) -> PyResult<Run<'py>> {
        let volts = finite(&volts, "volts")?;
        Ok(self.ticks(py, &volts, |estimator, &volts| estimator.tick_volts(volts)))
    }

    /// The same for the codes of an ADC with the table's calibration; an array of uint16.
    fn run_codes<'py>(&mut self, py: Python<'py>, codes: PyReadonlyArray1<'py, u16>) -> PyResult<Run<'py>> {
        Ok(self.ticks(py, &codes.to_vec()?, |estimator, &code| estimator.tick(AdcCode(code))))
    }

    /// Calls the displacement of now `at_um`, where a stop, a gauge or rest tells it; the interval is relative to it. Refused
    /// before the first tick, and while an actuator that moved then is on its way.
    #[pyo3(signature = (at_um=0.0))]
    fn set_zero(&mut self, at_um: f64) -> PyResult<()> {
        if self.0.set_zero(finite_number(at_um, "at_um")?) {
            Ok(())
        } else {
            Err(PiezoError::new_err("the displacement may not be told yet: too few ticks have gone by since the start"))
        }
    }

    /// Starts anew from a known displacement, µm relative to the model's zero; whether it lay within the table's limits, the
    /// nearest of which it becomes where it did not.
    fn start_at(&mut self, displacement_um: f64) -> PyResult<bool> {
        Ok(self.0.start_at(finite_number(displacement_um, "displacement_um")?))
    }

    /// Starts anew, from rest at the next tick's voltage; what was told is forgotten.
    fn restart(&mut self) {
        self.0.restart();
    }

    /// What is added to the model's displacement, as it was told, µm.
    #[getter]
    fn bias_um(&self) -> f32 {
        self.0.bias()
    }
}

impl Estimator {
    /// A tick for each input, while other threads of Python run.
    fn ticks<'py, I: Sync>(
        &mut self,
        py: Python<'py>,
        inputs: &[I],
        tick: impl Fn(&mut estimator_core::Estimator<f32>, &I) -> Estimate<f32> + Sync,
    ) -> Run<'py> {
        let estimator = &mut self.0;
        let (displacement, half_width, status) = py.detach(|| {
            let estimates = inputs.iter().map(|input| tick(estimator, input));
            let (numbers, status): (Vec<(f32, f32)>, Vec<u8>) =
                estimates.map(|of| ((of.displacement, of.half_width.unwrap_or(f32::NAN)), of.status.bits())).unzip();
            let (displacement, half_width): (Vec<f32>, Vec<f32>) = numbers.into_iter().unzip();
            (displacement, half_width, status)
        });
        (PyArray1::from_vec(py, displacement), PyArray1::from_vec(py, half_width), PyArray1::from_vec(py, status))
    }
}
