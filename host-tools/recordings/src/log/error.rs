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
pub(super) struct PlacedFault(pub Place, pub Fault);

impl Fault {
    pub(super) fn at(self, place: Place) -> PlacedFault {
        PlacedFault(place, self)
    }
}

impl From<Fault> for PlacedFault {
    fn from(fault: Fault) -> Self {
        Self(Place::File, fault)
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::Quantity;
    use super::*;

    #[test]
    fn reads_path_line_what_value_remedy() {
        let fault = Fault::NotFinite { quantity: Quantity::Voltage, value: "nan".into() };
        let PlacedFault(place, fault) = fault.at(Place::Line(7));
        let error = LogError { path: "a/b.csv".into(), place, fault };
        assert!(error.to_string().starts_with("a/b.csv:7: the voltage is not finite (nan): "));
    }
}
