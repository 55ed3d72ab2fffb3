//! Arrays of a binary file, put side by side as the columns of a table.
//!
//! One array of three rows or columns is the table. Else the table is made of all signals of one length, those that hold
//! most numbers; a number alone may be the sample time.

use crate::fault::{Fault, Format, Place, PlacedFault};
use crate::preamble::words;
use crate::sample_time;
use crate::table::{Body, Column, SampleTime, Table};

/// One real array of numbers, or what else a file names.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Array {
    /// Its name; of a field the last one.
    pub name: String,
    /// Name and sides, for messages.
    pub description: String,
    pub rows: usize,
    pub columns: usize,
    /// Its numbers, column by column, as many as the sides say; nothing if it is no real two-dimensional array.
    pub values: Option<Vec<f64>>,
}

impl Array {
    /// How many signals the array can hold: its shorter side.
    fn channels(&self) -> usize {
        if self.values.is_some() { self.rows.min(self.columns) } else { 0 }
    }

    /// How many samples each has.
    fn samples(&self) -> usize {
        self.rows.max(self.columns)
    }

    fn signal(&self, channel: usize) -> Vec<f64> {
        let values = self.values.as_deref().unwrap_or_default();
        match self.rows <= self.columns {
            true => values.iter().skip(channel).step_by(self.rows.max(1)).copied().collect(),
            false => values.chunks(self.rows).nth(channel).unwrap_or_default().to_vec(),
        }
    }

    fn name_of(&self, channel: usize) -> String {
        match (self.channels(), self.rows <= self.columns) {
            (1, _) => self.name.clone(),
            (_, true) => format!("{}({},:)", self.name, channel + 1),
            (_, false) => format!("{}(:,{})", self.name, channel + 1),
        }
    }
}

/// The table that the arrays of a file make.
pub(crate) fn table<'a>(format: Format, arrays: &[Array]) -> Result<Table<'a>, PlacedFault> {
    let three: Vec<&Array> = arrays.iter().filter(|array| array.channels() == 3).collect();
    let (chosen, named) = match three[..] {
        [first, _, ..] => {
            let variables = listed(three.iter().map(|array| array.description.as_str()));
            return Err(Fault::SeveralArrays { variables, first: first.name.clone() }.into());
        }
        [only] => (vec![only], false),
        [] => (longest(arrays), true),
    };
    if chosen.is_empty() {
        let variables = listed(arrays.iter().map(|array| array.description.as_str()));
        return Err(Fault::NoSignals { format, variables }.into());
    }
    let signals = chosen.iter().flat_map(|array| (0..array.channels()).map(move |channel| (array, channel)));
    let columns = signals.map(|(array, channel)| column(array.name_of(channel), array.signal(channel))).collect();
    Ok(of_columns(columns, named, arrays.iter().find_map(stated)))
}

/// A table of columns that are all there.
pub(crate) fn of_columns<'a>(columns: Vec<Column>, named: bool, sample_time: Option<SampleTime>) -> Table<'a> {
    Table { columns, named, header: Place::File, sample_time, first_row: Place::Sample(1), body: Body::Series }
}

/// A column of numbers.
pub(crate) fn column(name: String, values: Vec<f64>) -> Column {
    Column { name, numeric: true, stamps: false, values }
}

/// The signals of that length whose signals hold most numbers.
fn longest(arrays: &[Array]) -> Vec<&Array> {
    let of_length =
        |length: usize| arrays.iter().filter(move |array| array.channels() > 0 && array.samples() == length);
    let numbers = |length: usize| of_length(length).map(|array| array.channels() * length).sum::<usize>();
    let lengths = arrays.iter().filter(|array| array.channels() > 0 && array.samples() > 1).map(Array::samples);
    lengths.max_by_key(|&length| numbers(length)).map(|length| of_length(length).collect()).unwrap_or_default()
}

/// The sample time that a number alone states by its name.
fn stated(array: &Array) -> Option<SampleTime> {
    let &[value] = array.values.as_deref()? else { return None };
    let seconds = sample_time::seconds(&words(&array.name), &value.to_string(), None)?;
    Some(SampleTime { seconds, place: Place::File, name: array.name.clone() })
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MOST: usize = 10;
    let mut names: Vec<&str> = names.collect();
    if names.len() > MOST {
        names.truncate(MOST);
        names.push("…");
    }
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
