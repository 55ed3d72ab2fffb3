//! Where a log was refused, and how that reads: `path:line: what (value): remedy`.

use std::fmt;
use std::path::PathBuf;

use super::fault::Fault;

/// A log that cannot be used. Displayed as `path:line: what (value): remedy`.
#[derive(Debug, thiserror::Error)]
#[error("{}{place}: {fault}", .path.display())]
pub struct LogError {
    /// The file as the caller named it.
    pub path: PathBuf,
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub fault: Fault,
}

/// A place in a log file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1, comments and header included.
    Line(usize),
    /// A sample of a binary array, counted from 1.
    Sample(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::Sample(sample) => write!(f, ": sample {sample}"),
        }
    }
}

/// A fault and where it is; the file's path is added by [`super::read`].
#[derive(Debug)]
pub(super) struct Located(pub Place, pub Fault);

impl Fault {
    pub(super) fn at(self, place: Place) -> Located {
        Located(place, self)
    }
}

impl From<Fault> for Located {
    fn from(fault: Fault) -> Self {
        Self(Place::File, fault)
    }
}

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

/// `text` cut to what a message can carry.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::super::units::Quantity;
    use super::*;

    #[test]
    fn reads_path_line_what_value_remedy() {
        let fault = Fault::NotFinite { quantity: Quantity::Voltage, value: "nan".into() };
        let Located(place, fault) = fault.at(Place::Line(7));
        let error = LogError { path: "a/b.csv".into(), place, fault };
        assert!(error.to_string().starts_with("a/b.csv:7: the voltage is not finite (nan): "));
    }

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

    #[test]
    fn long_text_is_cut() {
        assert_eq!(excerpt("ab"), "ab");
        assert_eq!(excerpt(&"µ".repeat(50)).chars().count(), 41);
    }
}
