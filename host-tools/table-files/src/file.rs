//! `table.toml`: read, admitted, brought to another tick, and written.

use crate::earlier::earlier;
use crate::error::{Refused, TableFileError};
use crate::line::Line;
use crate::name::name;
use crate::noise::Noise;
use estimator_core::table::BoundToTick;
use estimator_core::{Admitted, Table};
use identification::SearchOptions;
use identification::cost::{Feedback, Norm};
use recordings::prepare::Recipe;
use recordings::{LogUse, Role};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A table.toml as it is read and written.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableFile {
    /// Which program wrote it.
    pub tool: String,
    /// The unit of a fleet that it is of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Reasons not to trust it, in words.
    #[serde(default)]
    pub doubts: Vec<String>,
    /// What the training determined of the actuator, with standard errors, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub determined: Vec<String>,
    /// What the logs were read with; none in a table of before, or where it was written by hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// The parameter table itself.
    pub table: Table,
    /// How logs are prepared for it.
    pub recipe: Recipe,
    /// Whose error was minimised; none where it was written by hand.
    pub cost: Option<Feedback>,
    /// Which error the search minimised.
    pub norm: Option<Norm>,
    /// The measurement's share in what each step started from, of the cost `multi-step`.
    pub feedback_weight: Option<f64>,
    /// How it was searched for; none where it was written by hand.
    pub search: Option<SearchOptions>,
    /// The logs it saw and those held out.
    #[serde(default)]
    pub logs: Vec<LogUse>,
}

const HEADER: &str = "\
# Parameter table of a piezo actuator, for sensorless displacement estimation.
# Units stand in the names: um is micrometre, v volt, us microsecond.
# [table] is what the firmware runs; after changing it (a calibration, say), make its other faces again: piezo emit
";

/// No face is longer than this; a table.toml of fifty logs has 30 kB.
pub const MOST_BYTES: u64 = 4 << 20;

impl TableFile {
    /// Reads and admits a table, which may be named by its folder.
    ///
    /// # Errors
    /// The file cannot be read, is no table, or is refused.
    pub fn load(path: &Path) -> Result<(Self, Admitted), TableFileError> {
        let path = &in_folder(path);
        let text = result_files::read_text(path, MOST_BYTES)
            .map_err(|error| TableFileError::Unreadable { path: path.clone(), error })?;
        Self::parse(path, &text)
    }

    /// Reads and admits a table from a file's text, which comes with a program or was read before.
    ///
    /// # Errors
    /// It is no table, or is refused.
    pub fn parse(path: &Path, text: &str) -> Result<(Self, Admitted), TableFileError> {
        let file: Self = toml::from_str(text).map_err(|error| {
            let path = path.to_owned();
            match earlier(&error, text) {
                Some((field, logs)) => TableFileError::Earlier { path, field, logs },
                None => TableFileError::NoTable { path, error: Box::new(error) },
            }
        })?;
        let admitted = file.admit().map_err(|source| {
            let line = source.field().and_then(|field| Line::that_sets(field, text));
            TableFileError::Refused { path: path.to_owned(), line, source }
        })?;
        if let Some(field) = toml::from_str(text).ok().and_then(|value| not_finite(&value)) {
            return Err(TableFileError::NotFinite { path: path.to_owned(), field });
        }
        Ok((file, admitted))
    }

    /// Checks the table and its recipe.
    ///
    /// # Errors
    /// The table breaks a rule, alone or together with the recipe.
    pub fn admit(&self) -> Result<Admitted, Refused> {
        let admitted = self.table.admit()?;
        self.recipe.check().map_err(Refused::Recipe)?;
        let (recipe, table) = (&self.recipe, &self.table);
        let same = recipe.tick_us == table.sample_period_us
            && recipe.voltage_zero_v as f32 == table.voltage_zero_v
            && recipe.displacement_zero_um as f32 == table.displacement_zero_um;
        if !same {
            return Err(Refused::Differ);
        }
        Ok(admitted)
    }

