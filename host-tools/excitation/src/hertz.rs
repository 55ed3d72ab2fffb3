//! Frequencies as a person types them.

/// A frequency above 0 as `50`, `50Hz`, `50 Hz` or `0.05kHz`, Hz.
///
/// # Errors
/// It is none.
pub fn hertz(text: &str) -> Result<f64, String> {
    let (number, factor) = match (text.strip_suffix("kHz"), text.strip_suffix("Hz")) {
        (Some(number), _) => (number, 1e3),
        (None, number) => (number.unwrap_or(text), 1.0),
    };
    let number = number.trim_end().parse::<f64>().ok().map(|number| factor * number).filter(|hz| hz.is_finite());
    match number {
        Some(hz) if hz > 0.0 => Ok(hz),
        Some(_) => Err("must be above 0".to_owned()),
        None => Err("expected a frequency, as 50Hz or 50".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_may_have_its_unit() {
        for (text, hz) in [("50", 50.0), ("50Hz", 50.0), ("50 Hz", 50.0), ("2.5kHz", 2_500.0), ("1e-3kHz", 1.0)] {
            assert_eq!(hertz(text), Ok(hz), "{text}");
        }
        for text in ["", "Hz", "50 V", "50hertz", "0Hz", "-1", "nan", "infHz", "1e999Hz"] {
            assert!(hertz(text).is_err(), "{text}");
        }
    }
}
