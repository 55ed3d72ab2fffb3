//! A unit as one row: of a table for people, of a CSV file, of JSON.

use crate::error::UnitError;
use crate::member::Member;
use crate::unit::{Ended, Identified};
use estimator_core::Model;
use serde::Serialize;
use std::fmt;

/// By what the CSV file is known near its beginning.
pub const CSV: &str = "unit,folder,status,";

/// How a unit is.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// It has a table.
    Identified,
    /// Its run has ended without a table.
    Failed,
    /// Its run has not ended: it holds the folder.
    Running,
    /// Its run was killed, or goes on where its lock is not seen from here.
    Killed,
    /// There is no file of it.
    Missing,
    /// There is one that says nothing.
    #[default]
    Unreadable,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Identified => "identified",
            Self::Failed => "failed",
            Self::Running => "running",
            Self::Killed => "killed",
            Self::Missing => "missing",
            Self::Unreadable => "unreadable",
        })
    }
}

/// One unit, with a column for each field; empty where nothing is known.
#[derive(Clone, Default, PartialEq, Debug, Serialize)]
pub struct Row {
    /// The unit; of a folder that does not say it, the folder's name.
    pub unit: String,
    /// The folder that the unit's files are in.
    pub folder: String,
    /// Whether it has a table, has failed or still runs.
    pub status: State,
    /// The chosen model.
    pub model: Option<Model>,
    /// Mean absolute error on what was held out, µm.
    pub held_out_mae_um: Option<f64>,
    /// The same in % of the stroke.
    pub held_out_mae_percent: Option<f64>,
    /// Largest error there, µm.
    pub held_out_max_um: Option<f64>,
    /// Least half-width of the interval, µm.
    pub half_width_um: Option<f64>,
    /// The same in % of the training stroke.
    pub half_width_percent: Option<f64>,
    /// Stroke of the training, µm.
    pub stroke_um: Option<f64>,
    /// How many doubts there are.
    pub doubts: Option<usize>,
    /// The kind of the gravest.
    pub gravest_doubt: Option<String>,
    /// It is so grave that the table is not to be used.
    pub grave: bool,
    /// The checksum of the table's record.
    pub table: Option<String>,
    /// Time that it took, s.
    pub seconds: Option<f64>,
    /// The gravest doubt, or why there is no table, in words.
    pub said: Option<String>,
}

impl Row {
    /// Of a member; `said` puts into words what is wrong with its file.
    pub fn of(member: &Member, said: &impl Fn(&UnitError) -> String) -> Self {
        let folder_name = member.folder.file_name().unwrap_or(member.folder.as_os_str()).to_string_lossy();
        let row =
            Self { unit: folder_name.into_owned(), folder: member.folder.display().to_string(), ..Self::default() };
        let unit = match &member.unit {
            Ok(unit) => unit,
            Err(error) => {
                let status =
                    if matches!(error, UnitError::Missing { .. }) { State::Missing } else { State::Unreadable };
                return Self { status, said: Some(said(error)), ..row };
            }
        };
        let row = Self { unit: unit.unit.to_string(), ..row };
        match &unit.ended {
            Ended::Begun => {
                let (status, said) = match result_files::is_held(&member.folder) {
                    true => (State::Running, "its run has not ended yet"),
                    // A network's file system may show the locks of another machine to nobody.
                    false => (State::Killed, "its run was killed, unless it goes on on another machine"),
                };
                Self { status, said: Some(said.to_owned()), ..row }
            }
            Ended::Failed { error, seconds, table_before, .. } => {
                let of_before = |table: &String| format!("; the folder still holds {table} of an earlier run");
                let of_before = table_before.as_ref().map(of_before).unwrap_or_default();
                let said = Some(format!("{error}{of_before}"));
                Self { status: State::Failed, seconds: Some(*seconds), said, ..row }
            }
            Ended::Identified(identified) => row.identified(identified),
        }
    }

    fn identified(self, Identified { found, seconds, .. }: &Identified) -> Self {
        let stroke_um = found.training.map(|errors| errors.stroke_um).filter(|&stroke| stroke > 0.0);
        let gravest = found.doubts.first();
        Self {
            status: State::Identified,
            model: Some(found.model),
            held_out_mae_um: found.held_out.map(|errors| errors.mae_um),
            held_out_mae_percent: found.held_out.and_then(|errors| errors.mae_percent),
            held_out_max_um: found.held_out.map(|errors| errors.max_um),
            half_width_um: found.half_width_um,
            half_width_percent: found.half_width_um.zip(stroke_um).map(|(half, stroke)| 100.0 * half / stroke),
            stroke_um,
            doubts: Some(found.doubts.len()),
            gravest_doubt: gravest.map(|gravest| gravest.doubt.clone()),
            grave: gravest.is_some_and(|gravest| gravest.grave),
            table: Some(found.table.clone()),
            seconds: Some(*seconds),
            said: gravest.map(|gravest| gravest.said.clone()),
            ..self
        }
    }
}

/// Rows as a CSV file, with a heading.
///
/// # Errors
/// A row that cannot be written.
pub fn csv(rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    writer.into_inner().map_err(|error| error.into_error().into())
}
