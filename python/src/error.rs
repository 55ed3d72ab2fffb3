//! What is refused, as an exception in the library's own words.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use std::error::Error;

create_exception!(
    piezo_estimator,
    PiezoError,
    PyValueError,
    "What a file, a table, a log or a request is refused for, in words."
);

/// The exception of an error and of what caused it. What it quotes of a file changes nothing of a terminal.
pub fn refused(error: impl Error + 'static) -> PyErr {
    let chain = std::iter::successors(Some(&error as &(dyn Error + 'static)), |&error| error.source());
    let words = chain.map(ToString::to_string).collect::<Vec<_>>().join(": ");
    PiezoError::new_err(
        words.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { '?' } else { c }).collect::<String>(),
    )
}

/// The exception where a rule of a request does not hold.
pub fn require(holds: bool, rule: &str) -> Result<(), PyErr> {
    if holds { Ok(()) } else { Err(PiezoError::new_err(rule.to_owned())) }
}
