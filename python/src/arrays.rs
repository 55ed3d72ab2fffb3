//! Arrays in, checked before anything moves.

use crate::error::{PiezoError, require};
use numpy::{
    AllowTypeChange, PyArray1, PyArrayDescrMethods, PyArrayLike1, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// Numbers that a tick takes, of any real type and stride; rounded once, to the `f32` that the board computes in.
/// Copied: another thread may write to the array while the ticks run.
pub struct Numbers(Vec<f32>);

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array = aligned(given)?;
        // Their imaginary parts would be lost with a warning.
        require(array.dtype().kind() != b'c', "the numbers are complex: real ones are wanted")?;
        Ok(Self(array.extract::<PyArrayLike1<'_, f32, AllowTypeChange>>()?.as_array().to_vec()))
    }
}

impl Numbers {
    /// The numbers, in the order of the array.
    ///
    /// # Errors
    /// One of them is not finite; what it is called stands before its index.
    pub fn finite(self, name: &str) -> PyResult<Vec<f32>> {
        match self.0.iter().position(|number| !number.is_finite()) {
            None => Ok(self.0),
            Some(index) => Err(PiezoError::new_err(format!("{name}[{index}] is not a finite number in f32"))),
        }
    }
}

/// Codes of an ADC, an array of uint16 and of nothing else: another type's would be cut off. Copied, as numbers are.
pub struct Codes(pub Vec<u16>);

impl<'a, 'py> FromPyObject<'a, 'py> for Codes {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        given.cast::<PyArray1<u16>>()?;
        Ok(Self(aligned(given)?.cast::<PyArray1<u16>>()?.readonly().as_array().to_vec()))
    }
}

/// The array that numpy makes of it, or itself where it is one, with each number where a processor may read it: those
/// of a packed record need not be.
fn aligned<'py>(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = given.py();
    Ok(py.import("numpy")?.call_method1("require", (given, py.None(), "A"))?.cast_into()?)
}

/// One number, rounded once.
///
/// # Errors
/// It is not finite.
pub fn finite_number(number: f64, name: &str) -> PyResult<f32> {
    let number = number as f32;
    if number.is_finite() {
        Ok(number)
    } else {
        Err(PiezoError::new_err(format!("{name} is not a finite number in f32")))
    }
}
