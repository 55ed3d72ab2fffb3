//! Where a log was refused, and how that reads: `path:line: what (value): remedy`.

use std::path::{Path, PathBuf};

use measurement_files::Place;

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

impl LogError {
    /// A sensor's scale was stated for a displacement that is one already.
    pub fn is_of_length(&self) -> bool {
        matches!(self.fault, Fault::SensitivityOfLength { .. })
    }
}

/// A fault and where it is; the file's path is added by [`super::read`].
#[derive(Debug)]
pub(super) struct PlacedFault(pub Place, pub Fault);

impl PlacedFault {
    /// The error about the file at `path`.
    pub fn in_file(self, path: &Path) -> LogError {
        let Self(place, fault) = self;
        LogError { path: path.to_owned(), place, fault }
    }
}

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
    use super::*;
    use measurement_files::Quantity;

    #[test]
    fn reads_path_line_what_value_remedy() {
        let fault = Fault::NotFinite { quantity: Quantity::Voltage, value: "nan".into() };
        let PlacedFault(place, fault) = fault.at(Place::Line(7));
        let error = LogError { path: "a/b.csv".into(), place, fault };
        assert!(error.to_string().starts_with("a/b.csv:7: the voltage is not finite (nan): "));
    }
}
