//! Everything that can be wrong with a log, each with its value, and its remedy where that lies in the file. Where it
//! lies in what is said about the file ([`ReadOptions`](super::ReadOptions)), the fault holds an example of it.

use measurement_files::{Quantity, Unit, UnknownUnit};

use super::number::Number;

/// What is wrong with a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// There is no such file.
    #[error("no such file: check the name, and the folder it is looked for in")]
    NotFound,
    /// The operating system refuses to read it.
    #[error("cannot be read ({0}){remedy}", remedy = match .0.kind() {
        std::io::ErrorKind::PermissionDenied => ": check its permissions",
        std::io::ErrorKind::OutOfMemory => ": it is larger than this machine's memory, split it",
        _ => "",
    })]
    Unreadable(std::io::Error),
    /// A directory was named.
    #[error("is a directory: name one log file in it")]
    Directory,
    /// A device, pipe or socket was named.
    #[error("is not a regular file: save the log to a file first")]
    NotRegular,
    /// No bytes, or nothing but comments.
    #[error("holds no data: record or export the log again")]
    Empty,
    /// Neither text nor of a binary format that is read.
    #[error("is {what}, and no log that can be read: export the recording as CSV, or as a .mat or .tdms file")]
    Binary {
        /// What the file looks like.
        what: &'static str,
    },
    /// Too short to say anything about.
    #[error("has {rows} rows of numbers, and {minimum} are the fewest that can be used: record for longer")]
    FewRows {
        /// Rows that were found.
        rows: usize,
        /// Rows that are needed.
        minimum: usize,
    },

    /// The stated rate is none.
    #[error("{0} Hz is not a sample rate")]
    SampleRate(f64),
    /// A table without a header, and no columns stated.
    #[error("no header names the {count} columns ({columns})")]
    NoHeader {
        /// Columns of the file.
        count: usize,
        /// The columns there are, each with its range.
        columns: String,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
        /// Whether the sample rate has to be stated, too.
        rate_needed: bool,
    },
    /// Neither a time column, nor a sample time in the file, nor a stated rate.
    #[error("nothing in the file says when its rows were recorded (columns: {columns})")]
    NoTime {
        /// The columns there are, each with its range.
        columns: String,
    },
    /// No column for a quantity that is needed.
    #[error("no column says that it holds the {quantity} (columns: {columns})")]
    NoColumn {
        /// What is missing.
        quantity: Quantity,
        /// The columns there are, each with its range.
        columns: String,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
        /// The same where the displacement was recorded as a sensor's volts; if that can be.
        with_sensor: Option<String>,
        /// Whether the sample rate has to be stated, too.
        rate_needed: bool,
    },
    /// Several columns can be a quantity by their units, and none says so by its name.
    #[error("several columns can be the {quantity} (columns: {columns})")]
    Ambiguous {
        /// What is sought.
        quantity: Quantity,
        /// The columns there are, each with its range.
        columns: String,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// A sensor's volts, and no scale to turn them into a displacement.
    #[error("column {column:?} is a sensor's output in {unit}, and how far a volt is was not said")]
    NoSensitivity {
        /// The header name.
        column: String,
        /// The unit that stands with it.
        unit: Unit,
    },
    /// A sensor's scale for a column that is a displacement already.
    #[error("a sensor's scale was stated, and column {column:?} is in {unit}")]
    SensitivityOfLength {
        /// The header name.
        column: String,
        /// The unit that stands with it.
        unit: Unit,
    },
    /// The file states a sample time outside its columns that no log has.
    #[error(
        "the file's {name:?} is a sample time of {seconds} s, which no such log has: correct that line of the file"
    )]
    ImplausibleSampleTime {
        /// What the file calls it.
        name: String,
        /// The sample time, s.
        seconds: Number,
    },
    /// The stated rate and the file's own sample time differ.
    #[error("a rate of {stated} Hz disagrees with the file's {name:?}, a sample time of {seconds} s")]
    RateContradicted {
        /// The stated rate, Hz.
        stated: Number,
        /// What the file calls its sample time.
        name: String,
        /// The file's sample time, s.
        seconds: Number,
    },
    /// Two header names claim one quantity.
    #[error("columns {first:?} and {second:?} both claim to be the {quantity}")]
    TwoClaims {
        /// What both claim to be.
        quantity: Quantity,
        /// The first header name.
        first: String,
        /// The second header name.
        second: String,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// A header name without a unit.
    #[error("column {column:?} states no unit")]
    MissingUnit {
        /// The header name.
        column: String,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
        /// The same where the displacement was recorded as a sensor's volts; if that can be.
        with_sensor: Option<String>,
    },
    /// A header name with a unit that is not known.
    #[error("column {column:?}: {unit}")]
    UnknownUnit {
        /// The header name.
        column: String,
        /// The unit's text.
        unit: UnknownUnit,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// A header name with a unit of another quantity.
    #[error("column {column:?} is read as the {quantity} and {unit} is no unit of it")]
    WrongDimension {
        /// The header name.
        column: String,
        /// What the name says.
        quantity: Quantity,
        /// What the unit says.
        unit: Unit,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// A column with the name of a quantity holds text.
    #[error("column {column:?} is named as the {quantity} and holds text ({value:?}): {remedy}")]
    TextColumn {
        /// What the name says.
        quantity: Quantity,
        /// The header name.
        column: String,
        /// Its first text.
        value: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A stated column is not there.
    #[error("column {wanted} was asked for and the columns are {columns}: choose among these")]
    NoSuchColumn {
        /// What was asked for.
        wanted: String,
        /// The columns there are.
        columns: String,
    },

    /// A field that is no number.
    #[error("the {quantity} is not a number ({value:?}): correct the value, or delete the rows before or after it")]
    NotANumber {
        /// Which quantity it is of.
        quantity: Quantity,
        /// The field's text.
        value: String,
    },
    /// NaN, infinity, or an instrument's overload.
    #[error("the {quantity} is not finite ({value}): remove the recording's invalid part, or record again")]
    NotFinite {
        /// Which quantity it is of.
        quantity: Quantity,
        /// The value as written.
        value: String,
    },
    /// An empty field.
    #[error("the {quantity} is missing (empty field): fill it in, or record again")]
    MissingField {
        /// Which quantity it is of.
        quantity: Quantity,
    },
    /// More values that are none than holes of a recording.
    #[error(
        "the {quantity} is no number in {missing} of {rows} rows, first here: that is no hole of a recording; record again"
    )]
    Holes {
        /// Which quantity it is of.
        quantity: Quantity,
        /// The rows without one.
        missing: usize,
        /// All rows of the log.
        rows: usize,
    },
    /// A row of another length than the rows before.
    #[error(
        "this row has {found} fields and the first has {expected}: complete the row, or separate all fields in one way"
    )]
    UnevenRow {
        /// Fields of this row.
        found: usize,
        /// Fields of the header or the first row.
        expected: usize,
    },
    /// A comma between the fields, and in the numbers.
    #[error(
        "a comma separates the columns and is the decimal separator, too, so that each number is two fields: export it with \
         semicolons or tabs between the columns, or with decimal points"
    )]
    DecimalCommas,
    /// An empty line with rows after it.
    #[error("an empty line separates the rows: keep one recording a file, or delete the line")]
    EmptyLine,

    /// A time stamp not after the one before.
    #[error("time does not increase ({value} s after {previous} s): keep one recording a file, with its rows in order")]
    TimeNotIncreasing {
        /// The time stamp, s.
        value: Number,
        /// The one before, s.
        previous: Number,
    },
    /// Samples are missing.
    #[error(
        "{missing} samples are missing after t = {after} s (gaps in all: {gaps}): keep the part before or after, or record again"
    )]
    Gap {
        /// Samples missing in this gap.
        missing: u64,
        /// Last time stamp before it, s.
        after: Number,
        /// Gaps in the whole log.
        gaps: usize,
        /// Whether what is missing in all of them is little enough to be holes
        /// ([`ReadOptions::holes`](super::ReadOptions::holes)).
        few: bool,
    },
    /// A time stamp off the clock.
    #[error(
        "irregular time stamp (t = {value} s is {percent} % of a sample period of {period} s off its place): record with a \
         hardware clock or, if the rate was in truth constant, leave the time column out and state the rate"
    )]
    IrregularTime {
        /// The time stamp, s.
        value: Number,
        /// Deviation, % of the period.
        percent: Number,
        /// Sample period, s.
        period: Number,
        /// [`Columns`](super::Columns) without the time.
        example: String,
    },
    /// A sample period that no log of this kind has.
    #[error("the time column gives a sample period of {period} s, taken to be in {unit}")]
    ImplausiblePeriod {
        /// Sample period, s.
        period: Number,
        /// The unit it was read in.
        unit: Unit,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// The stated rate and the time column differ.
    #[error("a rate of {stated} Hz disagrees with the time column ({found} Hz, taken to be in {unit})")]
    RateDisagrees {
        /// The stated rate, Hz.
        stated: Number,
        /// From the time column, Hz.
        found: Number,
        /// The unit it was read in.
        unit: Unit,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },

    /// The same value in every row.
    #[error("the {quantity} is constant ({value} {unit} in all {rows} rows)")]
    Constant {
        /// Which quantity it is of.
        quantity: Quantity,
        /// The value, base unit.
        value: Number,
        /// The base unit.
        unit: Unit,
        /// How many rows.
        rows: usize,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },
    /// A span that no such log has, most often a wrong unit.
    #[error("the {quantity} spans {span} {base}, {limit}; it was taken to be in {unit}")]
    ImplausibleSpan {
        /// Which quantity it is of.
        quantity: Quantity,
        /// Largest minus smallest value, base unit.
        span: Number,
        /// The base unit.
        base: Unit,
        /// The limit passed, in words.
        limit: &'static str,
        /// The unit it was read in.
        unit: Unit,
        /// [`Columns`](super::Columns) as they may be meant.
        example: String,
    },

    /// A MATLAB file of a version that is not read, or none at all.
    #[error("is {what}: save it again with save('log.mat', 'log', '-v7')")]
    MatVersion {
        /// What the file is.
        what: &'static str,
    },
    /// A damaged MATLAB file.
    #[error("is a damaged MATLAB file ({what}): save it again with save('log.mat', 'log', '-v7')")]
    MatDamaged {
        /// What was found.
        what: String,
    },
    /// A LabVIEW file that cannot be read.
    #[error("is a .tdms file that cannot be read ({what}): export it as .lvm or CSV")]
    TdmsDamaged {
        /// What was found.
        what: String,
    },
    /// No variable of the file can be a log.
    #[error(
        "no variable holds signals (variables: {variables}): save the log as log = [t(:)'; V(:)'; y(:)'] in s, V and um; of a \
         timeseries ts, ts.Time and ts.Data"
    )]
    MatNoLog {
        /// The variables there are.
        variables: String,
    },
    /// No channel of the file can be a log.
    #[error("no channel holds numbers (channels: {variables}): record or export the log again")]
    TdmsNoLog {
        /// The channels there are.
        variables: String,
    },
    /// Several variables of the file can be a log.
    #[error("several variables can be the log ({variables}): save one a file, as in save('log.mat', '{first}', '-v7')")]
    MatSeveral {
        /// Their names and sizes.
        variables: String,
        /// The first one's name.
        first: String,
    },
}
