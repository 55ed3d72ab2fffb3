//! What keeps a file from being a table of numbers, and where.

use std::fmt;

/// A place in a file.
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

/// What is wrong with a file. A column is counted from 0 among those that were asked for.
#[derive(Debug)]
pub enum Fault {
    /// The operating system, or the decompression, gave no more bytes.
    Unreadable(std::io::Error),
    /// There are no bytes, or nothing but comments.
    Empty,
    /// The file is neither text nor of a binary format that is read.
    Binary {
        /// What the file looks like.
        what: &'static str,
    },
    /// No line is a row of numbers.
    NoRows,
    /// A comma stands between the fields and is the decimal separator, too.
    DecimalCommas,
    /// A row has another number of fields than the rows before.
    UnevenRow {
        /// Fields of this row.
        found: usize,
        /// Fields of the header or the first row.
        expected: usize,
    },
    /// An empty line has rows after it.
    EmptyLine,
    /// A field is no number.
    NotANumber {
        /// Index among the columns asked for.
        column: usize,
        /// The field's text.
        value: String,
    },
    /// A field is NaN, infinite, or an instrument's overload.
    NotFinite {
        /// Index among the columns asked for.
        column: usize,
        /// The field's text.
        value: String,
    },
    /// A field is empty.
    MissingField {
        /// Index among the columns asked for.
        column: usize,
    },
    /// A MATLAB file is of a version that is not read.
    MatVersion {
        /// What the file is.
        what: &'static str,
    },
    /// A binary file does not keep its own format.
    Damaged {
        /// Of which format the file is.
        format: Format,
        /// What was found.
        what: String,
    },
    /// No variable of a MATLAB or LabVIEW file holds signals.
    NoSignals {
        /// Of which format the file is.
        format: Format,
        /// The variables there are.
        variables: String,
    },
    /// Several arrays of a MATLAB file can be the log.
    SeveralArrays {
        /// Their names and sizes.
        variables: String,
        /// The first one's name.
        first: String,
    },
}

/// A binary format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MATLAB's, of any version.
    Matlab,
    /// National Instruments' `.tdms`.
    Tdms,
}

impl Fault {
    pub(crate) fn unreadable(error: std::io::Error) -> Self {
        Self::Unreadable(error)
    }

    pub(crate) fn at(self, place: Place) -> PlacedFault {
        PlacedFault(place, self)
    }
}

/// A fault and where it is.
#[derive(Debug)]
pub struct PlacedFault(pub Place, pub Fault);

impl From<Fault> for PlacedFault {
    fn from(fault: Fault) -> Self {
        Self(Place::File, fault)
    }
}
