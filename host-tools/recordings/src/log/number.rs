//! Numbers of a log, short enough for a message.

use std::fmt;

/// A number in a message: at most six significant digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.5e}", self.0);
        match text.parse::<f64>() {
            Ok(x) if x == 0.0 || (1e-6..1e9).contains(&x.abs()) => write!(f, "{x}"),
            Ok(x) => write!(f, "{x:e}"),
            Err(_) => f.write_str(&text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.000_500_000_000_1, "0.0005"),
            (0.0, "0"),
            (-123.456_789, "-123.457"),
            (1e300, "1e300"),
            (1.5e-9, "1.5e-9"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Number(x).to_string(), text);
        }
    }
}
