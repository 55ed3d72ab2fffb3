//! A file's table: what its columns are called, and its rows, one after the other.

use crate::fault::{Fault, Place, PlacedFault};
use crate::reading::is_reading;
use crate::sample_time::SampleTime;
use crate::text_rows::TextRows;

/// A table of numbers, opened and not yet read to its end.
pub struct Table<'a> {
    /// The columns from left to right.
    pub columns: Vec<Column>,
    /// Whether the file names its columns.
    pub named: bool,
    /// Where the columns are named, or where the rows begin if nothing names them.
    pub header: Place,
    /// The sample time that the file states outside its columns.
    pub sample_time: Option<SampleTime>,
    /// Where the first row stands.
    pub first_row: Place,
    pub(crate) body: Body<'a>,
}

/// Where the rows are.
pub(crate) enum Body<'a> {
    Text(Box<TextRows<'a>>),
    Series,
}

/// One column of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// The name as the file states it, with the unit in parentheses if that stands apart from it.
    pub name: String,
    /// Whether the column holds numbers or time stamps; else text, or nothing.
    pub numeric: bool,
    /// Whether the column holds time stamps, which are read as seconds since the first.
    pub stamps: bool,
    /// The first text of a column that holds text.
    pub text: Option<String>,
    /// The values of the rows that were looked at to find the table; of a binary file all.
    pub values: Vec<f64>,
}

impl Table<'_> {
    /// Hands each row's values of the columns `wanted` (indices into [`Table::columns`]) to `visit`, to the file's end.
    /// With `holes`, a value that is no finite number, or is an instrument's overload, is NaN where another value of
    /// its row is one that was read.
    ///
    /// # Errors
    /// The first row that is none, with its place.
    pub fn rows(self, wanted: &[usize], holes: bool, visit: &mut dyn FnMut(&[f64])) -> Result<(), PlacedFault> {
        match self.body {
            Body::Text(rows) => rows.read(wanted, holes, visit),
            Body::Series => series(&self.columns, self.first_row, wanted, holes, visit),
        }
    }
}

/// The place of row `index`, counted from 0, where the first row stands at `first`.
#[must_use]
pub fn place(first: Place, index: usize) -> Place {
    match first {
        Place::File => Place::File,
        Place::Line(line) => Place::Line(line.saturating_add(index)),
        Place::Sample(sample) => Place::Sample(sample.saturating_add(index)),
    }
}

fn series(
    columns: &[Column],
    first: Place,
    wanted: &[usize],
    holes: bool,
    visit: &mut dyn FnMut(&[f64]),
) -> Result<(), PlacedFault> {
    let chosen: Vec<&[f64]> = wanted.iter().map(|&at| columns.get(at).map_or(&[][..], |c| &c.values)).collect();
    let length = chosen.iter().map(|values| values.len()).min().unwrap_or(0);
    let mut row = vec![0.0; chosen.len()];
    for index in 0..length {
        row.iter_mut().zip(&chosen).for_each(|(value, values)| *value = values[index]);
        let some = holes && row.iter().any(|&value| is_reading(value));
        for (column, value) in row.iter_mut().enumerate().filter(|(_, value)| !is_reading(**value)) {
            if !some {
                let value = value.to_string();
                return Err(Fault::NotFinite { column, value }.at(place(first, index)));
            }
            *value = f64::NAN;
        }
        visit(&row);
    }
    Ok(())
}
