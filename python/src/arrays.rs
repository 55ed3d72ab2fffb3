//! Arrays in, checked before anything moves.

use crate::error::PiezoError;
use numpy::{AllowTypeChange, PyArrayLike1, PyArrayMethods};
use pyo3::PyResult;

/// Numbers that a tick takes, of any real type; rounded once, to the `f32` that the board computes in.
pub type Numbers<'py> = PyArrayLike1<'py, f32, AllowTypeChange>;

/// The numbers, copied: another thread may write to the array while the ticks run.
///
/// # Errors
/// One of them is not finite; what it is called stands before its index.
pub fn finite(numbers: &Numbers<'_>, name: &str) -> PyResult<Vec<f32>> {
    let numbers = numbers.to_vec()?;
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(index) => Err(PiezoError::new_err(format!("{name}[{index}] is not a finite number in f32"))),
    }
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
