//! `unit.json`: what came of one unit's identification, whether it found a table or not.

use crate::asked::Asked;
use crate::error::UnitError;
use estimator_core::Model;
use identification::validate::Figures;
use identification::{Doubt, Outcome};
use recordings::LogUse;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::io::ErrorKind;
use std::path::Path;
use std::str::FromStr;

/// The file's name, and by what it is known near its beginning.
pub const UNIT: (&str, &str) = ("unit.json", "\"piezo_unit\"");
/// The version of its format.
pub const VERSION: u64 = 1;
/// Characters of a name at most.
pub const LONGEST: usize = 100;
/// No file is longer than this; that of fifty logs has 20 kB.
const MOST_BYTES: u64 = 4 << 20;

/// What a unit is called, as its label or its serial number has it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct UnitName(String);

impl FromStr for UnitName {
    type Err = UnitError;

    /// What begins as a spreadsheet's formula, or as an option, is no name: it would be taken for one where the name
    /// is passed on.
    fn from_str(name: &str) -> Result<Self, UnitError> {
        let length = name.chars().count();
        let wrong = name.trim() != name
            || !(1..=LONGEST).contains(&length)
            || name.starts_with(['-', '=', '+', '@'])
            || name.chars().any(char::is_control);
        if wrong { Err(UnitError::Name { name: name.to_owned(), longest: LONGEST }) } else { Ok(Self(name.to_owned())) }
    }
}

impl TryFrom<String> for UnitName {
    type Error = UnitError;

    fn try_from(name: String) -> Result<Self, UnitError> {
        name.parse()
    }
}

impl From<UnitName> for String {
    fn from(UnitName(name): UnitName) -> Self {
        name
    }
}

impl fmt::Display for UnitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// What a unit's folder says of it: the file unit.json.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Unit {
    /// The version of its format; the first field, by which the file is known.
    pub piezo_unit: u64,
    /// What the unit is called.
    pub unit: UnitName,
    /// Which program wrote it.
    pub tool: String,
    /// How the run ended, and what it has found.
    #[serde(flatten)]
    pub ended: Ended,
}

/// How an identification ended.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
pub enum Ended {
    /// It has not: it still runs, or was killed.
    Begun,
    /// There is a table.
    Identified(Box<Identified>),
    /// The run ended without a table.
    Failed {
        /// The program's exit code.
        exit_code: u8,
        /// Why, as the user was told it.
        error: String,
        /// Time that it took, s.
        seconds: f64,
        /// The table of an earlier run that is still in the folder, in words.
        table_before: Option<String>,
    },
}

/// What there is of an identification that found a table.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Identified {
    /// The program's exit code.
    pub exit_code: u8,
    /// Time that it took, s.
    pub seconds: f64,
    /// What it was made from.
    pub asked: Asked,
    /// The model, its errors and its doubts.
    #[serde(flatten)]
    pub found: Found,
    /// The files beside this one, by name, with their SHA-256.
    pub files: BTreeMap<String, String>,
}

/// The model, its errors and its doubts.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Found {
    /// The chosen model.
    pub model: Model,
    /// Why it was chosen, in words.
    pub reason: String,
    /// The checksum of its table's record, which names the table.
    pub table: String,
    /// Errors of the table on what it was learnt from.
    pub training: Option<Errors>,
    /// Errors of the model as it was judged, on what was held out until then; `None` where nothing was.
    pub held_out: Option<Errors>,
    /// Least half-width of the interval beside the estimate, µm; `None` where there is none.
    pub half_width_um: Option<f64>,
    /// Reasons not to trust it, the gravest first.
    pub doubts: Vec<Reservation>,
    /// What each log was used for.
    pub logs: Vec<LogUse>,
}

/// A doubt, in short and in words.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Reservation {
    /// The kind of doubt, as identify's JSON names it.
    pub doubt: String,
    /// The table is not to be used before it is mended.
    pub grave: bool,
    /// As the user reads it.
    pub said: String,
}

/// Errors of an estimate in simulation.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct Errors {
    /// Mean absolute error, µm.
    pub mae_um: f64,
    /// The same in % of the stroke; `None` of a stroke of nothing.
    pub mae_percent: Option<f64>,
    /// Mean absolute error without offset, µm.
    pub mae_without_offset_um: f64,
    /// Root mean square error, µm.
    pub rmse_um: f64,
    /// Largest absolute error, µm.
    pub max_um: f64,
    /// Measured displacement, peak to peak, µm.
    pub stroke_um: f64,
}

impl Unit {
    /// Reads a unit's file.
    ///
    /// # Errors
    /// It is missing, cannot be read, or is another file.
    pub fn read(path: &Path) -> Result<Self, UnitError> {
        let text = result_files::read_text(path, MOST_BYTES).map_err(|error| match error.kind() {
            ErrorKind::NotFound => UnitError::Missing { folder: path.parent().unwrap_or(path).to_owned() },
            _ => UnitError::Unreadable { path: path.to_owned(), error },
        })?;
        Self::parse(path, &text)
    }

    /// Reads a unit from a file's text.
    ///
    /// # Errors
    /// It is another file's.
    pub fn parse(path: &Path, text: &str) -> Result<Self, UnitError> {
        let wrong = |error| UnitError::NoUnit { path: path.to_owned(), error };
        // The version first: a field that another has and this has not says less.
        let Version { piezo_unit } = serde_json::from_str(text).map_err(wrong)?;
        if piezo_unit != VERSION {
            return Err(UnitError::Version { path: path.to_owned(), version: piezo_unit, read: VERSION });
        }
        serde_json::from_str(text).map_err(wrong)
    }

