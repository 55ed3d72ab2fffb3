//! Arrays of a binary file, put side by side as the columns of a table.
//!
//! One array of three rows or columns is the table, unless other signals are longer. Else the table is made of all
//! signals of one length, those that hold most numbers; a number alone may be the sample time.

use crate::fault::{Fault, Format, Place, PlacedFault};
use crate::preamble::words;
use crate::sample_time;
use crate::sample_time::SampleTime;
use crate::table::{Body, Column, Table};

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
    let longest = longest(arrays);
    let length = longest.first().map_or(0, |array| array.samples());
    // A matrix beside the signals, of gains or colours, is shorter than they.
    let is_log = |array: &&Array| array.channels() == 3 && array.samples() >= length;
    let three: Vec<&Array> = arrays.iter().filter(is_log).collect();
    let (chosen, named) = match three[..] {
        [first, _, ..] => {
            let variables = listed(three.iter().map(|array| array.description.as_str()));
            return Err(Fault::SeveralArrays { variables, first: first.name.clone() }.into());
        }
        [only] => (vec![only], false),
        [] => (longest, true),
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
    Column { name, numeric: true, stamps: false, text: None, values }
}

/// The signals of that length whose signals hold most numbers; a signal alone comes last, however long.
fn longest(arrays: &[Array]) -> Vec<&Array> {
    let of_length =
        |length: usize| arrays.iter().filter(move |array| array.channels() > 0 && array.samples() == length);
    let numbers = |length: usize| {
        let channels = of_length(length).map(Array::channels).sum::<usize>();
        (channels > 1, channels.saturating_mul(length))
    };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(name: &str, length: usize) -> Array {
        let values = Some((0..length).map(|k| k as f64).collect());
        Array { name: name.to_owned(), description: name.to_owned(), rows: length, columns: 1, values }
    }

    #[test]
    fn signals_of_one_length_make_the_table_and_numbers_alone_its_sample_time() {
        let rate = Array { name: "Fs".to_owned(), rows: 1, columns: 1, values: Some(vec![200.0]), ..Array::default() };
        let arrays = [vector("long", 1000), vector("u", 20), rate, vector("y", 20), vector("other", 30)];
        let table = table(Format::Matlab, &arrays).unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["u", "y"]);
        assert_eq!(table.sample_time.unwrap().seconds, 0.005);
    }

    #[test]
    fn a_matrix_beside_longer_signals_is_not_the_log() {
        for side in [3, 64] {
            let matrix = Array { columns: 3, values: Some(vec![0.0; 3 * side]), ..vector("K", side) };
            let signals = [matrix.clone(), vector("t", 1200), vector("voltage", 1200), vector("displacement", 1200)];
            let found = table(Format::Matlab, &signals).unwrap();
            let names: Vec<&str> = found.columns.iter().map(|column| column.name.as_str()).collect();
            assert_eq!((&*names, found.named), (&["t", "voltage", "displacement"][..], true), "{side}");
            let log = Array { columns: 3, values: Some(vec![0.0; 3600]), ..vector("log", 1200) };
            let found = table(Format::Matlab, &[matrix, log]).unwrap();
            assert_eq!((found.columns[0].values.len(), found.named), (1200, false), "{side}");
        }
    }

    #[test]
    fn two_arrays_of_three_signals_are_not_chosen_between() {
        let array = |name: &str| Array { rows: 3, columns: 4, values: Some(vec![0.0; 12]), ..vector(name, 0) };
        let found = table(Format::Matlab, &[array("first"), array("second")]).map(|_| ());
        assert!(matches!(found, Err(PlacedFault(_, Fault::SeveralArrays { .. }))), "{found:?}");
    }
}