    /// Brings the table to a tick of so many µs, and its recipe with it, without another search ([`Table::at_tick`]).
    /// What its errors are there nobody has measured, which the doubts are to say.
    ///
    /// # Errors
    /// Its model is bound to the tick that it was identified at.
    pub fn bring_to(&mut self, tick_us: u32) -> Result<(), BoundToTick> {
        let before_us = self.table.sample_period_us;
        if tick_us == before_us {
            return Ok(());
        }
        self.table = self.table.at_tick(tick_us)?;
        self.recipe.tick_us = tick_us;
        let delay_us = f64::from(self.recipe.delay_ticks) * f64::from(before_us);
        self.recipe.delay_ticks = (delay_us / f64::from(tick_us)).round() as u32;
        Ok(())
    }

    /// The text of the file.
    ///
    /// # Errors
    /// A number that the format cannot hold.
    pub fn to_toml(&self) -> Result<String, TableFileError> {
        let mut value = toml::Value::try_from(self)?;
        shorten(&mut value);
        Ok(format!("{HEADER}\n{}", toml::to_string_pretty(&value)?))
    }
}

/// The table.toml in a folder that is named where a table is; what was named where it is none that has one.
pub fn in_folder(path: &Path) -> PathBuf {
    let inside = path.join("table.toml");
    if inside.is_file() { inside } else { path.to_owned() }
}

/// Reads and admits a table from one of its faces, a table.toml or the record in a table.bin, which has nothing
/// but the table.
///
/// # Errors
/// The file cannot be read, is neither, or is refused.
pub fn read(path: &Path) -> Result<(Option<TableFile>, Admitted), TableFileError> {
    if path.extension().is_none_or(|extension| extension != "bin") {
        let (file, admitted) = TableFile::load(path)?;
        return Ok((Some(file), admitted));
    }
    let bytes = result_files::read(path, MOST_BYTES)
        .map_err(|error| TableFileError::Unreadable { path: path.to_owned(), error })?;
    let admitted = Table::parse(&bytes).map_err(|error| TableFileError::Refused {
        path: path.to_owned(),
        line: None,
        source: error.into(),
    })?;
    Ok((None, admitted))
}

/// The table in a folder of results, in words; `None` where there is none that can be read.
pub fn former(folder: &Path) -> Option<String> {
    let (file, table) = TableFile::load(&folder.join("table.toml")).ok()?;
    let logs: Vec<&str> =
        file.logs.iter().filter(|log| log.role == Role::Training).map(|log| log.file.as_str()).collect();
    let logs = Some(logs.join(", ")).filter(|logs| !logs.is_empty());
    let of: Vec<String> = file.unit.into_iter().chain(logs).collect();
    let of = if of.is_empty() { String::new() } else { format!(" of {}", of.join(", ")) };
    Some(format!("the {} table{of} (checksum {})", table.model().name(), name(&table)))
}

/// Where a number is that is not finite.
fn not_finite(value: &toml::Value) -> Option<String> {
    let below =
        |key: String, value| not_finite(value).map(|inner| [key, inner].join(".").trim_end_matches('.').to_owned());
    match value {
        toml::Value::Float(x) => (!x.is_finite()).then(String::new),
        toml::Value::Array(values) => values.iter().enumerate().find_map(|(at, value)| below(at.to_string(), value)),
        toml::Value::Table(table) => table.iter().find_map(|(key, value)| below(key.clone(), value)),
        _ => None,
    }
}

/// Writes numbers that are an `f32` with the fewest digits that bring the same `f32` back: 0.00772, not
/// 0.007720000110566616.
fn shorten(value: &mut toml::Value) {
    match value {
        toml::Value::Float(x) => {
            let single = *x as f32;
            if f64::from(single) == *x {
                // Cannot fail: it is a number's own text.
                *x = single.to_string().parse().unwrap_or(*x);
            }
        }
        toml::Value::Array(values) => values.iter_mut().for_each(shorten),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| shorten(value)),
        _ => {}
    }
}
