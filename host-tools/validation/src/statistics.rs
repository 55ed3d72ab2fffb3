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

/// The logarithm of an error (µm) that may be 0; infinite of what is no number.
pub fn logarithm(error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { error.max(f64::MIN_POSITIVE).ln() }
}

/// The geometric mean of errors.
pub fn geometric_mean(errors: &[f64]) -> f64 {
    mean(&errors.iter().copied().map(logarithm).collect::<Vec<_>>()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_nothing_is_small_and_what_is_no_number_is_no_small_one() {
        assert!((geometric_mean(&[1.0, 4.0]) - 2.0).abs() < 1e-12);
        assert!(geometric_mean(&[0.0, 1.0]) < 1e-100);
        assert_eq!(geometric_mean(&[f64::NAN, 1.0]), f64::INFINITY);
        assert_eq!((mean(&[]), standard_error(&[3.0])), (0.0, 0.0));
        assert!((standard_error(&[1.0, 3.0]) - 1.0).abs() < 1e-12);
    }
}
