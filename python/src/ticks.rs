//! A run of ticks, which other threads of Python and Ctrl-C get through.

use numpy::{Element, PyArray1};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Ticks between two looks at what Python has to raise.
const STRETCH: usize = 1_000_000;

/// Two numbers and one thing more, of each tick.
pub type Run<'py, T> = (Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<T>>);

/// So many ticks of something, and what each of them gives. What Python raises meanwhile ends it, and then none of
/// them was made.
///
/// # Errors
/// Python has something to raise, or not the memory for so many ticks.
pub fn ticks<'py, S: Clone + Send, T: Element>(
    py: Python<'py>,
    running: &mut S,
    count: usize,
    tick: impl Fn(&mut S, usize) -> (f32, f32, T) + Sync,
) -> PyResult<Run<'py, T>> {
    let mut ahead = running.clone();
    let (mut first, mut second, mut third) = (reserved(count)?, reserved(count)?, reserved(count)?);
    for from in (0..count).step_by(STRETCH) {
        py.detach(|| {
            for at in from..count.min(from + STRETCH) {
                let (one, two, three) = tick(&mut ahead, at);
                first.push(one);
                second.push(two);
                third.push(three);
            }
        });
        py.check_signals()?;
    }
    *running = ahead;
    Ok((PyArray1::from_vec(py, first), PyArray1::from_vec(py, second), PyArray1::from_vec(py, third)))
}

/// A list that this many fit into.
fn reserved<T>(count: usize) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    let enough = list.try_reserve_exact(count);
    enough.map_err(|error| PyMemoryError::new_err(format!("of {count} ticks: {error}")))?;
    Ok(list)
}