    /// What was found, where there is a table.
    pub fn identified(&self) -> Option<&Identified> {
        if let Ended::Identified(identified) = &self.ended { Some(identified) } else { None }
    }
}

#[derive(Deserialize)]
struct Version {
    piezo_unit: u64,
}

impl Found {
    /// Of an identification.
    ///
    /// # Errors
    /// A doubt that cannot be written.
    pub fn of(outcome: &Outcome) -> serde_json::Result<Self> {
        let learnt = &outcome.learnt.candidate;
        // What a log is known by again is in the table.
        let used = |log: &LogUse| LogUse { content: None, ..log.clone() };
        Ok(Self {
            model: learnt.table.model(),
            reason: findings::reason(&outcome.reason),
            table: table_files::name(&learnt.table),
            training: learnt.training_figures().map(Errors::from),
            held_out: outcome.judged().held_out_figures().map(Errors::from),
            half_width_um: learnt.table.interval.map(|interval| f64::from(interval.misfit_um)),
            doubts: outcome.doubts.iter().map(Reservation::of).collect::<serde_json::Result<_>>()?,
            logs: outcome.learnt.logs.iter().map(used).collect(),
        })
    }
}

impl Reservation {
    fn of(doubt: &Doubt) -> serde_json::Result<Self> {
        let kind = findings::doubt_json(doubt)?["doubt"].as_str().unwrap_or_default().to_owned();
        Ok(Self { doubt: kind, grave: doubt.grave(), said: findings::doubt(doubt) })
    }
}

impl From<Figures> for Errors {
    fn from(of: Figures) -> Self {
        let Figures { mae_um, mae_percent, mae_without_offset_um, rmse_um, max_um, stroke_um, .. } = of;
        let mae_percent = Some(mae_percent).filter(|percent| percent.is_finite());
        Self { mae_um, mae_percent, mae_without_offset_um, rmse_um, max_um, stroke_um }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An identified unit with this error and ±, in % of a stroke of 20 µm.
    pub fn identified(name: &str, mae_percent: f64, half_width_percent: f64) -> Unit {
        let errors = Errors {
            mae_um: 0.2 * mae_percent,
            mae_percent: Some(mae_percent),
            mae_without_offset_um: 0.1 * mae_percent,
            rmse_um: 0.3 * mae_percent,
            max_um: mae_percent,
            stroke_um: 20.0,
        };
        let found = Found {
            model: Model::GeneralisedPrandtlIshlinskii,
            reason: "it was asked for.".to_owned(),
            table: "0badcafe".to_owned(),
            training: Some(errors),
            held_out: Some(errors),
            half_width_um: Some(0.2 * half_width_percent),
            doubts: Vec::new(),
            logs: Vec::new(),
        };
        let asked = Asked { inputs: name.to_owned(), options: String::new(), program: String::new() };
        let identified = Identified { exit_code: 0, seconds: 3.5, asked, found, files: BTreeMap::new() };
        unit(name, Ended::Identified(Box::new(identified)))
    }

    pub fn unit(name: &str, ended: Ended) -> Unit {
        Unit { piezo_unit: VERSION, unit: name.parse().unwrap(), tool: "piezo 0.0.0".to_owned(), ended }
    }

    #[test]
    fn a_file_is_read_as_it_was_written_and_begins_with_what_it_is_known_by() {
        let error = "a \"quoted\" error".to_owned();
        let failed = Ended::Failed { exit_code: 2, error, seconds: 0.1, table_before: None };
        for unit in [identified("SN042", 0.19, 2.0), unit("Nº 7", failed), unit("SN043", Ended::Begun)] {
            let text = serde_json::to_string_pretty(&unit).unwrap();
            assert!(text.find(UNIT.1).unwrap() < 10, "{text}");
            assert_eq!(Unit::parse(Path::new("unit.json"), &text).unwrap(), unit);
        }
    }

    #[test]
    fn what_is_no_unit_s_file_says_why() {
        let said = |text: &str| Unit::parse(Path::new("a/unit.json"), text).unwrap_err().to_string();
        assert!(said("{\"unit\": \"SN042\"}").contains("missing field `piezo_unit`"));
        assert!(said("{\"piezo_unit\": 1, \"unit").contains("a/unit.json: is no unit.json (EOF while parsing"));
        assert!(said("{\"piezo_unit\": 2, \"new\": true}").contains("of version 2, and this program reads version 1"));
        let half = "{\"piezo_unit\": 1, \"unit\": \"a\", \"tool\": \"piezo\", \"status\": \"identified\"}";
        assert!(said(half).contains("missing field `exit_code`"), "{}", said(half));
        let name = "{\"piezo_unit\": 1, \"unit\": \"=1+1\", \"tool\": \"piezo\", \"status\": \"begun\"}";
        assert!(said(name).contains("`=1+1` is no unit's name"), "{}", said(name));
    }

    #[test]
    fn a_name_is_what_a_label_has_and_nothing_that_is_taken_for_something_else() {
        for name in ["SN042", "Nº 7", "stage/3 (left)", "$1"] {
            assert_eq!(name.parse::<UnitName>().unwrap().to_string(), name);
        }
        let long = "x".repeat(LONGEST + 1);
        for name in ["", " ", " SN042", "-f", "=SUM(A1)", "+1", "@a", "a\nb", "a\u{1b}[2J", &long] {
            assert!(name.parse::<UnitName>().is_err(), "{name:?}");
        }
    }
}
