//! Statistics of some errors.

/// Their mean; 0 of none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The standard error of their mean; 0 of a single one.
pub fn standard_error(values: &[f64]) -> f64 {
    let (count, mean) = (values.len() as f64, mean(values));
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (squares / (count * (count - 1.0).max(1.0))).sqrt()
}

/// The logarithm of an error (µm) that may be 0.
pub fn logarithm(error: f64) -> f64 {
    error.max(f64::MIN_POSITIVE).ln()
}

/// The geometric mean of errors.
pub fn geometric_mean(errors: &[f64]) -> f64 {
    mean(&errors.iter().copied().map(logarithm).collect::<Vec<_>>()).exp()
}
